//! A rigid ball on a block of finite elements, by contacts of its nodes, against the formula of Hertz for a half space.

use crate::stable::{model, reference, scene};
use proboscis::dynamics::stable_equilibrium;
use serde_json::{Value, json};

/// Modulus in MPa and Poisson ratio of the block, radius of the ball in mm, acceleration in mm/ms².
const MODULUS: f64 = 1.0;
const RATIO: f64 = 0.3;
const RADIUS: f64 = 100.0;
const GRAVITY: f64 = 9.81e-3;
/// Indentation in mm that is asked for.
const DEPTH: f64 = 0.1;
/// Sides of the block in radii of the touch.
const SIDES: f64 = 20.0;

/// Thicknesses in mm of the elements from the middle outwards: so many within one and a half radii of the touch, then ever larger ones.
fn thicknesses(touch: f64, each: usize) -> Vec<f64> {
    let (fine, end) = (1.5 * touch, SIDES * touch);
    let mut sizes = vec![fine / each as f64; each];
    let mut reached = fine;
    while reached < end {
        let next = 1.6 * sizes[sizes.len() - 1];
        let left = end - reached;
        sizes.push(if left > 1.5 * next { next } else { left });
        reached += sizes[sizes.len() - 1];
    }
    sizes
}

/// A quarter of a block under a quarter of a ball.
fn pressed(touch: f64, each: usize) -> Value {
    let mm = |length: f64| json!(format!("{length:e} mm"));
    let layers = |sizes: &mut dyn Iterator<Item = &f64>| -> Value {
        let layer = |size: &f64| json!({ "thickness": mm(*size), "elements": 1 });
        sizes.map(layer).collect()
    };
    let sizes = thicknesses(touch, each);
    let (out, down) = (layers(&mut sizes.iter()), layers(&mut sizes.iter().rev()));
    let side: f64 = sizes.iter().sum();
    let reach = 1.5 * touch * (1.0 + 1e-6);
    let stiff = 4.0 / 3.0 * MODULUS / (1.0 - RATIO * RATIO);
    let force = stiff * RADIUS.sqrt() * DEPTH.powf(1.5);
    let grams = 0.25 * force / GRAVITY;
    let at = json!([0, mm(RADIUS), 0]);
    // The pressure of the touch sinks by a thousandth of the depth into the nodes.
    let stiffness = 2000.0 * MODULUS * reach * reach / RADIUS;
    json!({
        "name": "hertz", "gravity": [0, -1e3 * GRAVITY, 0],
        "materials": { "soft": {
            "density": "1 g/m^3", "poisson_ratio": RATIO, "shear_modulus": format!("{} MPa", 0.5 * MODULUS / (1.0 + RATIO))
        } },
        "bodies": [ { "name": "ball", "mass": format!("{grams} g"), "sphere": { "radius": mm(RADIUS) }, "position": at } ],
        "joints": [ { "name": "guide", "prismatic": { "axis": [0, 1, 0] }, "parent": "ground", "child": "ball", "at": [0, 0, 0] } ],
        "solids": [ {
            "name": "block", "material": "soft",
            "box": { "corner": [0, mm(-side), 0], "size": [mm(side), mm(side), mm(side)], "elements": [out, down, out] },
            "fixed": [ "y_min", { "face": "x_min", "directions": ["x"] }, { "face": "z_min", "directions": ["z"] } ]
        } ],
        "shapes": [
            { "name": "skin", "nodes": { "solid": "block", "box": { "min": [0, 0, 0], "max": [mm(reach), 0, mm(reach)] } } },
            { "name": "ball", "body": "ball", "sphere": { "at": at, "radius": mm(RADIUS) } }
        ],
        "contacts": [ { "between": ["ball", "skin"], "stiffness": format!("{stiffness} N/mm"), "smoothing": mm(1e-3 * DEPTH) } ]
    })
}

#[test]
fn a_ball_sinks_into_a_block_as_hertz_says() {
    let touch = (RADIUS * DEPTH).sqrt();
    let errors = [2, 3].map(|each| {
        let model = model(scene(&pressed(touch, each)));
        let rest = stable_equilibrium(&model, &reference(&model), &[]).unwrap();
        -rest.z[0] / DEPTH - 1.0
    });
    println!("depths are {errors:?} beside those of Hertz");
    // The sides of the block, 20 radii away, hold back 2 % of the depth.
    assert!(
        errors[1].abs() < 0.03 && errors[1].abs() < errors[0].abs(),
        "{errors:?}"
    );
}
