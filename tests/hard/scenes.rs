//! Scenes and problems as they are written.

use serde_json::{Value, json};

/// Permittivity of vacuum in F/m, which is N/V².
pub(crate) const VACUUM: f64 = proboscis::model::VACUUM_PERMITTIVITY;
/// Shear modulus of the silicone in Pa.
pub(crate) const SHEAR: f64 = 1e5;

/// The silicone of the trunk.
pub(crate) fn silicone() -> Value {
    json!({
        "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "400 kPa",
        "relative_permittivity": 3.0, "viscosity": "1000 Pa s",
    })
}

/// The silicone with some entries changed; null takes one away.
pub(crate) fn silicone_with(changes: Value) -> Value {
    let mut material = silicone();
    let entries = material.as_object_mut().unwrap();
    for (key, value) in changes.as_object().unwrap() {
        match value {
            Value::Null => entries.remove(key),
            value => entries.insert(key.clone(), value.clone()),
        };
    }
    material
}

/// The elephant trunk with any number of segments.
pub(crate) fn trunk(segments: usize, material: Value) -> Value {
    json!({
        "name": "trunk", "materials": { "silicone": material },
        "chain": {
            "segments": segments, "length": "50 mm", "radius": "20 mm", "mass": "30 g",
            "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
            "muscles": {
                "material": "silicone", "arm": "15 mm", "rest_length": "40 mm",
                "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
            },
            "tip_marker": "tip",
        },
    })
}

/// One muscle of 30 mm, 4 mm by 5 mm, from the ground to a weight of 10 g that slides along z.
pub(crate) fn slider(material: Value) -> Value {
    json!({
        "name": "slider", "materials": { "silicone": material },
        "bodies": [{
            "name": "weight", "mass": "10 g", "position": [0, 0, "35 mm"],
            "box": { "size": ["10 mm", "10 mm", "10 mm"] },
        }],
        "joints": [{
            "name": "slide", "prismatic": { "axis": [0, 0, 1] },
            "parent": "ground", "child": "weight", "at": [0, 0, "30 mm"],
        }],
        "muscles": [{
            "name": "muscle", "material": "silicone", "cross_section": ["4 mm", "5 mm"], "layer_thickness": "50 um",
            "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "weight", "at": [0, 0, "30 mm"] },
        }],
        "markers": [{ "name": "end", "body": "weight", "at": [0, 0, "30 mm"] }],
    })
}

/// Rest length of the slider's muscle in mm.
pub(crate) const LENGTH: f64 = 30.0;
/// Volume of the slider's muscle in mm³.
pub(crate) const VOLUME: f64 = 600.0;
/// Mass of the slider's weight in g.
pub(crate) const WEIGHT: f64 = 10.0;

/// A cube of 10 mm between electrodes at z = 0 and 10 mm, on three rollers.
pub(crate) fn cube(material: Value, element: &str, elements: usize) -> Value {
    json!({
        "name": "cube", "materials": { "silicone": material },
        "solids": [{
            "name": "cube", "material": "silicone", "element": element,
            "box": { "size": ["10 mm", "10 mm", "10 mm"], "elements": [elements, elements, elements] },
            "electrodes": [
                { "name": "bottom", "face": "z_min", "potential": "grounded" },
                { "name": "top", "face": "z_max", "potential": "driven" },
            ],
            "fixed": [
                { "face": "x_min", "directions": ["x"] },
                { "face": "y_min", "directions": ["y"] },
                { "face": "z_min", "directions": ["z"] },
            ],
        }],
        "markers": [{ "name": "corner", "solid": "cube", "at": ["10 mm", "10 mm", "10 mm"] }],
    })
}

/// A simulation.
pub(crate) fn simulate(duration: &str, step: &str, voltages: Value) -> Value {
    json!({ "simulate": { "duration": duration, "step": step, "voltages": voltages } })
}

/// A simulation from joint coordinates and rates.
pub(crate) fn simulate_from(duration: &str, step: &str, angles: Value, rates: Value) -> Value {
    json!({ "simulate": {
        "duration": duration, "step": step, "start": { "joint_angles": angles, "joint_rates": rates },
    } })
}

/// An equilibrium.
pub(crate) fn equilibrium(voltages: Value) -> Value {
    json!({ "equilibrium": { "voltages": voltages } })
}

/// Motion from rest without voltages to a goal with least effort.
pub(crate) fn control(duration: &str, intervals: usize, goal: Value) -> Value {
    json!({ "control": {
        "duration": duration, "intervals": intervals,
        "start": { "rest_at_voltages": {} }, "goal": goal,
        "voltage_bounds": ["0 V", "3 kV"], "objective": { "effort": 1.0 },
    } })
}

/// The goal of the pair of muscles.
pub(crate) fn bent() -> Value {
    json!({ "rest_at_voltages": { "muscle2": "1.7 kV" } })
}

/// The zero of a function between two places where its sign differs, by halving.
pub(crate) fn bisection(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let at_low = f(low);
    assert!(at_low * f(high) < 0.0, "no change of sign");
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) * at_low > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
