//! Limits of electric fields.

use crate::common::random::Random;
use crate::limits::{Ran, kept, run};
use nalgebra::{Matrix3, Vector3};
use proboscis::control::problem::{Duration, Task};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::element::{ElementGeometry, FieldPoint};
use proboscis::ipopt::{self, Options};
use proboscis::mesh::CORNERS;
use serde_json::{Value, json};
use std::fs;
use std::ops::ControlFlow;

/// Largest true field of all muscles in V/mm: at instants under the voltages of both intervals that meet there, and at midpoints
/// of their spans, from what the files say of the motion.
fn largest_field(ran: &Ran) -> [f64; 2] {
    let solution = ran.read("solution.json");
    let scene = ran.folder.path().join("p.json");
    let system = proboscis::files::read_problem(&scene, &[]).unwrap().system;
    let model = proboscis::model::Model::new(system, None, 1.0, &[]).unwrap();
    let rows = |value: &Value| -> Vec<f64> {
        let list = value.as_array().unwrap();
        list.iter().map(|v| v.as_f64().unwrap()).collect()
    };
    let joints: Vec<Vec<f64>> = model
        .system
        .joints
        .iter()
        .map(|joint| rows(&solution["configuration"]["joints"][&joint.name]))
        .collect();
    let instants = joints[0].len();
    // Ends of each muscle, from the poses of the bodies.
    let span = |k: usize, muscle: &proboscis::model::system::Muscle| {
        let values: Vec<f64> = joints.iter().map(|list| list[k]).collect();
        let mut instant = model.action.map.instant();
        instant.z.copy_from_slice(&model.coordinates_at(&values));
        model.action.map.place(&mut instant);
        let poses = model.poses(&instant);
        let end = |a: &proboscis::model::system::Attachment| match a.body {
            None => a.at,
            Some(b) => {
                let body = &model.system.bodies[b];
                let local = body.directors.transpose() * (a.at - body.centre);
                poses[b].centre + poses[b].directors * local
            }
        };
        end(&muscle.to) - end(&muscle.from)
    };
    let mut largest = [0.0_f64; 2];
    for muscle in &model.system.muscles {
        let volts = rows(&solution["voltages"][&muscle.name]);
        let spans: Vec<_> = (0..instants).map(|k| span(k, muscle)).collect();
        let nominal = |k: usize| volts[k] / muscle.layer_thickness * muscle.length();
        for k in 0..volts.len() {
            for r in [spans[k], spans[k + 1]] {
                largest[0] = largest[0].max(nominal(k) / r.norm());
            }
            let middle = (spans[k] + spans[k + 1]) * 0.5;
            largest[1] = largest[1].max(nominal(k) / middle.norm());
        }
    }
    largest
}

#[test]
fn fields_keep_their_limit_at_instants_and_midpoints() {
    let mut problem = kept("10_field_limit_exceeded_at_instants.json");
    // Its goal itself is beyond the limit.
    let words = [
        "control.goal",
        "field of m2",
        "45.032 V/um",
        "at most 43.743 V/um",
    ];
    run("solve", &problem, &[]).is_refused(&words);
    let max = 54e6;
    problem["control"]["limits"][0]["electric_field"]["max"] = json!(max);
    let ran = run("solve", &problem, &[]);
    ran.is_solved();
    let [at_instants, between] = largest_field(&ran);
    let max = max / 1e3;
    assert!(at_instants <= max * (1.0 + 1e-6), "{at_instants} {max}");
    assert!(between <= max * (1.0 + 1e-6), "{between} {max}");
    // The limit is what holds it back, and it does so at instants first.
    assert!(at_instants > 0.9999 * max, "{at_instants} {max}");
    problem["control"]["limits"] = json!([]);
    let free = run("solve", &problem, &[]);
    assert!(largest_field(&free)[0] > 1.02 * max);
}

/// The true field at a point of an element, over the isoparametric coordinates and without the reference configuration:
/// −(∂x/∂ξ)⁻ᵀ ∂φ/∂ξ.
fn naive_field(x: &[Vector3<f64>; 8], phi: &[f64; 8], xi: [f64; 3]) -> Vector3<f64> {
    let mut slope = Matrix3::zeros();
    let mut rise = Vector3::zeros();
    for i in 0..8 {
        let c = CORNERS[i];
        for m in 0..3 {
            let (a, b) = ((m + 1) % 3, (m + 2) % 3);
            let d = 0.125 * c[m] * (1.0 + c[a] * xi[a]) * (1.0 + c[b] * xi[b]);
            slope.set_column(m, &(slope.column(m) + x[i] * d));
            rise[m] += phi[i] * d;
        }
    }
    -(slope.transpose().lu().solve(&rise).unwrap())
}

/// Centre and Gauss points in isoparametric coordinates.
fn points() -> Vec<(Option<usize>, [f64; 3])> {
    let gauss = |g: usize| (Some(g), CORNERS[g].map(|c| c / 3.0_f64.sqrt()));
    std::iter::once((None, [0.0; 3]))
        .chain((0..8).map(gauss))
        .collect()
}

#[test]
fn the_field_at_a_point_and_its_derivatives_are_those_of_the_naive_formula() {
    let mut random = Random(7);
    let reference = CORNERS.map(|c| Vector3::from(c).map(|v| v + 0.2 * random.unit()));
    let x = reference.map(|place| place.map(|v| 1.1 * v + 0.2 * random.unit()));
    let phi: [f64; 8] = std::array::from_fn(|_| 50.0 * random.unit());
    let shape = ElementGeometry::new(&reference).unwrap();
    for (point, xi) in points() {
        let gradients = match point {
            Some(g) => shape.gradients_at(g),
            None => ElementGeometry::central_gradients(&reference).unwrap(),
        };
        let limit = 30.0;
        let at = FieldPoint { gradients, limit };
        let naive = |x: &[Vector3<f64>; 8], phi: &[f64; 8]| {
            naive_field(x, phi, xi).norm_squared() / (limit * limit)
        };
        let field = at.at(&x, &phi);
        let value = naive(&x, &phi);
        assert!(value > 0.01, "{value}");
        assert!((field.value() - value).abs() < 1e-12 * value);
        // Central differences, of arguments of size one; potentials in tens of volts.
        let (step, volts) = (1e-5, 10.0);
        let moved = |entry: usize, by: f64| {
            let (mut x, mut phi) = (x, phi);
            match entry.checked_sub(24) {
                None => x[entry / 3][entry % 3] += by,
                Some(i) => phi[i] += volts * by,
            }
            (x, phi)
        };
        let gradient = |x: &[Vector3<f64>; 8], phi: &[f64; 8]| -> Vec<f64> {
            let field = at.at(x, phi);
            let places = (0..8).flat_map(|i| field.by_place(i).iter().copied().collect::<Vec<_>>());
            places
                .chain((0..8).map(|i| volts * field.by_potential(i)))
                .collect()
        };
        let exact = gradient(&x, &phi);
        let size = exact.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(exact.iter().all(|v| v.abs() > 1e-6 * size));
        let mut largest = 0.0_f64;
        for (a, slope) in exact.iter().enumerate() {
            let [up, down] = [step, -step].map(|by| moved(a, by));
            let difference = (naive(&up.0, &up.1) - naive(&down.0, &down.1)) / (2.0 * step);
            assert!(
                (slope - difference).abs() < 1e-8 * size,
                "{a}: {slope} {difference}"
            );
            let [up, down] = [gradient(&up.0, &up.1), gradient(&down.0, &down.1)];
            for b in 0..32 {
                let difference = (up[b] - down[b]) / (2.0 * step);
                let (i, j) = (a / 3, b / 3);
                let second = match (a.checked_sub(24), b.checked_sub(24)) {
                    (None, None) => field.by_places(i, j)[(a % 3, b % 3)],
                    (None, Some(j)) => volts * field.by_place_and_potential(i, j)[a % 3],
                    (Some(i), None) => volts * field.by_place_and_potential(j, i)[b % 3],
                    (Some(i), Some(j)) => volts * volts * field.by_potentials(i, j),
                };
                largest = largest.max(second.abs());
                assert!(
                    (second - difference).abs() < 1e-7 * size,
                    "{a} {b}: {second} {difference}"
                );
            }
        }
        assert!(largest > 0.1 * size);
    }
}

/// The lift of the kept problem on two elements, in a given time.
pub(crate) fn lift(seconds: f64) -> Value {
    let mut problem = kept("04_fe_lift_rest_reduced_vs_redundant.json");
    let solid = &mut problem["scene"]["solids"][0];
    solid["box"]["elements"] = json!([1, 1, 2]);
    solid["stack"]["layers"] = json!(2);
    let control = &mut problem["control"];
    control["duration"] = json!(seconds);
    control["intervals"] = json!(8);
    control["voltage_bounds"] = json!([0, 400e3]);
    control["goal"]["hold"] = json!({ "s.hv": 140e3 });
    control["guess"] = json!({ "simulate": { "voltages": { "s.hv": 140e3 } } });
    problem
}

/// Largest true field of a solved problem in V/mm at centres and Gauss points, at instants under the voltages of both intervals
/// that meet there and between them, over the deformed elements alone.
fn solved_field(problem: &Value) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.json");
    fs::write(&path, problem.to_string()).unwrap();
    let loaded = proboscis::files::read_problem(&path, &[]).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a control problem")
    };
    let Duration::Given(t) = control.duration else {
        panic!("a given duration")
    };
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&loaded.system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let start = program.start(&initial);
    let solution = ipopt::solve(&mut program, &start, &Options::default(), &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    let discrete = program.decode(&solution.x);
    let places: Vec<Vec<Vector3<f64>>> = discrete
        .z
        .iter()
        .map(|z| {
            let mut instant = model.action.map.instant();
            instant.z.copy_from_slice(z);
            model.action.map.vectors(&mut instant);
            model.solids[0].places(&instant.x)
        })
        .collect();
    let mut largest = 0.0_f64;
    for (k, scalars) in discrete.scalars.iter().enumerate() {
        let phi = model.solids[0].potentials(scalars);
        let middle: Vec<_> = (0..phi.len())
            .map(|n| (places[k][n] + places[k + 1][n]) * 0.5)
            .collect();
        for nodes in &model.solids[0].solid.mesh.hexahedra {
            for x in [&places[k], &places[k + 1], &middle] {
                for (_, xi) in points() {
                    let field = naive_field(&nodes.map(|n| x[n]), &nodes.map(|n| phi[n]), xi);
                    largest = largest.max(field.norm());
                }
            }
        }
    }
    (largest, solution.objective)
}

#[test]
fn fields_of_finite_elements_keep_their_limit() {
    // So fast that the voltage is higher on the way than at the end.
    let mut problem = lift(0.009);
    let (free, cheap) = solved_field(&problem);
    let max = 1e3 * 0.95 * free;
    problem["control"]["limits"] = json!([{ "electric_field": { "solid": "s", "max": max } }]);
    let (held, dear) = solved_field(&problem);
    println!("{free} {cheap}, {held} {dear}");
    assert!(held <= 0.95 * free * (1.0 + 1e-6), "{held} {free}");
    assert!(held > 0.9499 * free && dear > cheap, "{held} {free}");
}
