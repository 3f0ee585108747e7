//! Rows of four-bar linkages through their singular positions (IFToMM A02), against the one equation that they obey.

use crate::closed_loop::{AXIAL, bar};
use crate::common::{at_reference, bare, motion, richardson, spin};
use crate::redundant_loops::{hinge, holds, in_directors, left_out};
use nalgebra::Vector3;
use proboscis::dynamics::Start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::Model;
use proboscis::model::system::System;

/// N bars upright, N + 1 of them on the ground, and N across (IFToMM A02), with bars of 1 m and 1 kg.
fn four_bars(n: usize) -> System {
    let at = |x: usize, y: f64| Vector3::new(x as f64, y, 0.0);
    let z = Vector3::z();
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for i in 0..=n {
        bodies.push(bar(&format!("up{i}"), 1.0, AXIAL, at(i, 0.0), at(i, 1.0)));
        joints.push(hinge(&format!("foot{i}"), z, None, i, at(i, 0.0)));
    }
    for i in 0..n {
        let across = n + 1 + i;
        bodies.push(bar(
            &format!("across{i}"),
            1.0,
            AXIAL,
            at(i, 1.0),
            at(i + 1, 1.0),
        ));
        joints.push(hinge(&format!("left{i}"), z, Some(i), across, at(i, 1.0)));
        joints.push(hinge(
            &format!("right{i}"),
            z,
            Some(i + 1),
            across,
            at(i + 1, 1.0),
        ));
    }
    bare(bodies, joints, Some(Vector3::new(0.0, -9.81, 0.0)))
}

/// The bars with a speed of 1 m/s at their tops.
fn pushed(linkage: &Model, n: usize) -> Start {
    let mut rates = Vec::new();
    for (b, pose) in linkage.reference.iter().enumerate() {
        let turn = Vector3::z() * -1.0;
        let (velocity, turn) = match b <= n {
            true => (turn.cross(&Vector3::new(0.0, 0.5, 0.0)), turn),
            false => (turn.cross(&Vector3::y()), Vector3::zeros()),
        };
        rates.extend(spin(pose, velocity, turn));
    }
    Start::with_rates(linkage, at_reference(linkage), &rates)
}

/// θ after a time by the Runge-Kutta method, θ̈ = [((N+1)/2 + N)/((N+1)/3 + N)] g sin θ, θ(0) = 0, θ̇(0) = 1.
fn turned(n: usize, time: f64) -> f64 {
    let n = n as f64;
    let pull = ((n + 1.0) / 2.0 + n) / ((n + 1.0) / 3.0 + n) * 9.81;
    let steps = 20_000;
    let h = time / f64::from(steps);
    let rate = |[angle, speed]: [f64; 2]| [speed, pull * angle.sin()];
    let on = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    let mut y = [0.0, 1.0];
    for _ in 0..steps {
        let a = rate(y);
        let b = rate(on(y, a, h / 2.0));
        let c = rate(on(y, b, h / 2.0));
        let d = rate(on(y, c, h));
        let mean = [0, 1].map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0);
        y = on(y, mean, h);
    }
    y[0]
}

#[test]
fn forty_four_bars_pass_their_singular_positions_in_steps_of_10_ms() {
    let linkage = in_directors(four_bars(40));
    let start = pushed(&linkage, 40);
    let discrete = motion(&linkage, &start, 0.01, 300, &[]);
    holds(&linkage, &discrete);
    let motion = Trajectory::from_discrete(&linkage, &discrete);
    let apart = motion.poses.iter().map(|poses| {
        let first = poses[0].directors.column(2).into_owned();
        let others = poses[1..=40].iter();
        let far = others.map(|pose| (pose.directors.column(2) - first).norm());
        far.fold(0.0, f64::max)
    });
    let apart = apart.fold(0.0, f64::max);
    for (steps, bound) in [(50, 1e-3), (100, 4e-3), (300, 1e-2)] {
        let angle = turned(40, 0.01 * steps as f64);
        let up = motion.poses[steps][0].directors.column(2).into_owned();
        let error = (up - Vector3::new(-angle.sin(), angle.cos(), 0.0)).norm();
        let other = (up - Vector3::new(angle.sin(), angle.cos(), 0.0)).norm();
        println!(
            "{steps} steps: turned by {angle}, off by {error:e} or {other:e}, apart {apart:e}"
        );
        assert!(error.min(other) < bound, "{error:e} {other:e}");
    }
    assert!(turned(40, 1.0) > 1.6 && apart < 1e-9, "{apart:e}");
}

#[test]
fn a_row_of_four_bars_passes_its_singular_positions() {
    // θ̈ = [((N+1)/2 + N)/((N+1)/3 + N)] g sin θ, θ(0) = 0, θ̇(0) = 1; top of the first bar at 1 s for N = 2.
    let exact = [-0.1950203019, -0.9807992057];
    let linkage = in_directors(four_bars(2));
    assert_eq!(left_out(&linkage).len(), 6);
    assert_eq!(linkage.loops.mobility, Some(1));
    let start = pushed(&linkage, 2);
    let tops = [500, 1000, 2000].map(|steps| {
        let discrete = motion(&linkage, &start, 1.0 / steps as f64, steps, &[]);
        holds(&linkage, &discrete);
        let pose = Trajectory::from_discrete(&linkage, &discrete).poses[steps][0];
        let top = pose.centre + pose.directors.column(2) * 0.5;
        [top.x, top.y]
    });
    for i in 0..2 {
        let errors = tops.map(|top| (top[i] - exact[i]).abs());
        let limit = richardson(&tops.map(|top| top[i]));
        println!(
            "top of N = 2 at 1 s: {errors:?}, limit {:e}",
            (limit - exact[i]).abs()
        );
        assert!(errors[0] > 1e-7 && ((errors[1] / errors[2]).log2() - 2.0).abs() < 0.1);
        assert!((limit - exact[i]).abs() < 1e-9);
    }
}
