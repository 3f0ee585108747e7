//! The law of a controller in SI units: `feedback.json`, a table, a C file.

mod read;
mod record;
mod write_c;

pub(crate) use read::read_law;
pub(crate) use record::{factor_of, unit_of};
pub use record::{law_csv, law_json};
pub use write_c::law_c;
