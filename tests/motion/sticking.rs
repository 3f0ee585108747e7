//! Friction that sticks: rest below its limit, sliding and rolling against closed forms, and stick-slip against Coulomb's law integrated
//! from event to event.

use crate::common::{at_reference, column, motion, with_velocities};
use crate::contact::{BOTH, GRAVITY, MASS, RADIUS, acceleration, incline, model, way};
use nalgebra::Vector3;
use proboscis::dynamics::{Start, observations, simulate};
use proboscis::model::{Coordinates, Model};
use proboscis::prelude::*;
use std::ops::ControlFlow;

const FRICTION: f64 = 0.4;

/// A ball or a point on an incline, where it sticks up to an elastic displacement in mm.
fn sticking(alpha: f64, radius: f64, stick: f64) -> crate::contact::Incline {
    let mut of = incline(alpha, radius, FRICTION);
    of.system.components.contacts[0].stick = Some(stick);
    of
}

/// A start at rest with the elastic displacement that holds a part of the limit, along the one that a short motion takes.
fn held(of: &Model, part: f64) -> Start {
    let free = Start::at_rest(of, at_reference(of));
    let begun = motion(of, &free, 0.01, 10, &[]);
    let memory: Vec<usize> = of.memory().collect();
    let along: Vec<f64> = memory.iter().map(|&i| begun.z[10][i]).collect();
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut z = at_reference(of);
    for (&i, x) in memory.iter().zip(along) {
        z[i] = part * x / length;
    }
    Start::at_rest(of, z)
}

#[test]
fn what_sticks_does_not_creep() {
    let (part, stick) = (0.8, 0.01);
    let alpha = (part * FRICTION).atan();
    let of = sticking(alpha, 0.0, stick);
    let model = model(&of.system, Coordinates::Reduced, 2.0);
    // Held, for 100 s.
    let discrete = motion(&model, &held(&model, part), 50.0, 2000, &[]);
    let from = way(&model, &discrete, 0, &of.down);
    let farthest = (0..discrete.z.len())
        .map(|k| (way(&model, &discrete, k, &of.down) - from).abs())
        .fold(0.0, f64::max);
    println!("held: {farthest:e}");
    assert!(farthest < 1e-9, "{farthest:e}");
    let observed = observations(&model, &discrete);
    let friction = column(&observed, "contact1_friction")[1000];
    let load = MASS * GRAVITY * alpha.sin();
    assert!((friction - load).abs() < 1e-9 * load, "{friction} {load}");
    // Let go without a displacement it swings about the held one, slips as long as it swings beyond nine tenths of the limit, and no more.
    let start = Start::at_rest(&model, at_reference(&model));
    let discrete = motion(&model, &start, 2.0, 6000, &[]);
    let farthest = |steps: std::ops::Range<usize>| {
        let ways = steps.map(|k| way(&model, &discrete, k, &of.down));
        ways.fold(f64::NEG_INFINITY, f64::max)
    };
    let [early, late] = [2000..3000, 5000..6000].map(farthest);
    println!("let go: {:e}, creep {:e}", early - from, late - early);
    assert!(early - from < 3.0 * stick, "{early} {from}");
    // Friction without a displacement would creep by 0.8 mm in this time.
    assert!((late - early).abs() < 1e-5, "{early} {late}");
}

#[test]
fn what_slides_has_the_friction_of_its_normal_force() {
    let alpha = (1.5 * FRICTION).atan();
    for radius in [0.0, 1e-3] {
        let of = sticking(alpha, radius, 0.001);
        let model = model(&of.system, Coordinates::Reduced, 0.1);
        let velocity = [of.down * 0.2, Vector3::zeros()];
        let start = with_velocities(&model, held(&model, 1.0).z, &[velocity]);
        let found = acceleration(&of, &start, &model, 0.1, 100.0);
        let exact = GRAVITY * (alpha.sin() - FRICTION * alpha.cos());
        println!("sliding: {:e}", found / exact - 1.0);
        assert!((found - exact).abs() < 1e-6 * exact, "{found} {exact}");
    }
}

#[test]
fn what_rolls_sticks() {
    let alpha = 10.0_f64.to_radians();
    // The friction of rolling is 2/7 m g sin α.
    let part = 2.0 / 7.0 * alpha.tan() / FRICTION;
    for coordinates in BOTH {
        let of = sticking(alpha, RADIUS, 0.001);
        let model = model(&of.system, coordinates, 0.1);
        let found = acceleration(&of, &held(&model, part), &model, 0.1, 100.0);
        let exact = 5.0 / 7.0 * GRAVITY * alpha.sin();
        println!("rolling: {:e}", found / exact - 1.0);
        assert!((found - exact).abs() < 1e-6 * exact, "{found} {exact}");
    }
}

/// Amplitude in mm and angular frequency in rad/ms of a table.
const SHAKE: [f64; 2] = [1.6, 0.0628];

/// Place of a block on a table at `A sin(ωt)` after a time in ms under Coulomb's law: it moves with the table while its acceleration is within
/// the limit, and slides with a constant one between events.
fn slid(limit: f64, end: f64) -> f64 {
    let [amplitude, omega] = SHAKE;
    let speed = |t: f64| amplitude * omega * (omega * t).cos();
    let place = |t: f64| amplitude * (omega * t).sin();
    let acceleration = |t: f64| -amplitude * omega * omega * (omega * t).sin();
    let step = 1e-3;
    // The place of an event, to the last bits.
    let event = |is_past: &dyn Fn(f64) -> bool, from: f64| {
        let mut low = from;
        while !is_past(low + step) {
            low += step;
            if low > end {
                return end;
            }
        }
        let mut high = low + step;
        while high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            match is_past(middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        high.min(end)
    };
    // It rests at first, while the table is fastest.
    let (mut t, mut x, mut v) = (0.0, 0.0, 0.0);
    let mut slides = true;
    while t < end {
        let next;
        if slides {
            let ahead = v > speed(t) || (v == speed(t) && acceleration(t) < 0.0);
            let pull = if ahead { -limit } else { limit };
            let sign = if ahead { 1.0 } else { -1.0 };
            next = event(&|s| sign * (v + pull * (s - t) - speed(s)) < 0.0, t);
            x += v * (next - t) + 0.5 * pull * (next - t).powi(2);
            v = speed(next);
            slides = acceleration(next).abs() > limit;
            if next == end {
                return x;
            }
        } else {
            next = event(&|s| acceleration(s).abs() > limit, t);
            x += place(next) - place(t);
            v = speed(next);
            slides = true;
        }
        t = next;
    }
    x
}

#[test]
fn a_block_on_a_shaken_table_sticks_and_slips() {
    let end = 150.0;
    let exact = slid(FRICTION * GRAVITY, end);
    let [amplitude, omega] = SHAKE;
    let errors = [1e-2, 1e-3, 1e-4].map(|stick| {
        let mut system = System::new("table");
        system.gravity = Some(-Y * GRAVITY);
        let table = system.add(Body::cuboid([80.0, 10.0, 80.0]).mass(30.0).at(-Y * 5.0));
        let shake = Signal::Sine {
            mean: 0.0,
            amplitude,
            frequency: omega / std::f64::consts::TAU,
            phase: 0.0,
        };
        system.add(Joint::prismatic(X).between(GROUND, table).motion(shake));
        let sunk = -Y * (MASS * GRAVITY / 10.0);
        let block = system.add(Body::sphere(RADIUS).mass(MASS).at(sunk));
        system.add(Joint::planar(Z).between(GROUND, block));
        let contact = Contact::on_plane((block, sunk, 0.0), (table, Vector3::zeros(), Y));
        system.add(contact.stiffness(10.0).friction(FRICTION).stick(stick));
        let h = 0.02;
        let model = model(&system, Coordinates::Reduced, h);
        let start = Start::at_rest(&model, at_reference(&model));
        // Where it begins to slip at once, steps are halved.
        let go_on = |_: &_| ControlFlow::Continue(());
        let steps = (end / h) as usize;
        let (discrete, failure) = simulate(&model, &start, h, steps, |_, _| Vec::new(), go_on);
        assert_eq!(failure, None);
        let last = crate::common::placed(&model, discrete.z.last().unwrap());
        let found = model.poses(&last)[1].centre.x;
        found - exact
    });
    println!("stick-slip to {exact}: {errors:?}");
    // Where it begins to stick it swings with velocities up to √(μ g z), which nothing damps: an error of order ½.
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((2.4..4.2).contains(&ratio), "{errors:?}");
    }
    assert!(errors[2].abs() < 0.05, "{errors:?}");
}
