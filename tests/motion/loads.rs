//! Loads: forces and torques in time, against closed forms and against each other, in both kinds of coordinates.

use crate::common::bare;
use crate::components::body;
use nalgebra::Vector3;
use proboscis::control::Signal;
use proboscis::control::problem::{BoundaryState, Simulation, Voltages};
use proboscis::dynamics::{Solving, stable_equilibrium};
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
fn on(kind: JointKind, spring: Option<JointSpring>, load: LoadPlace) -> System {
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

fn slide() -> JointKind {
    JointKind::Prismatic { axis: Vector3::x() }
}

fn hinge() -> JointKind {
    JointKind::Revolute { axis: Vector3::z() }
}

/// A force on the centre of mass, across the hinge in the reference configuration.
fn at_centre(direction: Vector3<f64>) -> LoadPlace {
    let at = Attachment {
        body: Some(0),
        at: Vector3::new(20.0, 0.0, 0.0),
    };
    LoadPlace::Point { at, direction }
}

/// The joint coordinate at the end of a motion from rest under a load.
fn end(system: &System, load: &Signal, step: f64, coordinates: Coordinates) -> f64 {
    let task = Simulation {
        duration: DURATION,
        step,
        tolerance: None,
        start: BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: BTreeMap::new(),
        },
        voltages: Voltages::Signals(vec![load.clone()]),
        coordinates: Some(coordinates),
        solving: Solving::default(),
    };
    let go_on = |_: &Model, _: &_| ControlFlow::Continue(());
    let done = integrate(system, &task, go_on).unwrap();
    assert!(done.failure.is_none(), "{:?}", done.failure);
    let z = done.discrete.z.last().unwrap();
    let instant = done.model.action.map.placed(z);
    done.model.joints(&instant, &[0.0])[0]
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
        let none = Voltages::Constant(Vec::new());
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
