//! `feedback.json`: the law of a controller in SI units.

mod read;
mod record;
mod write;

pub(crate) use read::read_law;
pub use write::{law_csv, law_json};
