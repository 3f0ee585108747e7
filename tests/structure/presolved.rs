//! Presolve: a scene is not solved for parts that it does not need: welded and fixed bodies, immobile parts, sources without voltage,
//! inertia and friction at rest. Counts have closed forms, and numbers are those of the scene without it to the last bit.

use crate::common::cases::{cases, control, hold, joints};
use crate::common::solid::{DRIVEN, block, electrode, held};
use crate::common::systems::{GRAVITY, blocks, branched};
use crate::common::{at_reference, motion, placed, trunk};
use crate::welded::cuboid;
use nalgebra::Vector3;
use proboscis::Signal;
use proboscis::control::problem::{AtRest, BoundaryState, Simulation, Voltages};
use proboscis::control::{BoundaryConditions, resolve_start};
use proboscis::dynamics::{DiscreteTrajectory, Solving, Start, equilibrium, simulate};
use proboscis::functional::{Term, TermKind};
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{Potential, System};
use proboscis::model::term_order::terms;
use proboscis::model::{Analysis, Coordinates, Model, Response, Role};
use proboscis::sparse::Symmetry;
use proboscis::workflow::Plan;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

pub(crate) const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

/// A simulation of 100 ms in steps of 5 ms from the reference configuration under constant voltages.
pub(crate) fn under(voltages: Vec<f64>, coordinates: Coordinates) -> Simulation {
    Simulation {
        duration: 100.0,
        step: 5.0,
        tolerance: None,
        start: joints(&[]),
        voltages: Voltages::constant(&voltages),
        coordinates: Some(coordinates),
        solving: Solving::default(),
        controller: None,
    }
}

/// The model of a simulation and its motion.
pub(crate) fn moved(system: &System, task: &Simulation) -> (Model, DiscreteTrajectory) {
    let analysis = task.analysis(system, task.step);
    let model = Model::for_analysis(system.clone(), analysis).unwrap();
    let start = resolve_start(&model, &task.start).unwrap();
    let scalars = model.scalars(&task.voltages.at(0.0));
    let steps = (task.duration / task.step) as usize;
    let (discrete, failure) = simulate(
        &model,
        &start,
        task.step,
        steps,
        |_, _| scalars.clone(),
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    (model, discrete)
}

pub(crate) fn names(model: &Model) -> BTreeSet<String> {
    let sums = [&model.action.intervals, &model.action.instants];
    let effects = sums.into_iter().flat_map(|sum| &sum.terms);
    effects.map(|e| Term::name(e.as_ref()).to_owned()).collect()
}

/// Sources of the voltages of a model.
fn sources(model: &Model) -> Vec<usize> {
    model.variables.sources().collect()
}

#[test]
fn a_muscle_without_voltage_moves_like_a_passive_one_to_the_last_bit() {
    for coordinates in BOTH {
        let system = trunk(2);
        let task = under(vec![0.0, 900.0, 0.0, 700.0], coordinates);
        let mut passive = system.clone();
        for muscle in [0, 2] {
            passive.muscles[muscle].material.electric = None;
        }
        let ((model, found), (other, expected)) = (moved(&system, &task), moved(&passive, &task));
        assert_eq!([sources(&model), sources(&other)], [[1, 3], [1, 3]]);
        assert_eq!(model.reached, vec![0, 1, 2, 3]);
        let way: f64 = found.z[20]
            .iter()
            .zip(&found.z[0])
            .map(|(a, b)| (a - b).abs())
            .sum();
        assert!(way > 0.01, "{way}");
        assert_eq!(found.z, expected.z);
        assert_eq!(found.momenta, expected.momenta);
    }
}

#[test]
fn an_electrode_without_voltage_is_grounded() {
    let mesh = Grid::uniform(Vector3::zeros(), Vector3::new(10.0, 12.0, 20.0), [1, 1, 4]).mesh();
    let material = blocks().muscles[0].material;
    let with = |middle: Potential, top: Potential| {
        let mut solid = block(mesh.clone(), material);
        solid.supports = vec![held(&mesh, "z_min", [true; 3])];
        solid.electrodes = vec![
            electrode(&mesh, "bottom", 0.0, Potential::Given(0.0)),
            electrode(&mesh, "middle", 10.0, middle),
            electrode(&mesh, "top", 20.0, top),
        ];
        crate::common::solid::system(vec![solid])
    };
    let second = Potential::Driven {
        source: 1,
        factor: 1.0,
    };
    let (driven, grounded) = (with(DRIVEN, second), with(Potential::Given(0.0), DRIVEN));
    let of_reduced = |row| under(row, Coordinates::Reduced);
    let (model, found) = moved(&driven, &of_reduced(vec![0.0, 3e4]));
    let (other, expected) = moved(&grounded, &of_reduced(vec![3e4]));
    // One plane of potentials between middle and top, none below.
    let potentials = [&model, &other].map(|model| model.variables.count(Role::Potential));
    assert_eq!(potentials, [4, 4]);
    assert_eq!((sources(&model), &model.reached), (vec![1], &vec![0, 1]));
    assert!((found.z[20][2] - found.z[0][2]).abs() > 1e-6);
    assert_eq!(found.z, expected.z);
    // Without any voltage there is no field, and nothing moves.
    let (still, rest) = moved(&driven, &of_reduced(vec![0.0, 0.0]));
    let potentials = still.variables.count(Role::Potential);
    assert_eq!((potentials, still.coordinate_count()), (0, 0));
    assert_eq!((names(&still).len(), rest.intervals()), (0, 20));
}

#[test]
fn at_rest_there_is_neither_inertia_nor_friction() {
    for coordinates in BOTH {
        for mut system in [trunk(2), blocks(), branched()] {
            system.gravity = Some(GRAVITY);
            let volts: Vec<f64> = (1..=system.sources().len())
                .map(|s| 200.0 * s as f64)
                .collect();
            let task = AtRest {
                response: Response::Relaxed,
                voltages: volts.clone(),
                coordinates: Some(coordinates),
                path: None,
                vibrations: None,
            };
            let of_motion = Analysis {
                coordinates: Some(coordinates),
                ..Analysis::of_motion(1.0)
            };
            let still = Model::for_analysis(system.clone(), task.analysis(&system)).unwrap();
            let moving = Model::for_analysis(system.clone(), of_motion).unwrap();
            let kinds = |model: &Model| -> Vec<TermKind> {
                let effects = model.action.intervals.terms.iter();
                effects.map(|e| e.kind()).collect()
            };
            for kind in [TermKind::Kinetic, TermKind::Dissipation] {
                assert!(kinds(&moving).contains(&kind) && !kinds(&still).contains(&kind));
            }
            // Weight needs masses, not inertia.
            assert!(names(&still).contains("gravity"));
            assert_eq!(still.coordinate_count(), moving.coordinate_count());
            let [found, expected] = [&still, &moving].map(|model| {
                equilibrium(model, &at_reference(model), &model.scalars(&volts)).unwrap()
            });
            let away = found
                .z
                .iter()
                .zip(at_reference(&still))
                .map(|(a, b)| (a - b).abs());
            assert!(away.fold(0.0, f64::max) > 1e-3);
            for (a, b) in found
                .z
                .iter()
                .zip(&expected.z)
                .take(still.coordinate_count())
            {
                assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{a} {b}");
            }
        }
    }
}

/// The first `segments` segments of a trunk, and the rest as a trunk of its own beside it.
fn beside(segments: usize, others: usize) -> System {
    let (mut system, mut other) = (trunk(segments), trunk(others));
    let far = Vector3::new(500.0, 0.0, 0.0);
    for body in &mut other.bodies {
        body.name.push_str(" beside");
        body.centre += far;
    }
    for joint in &mut other.joints {
        joint.name.push_str(" beside");
        joint.at += far;
        joint.parent = joint.parent.map(|b| b + segments);
        joint.child += segments;
    }
    for muscle in &mut other.muscles {
        muscle.name.push_str(" beside");
        for end in [&mut muscle.from, &mut muscle.to] {
            end.at += far;
            end.body = end.body.map(|b| b + segments);
        }
    }
    system.bodies.extend(other.bodies);
    system.joints.extend(other.joints);
    system.muscles.extend(other.muscles);
    system
}

#[test]
fn what_nothing_moves_is_not_solved_for() {
    let (alone, both) = (trunk(2), beside(2, 3));
    let volts = |count: usize| {
        let mut row = hold(2);
        row.resize(count, 0.0);
        row
    };
    for coordinates in BOTH {
        let (model, found) = moved(&both, &under(volts(10), coordinates));
        let (other, expected) = moved(&alone, &under(volts(4), coordinates));
        assert_eq!(model.coordinate_count(), other.coordinate_count());
        assert_eq!(found.z, expected.z);
        assert_eq!(found.momenta, expected.momenta);
        let poses = model.poses(&placed(&model, &found.z[20]));
        assert_eq!(poses[4], both.bodies[4].pose());
        let kept = model.joints(&placed(&model, &found.z[20]), &[0.0; 5]);
        assert!(kept[0].abs() > 1e-3 && kept[2..] == [0.0; 3]);

        // Weight, a voltage, a start in motion or away from the reference bring it back.
        let count = |change: &dyn Fn(&mut System, &mut Simulation)| {
            let (mut system, mut task) = (both.clone(), under(volts(10), coordinates));
            change(&mut system, &mut task);
            let analysis = task.analysis(&system, task.step);
            let model = Model::for_analysis(system, analysis).unwrap();
            model.presolved.system.joints.len()
        };
        assert_eq!(count(&|_, _| {}), 2);
        assert_eq!(count(&|s, _| s.gravity = Some(GRAVITY)), 5);
        let driven = |_: &mut System, t: &mut Simulation| {
            let mut row = volts(10);
            row[9] = 10.0;
            t.voltages = Voltages::constant(&row);
        };
        assert_eq!(count(&driven), 5);
        assert_eq!(count(&|_, t| t.start = joints(&[(4, 0.1)])), 5);
        assert_eq!(count(&|_, t| t.start = joints(&[(4, 0.0)])), 2);
        let rates = |_: &mut System, t: &mut Simulation| {
            t.start = BoundaryState::JointAngles {
                angles: Default::default(),
                rates: [(4, 1e-3)].into(),
                velocities: Default::default(),
            };
        };
        assert_eq!(count(&rates), 5);
    }
    // A control problem whose goal or limits speak of it solves for it; else the voltages beside are given.
    let mut task = control(&both, 3);
    task.given = (4..10).map(|s| (s, Signal::Constant(0.0))).collect();
    task.goal = joints(&[(0, 0.05)]);
    let joints_of = |task: &proboscis::control::problem::Control| {
        let (model, _) = BoundaryConditions::resolve(&both, task, 10.0).unwrap();
        model.presolved.system.joints.len()
    };
    assert_eq!(joints_of(&task), 2);
    task.goal = joints(&[(3, 0.0)]);
    assert_eq!(joints_of(&task), 5);
}

#[test]
fn a_free_body_at_rest_leaves_the_tree_reduced() {
    let mut system = trunk(2);
    let stone = cuboid("stone", 5.0, [4.0; 3], Vector3::new(300.0, 0.0, 0.0));
    system.bodies.push(stone);
    let analysis = under(hold(2), Coordinates::Reduced).analysis(&system, 5.0);
    let model = Model::for_analysis(system.clone(), analysis).unwrap();
    assert_eq!(model.coordinate_count(), 2);
    // What a caller may set in motion is not taken for ground.
    let free = Model::new(system, None, 5.0, &[]).unwrap();
    assert_eq!(
        (free.coordinates, free.coordinate_count()),
        (Coordinates::Reduced, 2 + 6)
    );
    let mut rates = vec![0.0; 8];
    rates[2] = 1.0;
    let start = Start::with_rates(&free, at_reference(&free), &rates);
    let drift = motion(&free, &start, 5.0, 2, &[0.0; 4]);
    assert!((drift.z[2][2] - 10.0).abs() < 1e-9);
}

#[test]
fn a_tangent_is_symmetric_where_nothing_dissipates() {
    let mesh = Grid::uniform(Vector3::zeros(), Vector3::new(10.0, 12.0, 20.0), [1, 1, 2]).mesh();
    let symmetry = |viscosity| {
        let mut material = blocks().muscles[0].material;
        material.viscosity = viscosity;
        let mut solid = block(mesh.clone(), material);
        solid.supports = vec![held(&mesh, "z_min", [true; 3])];
        let model = Model::new(crate::common::solid::system(vec![solid]), None, 1.0, &[]).unwrap();
        model.step_symmetry()
    };
    assert_eq!(symmetry(None), Symmetry::Symmetric);
    assert_eq!(symmetry(Some(1.0)), Symmetry::Unsymmetric);
}

/// Hands over the name of each case with its model and plan, in both kinds of coordinates.
pub(crate) fn each_plan(mut to: impl FnMut(&str, &Model, &Plan)) {
    for case in cases() {
        for coordinates in BOTH {
            let mut control = case.control.clone();
            control.coordinates = Some(coordinates);
            let (model, _) = BoundaryConditions::resolve(&case.system, &control, 10.0).unwrap();
            let plan = Plan::from_model(&model, Some(&control), 0.0);
            to(case.name, &model, &plan);
        }
    }
}

#[test]
fn each_effect_is_in_the_plan_once_with_its_reason() {
    let mut seen = BTreeSet::new();
    each_plan(|name, _, plan| {
        for effect in &plan.effects {
            assert!(terms().any(|term| term == effect.name), "{}", effect.name);
            assert!(effect.why.len() > 5 && effect.elements > 0, "{effect:?}");
            assert!(effect.microseconds > 0.0 && effect.hessian.is_some());
            seen.insert(effect.name.clone());
        }
        let absent: Vec<&str> = plan.absent.iter().map(|a| a.name.as_str()).collect();
        for effect in terms() {
            let there = plan.effects.iter().any(|e| e.name == effect);
            assert_ne!(there, absent.contains(&effect), "{effect} of {}", name);
        }
        assert!(
            plan.absent.iter().all(|a| a.why.len() > 5),
            "{:?}",
            plan.absent
        );
    });
    let all: BTreeSet<String> = terms().map(str::to_owned).collect();
    assert_eq!(seen, all);
}

#[test]
fn entries_of_the_program_are_those_of_its_effects() {
    // In a trunk of one segment each effect couples all that there is: one angle, two voltages. An inner interval of the
    // program has 3 entries of the angle with itself and 2 of each voltage with the angles at its ends; its Hessian 2 of
    // the angle, 2 of each voltage with the angles, and each voltage with itself.
    let system = trunk(1);
    let mut task = control(&system, 4);
    let plan = |task: &proboscis::control::problem::Control| {
        let (model, _) = BoundaryConditions::resolve(&system, task, 10.0).unwrap();
        let plan = Plan::from_model(&model, Some(task), 0.0);
        let named = |name: &str| {
            let effect = plan.effects.iter().find(|e| e.name == name).unwrap();
            (effect.unknowns, effect.jacobian, effect.hessian.unwrap())
        };
        [named("body inertia"), named("muscle electroelasticity")]
    };
    assert_eq!(plan(&task), [(1, 3, 2), (3, 3 + 2 * 2, 2 + 2 * 2 + 2)]);
    task.given.insert(0, Signal::Constant(500.0));
    assert_eq!(plan(&task), [(1, 3, 2), (3, 3 + 2, 2 + 2 + 1)]);
}
