//! Springs, tendons and other components as lines between their points.

use crate::dynamics::trajectory::Trajectory;
use crate::model::Component;
use crate::model::system::System;
use nalgebra::Vector3;

/// Turns of a spring.
const TURNS: usize = 8;
/// Points of a turn.
const PER_TURN: usize = 14;
/// Radius of a spring, as a part of its length in the reference configuration.
const RADIUS: f64 = 0.06;
/// Straight ends of a spring, as parts of its length.
const END: f64 = 0.12;

/// The line of each component at an instant, in mm.
pub(super) fn lines(system: &System, trajectory: &Trajectory, k: usize) -> Vec<Vec<Vector3<f64>>> {
    let line = |component: &dyn Component| {
        let points = component.points();
        let at = points.iter().map(|p| trajectory.point(k, p, system));
        let at: Vec<_> = at.collect();
        match at[..] {
            [from, to] if component.is_coiled() => {
                coil(&from, &to, RADIUS * (points[1].at - points[0].at).norm())
            }
            _ => at,
        }
    };
    system.components.iter().map(line).collect()
}

/// A helix between two points, with straight ends.
fn coil(from: &Vector3<f64>, to: &Vector3<f64>, radius: f64) -> Vec<Vector3<f64>> {
    let span = to - from;
    let least = span.iamin();
    let Some(across) = span.cross(&Vector3::ith(least, 1.0)).try_normalize(0.0) else {
        return vec![*from, *to];
    };
    let other = span.normalize().cross(&across);
    let count = TURNS * PER_TURN;
    let turn = |i: usize| {
        let s = i as f64 / count as f64;
        let angle = std::f64::consts::TAU * TURNS as f64 * s;
        // The radius grows from the axis and goes back to it within half a turn.
        let grown = (2.0 * TURNS as f64 * s.min(1.0 - s)).min(1.0);
        let out = across * angle.cos() + other * angle.sin();
        from + span * (END + (1.0 - 2.0 * END) * s) + out * (radius * grown)
    };
    let turns = (0..=count).map(turn);
    [*from].into_iter().chain(turns).chain([*to]).collect()
}
