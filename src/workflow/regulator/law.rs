//! The law of a regulator: its gains read rates in place of momenta, as `δp = ∂p/∂q δq + M δq̇` at each instant of the motion.

use crate::dynamics::rates_of_momentum;
use crate::feedback::{HeldGain, Integral, Law, LawInput, Measured, Memory, Point};
use crate::model::{Model, Time};
use crate::workflow::regulator::design::{Design, State};
use crate::workflow::regulator::lasting::widened;
use crate::workflow::regulator::regulated::RegulatedStep;
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
        (rest, held): (Option<&[f64]>, Option<&(RegulatedStep, HeldGain)>),
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
        let wide = |step: &RegulatedStep| widened(step);
        let all: Vec<RegulatedStep>;
        let steps = match self.forced.is_empty() {
            true => steps,
            false => {
                all = steps.iter().map(wide).collect();
                &all
            }
        };
        let at_goal = held.map(|(step, _)| widened(step));
        let last = at_goal.as_ref().or(steps.last()).expect("a step");
        let ahead = |k: usize| steps.get(k).unwrap_or(last);
        let is_held = held.is_some();
        let points = steps.iter().enumerate().map(|(k, _)| {
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
        let held = rest.zip(at_goal.as_ref()).map(|(rest, step)| {
            let inputs = given(&self.model.scalars(rest));
            let gain = predicted((0..delay).map(|_| step), step);
            self.point(self.goal(), &gain, inputs)
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
        let (end, goal) = (motion.last().expect("an instant"), self.goal());
        let coordinates = self.coordinates.iter().map(|&i| end.z[i] - goal.z[i]);
        let momenta = self.momenta.iter();
        let momenta = momenta.map(|&i| end.momentum[i] - goal.momentum[i]);
        let mut state = DVector::zeros(held.by_state.nrows());
        let places = state.iter_mut().zip(coordinates.chain(momenta));
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
        let goal = is_held.then(|| self.goal());
        let motion = motion[..motion.len() - usize::from(is_held)].iter();
        let instants: Vec<_> = motion.chain(goal).map(|at| map.placed(&at.z)).collect();
        let moving = self.model.moving_markers().into_iter();
        let path = |(marker, vector): (usize, usize)| {
            let name = self.model.system.markers[marker].name.clone();
            let places = instants.iter().map(|instant| instant.x[vector].into());
            (name, places.collect())
        };
        moving.map(path).collect()
    }

    /// Coordinates and rates of a state.
    pub(super) fn measured(&self, State { z, momentum }: &State) -> Vec<f64> {
        let rates = rates_of_momentum(self.model, z, 0.0, momentum);
        let coordinates = self.coordinates.iter().map(|&i| z[i]);
        coordinates
            .chain(self.momenta.iter().map(|&i| rates[i]))
            .collect()
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
