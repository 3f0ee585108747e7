//! The law of a regulator: its gains read rates in place of momenta, as `δp = ∂p/∂q δq + M δq̇` at each instant of the motion.
//!
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

use crate::dynamics::rates_of_momentum;
use crate::feedback::{
    Forced, HeldGain, Integral, Lasting, Law, LawInput, Measured, Memory, Point,
};
use crate::model::{Model, Time};
use crate::workflow::regulator::design::{Design, State, with_ones};
use crate::workflow::regulator::regulated::{NoRegulator, RegulatedStep};
use nalgebra::{DMatrix, DVector};

/// Quantity that coordinate `i` remembers.
pub(crate) fn remembered(model: &Model, i: usize) -> Option<Memory> {
    let charge = model.unit_of_charge(i).map(Memory::Charge);
    charge.or_else(|| model.is_memory(i).then_some(Memory::Number))
}

impl Design<'_> {
    pub(super) fn law(
        &self,
        steps: &[RegulatedStep],
        motion: &[State],
        held: Option<&(RegulatedStep, HeldGain)>,
    ) -> Law {
        let scalars = self.model.variables.of(Time::Interval);
        let coordinate = |&i: &usize, is_rate: bool| Measured {
            name: self.model.variables.unknown(i).to_string(),
            is_rate,
            is_length: self.model.is_length(i),
            memory: remembered(self.model, i),
        };
        let coordinates = self.coordinates.iter().map(|i| coordinate(i, false));
        let rates = self.momenta.iter().map(|i| coordinate(i, true));
        let inputs = self.inputs.iter().zip(&self.bounds);
        let given = |scalars: &[f64]| -> Vec<f64> {
            let all = self.inputs.iter();
            all.map(|input| scalars[input.scalar]).collect()
        };
        let delay = self.task.delayed(self.h);
        let steps: Vec<RegulatedStep> = steps.iter().map(widened).collect();
        let at_goal = held.map(|(step, _)| widened(step));
        let last = at_goal.as_ref().or(steps.last()).expect("a step");
        let ahead = |k: usize| steps.get(k).unwrap_or(last);
        let is_held = held.is_some();
        let points = (0..steps.len()).map(|k| {
            let inputs = given(&self.discrete.scalars[k]);
            let gain = predicted((k..k + delay).map(ahead), ahead(k + delay));
            let offset = match (k + delay).checked_sub(steps.len()) {
                Some(behind) if is_held => self.offset(motion, behind, last),
                _ => Vec::new(),
            };
            Point {
                offset,
                ..self.point(&motion[k], &gain, inputs)
            }
        });
        let held = self.rest.zip(at_goal.as_ref()).map(|(rest, step)| {
            let inputs = given(&self.model.scalars(rest));
            let gain = predicted((0..delay).map(|_| step), step);
            self.point(&self.goal, &gain, inputs)
        });
        Law {
            measured: coordinates.chain(rates).collect(),
            inputs: inputs
                .map(|(input, &bounds)| LawInput {
                    name: scalars[input.scalar].name.clone(),
                    is_squared: input.is_squared,
                    bounds,
                })
                .collect(),
            integral: Integral {
                of: self.integrated.clone(),
            },
            h: self.h,
            delay,
            points: points.collect(),
            held,
            observer: None,
            markers: self.markers(motion, is_held),
        }
    }

    /// The correction some intervals behind the end of a motion that ends beside its goal, by the step that is held there.
    fn offset(&self, motion: &[State], behind: usize, held: &RegulatedStep) -> Vec<f64> {
        let (end, goal) = (motion.last().expect("an instant"), &self.goal);
        let mut state = DVector::zeros(held.by_state.nrows());
        let places = state.iter_mut().zip(self.change([goal, end]));
        places.for_each(|(to, value)| *to = value);
        for _ in 0..behind {
            state = &held.by_state * state;
        }
        (-(&held.gain * state)).iter().copied().collect()
    }

    /// The places of markers that can move.
    fn markers(&self, motion: &[State], is_held: bool) -> Vec<(String, Vec<[f64; 3]>)> {
        let map = &self.model.action.map;
        // The end is the goal, where that is held.
        let goal = is_held.then_some(&self.goal);
        let motion = motion[..motion.len() - usize::from(is_held)].iter();
        let instants: Vec<_> = motion.chain(goal).map(|at| map.placed(&at.z)).collect();
        let moving = self.model.moving_markers().into_iter();
        let paths = moving.map(|(marker, vector)| {
            let name = self.model.system.markers[marker].name.clone();
            let places = instants.iter().map(|instant| instant.x[vector].into());
            (name, places.collect())
        });
        paths.collect()
    }

    /// Coordinates and rates of a state.
    pub(super) fn measured(&self, State { z, momentum }: &State) -> Vec<f64> {
        let rates = rates_of_momentum(self.model, z, 0.0, momentum);
        let coordinates = self.coordinates.iter().map(|&i| z[i]);
        let rates = self.momenta.iter().map(|&i| rates[i]);
        coordinates.chain(rates).collect()
    }

    /// A point of the law, whose gain reads rates in place of momenta.
    fn point(&self, at: &State, gain: &DMatrix<f64>, inputs: Vec<f64>) -> Point {
        let by = self.by_rates(at);
        let mut read = gain.clone();
        let of_state = gain.columns(0, by.nrows()) * &by;
        read.columns_mut(0, by.nrows()).copy_from(&of_state);
        Point {
            state: self.measured(at),
            inputs,
            gain: read,
            offset: Vec::new(),
        }
    }
}

/// The gain K over the state some intervals before it acts, and over what the inputs are corrected by in each of these intervals: the
/// state in which it acts is predicted, `x₊ = A x + B u`.
fn predicted<'s>(
    intervals: impl Iterator<Item = &'s RegulatedStep>,
    acting: &RegulatedStep,
) -> DMatrix<f64> {
    let size = acting.by_state.nrows();
    // The state, by the state before and by the corrections.
    let mut by = vec![DMatrix::identity(size, size)];
    for step in intervals {
        by.iter_mut()
            .for_each(|block| *block = &step.by_state * &*block);
        by.push(step.by_inputs.clone());
    }
    let columns = by.iter().map(DMatrix::ncols).sum();
    let mut gain = DMatrix::zeros(acting.gain.nrows(), columns);
    let mut at = 0;
    for block in &by {
        gain.columns_mut(at, block.ncols())
            .copy_from(&(&acting.gain * block));
        at += block.ncols();
    }
    gain
}

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
    let (own, more) = (left.ncols(), right.ncols());
    let mut out = left.clone().resize_horizontally(own + more, 0.0);
    out.columns_mut(own, more).copy_from(right);
    out
}

/// The step with constant disturbances and the inputs against them as entries of its state.
pub(super) fn widened(step: &RegulatedStep) -> RegulatedStep {
    let Some([over_forces, _]) = &step.lasting else {
        return step.clone();
    };
    let (n, forces) = (step.by_state.nrows(), step.by_forces.ncols());
    let size = n + over_forces.ncols();
    let mut by_state = with_ones(&step.by_state, size);
    let mut of_forces = by_state.view_mut((0, n), (n, forces));
    of_forces.copy_from(&step.by_forces);
    RegulatedStep {
        by_state,
        by_inputs: step.by_inputs.clone().resize_vertically(size, 0.0),
        gain: side_by_side(&step.gain, over_forces),
        ..step.clone()
    }
}
