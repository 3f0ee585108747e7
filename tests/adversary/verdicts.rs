//! Optima of random robots: how far the motion under the optimal voltages deviates is told to a factor of two, or said not to be known.

use crate::common::random::Random;
use crate::robots::{Parts, robot};
use crate::seeds;
use proboscis::control::problem::{Control, MotionTask, Task};
use proboscis::dynamics::{DiscreteTrajectory, Integrator, Lengths, Solving, go_on};
use proboscis::files::{Loaded, read_problem};
use proboscis::workflow::{
    ACCURACY, Cause, SolveLimits, SolveRequest, integrate, optimise, optimise_together, solved,
};
use serde_json::json;
use std::ops::ControlFlow;

#[test]
fn the_error_of_an_optimum_is_at_least_half_of_the_true_one() {
    let (mut told, mut refused, mut unsolved) = (0, 0, 0);
    let mut lowest = f64::INFINITY;
    seeds(5000, 24, &[1_795_621_320], |seed| {
        let parts = Parts {
            weight: seed % 2 == 0,
            ball_joints: false,
            tendons: false,
            viscosity: seed % 3 != 0,
            bodies: 3,
        };
        let robot = robot(seed, parts);
        let random = &mut Random(seed);
        let goal: Vec<(&String, f64)> = robot
            .voltages
            .iter()
            .map(|(name, v)| (name, 0.8 * v))
            .collect();
        let goal: serde_json::Map<_, _> = goal
            .into_iter()
            .map(|(n, v)| (n.clone(), json!(v)))
            .collect();
        let loads = robot.loads.iter().map(|(name, size)| {
            let unit = if name == "motor" { "N mm" } else { "N" };
            (name.clone(), json!(format!("{size:?} {unit}")))
        });
        let loads: serde_json::Map<_, _> = loads.collect();
        let problem = json!({
            "scene": robot.scene,
            "control": {
                "duration": random.between(0.1, 0.4), "intervals": random.between(8.0, 30.0) as usize,
                "start": { "rest_at_voltages": {} }, "goal": { "rest_at_voltages": goal },
                "voltage_bounds": [0, 3000], "loads": loads, "objective": { "effort": 1.0 },
                "solver": { "max_iterations": 150 },
            },
        });
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("problem.json");
        std::fs::write(&path, problem.to_string()).unwrap();
        let loaded = read_problem(&path, &[]).unwrap();
        let Task::Control(control) = &loaded.task else {
            panic!("a control problem")
        };
        let limits = SolveLimits::default();
        let Ok(found) = optimise(&loaded.system, control, None, limits, &mut |_| {
            ControlFlow::Continue(())
        }) else {
            unsolved += 1;
            return;
        };
        let Some(tested) = found
            .resimulation
            .as_ref()
            .filter(|_| found.solution.status.is_solved())
        else {
            unsolved += 1;
            return;
        };
        let Some(error) = tested.error else {
            refused += 1;
            return;
        };
        // The same voltages by a method of order 6 in steps of a thirtieth.
        let (model, optimum) = (&found.model, &found.motion);
        let n = optimum.times.len() - 1;
        let h = optimum.times[n] / n as f64;
        let parts = 30;
        let times: Vec<f64> = (0..=parts * n)
            .map(|k| h * k as f64 / parts as f64)
            .collect();
        let drive = |from: f64, to: f64| {
            let k = (0.5 * (from + to) / h) as usize;
            model.scalars(&optimum.voltages[k.min(n - 1)])
        };
        let solving = Solving {
            integrator: Integrator::Galerkin { degree: 3 },
            ..Solving::default()
        };
        let begun = DiscreteTrajectory::at(&found.boundary.start);
        let (motion, failure) = go_on(
            solving,
            model,
            begun,
            Lengths::Between(&times),
            &drive,
            |_| ControlFlow::Continue(()),
        );
        if failure.is_some() {
            refused += 1;
            return;
        }
        let motion = solved(model, &motion, None);
        let (mut angle, mut length) = (0.0_f64, 0.0_f64);
        for k in 0..=n {
            for (a, b) in motion.joints[parts * k].iter().zip(&optimum.joints[k]) {
                angle = angle.max((a - b).abs());
            }
            for (a, b) in motion.poses[parts * k].iter().zip(&optimum.poses[k]) {
                length = length.max((a.centre - b.centre).norm());
            }
        }
        // Ways below 10⁻³ rad and lengths of the system count as none.
        let way = tested.path_length;
        let truth = f64::max(
            angle / way.angle.max(1e-3),
            length / (1e3 * way.length).max(1e-3 * model.length()),
        );
        told += 1;
        if tested.is_confirmed {
            lowest = lowest.min(error / truth);
            assert!(
                error + 1e-7 >= 0.5 * truth,
                "{seed}: told {error}, in truth {truth}"
            );
            assert!(
                error <= 3.0 * truth + 1e-6,
                "{seed}: told {error}, in truth {truth}"
            );
        } else {
            let is_refused = matches!(found.cause(), Some(Cause::Coarse { .. }));
            assert!(
                is_refused || truth < 0.5,
                "{seed}: told {error}, in truth {truth}"
            );
        }
    });
    println!("{told} told, lowest {lowest} of the truth, {refused} refused, {unsolved} not solved");
    assert!(told >= refused + unsolved);
}

/// A file of `tests/trust` as a problem.
fn kept(name: &str) -> Loaded {
    let path = format!("{}/tests/trust/{name}.json", env!("CARGO_MANIFEST_DIR"));
    read_problem(path.as_ref(), &[]).unwrap()
}

/// Between the instants of the optimum its motion vibrates, which half and a quarter of its steps do not resolve either: told 7 %, it
/// was 75 %. As many intervals as the verification needs resolve it.
#[test]
fn a_vibration_between_instants_is_seen_and_resolved() {
    let loaded = kept("07_error_told_too_small");
    let Task::Control(control) = &loaded.task else {
        panic!("a control problem")
    };
    let limits = SolveLimits::default();
    let coarse = optimise(&loaded.system, control, None, limits, &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(matches!(coarse.cause(), Some(Cause::Coarse { .. })));
    let refined = Control {
        is_refined: true,
        ..(**control).clone()
    };
    let task = MotionTask::alone(&loaded.system, &refined).into();
    let found = optimise_together(&task, SolveRequest::default(), &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let optimum = &found.optima[0];
    let tested = optimum.resimulation.as_ref().unwrap();
    assert!(optimum.is_solved() && tested.is_confirmed);
    assert!(tested.error.unwrap() <= ACCURACY && optimum.refined.is_none());
    assert!(optimum.motion.intervals() > 2 * control.intervals);
}

#[test]
fn where_nothing_moves_no_method_panics() {
    let loaded = kept("08_nothing_moves_by_stages");
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation")
    };
    let run = integrate(&loaded.system, task, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!((run.failure, run.discrete.intervals()), (None, 100));
}
