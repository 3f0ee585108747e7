//! Numbers with units, converted once to g, mm, ms, N, MPa, V.

mod dimension;
pub mod quantity;
pub(crate) mod unit;
mod written;

pub(crate) use written::si;
