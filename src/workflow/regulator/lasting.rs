//! Gains over constant disturbances on joints.
//!
//! Against forces f that last the goal is held by other inputs, ū more than those of the motion: they are found from f within bounds (`feedback::Lasting`).
//! With w = (f, ū) the state at rest is X w, X = (1 − A)⁻¹ (E, B) at the goal. Deviations from these, ξ = x − X w and v = u − ū, follow
//! ξ₊ = A ξ + B v + D w, D = A X + (E, B) − X, which vanishes at the goal. They cost as those from the motion do, so that
//!
//! ```text
//! v = −K ξ − K′ w,     K′ = (R + BᵀS₊B)⁻¹ Bᵀ (S₊D + P₊),     P = (A − BK)ᵀ (S₊D + P₊)
//! ```
//!
//! with P = 0 behind the end, and the gain over w is K′ − K X − (0, 1). Where rates cost, R̂ stands for R, S₊D + P₊ + WD for S₊D + P₊, and WD is
//! subtracted from P.

use crate::feedback::{Forced, Lasting};
use crate::workflow::regulator::design::Design;
use crate::workflow::regulator::regulated::{NoRegulator, RegulatedStep};
use nalgebra::DMatrix;

/// Constant disturbances with their effects, backward in time.
pub(super) struct Against {
    /// X.
    pub(super) rest: DMatrix<f64>,
    /// P behind the step that comes next, backward in time.
    ahead: DMatrix<f64>,
}

impl Against {
    /// That of the step at the held goal, whose gain it completes; `None` without constant disturbances.
    ///
    /// # Errors
    /// The goal is not held, or nothing is at rest under a force.
    pub(super) fn new(
        held: Option<&mut RegulatedStep>,
        is_wanted: bool,
    ) -> Result<Option<Self>, NoRegulator> {
        let none = |reason: &str| NoRegulator::Observer(reason.to_owned());
        if !is_wanted {
            return Ok(None);
        }
        let held = held.ok_or_else(|| {
            none("constant disturbances are held against at the goal, and nothing holds it")
        })?;
        let n = held.by_state.nrows();
        let left = DMatrix::identity(n, n) - &held.by_state;
        let rest = left.lu().solve(&acting(held));
        let rest = rest.filter(|rest| rest.iter().all(|value| value.is_finite()));
        let rest = rest.ok_or_else(|| {
            none("a joint is free at the goal: a constant disturbance moves it for ever")
        })?;
        let ahead = DMatrix::zeros(n, rest.ncols());
        held.lasting = Some([gain(held, &rest, None), ahead.clone()]);
        Ok(Some(Self { rest, ahead }))
    }

    /// Completes the gain of a step before one with the cost `after`; `None` if that is not finite.
    pub(super) fn step(&mut self, step: &mut RegulatedStep, after: &DMatrix<f64>) -> Option<()> {
        let RegulatedStep {
            by_state,
            by_inputs,
            ..
        } = &*step;
        let drift = by_state * &self.rest + acting(step) - &self.rest;
        let of_rates = step.weighted(&drift);
        let costs = after * drift + &self.ahead;
        let toward = by_inputs.transpose() * after;
        let inner = step.whole_costs().costs.inputs + toward * by_inputs;
        let further = by_inputs.transpose() * (&costs + &of_rates);
        let further = inner.cholesky()?.solve(&further);
        let closed = by_state - by_inputs * &step.gain;
        // Rates cost by the change of the state.
        self.ahead = closed.transpose() * (costs + &of_rates) - of_rates;
        step.lasting = Some([gain(step, &self.rest, Some(&further)), self.ahead.clone()]);
        Some(())
    }

    /// Forces of the inputs on the joints that are held at the goal, by force over the inputs.
    pub(super) fn forces(&self, design: &Design<'_>) -> Result<DMatrix<f64>, NoRegulator> {
        let places = design.forced.iter().map(|[place, _]| place);
        let moved = self.rest.select_rows(places);
        let (by_forces, by_inputs) =
            moved.columns_range_pair(..design.forced.len(), design.forced.len()..);
        let found = by_forces.into_owned().lu().solve(&by_inputs.into_owned());
        let none = "a constant disturbance moves no joint at the goal";
        found.ok_or_else(|| NoRegulator::Observer(none.to_owned()))
    }
}

impl Design<'_> {
    /// The constant disturbances of an observer.
    pub(super) fn lasting(&self, by_inputs: DMatrix<f64>) -> Lasting {
        let on = self.forced.iter().map(|&[place, _]| {
            let i = self.coordinates[place];
            Forced {
                name: self.model.variables.unknown(i).to_string(),
                is_length: self.model.is_length(i),
            }
        });
        Lasting {
            on: on.collect(),
            by_inputs,
        }
    }
}

/// (E, B).
fn acting(step: &RegulatedStep) -> DMatrix<f64> {
    side_by_side(&step.by_forces, &step.by_inputs)
}

fn gain(step: &RegulatedStep, rest: &DMatrix<f64>, further: Option<&DMatrix<f64>>) -> DMatrix<f64> {
    let mut out = -(&step.gain * rest);
    let forces = step.by_forces.ncols();
    (0..step.gain.nrows()).for_each(|i| out[(i, forces + i)] -= 1.0);
    match further {
        Some(further) => out + further,
        None => out,
    }
}

fn side_by_side(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(left.nrows(), left.ncols() + right.ncols());
    out.columns_mut(0, left.ncols()).copy_from(left);
    out.columns_mut(left.ncols(), right.ncols())
        .copy_from(right);
    out
}

/// The step with constant disturbances and the inputs against them as entries of its state.
pub(super) fn widened(step: &RegulatedStep) -> RegulatedStep {
    let Some([over_forces, _]) = &step.lasting else {
        return step.clone();
    };
    let (n, forces) = (step.by_state.nrows(), step.by_forces.ncols());
    let size = n + over_forces.ncols();
    let mut by_state = DMatrix::identity(size, size);
    by_state.view_mut((0, 0), (n, n)).copy_from(&step.by_state);
    by_state
        .view_mut((0, n), (n, forces))
        .copy_from(&step.by_forces);
    let mut by_inputs = DMatrix::zeros(size, step.by_inputs.ncols());
    by_inputs.rows_mut(0, n).copy_from(&step.by_inputs);
    RegulatedStep {
        by_state,
        by_inputs,
        gain: side_by_side(&step.gain, over_forces),
        ..step.clone()
    }
}
