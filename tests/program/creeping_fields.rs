//! Stress of a block that creeps as ParaView reads it: in a cube under a traction it balances the traction all the time, although its elastic
//! part alone does not.

use crate::fields::{Fields, request};
use nalgebra::Vector3;
use proboscis::app::run;
use serde_json::json;
use std::fs;

/// Shear modulus and first Lamé constant in Pa, edge of the cube in m, traction in Pa.
const MU: f64 = 1e5;
const LAMBDA: f64 = 4e5;
const EDGE: f64 = 0.01;
const PULL: f64 = 4e4;

#[test]
fn the_stress_of_a_creeping_cube_balances_its_traction() {
    let folder = tempfile::tempdir().unwrap();
    let roller = |axis: &str| json!({ "face": format!("{axis}_min"), "directions": [axis] });
    let rollers = ["x", "y", "z"].map(roller);
    let scene = json!({
        "name": "cube",
        "materials": { "gel": {
            "shear_modulus": MU, "lame_lambda": LAMBDA, "viscosity": "100 Pa s",
            "maxwell": [
                { "shear_modulus": "60 kPa", "relaxation_time": "80 ms" },
                { "shear_modulus": "30 kPa", "relaxation_time": "20 ms" }
            ]
        } },
        "solids": [{
            "name": "cube", "material": "gel",
            "box": { "size": [EDGE, EDGE, EDGE], "elements": [2, 1, 1] },
            "fixed": rollers
        }],
        "markers": [{ "name": "corner", "solid": "cube", "at": [EDGE, EDGE, EDGE] }],
        "loads": [
            { "name": "pull", "solid": "cube", "kind": "traction", "face": "x_max", "direction": [1, 0, 0] }
        ]
    });
    let problem = json!({ "scene": "scene.json", "simulate": {
        "duration": "0.2 s", "step": "2 ms",
        "loads": { "pull": { "ramp": { "to": PULL, "duration": "10 ms" } } }
    } });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let path = folder.path().join("problem.json");
    fs::write(&path, problem.to_string()).unwrap();
    let told = run(&request(path, &folder.path().join("out"), &[])).unwrap();
    assert!(told.is_solved, "{told:?}");

    let mut files: Vec<_> = fs::read_dir(folder.path().join("out/fields"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "vtu"))
        .collect();
    files.sort();
    let mut shares = Vec::new();
    for path in &files[files.len() / 4..] {
        let fields = Fields::read(path);
        let reference = fields.reference();
        let corner = reference
            .iter()
            .position(|x| x.min() > 0.99 * EDGE)
            .unwrap();
        let stretch = fields.vectors("displacement [m]")[corner].map(|u| 1.0 + u / EDGE);
        let expected = PULL / (stretch.y * stretch.z);
        let j = stretch.product();
        let elastic = MU / j * (stretch.x * stretch.x - 1.0) + LAMBDA * j.ln() / j;
        shares.push((expected - elastic) / expected);
        for found in fields.numbers("stress [Pa]").chunks_exact(9) {
            let expected = Vector3::new(expected, 0.0, 0.0);
            for (i, value) in found.iter().enumerate() {
                let expected = if i % 4 == 0 { expected[i / 4] } else { 0.0 };
                assert!((value - expected).abs() < 2e-3 * PULL, "{value} {expected}");
            }
        }
    }
    // The branches carry much at first, and less and less.
    let last = shares[shares.len() - 1];
    assert!(
        shares[0] > 0.1 && last < 0.6 * shares[0] && last > 0.01,
        "{shares:?}"
    );
}
