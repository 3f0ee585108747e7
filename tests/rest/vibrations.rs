//! Vibrations about states of rest, and responses to inputs that oscillate, against closed forms, other coordinates and motions that ring down.

use nalgebra::{Complex, DMatrix, DVector};
use proboscis::control::problem::Task;
use proboscis::dynamics::{Independent, Linearisation, Route};
use proboscis::files::read_problem_text;
use proboscis::tasks::{EquilibriumResult, Vibrating, equilibrium};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

/// The state of rest that a problem asks for.
fn rest(problem: &Value) -> EquilibriumResult {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/vibrations.json");
    let loaded = read_problem_text(&path, &problem.to_string(), &[]).unwrap();
    let Task::Equilibrium(task) = &loaded.task else {
        panic!("an equilibrium");
    };
    equilibrium(&loaded.system, task).unwrap()
}

fn vibrations(problem: &Value) -> Vibrating {
    let result = rest(problem);
    let told: Vec<String> = result.remarks.lines().collect();
    result.vibrations.unwrap_or_else(|| panic!("{told:?}"))
}

/// Frequencies in Hz and damping ratios.
fn modes(found: &Vibrating) -> Vec<[f64; 2]> {
    assert!(found.modes.are_exact);
    let modes = found.modes.vibrations.iter();
    modes
        .map(|mode| [1e3 * mode.frequency, mode.damping])
        .collect()
}

/// A mass of 2 kg on two rails across each other, with a spring of 800 N/m and a damper of 4 N s/m along each, and a motor along the first.
fn carts() -> Value {
    let body = |name: &str, mass: &str| json!({ "name": name, "mass": mass, "position": [0, 0, 0], "box": { "size": ["50 mm", "50 mm", "50 mm"] } });
    let rail = |name: &str, axis: Value, parent: &str, child: &str| {
        json!({ "name": name, "prismatic": { "axis": axis }, "parent": parent, "child": child, "at": [0, 0, 0],
                "damping": "4 N s/m", "stiffness": "800 N/m" })
    };
    json!({
        "name": "carts",
        "bodies": [body("bridge", "1e-9 kg"), body("cart", "2 kg")],
        "joints": [rail("x", json!([1, 0, 0]), "ground", "bridge"), rail("y", json!([0, 1, 0]), "bridge", "cart")],
        "markers": [{ "name": "tip", "body": "cart", "at": [0, 0, 0] }],
        "loads": [{ "name": "motor", "joint": "x" }],
    })
}

#[test]
fn equal_vibrations_across_each_other_are_both_found() {
    let found = vibrations(&json!({ "scene": carts(), "equilibrium": { "modes": 2 } }));
    let omega = (800.0_f64 / 2.0).sqrt();
    let found = modes(&found);
    assert_eq!(found.len(), 2);
    for [frequency, damping] in found {
        assert!((frequency * TAU / omega - 1.0).abs() < 1e-8, "{frequency}");
        let exact = 4.0 / (2.0 * 2.0 * omega);
        assert!(
            (damping / exact - 1.0).abs() < 1e-8,
            "{damping} for {exact}"
        );
    }
}

#[test]
fn a_force_that_oscillates_moves_a_mass_as_the_closed_form_says() {
    let sweep = json!({ "input": "motor", "from": "0.1 Hz", "to": "50 Hz", "points": 41 });
    let problem = json!({ "scene": carts(), "equilibrium": { "frequency_response": sweep } });
    let found = vibrations(&problem);
    let response = found.response.as_ref().unwrap();
    let place = |name: &str| {
        response
            .outputs
            .iter()
            .position(|(own, _)| own == name)
            .unwrap()
    };
    for (frequency, row) in response.frequencies.iter().zip(&response.values) {
        let omega = TAU * 1e3 * frequency;
        let exact = Complex::new(800.0 - 2.0 * omega * omega, 4.0 * omega).inv();
        for name in ["x", "tip_x"] {
            // mm for N.
            let value = row[place(name)] * 1e-3;
            assert!(
                (value - exact).norm() < 1e-8 * exact.norm(),
                "{name} at {frequency}: {value} for {exact}"
            );
        }
        assert!(row[place("tip_y")].norm() < 1e-12);
    }
    // The peak is among them.
    let [first, last] = [0, 41].map(|k| response.frequencies[k]);
    assert!((first - 1e-4).abs() < 1e-15 && (last - 5e-2).abs() < 1e-12);
}

/// A bar without contraction across, in n elements along it: clamped at one end, its longitudinal vibrations are those of a row of linear elements with
/// their consistent masses.
#[test]
fn a_bar_of_finite_elements_has_the_frequencies_of_a_row_of_them() {
    let (n, length, modulus, density) = (4_usize, 0.04, 2e5_f64, 1000.0);
    let scene = json!({
        "name": "bar",
        "materials": { "foam": { "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "0 Pa" } },
        "solids": [{
            "name": "bar", "material": "foam",
            "box": { "corner": [0, 0, 0], "size": ["40 mm", "10 mm", "10 mm"], "elements": [n, 1, 1] },
            "fixed": ["x_min", { "face": "y_min", "directions": ["y"] }, { "face": "y_max", "directions": ["y"] },
                      { "face": "z_min", "directions": ["z"] }, { "face": "z_max", "directions": ["z"] }],
        }],
    });
    let found = vibrations(&json!({ "scene": scene, "equilibrium": { "modes": 3 } }));
    let h = length / n as f64;
    let exact = |k: f64| {
        let cos = ((k - 0.5) * std::f64::consts::PI * h / length).cos();
        (modulus / density * 6.0 * (1.0 - cos) / (2.0 + cos)).sqrt() / (h * TAU)
    };
    let all = modes(&found);
    println!("{all:?}");
    // Across nothing moves, and longitudinal motions may differ across the section: only the even ones are compared.
    for k in [1.0, 2.0] {
        let near = all
            .iter()
            .map(|[f, _]| (f / exact(k) - 1.0).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(near < 1e-9, "{k}: {} Hz, {near:e} apart", exact(k));
    }
    assert!(all.iter().all(|[_, damping]| damping.abs() < 1e-9));
}

/// A trunk of three segments under voltages.
fn trunk(coordinates: &str) -> Value {
    let text = fs::read_to_string("problems/scenes/pair.json").unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    scene["chain"]["segments"] = json!(3);
    json!({
        "scene": scene,
        "equilibrium": {
            "voltages": { "muscle1": "1.5 kV", "muscle4": "1 kV" }, "coordinates": coordinates, "modes": 3,
            "frequency_response": { "input": "muscle1", "from": "0.5 Hz", "to": "40 Hz", "points": 7 },
        },
    })
}

#[test]
fn directors_and_joints_have_the_same_vibrations() {
    let [joints, directors] = ["reduced", "redundant"].map(|word| vibrations(&trunk(word)));
    let [a, b] = [&joints, &directors].map(modes);
    println!("{a:?}");
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} for {b}");
    }
    let [a, b] = [&joints, &directors].map(|one| one.response.as_ref().unwrap());
    for (a, b) in a.values.iter().flatten().zip(b.values.iter().flatten()) {
        assert!((a - b).norm() < 1e-7 * a.norm().max(1e-6), "{a} for {b}");
    }
}

#[test]
fn a_motion_rings_down_with_its_frequency_and_damping() {
    let mut problem = json!({
        "scene": "scenes/pair.json",
        "equilibrium": { "modes": 1 },
    });
    let [frequency, damping] = modes(&vibrations(&problem))[0];
    problem.as_object_mut().unwrap().remove("equilibrium");
    let step = 1.0 / (400.0 * frequency);
    problem["simulate"] = json!({
        "duration": 8.0 / frequency, "step": step,
        "start": { "joint_angles": { "joint1": 1e-4 } }, "voltages": {},
    });
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/vibrations.json");
    let loaded = read_problem_text(&path, &problem.to_string(), &[]).unwrap();
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation");
    };
    let request = proboscis::tasks::SimulationRequest::default();
    let go_on = &mut |_: usize, _: &_, _: &_| std::ops::ControlFlow::Continue(());
    let motion = proboscis::tasks::simulate(&loaded.system, task, request, go_on).unwrap();
    let discrete = &motion.simulated.discrete;
    let angle: Vec<f64> = discrete.z.iter().map(|z| z[0]).collect();
    // Times at which it passes zero upwards, and the largest angle between two of them.
    let ups = (1..angle.len()).filter(|&k| angle[k - 1] < 0.0 && angle[k] >= 0.0);
    let ups: Vec<f64> = ups
        .map(|k| k as f64 - angle[k] / (angle[k] - angle[k - 1]))
        .collect();
    let periods = (ups.len() - 1) as f64;
    let period = (ups[ups.len() - 1] - ups[0]) / periods * step;
    let peak = |from: f64, to: f64| {
        let (from, to) = (from as usize + 1, to as usize);
        let k = (from..to)
            .max_by(|&a, &b| angle[a].total_cmp(&angle[b]))
            .unwrap();
        let [a, b, c] = [angle[k - 1], angle[k], angle[k + 1]];
        b + (a - c) * (a - c) / (8.0 * (2.0 * b - a - c))
    };
    let (first, last) = (
        peak(ups[0], ups[1]),
        peak(ups[ups.len() - 2], ups[ups.len() - 1]),
    );
    let decay = (first / last).ln() / (periods - 1.0);
    let measured = decay / (TAU * TAU + decay * decay).sqrt();
    let natural = 1.0 / (period * (1.0 - measured * measured).sqrt());
    println!("{frequency} Hz by {natural} Hz, {damping} by {measured}");
    assert!(
        (natural / frequency - 1.0).abs() < 1e-4,
        "{natural} for {frequency}"
    );
    assert!(
        (measured / damping - 1.0).abs() < 1e-3,
        "{measured} for {damping}"
    );
}

#[test]
fn the_frequency_vanishes_towards_pull_in() {
    let text = fs::read_to_string("problems/pull_in.json").unwrap();
    let mut problem: Value = serde_json::from_str(&text).unwrap();
    let scene = fs::read_to_string("problems/scenes/pull_in.json").unwrap();
    let mut scene: Value = serde_json::from_str(&scene).unwrap();
    for material in scene["materials"].as_object_mut().unwrap().values_mut() {
        material["density"] = json!("1000 kg/m^3");
    }
    problem["scene"] = scene;
    let equilibrium = problem["equilibrium"].as_object_mut().unwrap();
    equilibrium.remove("path");
    let voltages = equilibrium["voltages"].clone();
    let lowest = |part: f64| {
        let mut problem = problem.clone();
        problem["equilibrium"]["modes"] = json!(1);
        let scaled = voltages.as_object().unwrap().iter().map(|(name, value)| {
            let text = value.as_str().unwrap();
            let (number, unit) = text.split_once(' ').unwrap();
            (
                name.clone(),
                json!(format!("{} {unit}", part * number.parse::<f64>().unwrap())),
            )
        });
        problem["equilibrium"]["voltages"] = Value::Object(scaled.collect());
        let result = rest(&problem);
        match (&result.loss, &result.vibrations) {
            (None, Some(found)) if result.found.route == Route::Loads => found
                .modes
                .vibrations
                .first()
                .map_or(0.0, |mode| 1e3 * mode.frequency),
            _ => f64::NAN,
        }
    };
    // The last part of the voltages at which there is a state of rest, by halves.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        if lowest(middle).is_nan() {
            high = middle;
        } else {
            low = middle;
        }
    }
    let [free, near] = [0.0, low].map(lowest);
    println!("{free} Hz without voltages, {near} Hz at {low} of them");
    assert!(near < 0.2 * free, "{near} of {free}");
}

#[test]
fn what_has_no_inertia_has_no_vibrations() {
    let text = fs::read_to_string("problems/pull_in.json").unwrap();
    let mut problem: Value = serde_json::from_str(&text).unwrap();
    problem["equilibrium"] = json!({ "voltages": { "cube.top": "300 kV" }, "modes": 2 });
    let result = rest(&problem);
    assert!(result.vibrations.is_none());
    let lines: Vec<String> = result.remarks.lines().collect();
    assert!(
        lines
            .iter()
            .any(|line| line.contains("nothing that moves has inertia")),
        "{lines:?}"
    );
}

/// The eigenvalue of a linearised step of the midpoint rule, which is a Cayley transform for steps of no length, next to a natural frequency in Hz and a
/// damping ratio.
fn by_step(found: &Vibrating, [frequency, damping]: [f64; 2]) -> [f64; 2] {
    let model = &found.model;
    let (z, scalars) = (
        found.shapes.z.last().unwrap(),
        found.shapes.scalars.last().unwrap(),
    );
    let h = 1e-3;
    let independent = Independent::of(model, (0..model.coordinate_count()).collect());
    let mut steps = Linearisation::new(model, &independent, &[]);
    let step = steps.step([z, z], scalars, h).unwrap().by_state;
    let one = Complex::new(1.0, 0.0);
    let lambda =
        Complex::new(-damping, (1.0 - damping * damping).sqrt()) * (1e-3 * TAU * frequency);
    let mu = (one + lambda * 0.5 * h) / (one - lambda * 0.5 * h);
    let step = step.map(|value| Complex::new(value, 0.0));
    let size = step.nrows();
    let factors = (&step - DMatrix::identity(size, size) * mu).lu();
    let mut vector = DVector::from_fn(size, |i, _| Complex::new(1.0 / (1.0 + i as f64), 0.3));
    for _ in 0..6 {
        vector = factors.solve(&vector).unwrap().normalize();
    }
    let mu = vector.dotc(&(&step * &vector));
    let lambda = (mu - one) / (mu + one) * (2.0 / h);
    [1e3 * lambda.norm() / TAU, -lambda.re / lambda.norm()]
}

#[test]
fn creep_and_resistors_are_in_the_vibrations() {
    for (scene, voltages) in [
        ("creeping_muscle", json!({})),
        ("elephant_trunk_creeping", json!({ "muscle3": "1.5 kV" })),
        (
            "elephant_trunk_resistors",
            json!({ "muscle1": "1.2 kV", "muscle6": "1 kV" }),
        ),
    ] {
        let found = vibrations(&json!({
            "scene": format!("scenes/{scene}.json"),
            "equilibrium": { "voltages": voltages, "modes": 4 },
        }));
        for own in modes(&found) {
            let step = by_step(&found, own);
            println!("{scene}: {own:?} by {step:?}");
            assert!(
                own.iter()
                    .zip(step)
                    .all(|(a, b)| (a / b - 1.0).abs() < 1e-5)
            );
        }
    }
}

#[test]
fn a_system_built_in_rust_has_its_vibrations() {
    use proboscis::prelude::*;
    let mut system = System::new("oscillator");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
    system.add(Joint::prismatic(X).between(GROUND, cart));
    let spring = Spring::between((GROUND, -X * mm(50.0)), (cart, X * mm(0.0)));
    system.add(spring.stiffness(n_per_m(200.0)));
    let found = Equilibrium::new().vibrations(&system, 3).unwrap();
    let exact = (200.0_f64 / 0.05).sqrt() / TAU;
    assert_eq!(found.len(), 1);
    assert!((1e3 * found[0].frequency / exact - 1.0).abs() < 1e-9);
}
