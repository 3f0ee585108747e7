//! Quantities that a problem names in limits, costs and recordings: their entries as written, and what these stand for.
//!
//! A new quantity has its entries in the file of its part, and a line of `keys` for each use.

pub(crate) mod entry;
pub mod joint;
pub mod keys;
pub mod marker;
pub mod muscle;
pub mod source;
