//! Forces and torques that joints transmit, against closed forms and the momentum of single bodies.

use crate::common::{bare, body, column, columns, joint, motion, runge_kutta};
use crate::maxwell::{BOTH, model};
use nalgebra::{Matrix3, Vector2, Vector3};
use proboscis::dynamics::trajectory::Observations;
use proboscis::dynamics::{DiscreteTrajectory, Start, observations, stable_equilibrium};
use proboscis::model::Model;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::{Body, Joint, JointKind, System};

const MASS: f64 = 25.0;
const ARM: f64 = 40.0;
const ABOUT: f64 = 800.0;
/// Distance of the centre of mass from the plane of the hinge.
const ASIDE: f64 = 15.0;
const GRAVITY: Vector3<f64> = Vector3::new(0.0, -9.81e-3, 0.0);

fn bob(name: &str, centre: Vector3<f64>) -> Body {
    body(
        name,
        MASS,
        [900.0, 900.0, ABOUT],
        centre,
        Matrix3::identity(),
    )
}

pub(crate) fn hinge(name: &str, parent: Option<usize>, child: usize, at: Vector3<f64>) -> Joint {
    joint(
        name,
        JointKind::Revolute { axis: Vector3::z() },
        parent,
        child,
        at,
    )
}

fn pendulum() -> System {
    let bob = bob("bob", Vector3::new(0.0, -ARM, ASIDE));
    bare(
        vec![bob],
        vec![hinge("hip", None, 0, Vector3::zeros())],
        Some(GRAVITY),
    )
}

/// The same between a body that is welded to the ground, which is the child, and the bob.
fn reversed() -> System {
    let mut system = pendulum();
    system.bodies.push(bob("wall", Vector3::x() * 100.0));
    let weld = joint("weld", JointKind::Fixed, None, 1, Vector3::zeros());
    system.joints = vec![hinge("hip", Some(0), 1, Vector3::zeros()), weld];
    system
}

/// Force and torque of the hinge on the bob: m (a − g), r × m (a − g) without its part along the axis.
fn exact(time: f64) -> [Vector3<f64>; 2] {
    let inertia = ABOUT + MASS * ARM * ARM;
    let acceleration = |angle: f64| MASS * GRAVITY.y * ARM * angle.sin() / inertia;
    let rate = |y: &Vector2<f64>| Vector2::new(y.y, acceleration(y.x));
    let start = Vector2::new(1.0, 2e-3);
    let y = (0..4000).fold(start, |y, _| runge_kutta(&rate, &y, time / 4000.0));
    let [along, across] = [
        Vector3::new(y.x.sin(), -y.x.cos(), 0.0),
        Vector3::new(y.x.cos(), y.x.sin(), 0.0),
    ];
    let moved = (across * acceleration(y.x) - along * y.y * y.y) * ARM;
    let force = (moved - GRAVITY) * MASS;
    let torque = (along * ARM + Vector3::z() * ASIDE).cross(&force);
    [force, Vector3::new(torque.x, torque.y, 0.0)]
}

#[test]
fn a_hinge_turns_its_pendulum_as_another_method_says() {
    let exact = [100.0, 200.0].map(exact);
    for coordinates in BOTH {
        for (system, sign) in [(pendulum(), 1.0), (reversed(), -1.0)] {
            let errors = [80, 160].map(|count| {
                let model = model(&system, coordinates, 1.0);
                let joints = model.system.joints.len();
                let by_joint = |value: f64| vec![value * sign; joints];
                let rates = match model.coordinate_count() {
                    1 => vec![2e-3 * sign],
                    _ => model
                        .rates_at(&by_joint(1.0), &by_joint(2e-3), &Default::default())
                        .unwrap(),
                };
                let start = Start::with_rates(&model, model.coordinates_at(&by_joint(1.0)), &rates);
                let discrete = motion(&model, &start, 200.0 / count as f64, count, &[]);
                let seen = observations(&model, &discrete);
                let found = ["hip_force", "hip_torque"].map(|name| columns(&seen, name));
                [count / 2, count].map(|k| {
                    let at = usize::from(k == count);
                    let error =
                        |i: usize| (found[i][k] * sign - exact[at][i]).norm() / exact[at][i].norm();
                    [error(0), error(1)]
                })
            });
            for (coarse, fine) in errors[0]
                .as_flattened()
                .iter()
                .zip(errors[1].as_flattened())
            {
                assert!(exact[0][0].norm() > 0.1 && exact[0][1].norm() > 1.0);
                let ratio = coarse / fine;
                assert!(
                    (3.5..4.7).contains(&ratio) && *fine < 2e-3,
                    "{coordinates:?} {sign}: {errors:?}"
                );
            }
        }
    }
}

fn of_rest(model: &Model) -> Observations {
    let found = stable_equilibrium(model, &model.reference_coordinates(), &[]).unwrap();
    let state = DiscreteTrajectory {
        times: vec![0.0],
        z: vec![found.z],
        momenta: vec![vec![0.0; model.coordinate_count()]],
        scalars: vec![found.scalars],
        ..DiscreteTrajectory::default()
    };
    observations(model, &state)
}

#[test]
fn joints_hold_the_weight_below_them() {
    let bodies = vec![
        bob("upper", -Vector3::y() * ARM),
        bob("lower", Vector3::new(0.0, -3.0 * ARM, ASIDE)),
    ];
    let joints = vec![
        hinge("hip", None, 0, Vector3::zeros()),
        hinge("knee", Some(0), 1, -Vector3::y() * 2.0 * ARM),
    ];
    for coordinates in BOTH {
        let model = model(
            &bare(bodies.clone(), joints.clone(), Some(GRAVITY)),
            coordinates,
            1.0,
        );
        let seen = of_rest(&model);
        for (name, count) in [("hip", 2.0), ("knee", 1.0)] {
            let force = columns(&seen, &format!("{name}_force"))[0];
            let torque = columns(&seen, &format!("{name}_torque"))[0];
            let weight = -GRAVITY * MASS;
            assert!((force - weight * count).norm() < 1e-9, "{name} {force}");
            // Of the lower body, whose centre lies aside.
            let lever = (Vector3::z() * ASIDE).cross(&weight);
            assert!(
                lever.norm() > 1.0 && (torque - lever).norm() < 1e-7,
                "{name} {torque}"
            );
        }
    }
}

#[test]
fn a_damped_motor_turns_through_its_joint() {
    let (torque, damping) = (2.0, 30.0);
    for coordinates in BOTH {
        let errors = [2.0, 1.0].map(|h| {
            let mut system = pendulum();
            system.gravity = None;
            system.joints[0].damping = Some(damping);
            let on = LoadPlace::Joint(0);
            system.components.loads = vec![Load {
                name: "motor".into(),
                on,
            }];
            let model = model(&system, coordinates, h);
            let start = Start::at_rest(&model, model.reference_coordinates());
            let count = (100.0 / h) as usize;
            let seen = observations(&model, &motion(&model, &start, h, count, &[torque]));
            let about = columns(&seen, "hip_torque");
            let rate = column(&seen, "hip_rate");
            assert!(damping * rate[count] > 0.05 * torque);
            let error = |k: usize| (about[k].z - (torque - damping * rate[k])).abs();
            (0..=count).map(error).fold(0.0_f64, f64::max)
        });
        assert!(
            errors[1] < 1e-4 && errors[0] / errors[1] > 3.0,
            "{coordinates:?}: {errors:?}"
        );
    }
}

/// Nothing holds two hinged bodies: the joint alone changes their momenta.
#[test]
fn a_joint_of_a_free_robot_changes_the_momenta_of_both_bodies() {
    let bodies = vec![
        bob("first", -Vector3::x() * ARM),
        bob("second", Vector3::x() * ARM),
    ];
    let joints = vec![hinge("elbow", Some(0), 1, Vector3::zeros())];
    let h = 1.0;
    for coordinates in BOTH {
        let mut system = bare(bodies.clone(), joints.clone(), None);
        system.components.loads = vec![Load {
            name: "motor".into(),
            on: LoadPlace::Joint(0),
        }];
        let model = model(&system, coordinates, h);
        let start = Start::at_rest(&model, model.reference_coordinates());
        let discrete = motion(&model, &start, h, 100, &[3.0]);
        let seen = observations(&model, &discrete);
        let force = columns(&seen, "elbow_force");
        let place =
            |k: usize| model.poses(&crate::common::placed(&model, &discrete.z[k]))[1].centre;
        for (k, force) in force.iter().enumerate().take(100).skip(1) {
            let change = (place(k + 1) - place(k) * 2.0 + place(k - 1)) * (MASS / (h * h));
            assert!((force - change).norm() < 1e-9, "{k}: {force} {change}");
        }
        assert!(force.iter().any(|f| f.norm() > 0.01));
    }
}
