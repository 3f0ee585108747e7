//! Optimal voltages put to the test: simulated forward from the start alone, then held at the goal's.

use std::ops::ControlFlow;

use serde::Serialize;

use crate::control::{Boundary, Solved};
use crate::dynamics::{History, StepError, simulate};
use crate::model::Model;
use crate::model::system::JointKind;
use crate::run::motion::solved;

/// Durations of the motion for which the goal is held.
const HELD: usize = 5;

/// How far a motion is from another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(super) struct Distance {
    /// Greatest distance of a joint angle in rad.
    pub(super) angle: f64,
    /// Greatest distance of a joint displacement, of the centre of a body or of a node in m.
    pub(super) length: f64,
}

/// What became of optimal voltages.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Resimulation {
    /// Greatest deviation from the optimal motion at its instants.
    pub(super) deviation: Distance,
    /// Time for which the voltages of the goal are held afterwards in s; absent where they are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) held: Option<f64>,
    /// Greatest drift from the last optimal instant in that time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) drift: Option<Distance>,
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) failure: Option<String>,
}

/// Simulates optimal voltages and holds the goal.
pub(super) fn resimulate(model: &Model, boundary: &Boundary, optimal: &Solved) -> Resimulation {
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let rest = boundary.rest[1].as_ref().map(|v| model.scalars(v));
    let steps = if rest.is_some() { n * (1 + HELD) } else { n };
    let scalars = |from: f64, _: f64| {
        let k = (from / h).round() as usize;
        match (optimal.voltages.get(k), &rest) {
            (Some(row), _) => model.scalars(row),
            (None, rest) => rest.clone().unwrap_or_default(),
        }
    };
    let (history, failure) = simulate(model, &boundary.start, h, steps, scalars, |_| {
        ControlFlow::Continue(())
    });
    let motion = solved(model, &history, None);
    let (mut deviation, mut drift) = (Distance::default(), Distance::default());
    for k in 0..motion.times.len() {
        match k <= n {
            true => deviation.grow(model, &motion, k, optimal, k),
            false => drift.grow(model, &motion, k, optimal, n),
        }
    }
    let is_held = rest.is_some();
    Resimulation {
        deviation,
        held: is_held.then_some((HELD * n) as f64 * h / 1e3),
        drift: is_held.then_some(drift),
        failure: failure.map(|error| error.to_string()),
    }
}

/// The motion under the constant voltages of the goal, for `durations` times as long as the optimal one.
pub(super) fn under_constant_voltages(
    model: &Model,
    boundary: &Boundary,
    optimal: &Solved,
    durations: usize,
) -> Option<(History, Option<StepError>)> {
    let scalars = model.scalars(boundary.rest[1].as_ref()?);
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let constant = |_: f64, _: f64| scalars.clone();
    let start = &boundary.start;
    Some(simulate(model, start, h, durations * n, constant, |_| {
        ControlFlow::Continue(())
    }))
}

impl Distance {
    /// Takes in the distance of instant `k` of a motion from instant `l` of another.
    fn grow(&mut self, model: &Model, motion: &Solved, k: usize, other: &Solved, l: usize) {
        let joints = motion.joints[k].iter().zip(&other.joints[l]);
        for ((a, b), joint) in joints.zip(&model.system.joints) {
            match joint.kind {
                JointKind::Prismatic { .. } => self.length = self.length.max((a - b).abs() / 1e3),
                _ => self.angle = self.angle.max((a - b).abs()),
            }
        }
        for (a, b) in motion.poses[k].iter().zip(&other.poses[l]) {
            self.length = self.length.max((a.centre - b.centre).norm() / 1e3);
        }
        let nodes = model.action.motion.of_bodies..model.coordinate_count();
        let ends = motion.z[k][nodes.clone()].iter().zip(&other.z[l][nodes]);
        self.length = ends.fold(self.length, |m, (a, b)| m.max((a - b).abs() / 1e3));
    }
}
