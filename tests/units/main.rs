//! Units that the library does not show. Their files are compiled here once more, with their tests, which stand in the folders beside this
//! file; a library with tests of its own would be compiled twice as a whole.
#![allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "a few files of the library alone are here"
)]

// As in the library, where the paths of the files begin at the same place.
#[path = "../../src/kkt/mod.rs"]
mod kkt;
#[path = "../../src/math/mod.rs"]
mod math;
#[path = "../../src/sparse/mod.rs"]
mod sparse;

mod coordinates;
mod dynamics;

mod electrodes;
mod poses;
mod signals;
