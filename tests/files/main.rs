//! Scene and problem files, as written and as mistaken.

mod fuzz_reader;
mod scene;
