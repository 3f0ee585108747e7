//! The files of the library that call Ipopt or MUMPS, and what they need.
#![allow(
    dead_code,
    unused_imports,
    reason = "the rest of the library is not here"
)]

#[path = "src/ipopt/mod.rs"]
pub mod ipopt;
#[path = "src/kkt/mod.rs"]
pub mod kkt;
#[path = "src/math/mod.rs"]
pub mod math;
#[path = "src/nlp/mod.rs"]
pub mod nlp;
#[path = "src/sparse/mod.rs"]
pub mod sparse;
#[path = "src/stop.rs"]
pub mod stop;
