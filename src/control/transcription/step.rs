//! Steps of quantities between neighbouring intervals: what limits of rates of voltages, of currents and of powers bound.

use crate::control::numbering::Span;
use crate::model::{Model, Quantity, What};
use std::ops::Range;

/// Step `f (m_k − n_{k−1})` from a quantity n of the interval before to a quantity m of an interval; both may be the same.
///
/// Where the inputs at rest before the start or after the end are known, so are the steps from rest and to it. A quantity of an interval is
/// that in its middle, half an interval from the start or the end of the motion: there half the bounds hold.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// Index of n among the measures of intervals.
    pub(super) before: usize,
    /// f, one over the unit.
    pub(super) factor: f64,
    /// Scalars of an interval at rest before the start and after the end; none of an impulse, which rest does not tell.
    ends: [Option<Vec<f64>>; 2],
    is_impulse: bool,
    span: Span,
}

impl Step {
    pub(super) fn new(
        before: usize,
        quantity: &Quantity,
        (model, rest): (&Model, &[Option<Vec<f64>>; 2]),
        span: Span,
    ) -> Self {
        let is_impulse = matches!(quantity.what, What::Reaction { .. });
        Self {
            before,
            factor: 1.0 / quantity.step_unit(),
            ends: match is_impulse {
                true => [None, None],
                false => ends(model, rest),
            },
            is_impulse,
            span,
        }
    }

    /// Takes other inputs at rest before and after.
    pub(super) fn move_ends(&mut self, model: &Model, rest: &[Option<Vec<f64>>; 2]) {
        if !self.is_impulse {
            self.ends = ends(model, rest);
        }
    }

    /// Returns true if inputs at rest are known where these are.
    pub(super) fn has_ends(&self, rest: &[Option<Vec<f64>>; 2]) -> bool {
        self.is_impulse
            || self.ends.each_ref().map(Option::is_some) == rest.each_ref().map(Option::is_some)
    }

    /// Intervals before which a step is limited, the end counted as one: the step there is that of a place that is given.
    pub(super) fn at(&self, is_end_given: bool) -> Range<usize> {
        let [first, last] = self.ends.each_ref().map(Option::is_some);
        let is_first = first || self.span.is_closed;
        let is_last = last && is_end_given;
        usize::from(!is_first)..self.span.intervals + usize::from(is_last)
    }

    /// The step at instant k as one of those that are limited.
    pub(super) fn nearest(&self, k: usize, limited: Range<usize>) -> Range<usize> {
        if limited.is_empty() {
            return limited;
        }
        let k = match self.span.is_closed {
            true => k % self.span.intervals,
            false => k,
        };
        let k = k.clamp(limited.start, limited.end - 1);
        k..k + 1
    }

    /// The interval before interval k, if the step from it is none from rest.
    pub(super) fn interval_before(&self, k: usize) -> Option<usize> {
        self.span.before(k)
    }

    /// Interval k, if the step to it is none to rest.
    pub(super) fn interval(&self, k: usize) -> Option<usize> {
        (k < self.span.intervals).then_some(k)
    }

    /// The interval after interval k, the end counted as one.
    pub(super) fn after(&self, k: usize) -> usize {
        match self.span.is_closed && k + 1 == self.span.intervals {
            true => 0,
            false => k + 1,
        }
    }

    /// Scalars at rest before the start (0) or after the end (1).
    pub(super) fn at_rest(&self, end: usize) -> &[f64] {
        let known = "a step from or to a state of rest that is known";
        self.ends[end].as_ref().expect(known)
    }

    /// Part of the bounds that holds before interval k.
    pub(super) fn part(&self, k: usize) -> f64 {
        let is_at_rest = self.span.before(k).is_none() || k == self.span.end;
        match is_at_rest && !self.is_impulse {
            true => 0.5,
            false => 1.0,
        }
    }
}

/// Scalars of an interval under the inputs at rest before and after.
fn ends(model: &Model, rest: &[Option<Vec<f64>>; 2]) -> [Option<Vec<f64>>; 2] {
    let scalars = |row: &Vec<f64>| {
        let mut scalars = vec![0.0; model.action.layout().interval_scalars];
        for (source, value) in row.iter().enumerate() {
            if let Some(s) = model.variables.input(source) {
                scalars[s] = *value;
            }
        }
        scalars
    };
    rest.each_ref().map(|row| row.as_ref().map(scalars))
}
