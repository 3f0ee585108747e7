//! Bytes as a Gmsh file of a block.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proboscis::files::read_scene;
use proboscis_fuzz::{check, with};
use std::fs;

const SCENE: &str = r#"{
  "name": "block", "materials": { "rubber": { "shear_modulus": "100 kPa", "lame_lambda": "400 kPa", "density": 1000 } },
  "solids": [ { "name": "block", "material": "rubber", "mesh": "block.msh" } ]
}"#;

fuzz_target!(|bytes: &[u8]| {
    with("block.msh", bytes, |folder, _| {
        let scene = folder.join("scene.json");
        if !scene.exists() {
            fs::write(&scene, SCENE).expect("a scene");
        }
        if let Err(error) = read_scene(&scene) {
            check("scene.json", error);
        }
    });
});
