//! Quantities that limits, costs and recordings name, and their measures.

pub(super) mod charge_measures;
pub(super) mod measures;
pub(super) mod pull;
pub(super) mod quantity;
pub(super) mod what;
