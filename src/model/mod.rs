//! From physics to indices.
pub mod system;
