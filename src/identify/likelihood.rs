//! Squares of residuals at the ends of intervals, against those that derivatives foretell.
//!
//! Half an interval of a constant follows from the derivatives J at the estimate. Its end belongs to a change δ of all unknowns, of which the
//! others make up for that of the constant as far as they can. Where the predictions f are straight, the sum of the squared residuals r rises
//! by ‖J δ‖² there; where it rises otherwise, the data allow another interval.

use crate::control::problem::Identification;
use crate::identify::error::IdentifyError;
use crate::identify::fit::Fit;
use crate::identify::information::Information;
use crate::identify::prediction::{Grid, predict};
use crate::model::System;
use crate::stop;
use nalgebra::{DMatrix, DVector};

/// Part of half an interval that has to lie within the bounds.
const INSIDE: f64 = 0.5;
/// Rises over those foretold, of an interval of about the right length.
const ALIKE: [f64; 2] = [0.6, 1.7];
/// Singular value of the derivatives, relative to the largest, of a combination that the others can make up for.
const RANK: f64 = 1e-8;

/// Rises at both ends of the interval of each constant over those foretold; none where bounds cut the interval, or there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rises(pub Vec<[Option<f64>; 2]>);

impl Rises {
    /// Those of a fit, by predictions on a grid.
    ///
    /// # Errors
    /// The recordings cannot be simulated at the estimate.
    pub(super) fn new(
        (system, task): (&System, &Identification),
        fitted: &[usize],
        (found, information): (&Fit, &Information),
        grid: &Grid,
    ) -> Result<Self, IdentifyError> {
        let jacobian = found.weighted();
        let residuals = found.residuals();
        let predicted = |values: &[f64]| {
            let mut unknowns = found.unknowns.clone();
            unknowns.values.copy_from_slice(values);
            let own = predict((system, task), fitted, &unknowns, grid)?;
            Ok::<_, IdentifyError>(
                own.with_priors(&task.priors, unknowns.of_constants())
                    .values,
            )
        };
        let estimate = &found.unknowns.values;
        let here = predicted(estimate)?;
        let mut out = Vec::new();
        for j in 0..task.parameters.len() {
            let half = information.half(j);
            let is_known = information.is_determined[j] && half > 0.0;
            if !is_known || stop::reason().is_some() {
                out.push([None; 2]);
                continue;
            }
            let change = end(&jacobian, found, j) * half;
            let foretold = (&jacobian * &change).norm_squared();
            out.push([-1.0, 1.0].map(|side| {
                let part = inside(task, estimate, &change, side);
                let moved = estimate.iter().zip(change.iter());
                let moved: Vec<f64> = moved.map(|(x, d)| x + side * part * d).collect();
                (part >= INSIDE).then(|| match predicted(&moved) {
                    Ok(there) => {
                        let change = (there - &here).component_div(&found.data.deviations);
                        let rise = (&residuals - change).norm_squared() - residuals.norm_squared();
                        rise / (part * part * foretold)
                    }
                    Err(_) => f64::INFINITY,
                })
            }));
        }
        Ok(Self(out))
    }

    /// Constants of which an interval is not confirmed, with the rises at its ends.
    pub fn unlike(&self) -> impl Iterator<Item = (usize, [Option<f64>; 2])> + '_ {
        let [least, most] = ALIKE;
        let is_unlike = move |rise: &f64| !(least..=most).contains(rise);
        let all = self.0.iter().copied().enumerate();
        all.filter(move |(_, ends)| ends.iter().flatten().any(is_unlike))
    }
}

/// Change of all unknowns by which constant `j` grows by one, and others make up for it.
fn end(jacobian: &DMatrix<f64>, found: &Fit, j: usize) -> DVector<f64> {
    let is_open = |&i: &usize| {
        let is_held = found.is_at_bound.get(i).copied().unwrap_or(false);
        i != j && !is_held && jacobian.column(i).amax() > 0.0
    };
    let others: Vec<usize> = (0..jacobian.ncols()).filter(is_open).collect();
    let mut out = DVector::zeros(jacobian.ncols());
    out[j] = 1.0;
    if others.is_empty() {
        return out;
    }
    let scaled = DMatrix::from_fn(jacobian.nrows(), others.len(), |row, i| {
        jacobian[(row, others[i])] / jacobian.column(others[i]).norm()
    });
    let svd = scaled.svd(true, true);
    let least = RANK * svd.singular_values.amax();
    let made_up = svd.solve(&jacobian.column(j), least);
    let made_up = made_up.expect("both sets of vectors were asked for");
    for (&i, by) in others.iter().zip(made_up.iter()) {
        out[i] = -by / jacobian.column(i).norm();
    }
    out
}

/// Greatest part of a change, at most all of it, by which constants stay within their bounds.
fn inside(task: &Identification, values: &[f64], change: &DVector<f64>, side: f64) -> f64 {
    let pairs = task.parameters.iter().zip(values).zip(change.iter());
    let parts = pairs.map(|((parameter, value), by)| {
        let by = side * by;
        let bound = if by < 0.0 {
            parameter.lower
        } else {
            parameter.upper
        };
        match by == 0.0 {
            true => 1.0,
            false => (bound - value) / by,
        }
    });
    parts.fold(1.0, f64::min)
}
