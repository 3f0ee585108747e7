//! Optima of a closed loop and their sensitivities: the same in the joint coordinates of a spanning tree as in directors.

use crate::resolved::optimum;
use proboscis::control::problem::{Control, OutcomeOf, Task};
use proboscis::files::read_problem;
use proboscis::model::{Coordinates, System};
use proboscis::sensitivity::{Sensitivity, gradients, sensitivities};
use proboscis::workflow::Optimum;
use serde_json::{Value, json};

const BOTH: [&str; 2] = ["reduced", "redundant"];

/// A plane four-bar that its muscle moves to a goal.
fn four_bar(goal: &Value, coordinates: &str) -> (System, Control) {
    let scene = format!(
        "{}/problems/scenes/four_bar.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let problem = json!({ "scene": scene, "control": {
        "duration": "0.2 s", "intervals": 10, "start": { "rest_at_voltages": {} }, "goal": goal,
        "voltage_bounds": ["0 V", "3 kV"], "objective": { "effort": 1.0 }, "solver": { "tolerance": 1e-12 },
        "limits": [{ "joint_angle": { "joint": "hinge3", "max": "2 rad" } }],
        "coordinates": coordinates,
        "sensitivity": { "materials.silicone.shear_modulus": {}, "materials.silicone.viscosity": {} },
    } });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.json");
    std::fs::write(&path, problem.to_string()).unwrap();
    let loaded = read_problem(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    let Task::Control(control) = loaded.task else {
        panic!("a control problem");
    };
    (loaded.system, *control)
}

/// The greatest difference of two lists, relative to the greatest value.
fn apart(a: impl Iterator<Item = f64>, b: impl Iterator<Item = f64>) -> f64 {
    let pairs: Vec<(f64, f64)> = a.zip(b).collect();
    let size = pairs.iter().fold(0.0_f64, |most, (_, b)| most.max(b.abs()));
    assert!(size > 0.0);
    let far = pairs.iter().map(|(a, b)| (a - b).abs());
    far.fold(0.0, f64::max) / size
}

fn squares(of: &Optimum) -> impl Iterator<Item = f64> {
    of.motion.voltages.iter().flatten().map(|v| v * v)
}

#[test]
fn optima_and_sensitivities_of_a_loop_are_those_of_directors() {
    let goals = [
        json!({ "rest_at_voltages": { "muscle1": "1.5 kV" }, "rest": "bodies" }),
        json!({ "joint_angles": { "hinge1": "0.03 rad" } }),
        json!({ "joint_angles": { "hinge3": "0.02 rad" } }),
    ];
    for goal in goals {
        let problems = BOTH.map(|coordinates| four_bar(&goal, coordinates));
        let optima = problems.each_ref().map(|problem| optimum(problem, None));
        assert_eq!(optima[0].model.coordinates, Coordinates::Reduced);
        let [a, b] = optima.each_ref().map(|one| one.solution.objective);
        let voltages = apart(squares(&optima[0]), squares(&optima[1]));
        println!("{goal}: objectives {a} {b}, squares apart by {voltages:e}");
        assert!((a - b).abs() < 1e-9 * b.abs() && voltages < 1e-7);
        let found = [0, 1].map(|i| {
            let (system, control) = &problems[i];
            let (by, refused) = sensitivities(system, control, &optima[i].motion).unwrap();
            assert!(refused.is_empty(), "{refused:?}");
            by
        });
        for (a, b) in found[0].iter().zip(&found[1]) {
            let joints = |of: &Sensitivity| of.joints.clone().into_iter().flatten();
            let markers = |of: &Sensitivity| {
                let places = of.markers.clone().into_iter().flatten();
                places.flat_map(|place| [place.x, place.y, place.z])
            };
            // All four hinges, that which closes the loop among them.
            assert_eq!(a.joints[3].len(), 4);
            assert!(a.joints.iter().any(|row| row[2].abs() > 0.0));
            let [joints, markers] = [apart(joints(a), joints(b)), apart(markers(a), markers(b))];
            println!("{}: joints {joints:e}, markers {markers:e}", a.varied.name);
            assert!((a.objective / b.objective - 1.0).abs() < 1e-7);
            assert!(joints < 1e-6 && markers < 1e-6);
        }
        let outcomes = [0, 2].map(|joint| OutcomeOf::Joint { joint, time: 100.0 });
        let by = [0, 1].map(|i| {
            let (system, control) = &problems[i];
            gradients(system, control, &optima[i].motion, &outcomes).unwrap()
        });
        let rows = |i: usize| by[i].outcomes.clone().into_iter().flatten();
        assert!(apart(rows(0), rows(1)) < 1e-6);
        // The same derivative by its adjoint as along its direction.
        assert!((by[0].outcomes[1][0] / found[0][0].joints[5][2] - 1.0).abs() < 1e-7);
    }
}
