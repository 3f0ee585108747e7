//! Bytes as a problem file, with its scene inside or in a file of its own.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proboscis::files::read_problem;
use proboscis_fuzz::{check, with};

fuzz_target!(|bytes: &[u8]| {
    with("problem.json", bytes, |_, path| {
        if let Err(error) = read_problem(&path, &[]) {
            // A mistake may stand in the scene that the problem names.
            check(".json", error);
        }
    });
});
