//! Limits and goals as rows behind the equations of motion.

use crate::control::limits::{Bounded, Place};
use crate::model::{Model, Quantity};
use std::ops::Range;

/// Where in time a quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Site {
    Instants,
    Intervals,
}

/// A limit or goal on its way to rows.
#[derive(Clone, Debug)]
pub(super) struct LimitRow {
    /// Index among the measures of its site.
    pub(super) measure: usize,
    pub(super) site: Site,
    /// Instants or intervals at which it is a row.
    pub(super) at: Range<usize>,
    /// Its first row among those of all limits.
    pub(super) first: usize,
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Entries of its gradient: (side, entry of z) or (2, scalar).
    pub(super) entries: Vec<(usize, usize)>,
    /// Vectors it reads.
    pub(super) vectors: Vec<usize>,
    pub(super) name: String,
    pub(super) place: Place,
    pub(super) scale: f64,
}

/// Rows of the bounded quantities over a horizon, with the entries their gradients have. Path limits end before the final
/// instant where the goal gives all its coordinates.
pub(super) fn limit_rows(
    model: &Model,
    list: &[Bounded],
    intervals: usize,
    final_is_given: bool,
) -> Vec<LimitRow> {
    let motion = &model.action.motion;
    let mut next = [0, 0];
    let mut first = 0;
    let row = |bounded: &Bounded| {
        let (site, sum) = if bounded.quantity.is_of_intervals() {
            (Site::Intervals, &model.action.intervals)
        } else {
            (Site::Instants, &model.action.instants)
        };
        let counter = &mut next[site as usize];
        let measure = *counter;
        *counter += 1;
        let reads = &sum.measures[measure];
        let mut support: Vec<usize> = reads
            .vectors()
            .iter()
            .flat_map(|&v| motion.support(v))
            .collect();
        support.sort_unstable();
        support.dedup();
        let at = match (bounded.place, site) {
            (Place::Goal, Site::Instants) => intervals..intervals + 1,
            (Place::Goal, Site::Intervals) => intervals - 1..intervals,
            (Place::Everywhere, Site::Intervals) => 0..intervals,
            (Place::Everywhere, Site::Instants) => 1..intervals + usize::from(!final_is_given),
        };
        let sides = 0..site.sides();
        let mut entries: Vec<(usize, usize)> = sides
            .flat_map(|side| support.iter().map(move |&i| (side, i)))
            .collect();
        if site == Site::Intervals {
            entries.extend(reads.scalars().into_iter().map(|s| (2, s)));
        }
        let scale = match bounded.quantity {
            Quantity::MarkerPlace { .. } | Quantity::MarkerStep { .. } => 1.0 / model.length(),
            _ => 1.0,
        };
        let limit = LimitRow {
            measure,
            site,
            first,
            at,
            lower: bounded.lower,
            upper: bounded.upper,
            entries,
            vectors: reads.vectors(),
            name: bounded.name.clone(),
            place: bounded.place,
            scale,
        };
        first += limit.at.len();
        limit
    };
    list.iter().map(row).collect()
}

impl Site {
    /// How many instants a quantity of the site reads.
    pub(super) fn sides(self) -> usize {
        match self {
            Self::Instants => 1,
            Self::Intervals => 2,
        }
    }
}

/// Weights of the measures of one site at instant or interval k: the costates of their rows.
pub(super) fn fill_weights(
    weights: &mut [f64],
    limits: &[LimitRow],
    site: Site,
    k: usize,
    costates: &[f64],
) {
    weights.fill(0.0);
    for limit in limits
        .iter()
        .filter(|l| l.site == site && l.at.contains(&k))
    {
        weights[limit.measure] = costates[limit.first + k - limit.at.start];
    }
}
