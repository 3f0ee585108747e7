//! Springs of joints: against closed forms, in both kinds of coordinates, beyond half turns, and as files say them.

use crate::common::{at_reference, bare, motion};
use crate::component_files::read;
use crate::components::{body, column};
use nalgebra::Vector3;
use proboscis::dynamics::{Start, stable_equilibrium};
use proboscis::model::system::{Joint, JointKind, JointSpring, System};
use proboscis::model::{Coordinates, Model};
use std::f64::consts::TAU;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];
/// N mm/rad or N/mm.
const STIFFNESS: f64 = 0.9;

fn on(kind: JointKind, rest: f64, damping: Option<f64>) -> System {
    let joint = Joint {
        name: "joint".into(),
        kind,
        child: 0,
        damping,
        spring: Some(JointSpring {
            stiffness: STIFFNESS,
            rest,
        }),
        ..Joint::default()
    };
    // The centre of mass is 20 mm from a hinge about z.
    bare(vec![body("mass", 20.0)], vec![joint], None)
}

/// Moment of inertia about z at the joint: 600 + 10 · 20², g mm².
const INERTIA: f64 = 4600.0;

#[test]
fn a_hinge_swings_about_a_rest_angle_of_several_turns_as_its_closed_form() {
    let hinge = JointKind::Revolute { axis: Vector3::z() };
    let slide = JointKind::Prismatic { axis: Vector3::x() };
    for (kind, rest, mass, h) in [(hinge, 11.0, INERTIA, 1.0), (slide, 7.0, 10.0, 0.05)] {
        for damping in [None, Some(0.05 * (STIFFNESS * mass).sqrt())] {
            let delta = 0.5 * damping.unwrap_or(0.0) / mass;
            let omega = (STIFFNESS / mass - delta * delta).sqrt();
            let exact = |t: f64| {
                let wave = (omega * t).cos() + delta / omega * (omega * t).sin();
                rest - rest * (-delta * t).exp() * wave
            };
            for coordinates in BOTH {
                let errors = [h, h / 2.0].map(|h| {
                    let steps = (1.2 * TAU / omega / h).round() as usize;
                    let model =
                        Model::new(on(kind, rest, damping), Some(coordinates), h, &[]).unwrap();
                    let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
                    let discrete = motion(&model, &start, h, steps, &[]);
                    let found = column(&model, &discrete, "joint");
                    let far = found.iter().copied().fold(0.0, f64::max);
                    assert!(
                        far > 1.8 * rest,
                        "it swings to {far}, not to {}",
                        2.0 * rest
                    );
                    let total = column(&model, &discrete, "total_energy");
                    let stored = 0.5 * STIFFNESS * rest * rest;
                    assert!((total[0] / stored - 1.0).abs() < 1e-12, "{}", total[0]);
                    let at = |k: usize| (found[k] - exact(k as f64 * h)).abs();
                    (0..=steps).map(at).fold(0.0, f64::max)
                });
                assert!(errors[0] < 0.02 * rest, "{errors:?}");
                let ratio = errors[0] / errors[1];
                assert!((3.7..4.3).contains(&ratio), "{coordinates:?}: {errors:?}");
            }
        }
    }
}

#[test]
fn weight_and_a_spring_of_a_hinge_balance_in_both_coordinates() {
    let rest = 2.5 * TAU;
    let mut system = on(JointKind::Revolute { axis: Vector3::z() }, rest, None);
    let g = 2e-4;
    system.gravity = Some(-Vector3::y() * g);
    // k (θ − θ₀) + m g l cos θ = 0 by bisection, from one side to the other of θ₀.
    let moment = |theta: f64| STIFFNESS * (theta - rest) + 10.0 * g * 20.0 * theta.cos();
    let (mut low, mut high) = (rest - 0.5, rest + 0.5);
    assert!(moment(low) < 0.0 && moment(high) > 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if moment(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    assert!((low - rest).abs() > 0.01, "the weight does nothing: {low}");
    for coordinates in BOTH {
        let model = Model::new(system.clone(), Some(coordinates), 1.0, &[]).unwrap();
        let found = stable_equilibrium(&model, &model.coordinates_at(&[0.0]), &[]).unwrap();
        let instant = crate::common::placed(&model, &found.z);
        let angle = model.joints(&instant, &[0.0])[0];
        assert!(
            (angle - low).abs() < 1e-9,
            "{coordinates:?}: {angle}, not {low}"
        );
    }
}

/// Masses in a row on equal sliders: of one ω² = k/m, of two (3 − √5)/2 k/m.
#[test]
fn the_slowest_vibration_has_the_period_of_its_closed_form() {
    let slide = JointKind::Prismatic { axis: Vector3::x() };
    let one = on(slide, 0.0, Some(0.01));
    let mut two = one.clone();
    two.bodies.push(body("second", 40.0));
    two.joints.push(Joint {
        name: "second".into(),
        parent: Some(0),
        child: 1,
        ..one.joints[0].clone()
    });
    for (system, part) in [(one, 1.0), (two, 0.5 * (3.0 - 5.0_f64.sqrt()))] {
        let exact = TAU / (part * STIFFNESS / 10.0).sqrt();
        for coordinates in BOTH {
            let model = Model::new(system.clone(), Some(coordinates), 1.0, &[]).unwrap();
            let rest = stable_equilibrium(&model, &at_reference(&model), &[]).unwrap();
            let period = rest.slowest_period(&model).unwrap();
            // The iteration ends where ω² changes by 1e-6.
            assert!(
                (period - exact).abs() < 1e-5 * exact,
                "{coordinates:?}: {period} ms, not {exact}"
            );
        }
    }
}

#[test]
fn a_joint_without_a_spring_has_no_unknown_and_no_term_of_one() {
    let hinge = JointKind::Revolute { axis: Vector3::z() };
    let with = on(hinge, 0.3, None);
    let mut without = with.clone();
    without.joints[0].spring = None;
    without.gravity = Some(Vector3::y());
    for (coordinates, more) in [(Coordinates::Reduced, 0), (Coordinates::Redundant, 1)] {
        let of = |system: &System| Model::new(system.clone(), Some(coordinates), 1.0, &[]).unwrap();
        let (with, without) = (of(&with), of(&without));
        let [a, b] = [&with, &without].map(|m| m.coordinate_count());
        assert_eq!(a, b + more);
        let [a, b] = [&with, &without].map(|m| m.action.map.multipliers);
        assert_eq!(a, b + more);
        let names = |model: &Model, term: &str| model.present.iter().any(|p| p.term == term);
        assert!(names(&with, "joint elasticity") && !names(&without, "joint elasticity"));
        assert_eq!(names(&with, "joint coordinates"), more == 1);
        assert!(!names(&without, "joint coordinates"));
    }
}

const SCENE: &str = r#"{
  "name": "hinge",
  "bodies": [{ "name": "arm", "mass": "10 g", "inertia": [1e-6, 1e-6, 1e-6], "position": ["20 mm", 0, 0] }],
  "joints": [{ "name": "elbow", KIND: { "axis": [0, 0, 1] }, "parent": "ground", "child": "arm",
               "at": [0, 0, 0], SPRING }]
}"#;

fn scene(kind: &str, spring: &str) -> Result<System, String> {
    read(&SCENE.replace("KIND", kind).replace("SPRING", spring))
}

#[test]
fn files_give_stiffness_and_rest_in_their_units() {
    let spring = |kind, spring| scene(kind, spring).unwrap().joints[0].spring;
    let found = spring(
        "\"revolute\"",
        r#""stiffness": "0.2 N m/rad", "rest_angle": "10 deg""#,
    );
    let found = found.expect("a spring");
    assert!((found.stiffness - 200.0).abs() < 1e-12);
    assert!((found.rest - 10.0_f64.to_radians()).abs() < 1e-15);
    let found = spring(
        "\"prismatic\"",
        r#""stiffness": "30 N/m", "rest_displacement": "4 mm""#,
    );
    assert_eq!(
        found,
        Some(JointSpring {
            stiffness: 0.03,
            rest: 4.0
        })
    );
    assert_eq!(spring("\"revolute\"", r#""stiffness": 0"#), None);
    for (kind, spring, words) in [
        ("\"revolute\"", r#""stiffness": "3 N/m""#, "stiffness"),
        (
            "\"revolute\"",
            r#""stiffness": "-3 N m/rad""#,
            "zero or a positive",
        ),
        (
            "\"revolute\"",
            r#""rest_angle": "3 deg""#,
            "a revolute joint with",
        ),
        (
            "\"revolute\"",
            r#""stiffness": "1 N m/rad", "rest_displacement": "3 mm""#,
            "a prismatic joint with",
        ),
    ] {
        let refused = scene(kind, spring).expect_err(spring);
        assert!(refused.contains(words), "{refused}");
    }
}
