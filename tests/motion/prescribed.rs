//! Prescribed motions of joints: against closed forms and another method, at rest, with the balance of energy, and as files say them.

use crate::common::{bare, body, column, joint, runge_kutta};
use crate::component_files::read;
use crate::maxwell::{BOTH, model};
use crate::parts;
use nalgebra::{Matrix3, Vector2, Vector3};
use proboscis::control::problem::BoundaryState;
use proboscis::control::resolve_start;
use proboscis::dynamics::{DiscreteTrajectory, Integrator, observations, stable_equilibrium};
use proboscis::math::Signal;
use proboscis::model::Model;
use proboscis::model::system::{Joint, JointKind, JointSpring, System};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// g, N/mm, mm, mm, 1/ms and mm/ms².
const MASS: f64 = 20.0;
const STIFFNESS: f64 = 0.02;
const ARM: f64 = 50.0;
const AMPLITUDE: f64 = 4.0;
const FREQUENCY: f64 = 0.008;
const GRAVITY: f64 = 9.81e-3;

fn shaking() -> Signal {
    Signal::Sine {
        mean: 1.0,
        amplitude: AMPLITUDE,
        frequency: FREQUENCY,
        phase: 0.3,
    }
}

fn part(name: &str, at: Vector3<f64>) -> proboscis::Body {
    body(name, MASS, [900.0, 500.0, 800.0], at, Matrix3::identity())
}

fn slide(name: &str, axis: Vector3<f64>, parent: Option<usize>, child: usize) -> Joint {
    let kind = JointKind::Prismatic { axis };
    joint(name, kind, parent, child, Vector3::zeros())
}

/// A cart on a spring that slides along a shaking base.
fn oscillator() -> System {
    let base = Joint {
        motion: Some(shaking()),
        ..slide("base", Vector3::x(), None, 0)
    };
    let cart = Joint {
        spring: Some(JointSpring {
            stiffness: STIFFNESS,
            rest: 0.0,
        }),
        ..slide("cart", Vector3::x(), Some(0), 1)
    };
    let parts = ["base", "cart"].map(|name| part(name, Vector3::zeros()));
    bare(parts.to_vec(), vec![base, cart], None)
}

/// A pendulum that hangs on a vertically shaking base.
fn pendulum() -> System {
    let base = Joint {
        motion: Some(shaking()),
        ..slide("base", Vector3::y(), None, 0)
    };
    let kind = JointKind::Revolute { axis: Vector3::z() };
    let hinge = joint("hinge", kind, Some(0), 1, Vector3::zeros());
    let parts = vec![
        part("base", Vector3::zeros()),
        part("bob", -Vector3::y() * ARM),
    ];
    bare(parts, vec![base, hinge], Some(-Vector3::y() * GRAVITY))
}

/// A motion whose other joints start at rest at these coordinates.
fn moved(
    model: &Model,
    angles: &[(usize, f64)],
    integrator: Integrator,
    (h, steps): (f64, usize),
) -> DiscreteTrajectory {
    let start = BoundaryState::JointAngles {
        angles: angles.iter().copied().collect(),
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    };
    let start = resolve_start(model, &start).unwrap();
    parts::moved(integrator, model, &start, h, steps, &[])
}

const METHODS: [(Integrator, f64, f64); 4] = [
    (Integrator::Midpoint, 2.0, 80.0),
    (Integrator::Galerkin { degree: 2 }, 4.0, 20.0),
    (
        Integrator::GeneralisedAlpha {
            spectral_radius: 0.7,
        },
        2.0,
        80.0,
    ),
    (Integrator::ImplicitEuler, 1.0, 320.0),
];

/// Errors of a joint at the end decrease with the order of each method, in both kinds of coordinates.
fn assert_orders(system: &System, angles: &[(usize, f64)], name: &str, duration: f64, exact: f64) {
    for coordinates in BOTH {
        for (integrator, order, coarse) in METHODS {
            let errors = [1.0, 2.0].map(|finer| {
                let h = duration / (coarse * finer);
                let model = model(system, coordinates, h);
                let steps = (coarse * finer) as usize;
                let discrete = moved(&model, angles, integrator, (h, steps));
                let seen = observations(&model, &discrete);
                for (k, value) in column(&seen, "base").iter().enumerate() {
                    let prescribed = shaking().at(k as f64 * h);
                    assert!((value - prescribed).abs() < 1e-12, "{k}: {value}");
                }
                column(&seen, name)[steps] - exact
            });
            let found = (errors[0] / errors[1]).log2();
            assert!(
                (found - order).abs() < 0.25,
                "{integrator:?} {coordinates:?}: {errors:?}, order {found}"
            );
        }
    }
}

#[test]
fn a_cart_on_a_shaking_base_moves_as_its_closed_form() {
    // y″ + ω₀² y = A ω² sin(ω t + φ) from rest at y = 0.
    let (omega, natural) = (TAU * FREQUENCY, (STIFFNESS / MASS).sqrt());
    let (duration, phase) = (200.0, 0.3_f64);
    let size = AMPLITUDE * omega * omega / (natural * natural - omega * omega);
    let (c, s) = (-size * phase.sin(), -size * omega * phase.cos() / natural);
    let exact = size * (omega * duration + phase).sin()
        + c * (natural * duration).cos()
        + s * (natural * duration).sin();
    assert!(exact.abs() > 1.0, "{exact}");
    assert_orders(&oscillator(), &[], "cart", duration, exact);
}

#[test]
fn a_pendulum_on_a_shaking_base_swings_as_by_another_method() {
    let inertia = 800.0 + MASS * ARM * ARM;
    let duration = 200.0;
    let rate = |y: &Vector3<f64>| {
        let [_, _, lift] = shaking().derivatives(y.z);
        let turn = -MASS * ARM * (GRAVITY + lift) * y.x.sin() / inertia;
        Vector3::new(y.y, turn, 1.0)
    };
    let steps = 20_000;
    let step = duration / f64::from(steps);
    let start = Vector3::new(0.7, 0.0, 0.0);
    let exact = (0..steps)
        .fold(start, |y, _| runge_kutta(&rate, &y, step))
        .x;
    assert!((exact - 0.7).abs() > 0.3, "{exact}");
    assert_orders(&pendulum(), &[(1, 0.7)], "hinge", duration, exact);
}

#[test]
fn the_force_of_a_prescribed_motion_supplies_the_energy() {
    let steps = 400;
    let h = 0.5;
    for coordinates in BOTH {
        for (system, axis) in [(oscillator(), "x"), (pendulum(), "y")] {
            let model = model(&system, coordinates, h);
            let discrete = moved(&model, &[(1, 0.4)], Integrator::Midpoint, (h, steps));
            let seen = observations(&model, &discrete);
            let force = column(&seen, &format!("base_force_{axis}"));
            let [rate, energy] = ["base_rate", "total_energy"].map(|name| column(&seen, name));
            let power: Vec<f64> = force.iter().zip(rate).map(|(f, v)| f * v).collect();
            let middle = 10..steps - 10;
            let sum: f64 = power[middle.clone()].iter().sum::<f64>()
                + 0.5 * (power[middle.end] - power[middle.start]);
            let gained = energy[middle.end] - energy[middle.start];
            assert!(gained.abs() > 0.05, "{gained}");
            let largest = power.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
            let error = (h * sum - gained).abs();
            assert!(
                error < 1e-3 * h * largest * steps as f64,
                "{error} {gained}"
            );
        }
    }
}

#[test]
fn at_rest_a_prescribed_joint_is_where_it_is_prescribed() {
    // A bent arm: gravity turns the spring of the elbow by the angle of its closed form.
    let kind = JointKind::Revolute { axis: Vector3::z() };
    let stiffness = 60.0;
    for coordinates in BOTH {
        for shoulder in [0.6_f64, -1.9] {
            let base = Joint {
                motion: Some(Signal::Constant(shoulder)),
                ..joint("shoulder", kind, None, 0, Vector3::zeros())
            };
            let elbow = Joint {
                spring: Some(JointSpring {
                    stiffness,
                    rest: 0.0,
                }),
                ..joint("elbow", kind, Some(0), 1, Vector3::zeros())
            };
            let parts = vec![
                part("upper", Vector3::zeros()),
                part("lower", -Vector3::y() * ARM),
            ];
            let system = bare(parts, vec![base, elbow], Some(-Vector3::y() * GRAVITY));
            let model = model(&system, coordinates, 1.0);
            let found = stable_equilibrium(&model, &model.reference_coordinates(), &[]).unwrap();
            assert_eq!(found.is_stable(), Some(true));
            let instant = model.action.map.placed(&found.z);
            let joints = model.joints(&instant, &[0.0; 2]);
            assert!((joints[0] - shoulder).abs() < 1e-14, "{joints:?}");
            let torque = MASS * GRAVITY * ARM * (joints[0] + joints[1]).sin();
            assert!(torque.abs() > 1.0, "{torque}");
            let error = stiffness * joints[1] + torque;
            assert!(error.abs() < 1e-9, "{error} {joints:?}");
        }
    }
}

const SCENE: &str = r#"{
  "name": "shaker",
  "bodies": [{ "name": "base", "mass": "10 g", "inertia": [1e-6, 1e-6, 1e-6], "position": [0, 0, 0] }],
  "joints": [{ "name": "table", KIND, "parent": "ground", "child": "base", "at": [0, 0, 0], "motion": MOTION }]
}"#;

fn scene(kind: &str, motion: &str) -> Result<System, String> {
    read(&SCENE.replace("KIND", kind).replace("MOTION", motion))
}

#[test]
fn files_prescribe_motions_in_the_units_of_their_joint() {
    let (slide, hinge) = (
        r#""prismatic": { "axis": [1, 0, 0] }"#,
        r#""revolute": { "axis": [0, 0, 1] }"#,
    );
    let of = |kind, motion| scene(kind, motion).unwrap().joints[0].motion.clone();
    let sine = r#"{ "sine": { "amplitude": "3 mm", "period": "0.5 s", "phase": "90 deg" } }"#;
    let Some(Signal::Sine {
        amplitude,
        frequency,
        phase,
        ..
    }) = of(slide, sine)
    else {
        panic!("it is a sine")
    };
    let found = Vector2::new(amplitude - 3.0, frequency - 0.002);
    assert!(found.norm() < 1e-15 && (phase - TAU / 4.0).abs() < 1e-15);
    let ramp = r#"{ "ramp": { "to": "45 deg", "duration": "1 s" } }"#;
    assert_eq!(of(hinge, ramp), Some(Signal::ramp(0.0, TAU / 8.0, 1000.0)));
    assert_eq!(of(hinge, "0.25"), Some(Signal::Constant(0.25)));
    for (kind, motion, words) in [
        (hinge, "\"3 mm\"", "an angle"),
        (slide, "\"3 deg\"", "a length"),
        (
            r#""spherical": {}"#,
            "0.1",
            "neither revolute nor prismatic",
        ),
        (slide, r#"{ "ramp": { "to": "3 mm" } }"#, "duration"),
        (slide, "{}", "one of"),
    ] {
        let error = scene(kind, motion).unwrap_err();
        assert!(error.contains("motion") && error.contains(words), "{error}");
    }
}

#[test]
fn kinetic_energy_at_instants_counts_the_prescribed_rate() {
    let steps = 200;
    let h = 1.0;
    for coordinates in BOTH {
        for integrator in [Integrator::Midpoint, Integrator::Galerkin { degree: 2 }] {
            let model = model(&oscillator(), coordinates, h);
            let discrete = moved(&model, &[], integrator, (h, steps));
            let seen = observations(&model, &discrete);
            let [cart, kinetic] = ["cart", "kinetic_energy"].map(|name| column(&seen, name));
            for k in [0, steps] {
                // One-sided differences of second order; the start is at rest on the base.
                let (a, b) = (cart[k.saturating_sub(1)], cart[k.saturating_sub(2)]);
                let along = if k == 0 {
                    0.0
                } else {
                    (1.5 * cart[k] - 2.0 * a + 0.5 * b) / h
                };
                let [_, base, _] = shaking().derivatives(k as f64 * h);
                let exact = 0.5 * MASS * (base * base + (base + along) * (base + along));
                assert!(exact > 0.1, "{exact}");
                let error = (kinetic[k] / exact - 1.0).abs();
                assert!(error < 5e-3, "{integrator:?} {coordinates:?} {k}: {error}");
            }
        }
    }
}
