//! Motion of a system over time.
pub mod trajectory;
