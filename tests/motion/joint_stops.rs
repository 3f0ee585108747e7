//! Stops of joints: against closed forms, in both kinds of coordinates, and as files say them.

use crate::common::{bare, motion};
use crate::component_files::read;
use crate::components::{body, column};
use nalgebra::Vector3;
use proboscis::dynamics::{Start, stable_equilibrium};
use proboscis::model::system::{Joint, JointKind, JointSpring, JointStops, System};
use proboscis::model::{Coordinates, Model};
use std::f64::consts::PI;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];
/// N/mm.
const STIFFNESS: f64 = 0.9;

/// 10 g on a slide along x with stops.
fn slide(at: [f64; 2], smoothing: f64) -> System {
    let joint = Joint {
        name: "joint".into(),
        kind: JointKind::Prismatic { axis: Vector3::x() },
        child: 0,
        stops: Some(JointStops {
            at,
            stiffness: STIFFNESS,
            smoothing,
        }),
        ..Joint::default()
    };
    bare(vec![body("mass", 20.0)], vec![joint], None)
}

#[test]
fn a_mass_bounces_off_a_stop_as_its_closed_form() {
    // 10 g at 0.5 mm/ms meet the stop after 4 ms, and come back at the same speed half a period later.
    let (speed, gap) = (0.5, 2.0);
    let omega = (STIFFNESS / 10.0_f64).sqrt();
    let contact = PI / omega;
    let h = contact / 400.0;
    for coordinates in BOTH {
        for (sign, at) in [(1.0, [-90.0, gap]), (-1.0, [-gap, f64::INFINITY])] {
            let model = Model::new(slide(at, 0.0), Some(coordinates), h, &[]).unwrap();
            let [here, ahead] = [0.0, sign * speed].map(|x| model.coordinates_at(&[x]));
            let rates = ahead.iter().zip(&here).map(|(b, a)| b - a);
            let rates: Vec<f64> = rates.take(model.coordinate_count()).collect();
            let start = Start::with_rates(&model, here, &rates);
            let steps = ((2.0 * gap / speed + contact) / h).round() as usize;
            let discrete = motion(&model, &start, h, steps, &[]);
            let found = column(&model, &discrete, "joint");
            let exact = |t: f64| match t - gap / speed {
                t if t < 0.0 => speed * t + gap,
                t if t < contact => gap + speed / omega * (omega * t).sin(),
                t => gap - speed * (t - contact),
            };
            let far = found.iter().map(|x| sign * x).fold(0.0, f64::max);
            assert!((far - gap - speed / omega).abs() < 1e-3, "{far}");
            for (k, x) in found.iter().enumerate() {
                let exact = exact(k as f64 * h);
                assert!((sign * x - exact).abs() < 2e-3, "{k}: {x} {exact}");
            }
        }
    }
}

#[test]
fn weight_rests_on_a_stop_at_its_closed_form_with_and_without_a_width() {
    // 10 g under 0.02 mm/ms²: 0.2 N press 0.2222 mm in; the width is left behind.
    for smoothing in [0.0, 0.3] {
        for coordinates in BOTH {
            let mut system = slide([f64::NEG_INFINITY, 3.0], smoothing);
            system.gravity = Some(0.02 * Vector3::x());
            let model = Model::new(system, Some(coordinates), 1.0, &[]).unwrap();
            let found = stable_equilibrium(&model, &model.coordinates_at(&[0.0]), &[]).unwrap();
            let instant = crate::common::placed(&model, &found.z);
            let at = model.joints(&instant, &[0.0])[0];
            assert!((at - 3.0 - 0.2 / STIFFNESS).abs() < 1e-9, "{at}");
            assert_eq!(found.unstable, Some(0));
        }
    }
}

#[test]
fn a_spring_presses_a_joint_out_of_the_reference_into_its_stop() {
    // Nothing else moves it: 0.1 (x − 5) + 0.9 (x − 2) = 0.
    let mut system = slide([-1.0, 2.0], 0.0);
    let (stiffness, rest) = (0.1, 5.0);
    system.joints[0].spring = Some(JointSpring { stiffness, rest });
    for coordinates in BOTH {
        let model = Model::new(system.clone(), Some(coordinates), 1.0, &[]).unwrap();
        let found = stable_equilibrium(&model, &model.coordinates_at(&[0.0]), &[]).unwrap();
        let at = model.joints(&crate::common::placed(&model, &found.z), &[0.0])[0];
        assert!((at - 2.3).abs() < 1e-9, "{at}");
    }
    // The reference lies beyond the stop, which moves the joint alone.
    let model = Model::new(slide([0.5, 2.0], 0.0), None, 1.0, &[]).unwrap();
    assert_eq!(model.coordinate_count(), 1);
}

#[test]
fn a_joint_without_stops_has_no_term_of_them() {
    let with = slide([-1.0, 1.0], 0.1);
    let mut without = with.clone();
    without.joints[0].stops = None;
    let of = |system: &System| {
        let mut system = system.clone();
        system.gravity = Some(Vector3::y() + Vector3::x());
        Model::new(system, None, 1.0, &[]).unwrap()
    };
    let (with, without) = (of(&with), of(&without));
    let names = |model: &Model| model.present.iter().any(|p| p.term == "joint stops");
    assert!(names(&with) && !names(&without));
    // Nothing reads the coordinate as a vector either.
    let vectors = |model: &Model| model.action.map.vectors.len();
    assert_eq!(vectors(&with), vectors(&without) + 1);
}

const SCENE: &str = r#"{
  "name": "hinge",
  "bodies": [{ "name": "arm", "mass": "10 g", "inertia": [1e-6, 1e-6, 1e-6], "position": ["20 mm", 0, 0] }],
  "joints": [{ "name": "elbow", KIND: { "axis": [0, 0, 1] }, "parent": "ground", "child": "arm",
               "at": [0, 0, 0], "stops": STOPS }]
}"#;

fn scene(kind: &str, stops: &str) -> Result<System, String> {
    read(&SCENE.replace("KIND", kind).replace("STOPS", stops))
}

#[test]
fn files_give_stops_in_the_units_of_their_joint() {
    let stops = |kind, stops| scene(kind, stops).unwrap().joints[0].stops.unwrap();
    let found = stops(
        "\"revolute\"",
        r#"{ "min": "-30 deg", "max": "90 deg", "stiffness": "2 N m/rad", "smoothing": "1 deg" }"#,
    );
    assert!((found.stiffness - 2000.0).abs() < 1e-9);
    assert!((found.at[0] + PI / 6.0).abs() < 1e-15 && (found.at[1] - PI / 2.0).abs() < 1e-15);
    assert!((found.smoothing - PI / 180.0).abs() < 1e-15);
    let found = stops(
        "\"prismatic\"",
        r#"{ "max": "4 mm", "stiffness": "30 N/m" }"#,
    );
    assert_eq!(found.at, [f64::NEG_INFINITY, 4.0]);
    for (kind, stops, words) in [
        (
            "\"revolute\"",
            r#"{ "stiffness": "2 N m/rad" }"#,
            "neither \"min\" nor \"max\"",
        ),
        (
            "\"revolute\"",
            r#"{ "min": "4 mm", "stiffness": "2 N m/rad" }"#,
            "stops.min",
        ),
        (
            "\"revolute\"",
            r#"{ "min": "4 deg", "max": "3 deg", "stiffness": "2 N m/rad" }"#,
            "more than \"min\"",
        ),
        (
            "\"revolute\"",
            r#"{ "min": "4 deg", "stiffness": "2 N/m" }"#,
            "stops.stiffness",
        ),
        (
            "\"revolute\"",
            r#"{ "min": "4 deg", "stiffness": "2 N m/rad", "smoothing": "-1 deg" }"#,
            "positive width",
        ),
    ] {
        let refused = scene(kind, stops).expect_err(stops);
        assert!(refused.contains(words), "{refused}");
    }
}
