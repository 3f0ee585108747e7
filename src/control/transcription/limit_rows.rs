//! Limits and goals as rows behind the equations of motion, and steps of quantities between neighbouring intervals, which limits of rates of voltages,
//! currents and powers bound.

use crate::control::goal::instant_at;
use crate::control::limits::{BoundedQuantity, When};
use crate::control::numbering::{Numbering, Span};
use crate::coordinates::{CoordinateMap, Reduced};
use crate::functional::{Functional, Measure, Outer};
use crate::model::{Model, Quantity, Role, Time, What};
use std::ops::Range;

/// Mark of a scalar among the entries of a gradient.
pub(super) const SCALAR: usize = 2;

/// Mark of a scalar of the interval before.
pub(super) const BEFORE: usize = 3;

/// Mark of the interval length.
pub(super) const DURATION: usize = 4;

/// Mark of a coordinate of the instant at which the interval before begins.
pub(super) const BEFORE_INSTANT: usize = 5;

/// Site in time at which a quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::control) enum Site {
    Instants,
    Intervals,
}

/// A limit or goal before it becomes rows.
#[derive(Clone, Debug)]
pub(in crate::control) struct LimitRow {
    pub(in crate::control) bounded: BoundedQuantity,
    /// Index among the measures of its site.
    pub(super) measure: usize,
    pub(in crate::control) site: Site,
    /// Instants or intervals at which it is a row.
    pub(in crate::control) at: Range<usize>,
    /// Its first row among those of all limits.
    pub(in crate::control) first: usize,
    /// Entries of its gradient: (side, entry of z), ([`SCALAR`], scalar), or those of the other marks.
    pub(super) entries: Vec<(usize, usize)>,
    /// Vectors it reads.
    pub(super) vectors: Vec<usize>,
    /// Factor of its rows, which follows from the derivatives at the guess.
    pub(super) scale: f64,
    /// Step from the interval before, where steps between intervals are limited.
    pub(super) step: Option<Step>,
}

impl LimitRow {
    /// Part of the bounds that holds at instant or interval k.
    pub(super) fn part(&self, k: usize) -> f64 {
        self.step.as_ref().map_or(1.0, |step| step.part(k))
    }
}

/// Rows of the bounded quantities over a horizon, with the entries their gradients have. A path limit has no row where start
/// or goal give all that it reads: there it is checked before. Those of inputs hold behind the end of the motion too.
pub(super) fn limit_rows(
    model: &Model,
    list: &[BoundedQuantity],
    rest: &[Option<Vec<f64>>; 2],
    span: Span,
    unknowns: &Numbering,
) -> Vec<LimitRow> {
    let map = &model.action.map;
    let mut first = 0;
    let mut others = model.measured[list.len()..].iter();
    let pairs = list.iter().zip(&model.measured);
    let rows = pairs.filter_map(|(bounded, measure)| {
        let before = match bounded.other_before() {
            Some(_) => others.next().expect("a measure of each quantity"),
            None => measure,
        };
        let measure = (*measure)?;
        let site = Site::from_quantity(&bounded.quantity);
        let reads = site.measure(model, measure);
        let step = (*before).filter(|_| bounded.quantity.before().is_some());
        let step = step.map(|before| Step::new(before, &bounded.quantity, model, rest, span));
        let before = step.as_ref().map(|step| site.measure(model, step.before));
        let support = support(reads, map);
        let mut entries = entries(reads, site, before, &support);
        let has_length = reads.reads_rates() || bounded.rate.is_some();
        if has_length && unknowns.horizon().is_some() {
            entries.push((DURATION, 0));
        }
        let scalars = model.variables.of(Time::Interval);
        let is_input = |&s: &usize| scalars[s].role != Role::Parameter;
        let reads_inputs = reads.scalars().iter().any(is_input);
        let single = sites(bounded.when, site, span, reads_inputs);
        let mut at = match &step {
            Some(step) => {
                let is_given = |&i: &usize| unknowns.unknown(span.all, i).is_none();
                let all = step.at(support.iter().all(is_given));
                match bounded.when {
                    When::Everywhere => all,
                    When::Goal => single.start.max(all.start)..single.end.min(all.end),
                    When::At(part) => step.nearest(instant_at(part, span.end), all),
                    When::Never => single,
                }
            }
            None => single,
        };
        let is_open = |k: usize| {
            let mut entries = entries.iter();
            entries.any(|&entry| unknowns.column_of_entry(k, entry).is_some())
        };
        at = unchecked(bounded, site, at, span, is_open);
        let mut vectors: Vec<usize> = Vec::new();
        for vector in reads.vectors() {
            if !vectors.contains(&vector) {
                vectors.push(vector);
            }
        }
        let limit = LimitRow {
            bounded: bounded.clone(),
            measure,
            site,
            first,
            at,
            entries,
            vectors,
            scale: 1.0,
            step,
        };
        first += limit.at.len();
        Some(limit)
    });
    rows.collect()
}

/// The rows of a limit without those at its ends of which nothing is open: start, goal and given inputs are checked before. Where all
/// follows from prescribed motions nothing is checked before, and no row is left out.
fn unchecked(
    bounded: &BoundedQuantity,
    site: Site,
    at: Range<usize>,
    span: Span,
    is_open: impl Fn(usize) -> bool,
) -> Range<usize> {
    let is_of_goal = site == Site::Instants && at.end == span.end + 1;
    let is_checked = match bounded.when {
        When::Everywhere => true,
        When::Goal | When::Never => false,
        When::At(_) => is_of_goal,
    };
    if !is_checked {
        return at;
    }
    let mut open = at.clone();
    while !open.is_empty() && !is_open(open.start) {
        open.start += 1;
    }
    while !open.is_empty() && !is_open(open.end - 1) {
        open.end -= 1;
    }
    let is_prescribed = bounded.when == When::Everywhere && open.is_empty();
    match is_prescribed && !matches!(bounded.quantity.what, What::Voltage(_)) {
        true => at,
        false => open,
    }
}

/// Coordinates of an instant on which what a measure reads depends.
fn support(reads: &dyn Measure, map: &CoordinateMap) -> Vec<usize> {
    let vectors = reads.vectors();
    let mut support: Vec<usize> = vectors.iter().flat_map(|&v| map.support(v)).collect();
    support.sort_unstable();
    support.dedup();
    support
}

/// Entries of the gradient of a measure, and of one that is subtracted in the interval before, which reads the same coordinates.
fn entries(
    reads: &dyn Measure,
    site: Site,
    before: Option<&dyn Measure>,
    support: &[usize],
) -> Vec<(usize, usize)> {
    let is_read_before = |side: usize| before.is_some_and(|before| before.reads(side));
    let marks = [
        (0, reads.reads(0) || is_read_before(1)),
        (1, site.sides() > 1 && reads.reads(1)),
        (BEFORE_INSTANT, is_read_before(0)),
    ];
    let marks = marks.into_iter().filter(|(_, is_read)| *is_read);
    let mut entries: Vec<(usize, usize)> = marks
        .flat_map(|(mark, _)| support.iter().map(move |&i| (mark, i)))
        .collect();
    if site == Site::Intervals {
        entries.extend(reads.scalars().into_iter().map(|s| (SCALAR, s)));
    }
    let before = before.into_iter().flat_map(Measure::scalars);
    entries.extend(before.map(|s| (BEFORE, s)));
    entries
}

/// Instants or intervals at which a quantity is bounded.
fn sites(when: When, site: Site, span: Span, reads_inputs: bool) -> Range<usize> {
    let Span {
        end,
        all: intervals,
        is_closed,
        ..
    } = span;
    match (when, site) {
        (When::Never, _) => 0..0,
        (When::Goal, Site::Instants) => end..end + 1,
        (When::Goal, Site::Intervals) => end - 1..end,
        (When::At(part), _) => {
            let k = instant_at(part, end) + 1 - site.sides();
            k..k + 1
        }
        // The last instant of a periodic motion is the first one.
        (When::Everywhere, Site::Instants) => 0..end + 1 - usize::from(is_closed),
        (When::Everywhere, Site::Intervals) if reads_inputs => 0..intervals,
        (When::Everywhere, Site::Intervals) => 0..end,
    }
}

impl Numbering {
    /// Column of an entry of the gradient of a limit at instant or interval k of a horizon.
    pub(super) fn column_of_entry(&self, k: usize, entry: (usize, usize)) -> Option<usize> {
        let (side, i) = entry;
        match side {
            SCALAR => self.scalar(k, i),
            BEFORE => self.scalar(self.span.before(k)?, i),
            DURATION => self.horizon(),
            BEFORE_INSTANT => self.unknown(self.span.before(k)?, i),
            _ => self.unknown(k + side, i),
        }
    }
}

impl Site {
    /// Returns the site at which a quantity is measured.
    pub(in crate::control) fn from_quantity(quantity: &Quantity) -> Self {
        match quantity.is_of_intervals() {
            true => Self::Intervals,
            false => Self::Instants,
        }
    }

    /// A measure of the site.
    pub(in crate::control) fn measure(self, model: &Model, index: usize) -> &dyn Measure {
        self.sum(&model.action).measures[index].as_ref()
    }

    /// The sum of the site.
    pub(super) fn sum(self, action: &Reduced) -> &Functional {
        match self {
            Self::Instants => &action.instants,
            Self::Intervals => &action.intervals,
        }
    }

    /// Returns the number of instants that a quantity of the site reads.
    pub(in crate::control) fn sides(self) -> usize {
        match self {
            Self::Instants => 1,
            Self::Intervals => 2,
        }
    }
}

/// Functions of the measures of one site at instant or interval k: limits and goals times the costates of their rows.
pub(super) fn fill_limits(
    outer: &mut [Outer],
    limits: &[LimitRow],
    site: Site,
    k: usize,
    costates: &[f64],
) {
    outer.fill(Outer::default());
    for limit in limits.iter().filter(|l| l.site == site) {
        let costate = |k: usize| {
            let is_row = limit.at.contains(&k);
            is_row.then(|| costates[limit.first + k - limit.at.start])
        };
        match &limit.step {
            Some(step) => {
                let after = costate(k).unwrap_or(0.0) * step.factor;
                outer[limit.measure].slope += after;
                let next = costate(step.after(k)).unwrap_or(0.0) * step.factor;
                outer[step.before].slope -= next;
            }
            None => {
                if let Some(costate) = costate(k) {
                    outer[limit.measure] = Outer::linear(costate);
                }
            }
        }
    }
}

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
        model: &Model,
        rest: &[Option<Vec<f64>>; 2],
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

    /// Intervals before which a step is limited, the end counted as one: the step there is that of a place that is given.
    pub(super) fn at(&self, is_end_given: bool) -> Range<usize> {
        let [first, last] = self.ends.each_ref().map(Option::is_some);
        let is_first = first || self.span.is_closed;
        let is_last = last && is_end_given;
        usize::from(!is_first)..self.span.all + usize::from(is_last)
    }

    /// The step at instant k as one of those that are limited.
    pub(super) fn nearest(&self, k: usize, limited: Range<usize>) -> Range<usize> {
        if limited.is_empty() {
            return limited;
        }
        let k = match self.span.is_closed {
            true => k % self.span.all,
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
        (k < self.span.all).then_some(k)
    }

    /// The interval after interval k, the end counted as one.
    pub(super) fn after(&self, k: usize) -> usize {
        match self.span.is_closed && k + 1 == self.span.all {
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
