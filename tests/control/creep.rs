//! Control of rubber that creeps.

use proboscis::control::problem::Task;
use proboscis::files::read_problem;
use proboscis::model::Role;
use proboscis::workflow::{SolveLimits, optimise};
use std::ops::ControlFlow;
use std::path::Path;

/// Twelve muscles of three Maxwell branches each.
#[test]
fn the_trunk_of_rubber_that_creeps_reaches_its_goal() {
    let solve = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        let loaded = read_problem(&path, &[]).unwrap();
        let Task::Control(control) = loaded.task else {
            panic!("a problem of control");
        };
        let limits = SolveLimits::default();
        let found = optimise(&loaded.system, &control, None, limits, &mut |_| {
            ControlFlow::Continue(())
        });
        let found = found.unwrap();
        assert!(found.is_solved(), "{name}");
        found
    };
    let [creeping, plain] = ["elephant_trunk_creeping", "elephant_trunk"].map(solve);
    assert_eq!(creeping.model.variables.count(Role::Coordinate), 6 + 36);
    let tested = creeping.resimulation.as_ref().unwrap();
    assert!(
        tested.is_confirmed && tested.error.unwrap() < 0.05,
        "{tested:?}"
    );
    let n = creeping.motion.times.len() - 1;
    let [a, b] = [&creeping, &plain].map(|found| &found.motion.joints[n]);
    assert!(a.iter().any(|angle| angle.abs() > 0.1));
    for (a, b) in a.iter().zip(b) {
        assert!(
            (a - b).abs() < 1e-6,
            "the goal is the same relaxed state: {a} {b}"
        );
    }
    // At the end the branches still remember: what holds the goal is not yet felt.
    let z = &creeping.motion.z[n];
    let slowest = creeping.model.viscous_coordinates().map(|i| z[i].abs());
    let stretched = slowest.fold(f64::INFINITY, f64::min);
    assert!(stretched < 1e-2, "{stretched}");
    let apart = creeping.motion.voltages.iter().zip(&plain.motion.voltages);
    let apart = apart.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    assert!(apart.fold(0.0, f64::max) > 100.0, "other voltages");
}
