//! Loads: forces and torques in time, against closed forms and against each other, in both kinds of coordinates.

use crate::common::{bare, numbers, reference, trunk};
use crate::components::body;
use nalgebra::Vector3;
use proboscis::control::problem::{BoundaryState, Simulation, Voltages};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{Integrator, Solving, observations, stable_equilibrium};
use proboscis::math::Signal;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::{Attachment, Joint, JointKind, JointSpring, System};
use proboscis::model::{Coordinates, Model};
use proboscis::workflow::integrate;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];
/// ms.
const DURATION: f64 = 200.0;

/// 10 g on a joint.
pub(crate) fn on(kind: JointKind, spring: Option<JointSpring>, load: LoadPlace) -> System {
    let joint = Joint {
        name: "joint".into(),
        kind,
        child: 0,
        spring,
        ..Joint::default()
    };
    let mut system = bare(vec![body("mass", 20.0)], vec![joint], None);
    system.components.loads = vec![Load {
        name: "push".into(),
        on: load,
    }];
    system
}

pub(crate) fn slide() -> JointKind {
    JointKind::Prismatic { axis: Vector3::x() }
}

pub(crate) fn hinge() -> JointKind {
    JointKind::Revolute { axis: Vector3::z() }
}

/// A force on the centre of mass, across the hinge in the reference configuration.
fn at_centre(direction: Vector3<f64>) -> LoadPlace {
    let at = Attachment {
        body: Some(0),
        at: Vector3::new(20.0, 0.0, 0.0),
    };
    LoadPlace::Point {
        at,
        direction,
        follows: false,
    }
}

/// A force across the hinge at the centre of mass that turns with it.
pub(crate) fn jet() -> System {
    let LoadPlace::Point { at, direction, .. } = at_centre(Vector3::y()) else {
        unreachable!("a point")
    };
    let follows = true;
    let load = LoadPlace::Point {
        at,
        direction,
        follows,
    };
    on(hinge(), None, load)
}

/// A motion from rest under a load.
fn task(load: &Signal, step: f64, coordinates: Coordinates) -> Simulation {
    Simulation {
        duration: DURATION,
        step,
        tolerance: None,
        start: BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: BTreeMap::new(),
        },
        voltages: Voltages::from(vec![load.clone()]),
        coordinates: Some(coordinates),
        solving: Solving::default(),
        controller: None,
    }
}

/// The joint coordinate at the end of a motion from rest under a load.
fn end(system: &System, load: &Signal, step: f64, coordinates: Coordinates) -> f64 {
    moved(system, load, step, coordinates).0
}

/// The same, and the work of loads that follow.
fn moved(
    system: &System,
    load: &Signal,
    step: f64,
    coordinates: Coordinates,
) -> (f64, Option<f64>) {
    read(system, &task(load, step, coordinates))
}

/// The joint coordinate at the end of a motion, and the work of loads that follow.
fn read(system: &System, task: &Simulation) -> (f64, Option<f64>) {
    let go_on = |_: &Model, _: &_| ControlFlow::Continue(());
    let done = integrate(system, task, go_on).unwrap();
    assert!(done.failure.is_none(), "{:?}", done.failure);
    let seen = observations(&done.model, &done.discrete);
    let last = |name: &str| {
        let column = seen.columns.iter().find(|column| column.name == name)?;
        column.values.last().copied()
    };
    // Angles of the table count whole turns.
    let angle = last("joint").expect("a column of the joint");
    (angle, last("following_load_work"))
}

#[test]
fn a_mass_under_a_force_in_time_moves_as_its_closed_form_with_order_two() {
    let period = 150.0;
    let omega = std::f64::consts::TAU / period;
    let sine = Signal::Sine {
        mean: 0.0,
        amplitude: 0.3,
        frequency: 1.0 / period,
        phase: 0.0,
    };
    // m ẍ = A sin ωt from rest.
    let of = |mass: f64, t: f64| 0.3 / mass * (t / omega - (omega * t).sin() / (omega * omega));
    let moment = 10.0 * 400.0 + 600.0;
    for (kind, mass, load) in [
        (slide(), 10.0, LoadPlace::Joint(0)),
        (slide(), 10.0, at_centre(Vector3::x())),
        (hinge(), moment, LoadPlace::Joint(0)),
    ] {
        let system = on(kind, None, load);
        let exact = of(mass, DURATION);
        assert!(exact > 0.1, "{exact}");
        for coordinates in BOTH {
            let errors = [2.0, 1.0].map(|h| (end(&system, &sine, h, coordinates) - exact).abs());
            assert!(errors[1] < 1e-3 * exact, "{coordinates:?}: {errors:?}");
            let ratio = errors[0] / errors[1];
            assert!((ratio - 4.0).abs() < 0.2, "{coordinates:?}: {errors:?}");
        }
    }
}

#[test]
fn a_force_turns_a_hinge_like_weight_of_its_size() {
    let direction = Vector3::new(0.6, 0.8, 0.0);
    for coordinates in BOTH {
        let pulled = on(hinge(), None, at_centre(direction));
        let mut heavy = pulled.clone();
        heavy.components.loads.clear();
        // 10 g under 0.03 mm/ms² weigh 0.3 N.
        heavy.gravity = Some(0.03 * direction);
        let one = end(&pulled, &Signal::Constant(0.3), 1.0, coordinates);
        let none = Voltages::default();
        let task = Simulation {
            duration: DURATION,
            step: 1.0,
            tolerance: None,
            start: BoundaryState::JointAngles {
                angles: BTreeMap::new(),
                rates: BTreeMap::new(),
                velocities: BTreeMap::new(),
            },
            voltages: none,
            coordinates: Some(coordinates),
            solving: Solving::default(),
            controller: None,
        };
        let go_on = |_: &Model, _: &_| ControlFlow::Continue(());
        let done = integrate(&heavy, &task, go_on).unwrap();
        let instant = done
            .model
            .action
            .map
            .placed(done.discrete.z.last().unwrap());
        let other = done.model.joints(&instant, &[0.0])[0];
        assert!(
            one.abs() > 0.1 && (one - other).abs() < 1e-9,
            "{one} {other}"
        );
    }
}

#[test]
fn a_force_that_follows_turns_a_hinge_like_a_torque() {
    // F r on a moment of inertia I: ½ F r/I t², and the work F r times the angle.
    let (force, arm, moment) = (0.05, 20.0, 10.0 * 400.0 + 600.0);
    let exact = 0.5 * force * arm / moment * DURATION * DURATION;
    assert!(exact > 4.0);
    let system = jet();
    for coordinates in BOTH {
        let run = |h: f64| moved(&system, &Signal::Constant(force), h, coordinates);
        let errors = [2.0, 1.0].map(|h| (run(h).0 - exact).abs());
        assert!(errors[1] < 1e-3 * exact, "{coordinates:?}: {errors:?}");
        assert!((errors[0] / errors[1] - 4.0).abs() < 0.2, "{errors:?}");
        let (angle, work) = run(1.0);
        let work = work.expect("a following load does work");
        assert!(
            (work / (force * arm * angle) - 1.0).abs() < 1e-3,
            "{work} {angle}"
        );
    }
    let dead = end(
        &on(hinge(), None, at_centre(Vector3::y())),
        &Signal::Constant(force),
        1.0,
        Coordinates::Reduced,
    );
    assert!((dead - exact).abs() > 1.0, "{dead}");
}

#[test]
fn every_method_turns_a_hinge_by_a_force_that_follows() {
    let system = jet();
    let exact = 0.5 * 0.05 * 20.0 / 4600.0 * DURATION * DURATION;
    for integrator in [
        Integrator::Galerkin { degree: 2 },
        Integrator::Galerkin { degree: 3 },
        Integrator::GeneralisedAlpha {
            spectral_radius: 0.8,
        },
    ] {
        let mut task = task(&Signal::Constant(0.05), 2.0, Coordinates::Reduced);
        task.solving.integrator = integrator;
        let (angle, work) = read(&system, &task);
        let near = match integrator {
            Integrator::Galerkin { .. } => 1e-6,
            _ => 2e-3,
        };
        assert!(
            (angle / exact - 1.0).abs() < near,
            "{integrator:?}: {angle}"
        );
        let work = work.expect("a following load does work");
        // F r is 1 N mm; methods that are not variational do not keep the balance.
        assert!(
            (work / angle - 1.0).abs() < 10.0 * near,
            "{integrator:?}: {work}"
        );
    }
}

/// The trunk under a sine of a force that keeps its direction at its tip and of one that turns with its third segment, by another program
/// (`tests/reference/exudyn_trunk.py`).
#[test]
fn the_trunk_under_two_forces_moves_as_exudyn_computes() {
    let known = reference("exudyn_trunk");
    let mut system = trunk(6);
    for muscle in &mut system.muscles {
        muscle.material.density = None;
    }
    let frequencies = numbers(&known["frequencies_Hz"]);
    let mut sines = vec![Signal::Constant(0.0); 12];
    for (i, (key, body, height)) in [("dead_N", 5, 300.0), ("following_N", 2, 150.0)]
        .into_iter()
        .enumerate()
    {
        let force = Vector3::from_vec(numbers(&known[key]));
        let at = Attachment {
            body: Some(body),
            at: Vector3::new(0.0, height, 0.0),
        };
        system.components.loads.push(Load {
            name: key.into(),
            on: LoadPlace::Point {
                at,
                direction: force.normalize(),
                follows: i == 1,
            },
        });
        sines.push(Signal::Sine {
            mean: 0.0,
            amplitude: force.norm(),
            frequency: frequencies[i] / 1e3,
            phase: 0.0,
        });
    }
    let tip = system.markers.iter().position(|m| m.name == "tip").unwrap();
    let times = numbers(&known["time_s"]);
    for (integrator, step, near) in [
        (Integrator::Galerkin { degree: 3 }, 2.0, 1e-5),
        (Integrator::Midpoint, 0.25, 1e-3),
    ] {
        for coordinates in BOTH {
            let task = Simulation {
                duration: 300.0,
                voltages: Voltages::from(sines.clone()),
                solving: Solving {
                    integrator,
                    ..Solving::default()
                },
                ..task(&Signal::Constant(0.0), step, coordinates)
            };
            let go_on = |_: &Model, _: &_| ControlFlow::Continue(());
            let done = integrate(&system, &task, go_on).unwrap();
            let motion = Trajectory::from_discrete(&done.model, &done.discrete);
            for (time, place) in times.iter().zip(known["tip_m"].as_array().unwrap()) {
                let k = (1e3 * time / step).round() as usize;
                let expected = 1e3 * Vector3::from_vec(numbers(place));
                let found = motion.marks[k][tip];
                let away = (found - expected).norm();
                // mm; the tip moves by 60 mm.
                assert!(away < near, "{integrator:?} {coordinates:?} {time}: {away}");
            }
        }
    }
}

#[test]
fn a_torque_holds_a_sprung_hinge_where_both_agree() {
    let spring = Some(JointSpring {
        stiffness: 40.0,
        rest: 0.1,
    });
    for coordinates in BOTH {
        let system = on(hinge(), spring, LoadPlace::Joint(0));
        let model = Model::new(system, Some(coordinates), 1.0, &[]).unwrap();
        let start = model.coordinates_at(&[0.0]);
        let found = stable_equilibrium(&model, &start, &model.scalars(&[26.0])).unwrap();
        let instant = model.action.map.placed(&found.z);
        let angle = model.joints(&instant, &[0.0])[0];
        assert!((angle - 0.75).abs() < 1e-9, "{angle}");
        assert_eq!(found.unstable, Some(0));
    }
}

#[test]
fn a_load_of_zero_leaves_no_trace() {
    let system = on(hinge(), None, LoadPlace::Joint(0));
    let mut bare = system.clone();
    bare.components.loads.clear();
    let zero_inputs = [0].into();
    let analysis = proboscis::model::Analysis {
        zero_inputs,
        ..proboscis::model::Analysis::of_motion(1.0)
    };
    let silent = Model::for_analysis(system, analysis).unwrap();
    let without = Model::new(bare, None, 1.0, &[]).unwrap();
    let terms = |model: &Model| model.present.clone();
    assert_eq!(terms(&silent), terms(&without));
    assert_eq!(silent.variables.inputs(), 0..0);
}
