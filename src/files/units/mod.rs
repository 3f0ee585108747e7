//! Numbers with units, converted once to g, mm, ms, N, MPa, V.

pub mod quantity;
pub(crate) mod unit;

pub(crate) use quantity::si;
pub(crate) use unit::number_and_unit;
