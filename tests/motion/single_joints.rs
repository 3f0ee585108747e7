//! Joints alone: motions that are known in closed form.

use crate::closed_loop::frame;
use crate::common::{at_reference, bare, body, column, columns, joint, motion, richardson, spin};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{Start, observations};
use proboscis::model::system::{Attachment, JointKind, Marker, System};
use proboscis::model::{Coordinates, Model};

#[test]
fn a_conical_pendulum_circles_at_its_speed() {
    // A bob without spin inertia on a weightless rod of length l at angle β: ω² = g/(l cos β).
    let (length, beta, g) = (1.5, 0.6_f64, 9.81);
    let omega = (g / (length * beta.cos())).sqrt();
    let centre = Vector3::new(beta.sin(), 0.0, -beta.cos()) * length;
    let bob = body("bob", 1.0, [1e-12; 3], centre, frame(&centre));
    let ball = joint("ball", JointKind::Spherical, None, 0, Vector3::zeros());
    let scene = bare(vec![bob], vec![ball], Some(Vector3::new(0.0, 0.0, -g)));
    let time = 2.0;
    let [x, y]: [Vec<f64>; 2] = [0, 1].map(|axis| {
        let place = |n: usize| {
            let h = time / n as f64;
            let model = Model::new(scene.clone(), Some(Coordinates::Redundant), h, &[]).unwrap();
            let rates = spin(
                &model.reference[0],
                Vector3::z().cross(&centre) * omega,
                Vector3::z() * omega,
            );
            let start = Start::with_rates(&model, at_reference(&model), &rates);
            let discrete = motion(&model, &start, h, n, &[]);
            discrete.z[n][axis]
        };
        [100, 200, 400].map(place).to_vec()
    });
    let exact = [(omega * time).cos(), (omega * time).sin()].map(|c| c * length * beta.sin());
    println!("conical: {x:?} {y:?} against {exact:?}");
    for (places, exact) in [x, y].iter().zip(exact) {
        assert!((richardson(places) - exact).abs() < 1e-7);
    }
}

#[test]
fn a_slider_falls_on_a_parabola_without_error() {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let sledge = body(
        "sledge",
        5.0,
        [1.0, 2.0, 3.0],
        Vector3::new(2.0, 1.0, 0.0),
        Matrix3::identity(),
    );
    let rail = joint(
        "rail",
        JointKind::Prismatic { axis },
        None,
        0,
        Vector3::zeros(),
    );
    let mut scene = bare(
        vec![sledge],
        vec![rail],
        Some(Vector3::new(0.1, 0.2, -9.81e-3)),
    );
    scene.markers.push(Marker {
        name: "nose".into(),
        point: Attachment {
            body: Some(0),
            at: Vector3::new(3.0, 1.0, 0.0),
        },
        solid: None,
    });
    let h = 3.0;
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let model = Model::new(scene.clone(), Some(coordinates), h, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let discrete = motion(&model, &start, h, 100, &[]);
        let seen = observations(&model, &discrete);
        let acceleration = axis.dot(&Vector3::new(0.1, 0.2, -9.81e-3));
        let nose = columns(&seen, "nose");
        for (k, (y, t)) in column(&seen, "rail")
            .iter()
            .zip(&discrete.times)
            .enumerate()
        {
            let exact = 0.5 * acceleration * t * t;
            // Sums of k² terms of size h²: relative rounding grows like k.
            assert!(
                (y - exact).abs() <= 1e-13 * exact.abs() + 1e-14 * k as f64,
                "{y} against {exact}"
            );
            let place = Vector3::new(3.0, 1.0, 0.0) + axis * exact;
            assert!((nose[k] - place).amax() < 1e-12 * (1.0 + exact.abs()));
        }
        assert!(column(&seen, "rail")[100] > 1e3);
    }
}

#[test]
fn two_bodies_fixed_together_are_one() {
    let gravity = Some(Vector3::new(0.2, -9.81, 0.3));
    let pivot = |axis| {
        joint(
            "pivot",
            JointKind::Revolute { axis },
            None,
            0,
            Vector3::zeros(),
        )
    };
    let axis = Vector3::new(0.2, 0.1, 1.0).normalize();
    // Two bodies in line along x with parallel principal axes.
    let (m, n) = (2.0, 0.5);
    let (c, d) = (Vector3::new(0.5, 0.0, 0.0), Vector3::new(1.3, 0.0, 0.0));
    let (i, j) = ([0.1, 0.2, 0.25], [0.03, 0.04, 0.02]);
    let centre = (c * m + d * n) / (m + n);
    // Steiner: both lie on the x axis.
    let apart = m * n / (m + n) * (d - c).norm_squared();
    let merged = [i[0] + j[0], i[1] + j[1] + apart, i[2] + j[2] + apart];
    let identity = Matrix3::identity();
    // The directors of the second body are other axes of the same frame, and its inertias follow them.
    let axes = frame(&Vector3::x());
    let along_axes = [0, 1, 2].map(|k| j[axes.column(k).iamax()]);
    let one = bare(
        vec![body("one", m + n, merged, centre, identity)],
        vec![pivot(axis)],
        gravity,
    );
    let two = bare(
        vec![
            body("first", m, i, c, identity),
            body("second", n, along_axes, d, axes),
        ],
        vec![
            pivot(axis),
            joint(
                "weld",
                JointKind::Fixed,
                Some(0),
                1,
                Vector3::new(1.0, 0.0, 0.0),
            ),
        ],
        gravity,
    );
    let h = 0.01;
    let run = |scene: &System, coordinates| {
        let model = Model::new(scene.clone(), Some(coordinates), h, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let discrete = motion(&model, &start, h, 300, &[]);
        column(&observations(&model, &discrete), "pivot").to_vec()
    };
    let expected = run(&one, Coordinates::Reduced);
    assert!(expected.iter().any(|a| a.abs() > 1.0));
    for (scene, coordinates) in [
        (&one, Coordinates::Redundant),
        (&two, Coordinates::Reduced),
        (&two, Coordinates::Redundant),
    ] {
        let angles = run(scene, coordinates);
        let worst = angles
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        println!("{} bodies {coordinates:?}: {worst:e}", scene.bodies.len());
        assert!(worst < 1e-10, "{worst:e}");
    }
}
