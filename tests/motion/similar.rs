//! Similar robots have similar motions.

use crate::common::problem;
use crate::common::similar::Scales;
use crate::robots::{Parts, Robot, robot};
use proboscis::control::problem::Task;
use proboscis::dynamics::trajectory::{Column, Trajectory};
use proboscis::dynamics::{DiscreteTrajectory, observations};
use proboscis::model::Model;
use proboscis::tasks::simulate::{SimulationRequest, simulate};
use proboscis::workflow::Simulated;
use serde_json::{Value, json};
use std::ops::ControlFlow;

const SCALES: Scales = Scales {
    mass: 2.0,
    length: 3.0,
    time: 5.0,
    voltage: 7.0,
};

#[test]
fn similar_problems_are_scaled_by_the_dimensions_of_their_numbers() {
    let scales = SCALES;
    let force = 2.0 * 3.0 / 25.0;
    let permittivity = force / 49.0;
    let problem = json!({
        "scene": {
            "name": "s",
            "materials": { "m": {
                "shear_modulus": "80 kPa", "density": 1000, "relative_permittivity": 30000.0, "dielectric": "ideal",
                "maxwell": [ { "shear_modulus": 1e4, "relaxation_time": "20 ms" } ]
            } },
            "bodies": [ { "name": "b", "mass": "10 g", "sphere": { "radius": 0.5 }, "position": [0.25, "5 cm", 0] } ],
            "joints": [ { "name": "j", "revolute": { "axis": [0, 0, 2] }, "child": "b", "damping": 4, "stiffness": "3 N/m" } ],
            "gravity": [0, -9.5, 0]
        },
        "simulate": {
            "duration": "100 ms", "step": 0.5, "tolerance": 1e-3,
            "voltages": { "m": { "sine": { "amplitude": "2 kV", "period": 0.5, "phase": 1 } }, "n": 8 },
            "loads": { "f": "2 N" },
            "start": { "joint_angles": { "j": 0.5, "k": "8 mm" }, "joint_rates": { "j": 2 } }
        },
        "control": {
            "duration": { "min": 0.5, "max": "1 s", "guess": 1 },
            "objective": { "effort": 2.0, "final": [ { "marker": { "marker": "m", "at": [0.5, null, 0], "weight": 4.0 } } ] },
            "limits": [ { "stretch": { "muscle": "m", "min": 0.5 } } ]
        }
    });
    let scaled = scales.problem(&problem);
    let number = |path: &str| {
        let value = scaled.pointer(path).unwrap_or(&Value::Null);
        let text = value.as_str().map(|text| text.split_once(' ').unwrap().0);
        text.map_or_else(|| value.as_f64(), |number| number.parse().ok())
    };
    let material = "/scene/materials/m";
    for (path, expected) in [
        (format!("{material}/shear_modulus"), 80.0 * force / 9.0),
        (format!("{material}/density"), 1000.0 * 2.0 / 27.0),
        (
            format!("{material}/relative_permittivity"),
            3e4 * permittivity,
        ),
        (
            format!("{material}/maxwell/0/shear_modulus"),
            1e4 * force / 9.0,
        ),
        (format!("{material}/maxwell/0/relaxation_time"), 100.0),
        ("/scene/bodies/0/mass".into(), 20.0),
        ("/scene/bodies/0/sphere/radius".into(), 1.5),
        ("/scene/bodies/0/position/0".into(), 0.75),
        ("/scene/bodies/0/position/1".into(), 15.0),
        ("/scene/joints/0/revolute/axis/2".into(), 2.0),
        ("/scene/joints/0/damping".into(), 4.0 * force * 3.0 * 5.0),
        ("/scene/joints/0/stiffness".into(), 3.0 * force / 3.0),
        ("/scene/gravity/1".into(), -9.5 * 3.0 / 25.0),
        ("/simulate/duration".into(), 500.0),
        ("/simulate/step".into(), 2.5),
        ("/simulate/tolerance".into(), 1e-3),
        ("/simulate/voltages/m/sine/amplitude".into(), 14.0),
        ("/simulate/voltages/m/sine/period".into(), 2.5),
        ("/simulate/voltages/m/sine/phase".into(), 1.0),
        ("/simulate/voltages/n".into(), 56.0),
        ("/simulate/loads/f".into(), 2.0 * force),
        ("/simulate/start/joint_angles/j".into(), 0.5),
        ("/simulate/start/joint_angles/k".into(), 24.0),
        ("/simulate/start/joint_rates/j".into(), 0.4),
        ("/control/duration/min".into(), 2.5),
        ("/control/duration/max".into(), 5.0),
        ("/control/objective/effort".into(), 2.0 / (49.0 * 5.0)),
        ("/control/objective/final/0/marker/at/0".into(), 1.5),
        ("/control/objective/final/0/marker/weight".into(), 4.0 / 9.0),
        ("/control/limits/0/stretch/min".into(), 0.5),
    ] {
        let found = number(&path).unwrap_or_else(|| panic!("nothing at {path}"));
        let off = (found - expected).abs();
        assert!(
            off <= 1e-14 * expected.abs(),
            "{path}: {found} for {expected}"
        );
    }
}

#[test]
fn every_number_with_a_unit_of_the_schema_is_known() {
    let (scene, problem) = proboscis::files::schema();
    for schema in [scene, problem] {
        for (name, definition) in schema["$defs"].as_object().unwrap() {
            let has_unit = definition["type"] == json!(["number", "string"]);
            assert!(!has_unit || SCALES.knows(name), "{name}");
        }
    }
}

/// A robot under voltages of its muscles that vary, and under its loads.
pub(crate) fn moving(seed: u64, simulate: &Value) -> Value {
    let parts = Parts {
        weight: !seed.is_multiple_of(3),
        ball_joints: seed.is_multiple_of(2),
        tendons: true,
        viscosity: !seed.is_multiple_of(4),
        bodies: 2,
    };
    let Robot {
        mut scene,
        voltages,
        loads,
    } = robot(seed, parts);
    scene["materials"]["m"]["dielectric"] = json!("ideal");
    let sine = |volts: f64| json!({ "sine": { "mean": volts, "amplitude": 0.5 * volts, "period": "50 ms" } });
    let voltages = voltages
        .iter()
        .map(|(name, volts)| (name.clone(), sine(*volts)));
    let loads = loads.iter().map(|(name, size)| match name.as_str() {
        "motor" => (name.clone(), json!(format!("{size} mN m"))),
        _ => (name.clone(), json!(format!("{size} N"))),
    });
    let mut simulate = simulate.clone();
    simulate["voltages"] = voltages.collect();
    simulate["loads"] = loads.collect();
    json!({ "scene": scene, "simulate": simulate })
}

/// A simulation as it is compared with that of a similar robot.
struct Seen {
    columns: Vec<Column>,
    counts: [usize; 3],
    error: Option<f64>,
    codes: Vec<String>,
}

fn seen(file: &Value) -> Seen {
    let (system, task) = problem(file);
    let Task::Simulate(task) = task else {
        panic!("a simulation")
    };
    let request = SimulationRequest::default();
    let go_on = &mut |_: usize, _: &Model, _: &DiscreteTrajectory| ControlFlow::Continue(());
    let result = simulate(&system, &task, request, go_on).unwrap();
    let Simulated {
        model, discrete, ..
    } = &result.simulated;
    let trajectory = Trajectory::from_discrete(model, discrete);
    let assessment = result.assess(&system, &task, &trajectory);
    let remarks = assessment.remarks.0.iter();
    let report = discrete.report;
    Seen {
        columns: observations(model, discrete).columns,
        counts: [report.steps, report.iterations, report.halved],
        error: result.simulated.error.map(|error| error.error),
        codes: remarks.map(|remark| remark.code.to_string()).collect(),
    }
}

/// From robots of 50 mm, 40 g and 1 kV to some of 1 mg and of 10 kg: steps, iterations, warnings and dimensionless numbers stay. The factors are
/// powers of two, so that rounding is the same.
#[test]
fn similar_robots_have_similar_motions() {
    let to = |mass: i32, length: i32, time: i32, permittivity: i32| {
        let [mass, length, time, permittivity] =
            [mass, length, time, permittivity].map(|power| 2.0_f64.powi(power));
        let Scales { voltage, .. } = Scales::in_vacuum(mass, length, time);
        let voltage = voltage / permittivity.sqrt();
        Scales {
            mass,
            length,
            time,
            voltage,
        }
    };
    let pairs = [to(-15, -5, -4, 0), to(8, 4, 12, 2), to(-3, 3, 2, 4)];
    for (seed, simulate) in [
        (1, json!({ "duration": "40 ms", "step": "1 ms" })),
        (
            2,
            json!({ "duration": "40 ms", "step": "2 ms", "integrator": { "galerkin": 2 } }),
        ),
        (3, json!({ "duration": "30 ms" })),
        (4, json!({ "duration": "30 ms", "tolerance": 1e-4 })),
        (
            6,
            json!({ "duration": "40 ms", "step": "8 ms", "coordinates": "redundant" }),
        ),
        (
            7,
            json!({ "duration": "40 ms", "step": "4 ms", "integrator": "implicit_euler" }),
        ),
        (9, json!({ "duration": "40 ms", "step": "20 ms" })),
    ] {
        let file = moving(seed, &simulate);
        let own = seen(&file);
        assert!(own.counts[0] > 1, "{seed}");
        for scales in &pairs {
            let other = seen(&scales.problem(&file));
            assert_eq!(own.counts, other.counts, "{seed} {simulate} {scales:?}");
            assert_eq!(own.codes, other.codes, "{seed} {simulate} {scales:?}");
            let errors = [own.error, other.error].map(Option::unwrap_or_default);
            assert!(
                (errors[0] - errors[1]).abs() <= 1e-9 * errors[0],
                "{errors:?}"
            );
            for (own, other) in own.columns.iter().zip(&other.columns) {
                let factor = scales.of_unit(own.unit);
                let size = own.values.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
                for (a, b) in own.values.iter().zip(&other.values) {
                    let apart = (a - b / factor).abs();
                    // Of a constraint that closes, rounding alone is left.
                    let is_rounding = own.name == "constraint_violation" && size < 1e-9;
                    assert!(
                        apart <= 1e-9 * size || is_rounding,
                        "{seed} {scales:?} {}: {a} {b}",
                        own.name
                    );
                }
            }
        }
    }
}
