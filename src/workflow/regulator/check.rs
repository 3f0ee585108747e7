//! Comparison of the linear closed loop with the equations of motion: an interval from a state a little off the motion.

use crate::dynamics::Linearisation;
use crate::workflow::regulator::design::{Design, State};
use crate::workflow::regulator::regulated::{RegulatedStep, Reproduced};
use nalgebra::DVector;

/// Deviation of each coordinate at the start, in rad or as a part of the length of the system.
const OFF: f64 = 1e-5;

/// Compares at the first, middle and last interval.
pub(super) fn reproduced(
    design: &Design<'_>,
    linearisation: &Linearisation<'_>,
    steps: &[RegulatedStep],
    motion: &[State],
) -> Vec<Reproduced> {
    let last = steps.len() - 1;
    let mut intervals = vec![0, last / 2, last];
    intervals.dedup();
    let at = |k: usize| Reproduced {
        interval: k,
        difference: difference(design, linearisation, &steps[k], (k, motion)),
    };
    intervals.into_iter().map(at).collect()
}

/// The relative difference of an interval; NaN where a step fails.
fn difference(
    design: &Design<'_>,
    linearisation: &Linearisation<'_>,
    step: &RegulatedStep,
    (k, motion): (usize, &[State]),
) -> f64 {
    let model = design.model;
    let sizes = model.sizes();
    let mut z = motion[k].z.clone();
    let mut off = DVector::zeros(step.by_state.ncols());
    for (place, &i) in linearisation.coordinates().iter().enumerate() {
        off[place] = OFF * sizes[i];
        z[i] += off[place];
    }
    let change = -(&step.gain * &off);
    let mut given = model.variables.split(&design.discrete.scalars[k])[0].to_vec();
    let mut acted = DVector::zeros(design.inputs.len());
    for (i, input) in design.inputs.iter().enumerate() {
        let value = &mut given[input.scalar];
        let before = *value;
        // A square below zero is none: both leave it out alike.
        (*value, acted[i]) = match input.is_squared {
            true => {
                let square = (before * before + change[i]).max(0.0);
                (square.sqrt(), square - before * before)
            }
            false => (before + change[i], change[i]),
        };
    }
    let linear = &step.by_state * &off + &step.by_inputs * acted;
    let momentum = motion[k].momentum.clone();
    let Ok(moved) = design.after(&State { z, momentum }, &given) else {
        return f64::NAN;
    };
    let [moved, motion] =
        [&moved, &motion[k + 1]].map(|of| linearisation.state(&of.z, &of.momentum));
    let places = linearisation.coordinates().len();
    // Coordinates and momenta have units of their own.
    let ranges = [0..places, places..linearisation.size()].into_iter();
    let relative = ranges.map(|range| {
        let size = range.clone().map(|i| linear[i].abs()).fold(0.0, f64::max);
        let far = |i: usize| (moved[i] - motion[i] - linear[i]).abs();
        match size > 0.0 {
            true => range.map(far).fold(0.0, f64::max) / size,
            false => 0.0,
        }
    });
    relative.fold(0.0, f64::max)
}
