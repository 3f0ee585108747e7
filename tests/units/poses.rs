//! Poses on the way from one to another.

use nalgebra::{Rotation3, Vector3};
use proboscis::Pose;

fn pose(turn: Vector3<f64>) -> Pose {
    Pose {
        centre: turn * 10.0,
        directors: Rotation3::from_scaled_axis(turn).into_inner(),
    }
}

#[test]
fn a_turn_about_an_axis_is_in_proportion() {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    for angle in [0.4, 1.7, 3.0] {
        let found = pose(axis * 0.2).towards(&pose(axis * (0.2 + angle)), 0.3);
        let expected = pose(axis * (0.2 + 0.3 * angle));
        assert!((found.directors - expected.directors).norm() < 1e-14);
        assert!((found.centre - expected.centre).norm() < 1e-14);
    }
}

#[test]
fn a_pose_between_two_that_hardly_differ_is_theirs() {
    for i in 0..2000 {
        let [a, b, c] = [1.0, 2.0, 3.0].map(|factor| (f64::from(i) * factor).sin());
        let turn = Vector3::new(a, b, c);
        let [from, to] = [turn, turn * (1.0 + 1e-12)].map(pose);
        for part in [0.0, 0.3, 1.0] {
            let error = (from.towards(&to, part).directors - from.directors).norm();
            assert!(error < 1e-11, "{error} at {turn:?}");
        }
    }
}
