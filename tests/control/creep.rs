//! Control of rubber that creeps.

use crate::common::cases::{control, hold};
use crate::common::robot::Robot;
use crate::common::{receding, trunk};
use proboscis::control::problem::{BoundaryState, Regulator, Rest, Task};
use proboscis::feedback::Controller;
use proboscis::files::read_problem;
use proboscis::model::system::{
    Discretisation, ElementKind, Fidelity, MaxwellBranch, MaxwellBranches,
};
use proboscis::model::{Model, Role};
use proboscis::workflow::{SolveLimits, optimise};
use std::ops::ControlFlow;
use std::path::Path;

/// Twelve muscles of three Maxwell branches each.
#[test]
fn the_trunk_of_rubber_that_creeps_reaches_its_goal() {
    let solve = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        let loaded = read_problem(&path, &["control.intervals=60".to_owned()]).unwrap();
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

/// One segment between a lumped muscle and one hexahedron, whose nodes are all glued: what it remembers is all that it adds.
#[test]
fn a_muscle_of_finite_elements_that_creeps_is_steered() {
    let mut system = trunk(1);
    let branch = MaxwellBranch {
        shear_modulus: 0.03,
        relaxation_time: 60.0,
    };
    let muscle = &mut system.muscles[1];
    muscle.material.lame_lambda = Some(0.4);
    muscle.material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    muscle.fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 1],
        layers: 1,
        element: ElementKind::Hex8,
    });
    let mut control = control(&system, 15);
    control.goal = BoundaryState::RestAtVoltages(hold(1), Rest::Everything);
    let limits = SolveLimits::default();
    let found = optimise(&system, &control, None, limits, &mut |_| {
        ControlFlow::Continue(())
    });
    let found = found.unwrap();
    assert!(found.is_solved(), "{:?}", found.solution.status);
    assert_eq!(found.model.variables.count(Role::Coordinate), 1 + 40);
    let tested = found.resimulation.as_ref().unwrap();
    assert!(tested.is_confirmed, "{tested:?}");
    let strains: Vec<usize> = found.model.strains().collect();
    assert_eq!(strains.len(), 40);
    // It starts relaxed, and at the end still remembers a shorter way than it has been turned.
    let (first, last) = (&found.motion.z[0], found.motion.z.last().unwrap());
    let largest = |z: &[f64]| strains.iter().map(|&i| z[i].abs()).fold(0.0, f64::max);
    assert!(largest(first) < 1e-9, "{}", largest(first));
    let turned = found.motion.joints.last().unwrap()[0].abs();
    assert!(
        turned > 0.02 && largest(last) > 1e-3,
        "{turned} {}",
        largest(last)
    );
}

/// What a regulator holds is at rest: the rubber has relaxed there, though not yet at the end of the motion. Under the gains the robot comes
/// to its goal.
#[test]
fn a_goal_is_held_where_rubber_has_relaxed() {
    let creeping = "scene.materials.silicone.maxwell=[{\"shear_modulus\": \"60 kPa\", \"relaxation_time\": \"0.1 s\"}]";
    let pair = receding::problem("pair.json", &[creeping]);
    let horizon = receding::horizon(&pair, &Regulator::default(), 4);
    let law = horizon.law();
    let held = law.held.as_ref().unwrap();
    let memory = law
        .measured
        .iter()
        .position(|one| one.memory.is_some())
        .unwrap();
    let at_end = law.at(law.duration() - 0.5 * law.h);
    let relaxed = held.state[memory] - at_end.state[memory];
    assert!(relaxed.abs() > 0.01, "{relaxed}");
    let model = Model::new(pair.0.clone(), None, law.h, &[]).unwrap();
    let mut robot = Robot::new(&model, 10);
    let end = 120.0 * law.h;
    let mut at_rest = Robot::new(&model, 10);
    let own = model.coordinate_count();
    let of_held = at_rest.z[..own].iter_mut().zip(&held.state);
    of_held.for_each(|(z, value)| *z = *value);
    let before = at_rest.z.clone();
    at_rest.go(law.h, &held.inputs);
    for (z, before) in at_rest.z[..own].iter().zip(&before) {
        assert!((z - before).abs() < 1e-9, "{z} {before}");
    }
    let mut regulator = Controller::new(law, law.h, 0.0);
    let mut inputs = vec![0.0; law.inputs.len()];
    let mut time = 0.0;
    while time < end {
        let state = robot.measure();
        regulator.sample(time, &state[..law.measured.len()]);
        regulator.inputs(time, time, &mut inputs);
        robot.go(law.h, &inputs);
        time += law.h;
    }
    let off = robot.z[0] - held.state[0];
    assert!(held.state[0] > 0.1 && off.abs() < 1e-4, "{off} rad");
}
