//! Bytes as a scene file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proboscis::files::{expand, read_scene};
use proboscis_fuzz::{check, with};

fuzz_target!(|bytes: &[u8]| {
    with("scene.json", bytes, |_, path| match read_scene(&path) {
        Ok(_) => {
            let expanded = expand(&path).expect("what was read can be written out");
            assert!(expanded.contains('{'));
        }
        Err(error) => check("scene.json", error),
    });
});
