//! Limits and goals as rows behind the equations of motion.

use crate::control::limits::{BoundedQuantity, When};
use crate::control::numbering::Numbering;
use crate::control::span::Span;
use crate::control::waypoint::instant_at;
use crate::coordinates::Reduced;
use crate::functional::{Functional, Measure, Outer};
use crate::model::{Model, Quantity};
use std::ops::Range;

/// Mark of a scalar among the entries of a gradient.
pub(super) const SCALAR: usize = 2;
/// Mark of a scalar of the interval before.
pub(super) const BEFORE: usize = 3;

/// Mark of the interval length.
pub(super) const DURATION: usize = 4;

/// Site in time at which a quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::control) enum Site {
    Instants,
    Intervals,
}

/// A limit or goal before it becomes rows.
#[derive(Clone, Debug)]
pub(super) struct LimitRow {
    pub(super) bounded: BoundedQuantity,
    /// Index among the measures of its site.
    pub(super) measure: usize,
    pub(super) site: Site,
    /// Instants or intervals at which it is a row.
    pub(super) at: Range<usize>,
    /// Its first row among those of all limits.
    pub(super) first: usize,
    /// Entries of its gradient: (side, entry of z) or ([`SCALAR`], scalar).
    pub(super) entries: Vec<(usize, usize)>,
    /// Vectors it reads.
    pub(super) vectors: Vec<usize>,
    pub(super) scale: f64,
    /// The input whose steps between intervals are limited.
    pub(super) step: Option<InputStep>,
}

/// An input whose steps between neighbouring intervals are limited, and those from its value at rest and to it, where that is known.
///
/// An input of an interval is its value in the middle, half an interval from the start or the end of the motion: there half the bounds
/// hold.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputStep {
    /// Scalar of the input.
    scalar: usize,
    /// One over its unit.
    pub(super) slope: f64,
    /// Values at rest before the start and after the end.
    ends: [Option<f64>; 2],
    span: Span,
}

impl InputStep {
    fn new(
        quantity: &Quantity,
        model: &Model,
        rest: &[Option<Vec<f64>>; 2],
        span: Span,
    ) -> Option<Self> {
        let Quantity::VoltageStep { source, unit, .. } = *quantity else {
            return None;
        };
        Some(Self {
            scalar: model.variables.input(source)?,
            slope: 1.0 / unit,
            ends: ends(rest, source),
            span,
        })
    }

    /// Takes other values at rest before and after.
    pub(super) fn move_ends(&mut self, quantity: &Quantity, rest: &[Option<Vec<f64>>; 2]) {
        if let Quantity::VoltageStep { source, .. } = *quantity {
            self.ends = ends(rest, source);
        }
    }

    /// Returns true if values at rest are known where these are.
    pub(super) fn has_ends(&self, rest: &[Option<Vec<f64>>; 2]) -> bool {
        self.ends.map(|end| end.is_some()) == rest.each_ref().map(|row| row.is_some())
    }

    /// Intervals before which a step is limited, the end counted as one.
    fn at(&self) -> Range<usize> {
        let [first, last] = self.ends.map(|end| usize::from(end.is_some()));
        let first = first.max(usize::from(self.span.is_closed));
        1 - first..self.span.intervals + last
    }

    /// The step before interval k, of the scalars of all intervals, `count` of each.
    pub(super) fn value(&self, k: usize, scalars: &[f64], count: usize) -> f64 {
        let of = |k: usize| scalars[k * count + self.scalar];
        let before = self.span.before(k).map(of).or(self.ends[0]);
        let after = match k == self.span.intervals {
            true => self.ends[1],
            false => Some(of(k)),
        };
        let known = "a step from or to a value at rest that is known";
        self.slope * (after.expect(known) - before.expect(known))
    }

    /// Part of the bounds that holds before interval k.
    pub(super) fn part(&self, k: usize) -> f64 {
        match self.span.before(k).is_none() || k == self.span.end {
            true => 0.5,
            false => 1.0,
        }
    }
}

/// Values of a source at rest before and after.
fn ends(rest: &[Option<Vec<f64>>; 2], source: usize) -> [Option<f64>; 2] {
    rest.each_ref()
        .map(|row| row.as_ref().map(|row| row[source]))
}

/// Rows of the bounded quantities over a horizon, with the entries their gradients have. A path limit has no row where start
/// or goal give all that it reads: there it is checked before. Those of inputs hold behind the end of the motion too.
pub(super) fn limit_rows(
    model: &Model,
    (list, rest): (&[BoundedQuantity], &[Option<Vec<f64>>; 2]),
    span: Span,
    unknowns: &Numbering,
) -> Vec<LimitRow> {
    let map = &model.action.map;
    let mut first = 0;
    let row = |(bounded, measure): (&BoundedQuantity, &Option<usize>)| {
        let measure = (*measure)?;
        let site = Site::from_quantity(&bounded.quantity);
        let reads = site.measure(model, measure);
        let mut support: Vec<usize> = reads
            .vectors()
            .iter()
            .flat_map(|&v| map.support(v))
            .collect();
        support.sort_unstable();
        support.dedup();
        let sides = (0..site.sides()).filter(|&side| reads.reads(side));
        let mut entries: Vec<(usize, usize)> = sides
            .flat_map(|side| support.iter().map(move |&i| (side, i)))
            .collect();
        if site == Site::Intervals {
            entries.extend(reads.scalars().into_iter().map(|s| (SCALAR, s)));
        }
        if reads.reads_rates() && unknowns.horizon().is_some() {
            entries.push((DURATION, 0));
        }
        let step = InputStep::new(&bounded.quantity, model, rest, span);
        entries.extend(step.map(|step| (BEFORE, step.scalar)));
        let reads_inputs = !reads.scalars().is_empty();
        let mut at = match step {
            Some(step) => step.at(),
            None => sites((bounded.when, site), span, reads_inputs),
        };
        if !bounded.when.is_single() {
            let is_open = |k: usize| {
                let mut entries = entries.iter();
                entries.any(|&entry| unknowns.column_of_entry(k, entry).is_some())
            };
            while !at.is_empty() && !is_open(at.start) {
                at.start += 1;
            }
            while !at.is_empty() && !is_open(at.end - 1) {
                at.end -= 1;
            }
        }
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
            scale: scale(bounded, model),
            step,
        };
        first += limit.at.len();
        Some(limit)
    };
    list.iter().zip(&model.measured).filter_map(row).collect()
}

/// Instants or intervals at which a quantity is bounded.
fn sites((when, site): (When, Site), span: Span, reads_inputs: bool) -> Range<usize> {
    let Span {
        end,
        intervals,
        is_closed,
    } = span;
    match (when, site) {
        (When::Goal, Site::Instants) => end..end + 1,
        (When::Goal, Site::Intervals) => end - 1..end,
        (When::At(part), _) => {
            let k = instant_at(part, end) + 1 - site.sides();
            k..k + 1
        }
        // The last instant of a periodic motion is the first one.
        (When::Everywhere | When::Steps, Site::Instants) => 0..end + 1 - usize::from(is_closed),
        (When::Everywhere | When::Steps, Site::Intervals) if reads_inputs => 0..intervals,
        (When::Everywhere | When::Steps, Site::Intervals) => 0..end,
    }
}

/// Factor that brings the values of a quantity near 1.
fn scale(bounded: &BoundedQuantity, model: &Model) -> f64 {
    match bounded.quantity {
        Quantity::JointStep { .. } => {
            let bounds = [bounded.lower, bounded.upper].map(f64::abs).into_iter();
            let finite = bounds.filter(|bound| *bound > 0.0 && bound.is_finite());
            1.0 / finite.reduce(f64::max).unwrap_or(1.0)
        }
        Quantity::MarkerPlace { .. } | Quantity::MarkerStep { .. } => 1.0 / model.length(),
        _ => 1.0,
    }
}

impl Numbering {
    /// Column of an entry of the gradient of a limit at instant or interval k of a horizon.
    pub(super) fn column_of_entry(&self, k: usize, (side, i): (usize, usize)) -> Option<usize> {
        match side {
            SCALAR => self.scalar(k, i),
            BEFORE => self.scalar(self.before(k)?, i),
            DURATION => self.horizon(),
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
    pub(super) fn sides(self) -> usize {
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
    for limit in limits
        .iter()
        .filter(|l| l.site == site && l.at.contains(&k) && l.step.is_none())
    {
        outer[limit.measure] = Outer::linear(costates[limit.first + k - limit.at.start]);
    }
}
