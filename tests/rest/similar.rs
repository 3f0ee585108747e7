//! Similar robots have similar equilibria: the same verdict, iterations and dimensionless numbers, whatever their masses, lengths, times and
//! voltages.

use crate::common::random::Random;
use crate::common::similar::Scales;
use crate::stable::{model, reference, scene};
use proboscis::dynamics::{Equilibrium, EquilibriumError, Route, stable_equilibrium};
use proboscis::model::Model;
use serde_json::{Value, json};

/// Two links upright and a slide, with a muscle beside the first link, heavy enough to lean.
fn links() -> Value {
    let inertia = [4e-6, 4e-6, 4e-6];
    json!({
        "name": "links",
        "materials": { "soft": { "shear_modulus": 1e5, "density": 1000, "relative_permittivity": 5, "dielectric": "ideal" } },
        "bodies": [
            { "name": "a", "mass": "20 g", "position": [0, 0.025, 0], "inertia": inertia },
            { "name": "b", "mass": "20 g", "position": [0, 0.075, 0], "inertia": inertia },
            { "name": "c", "mass": "10 g", "position": [0, 0.1, 0], "inertia": inertia }
        ],
        "joints": [
            { "name": "p", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "a", "at": [0, 0, 0], "stiffness": 0.02 },
            { "name": "q", "revolute": { "axis": [0, 0, 1] }, "parent": "a", "child": "b", "at": [0, 0.05, 0], "stiffness": 0.02 },
            { "name": "s", "prismatic": { "axis": [0, 1, 0] }, "parent": "b", "child": "c", "at": [0, 0.1, 0], "stiffness": "100 N/m" }
        ],
        "muscles": [ { "name": "m", "material": "soft", "cross_section": ["5 mm", "5 mm"], "layer_thickness": "0.1 mm",
            "from": { "body": "ground", "at": [0.02, 0, 0] }, "to": { "body": "a", "at": [0.02, 0.04, 0] } } ],
        "gravity": [0, -9.81, 0]
    })
}

/// A stack that is pulled in.
fn stack() -> Value {
    json!({
        "name": "stack",
        "materials": { "soft": { "shear_modulus": 1e5, "density": 1000, "relative_permittivity": 5, "dielectric": "ideal" } },
        "bodies": [ { "name": "a", "mass": "20 g", "position": [0, 0.045, 0], "inertia": [4e-6, 4e-6, 4e-6] } ],
        "joints": [ { "name": "s", "prismatic": { "axis": [0, 1, 0] }, "parent": "ground", "child": "a", "at": [0, 0.045, 0] } ],
        "muscles": [ { "name": "m", "material": "soft", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "0.1 mm",
            "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "a", "at": [0, 0.04, 0] } } ]
    })
}

fn found(written: &Value, voltage: f64) -> (Model, Result<Equilibrium, EquilibriumError>) {
    let model = model(scene(written));
    let voltages = vec![voltage; model.sources.len()];
    let found = stable_equilibrium(&model, &reference(&model), &model.scalars(&voltages));
    (model, found)
}

/// The state, and the word and the fraction of its route.
fn outcome(found: Result<Equilibrium, EquilibriumError>) -> (Equilibrium, String, f64) {
    let word = |route: &Route| {
        format!("{route:?}")
            .split(['(', ' '])
            .next()
            .unwrap()
            .to_owned()
    };
    match found {
        Ok(found) => {
            let fraction = found.loss().map_or(1.0, |loss| loss.fraction);
            let route = word(&found.route);
            (found, route, fraction)
        }
        Err(EquilibriumError::LimitPoint { loss, last }) => {
            (*last, format!("{:?}", loss.kind), loss.fraction)
        }
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn similar_robots_rest_alike() {
    let mut random = Random(7);
    let mut routes = Vec::new();
    for (scene, voltage) in [
        (links(), 0.0),
        (links(), 2000.0),
        (stack(), 1000.0),
        (stack(), 9000.0),
    ] {
        let (first, rest) = found(&scene, voltage);
        let (rest, route, fraction) = outcome(rest);
        routes.push(route.clone());
        for _ in 0..8 {
            let mut factor = |low: f64, high: f64| 10_f64.powf(random.between(low, high));
            let length = factor(-1.3, 1.2);
            let mass = length.powi(3) * factor(-1.0, 1.0);
            let time = (mass / (length * factor(-1.5, 1.5))).sqrt();
            let mut scales = Scales::in_vacuum(mass, length, time);
            // No permittivity is below that of vacuum.
            scales.voltage *= factor(-1.0, 0.3);
            let (model, twin) = found(&scales.scene(&scene), voltage * scales.voltage);
            let (twin, other, at) = outcome(twin);
            let name = first.system.name.as_str();
            assert_eq!((&other, twin.unstable), (&route, rest.unstable), "{name}");
            assert!((at - fraction).abs() < 1e-9, "{name}: {at} {fraction}");
            let sizes = first.sizes().into_iter().zip(model.sizes());
            let values = rest.z.iter().zip(&twin.z).zip(sizes);
            let apart = values.map(|((a, b), (one, two))| (a / one - b / two).abs());
            let apart = apart.fold(0.0, f64::max);
            println!(
                "{name} {route}: {apart:.1e}, {} and {} iterations",
                rest.iterations, twin.iterations
            );
            assert!(apart < 1e-9, "{name}: {apart}");
            assert_eq!(rest.iterations, twin.iterations, "{name}");
        }
    }
    assert!(routes.contains(&"Some(PullIn)".to_owned()), "{routes:?}");
}
