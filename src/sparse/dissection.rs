//! Nested dissection by places: an order of elimination with little fill for unknowns that have places in space.
//!
//! The unknowns of a place are one vertex. A plane cuts the vertices in halves; those behind it that have neighbours before it
//! separate the two sides and are eliminated after them, and both sides are cut again (A. George, SIAM J. Numer. Anal. 10, 1973).
//! Of the three directions the one with the smallest separator is taken. Unknowns without a place, which may be coupled to any
//! other, come last.
//!
//! The parts make a tree: what two sides eliminate does not meet before the rows that separate them.

use std::collections::HashMap;
use std::ops::Range;

use rustc_hash::FxBuildHasher;

use crate::sparse::pattern::Pattern;

/// A part of so few vertices is not cut.
const LEAF: usize = 27;
/// Sides of a cut are of similar size where the smaller one is larger than this part of the other.
const EVEN: f64 = 0.3;

/// Place in space of each row, where it has one.
pub type Places = [Option<[f64; 3]>];

/// An order of elimination and its parts.
#[derive(Debug)]
pub(crate) struct Dissection {
    /// Rows in the order of elimination.
    pub(crate) order: Vec<usize>,
    /// Each part after its sides; the last one is the whole.
    pub(crate) parts: Vec<DissectionPart>,
}

/// A part of the unknowns: its two sides and what separates them, or unknowns that were not cut.
#[derive(Debug)]
pub(crate) struct DissectionPart {
    /// Range of the order that holds the rows of the separator, or of the part that was not cut.
    pub(crate) own: Range<usize>,
    /// The parts before and behind the cut.
    pub(crate) sides: Option<[usize; 2]>,
}

impl Dissection {
    /// Of the rows of a symmetric pattern.
    pub(crate) fn new(pattern: &Pattern, places: &Places) -> Self {
        let graph = Graph::new(pattern, places);
        let mut dissection = Self {
            order: Vec::with_capacity(pattern.size),
            parts: Vec::new(),
        };
        let mut side = vec![Side::Outside; graph.places.len()];
        let mut vertices: Vec<usize> = (0..graph.places.len()).collect();
        let whole = graph.dissect(&mut vertices, &mut side, &mut dissection);
        let last = (0..pattern.size).filter(|&row| places[row].is_none());
        dissection.order.extend(last);
        dissection.parts[whole].own.end = pattern.size;
        dissection
    }

    /// Appends a part with these rows of its own.
    fn push(&mut self, sides: Option<[usize; 2]>, rows: impl Iterator<Item = usize>) -> usize {
        let start = self.order.len();
        self.order.extend(rows);
        self.parts.push(DissectionPart {
            own: start..self.order.len(),
            sides,
        });
        self.parts.len() - 1
    }
}

/// Side of the cut on which a vertex lies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Outside,
    Before,
    Behind,
}

/// A cut: vertices before it, behind it, and between them.
struct Cut {
    before: Vec<usize>,
    behind: Vec<usize>,
    between: Vec<usize>,
}

impl Cut {
    /// Returns true if the sides are of similar size.
    fn is_even(&self) -> bool {
        let [before, behind] = [&self.before, &self.behind].map(Vec::len);
        before.min(behind) as f64 > EVEN * before.max(behind) as f64
    }
}

/// Vertices and their neighbours.
struct Graph {
    places: Vec<[f64; 3]>,
    rows: Vec<Vec<usize>>,
    /// Neighbours of vertex `v` begin at `starts[v]`.
    starts: Vec<usize>,
    neighbours: Vec<usize>,
}

impl Graph {
    fn new(pattern: &Pattern, places: &Places) -> Self {
        let (mut of_place, mut vertex) = (HashMap::with_hasher(FxBuildHasher), Vec::new());
        let mut rows: Vec<Vec<usize>> = Vec::new();
        let mut distinct = Vec::new();
        for (row, place) in places.iter().enumerate() {
            vertex.push(place.map(|place| {
                let v = *of_place
                    .entry(place.map(f64::to_bits))
                    .or_insert(rows.len());
                if v == rows.len() {
                    rows.push(Vec::new());
                    distinct.push(place);
                }
                rows[v].push(row);
                v
            }));
        }
        let mut pairs = Vec::new();
        for col in 0..pattern.size {
            for slot in pattern.slots(col) {
                if let (Some(a), Some(b)) = (vertex[pattern.rows[slot]], vertex[col])
                    && a != b
                {
                    pairs.extend([(a, b), (b, a)]);
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0; rows.len() + 1];
        for &(a, _) in &pairs {
            starts[a + 1] += 1;
        }
        for v in 0..rows.len() {
            starts[v + 1] += starts[v];
        }
        Self {
            places: distinct,
            rows,
            starts,
            neighbours: pairs.into_iter().map(|(_, b)| b).collect(),
        }
    }

    /// Appends some vertices as a part; `side` is outside for all before and after.
    fn dissect(&self, vertices: &mut [usize], side: &mut [Side], to: &mut Dissection) -> usize {
        let mut best: Option<Cut> = None;
        let axes = if vertices.len() > LEAF { 0..3 } else { 0..0 };
        for cut in axes.filter_map(|axis| self.cut(vertices, axis, side)) {
            let rank = |cut: &Cut| (!cut.is_even(), cut.between.len());
            if best.as_ref().is_none_or(|best| rank(&cut) < rank(best)) {
                best = Some(cut);
            }
        }
        let Some(mut cut) = best else {
            return to.push(None, self.rows_of(vertices));
        };
        let sides = [&mut cut.before, &mut cut.behind].map(|part| self.dissect(part, side, to));
        to.push(Some(sides), self.rows_of(&cut.between))
    }

    fn rows_of<'a>(&'a self, vertices: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
        vertices.iter().flat_map(|&v| self.rows[v].iter().copied())
    }

    /// Cuts across an axis at the median; `None` where all vertices have one place along it.
    fn cut(&self, vertices: &mut [usize], axis: usize, side: &mut [Side]) -> Option<Cut> {
        let at = |v: usize| self.places[v][axis];
        vertices.sort_unstable_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let (&first, &median) = (vertices.first()?, &vertices[vertices.len() / 2]);
        let plane = match at(median) > at(first) {
            true => at(median),
            false => vertices.iter().map(|&v| at(v)).find(|&x| x > at(first))?,
        };
        let behind = vertices.partition_point(|&v| at(v) < plane);
        let (before, behind) = vertices.split_at(behind);
        before.iter().for_each(|&v| side[v] = Side::Before);
        behind.iter().for_each(|&v| side[v] = Side::Behind);
        let neighbours = |v: usize| &self.neighbours[self.starts[v]..self.starts[v + 1]];
        let separates = |&v: &usize| neighbours(v).iter().any(|&n| side[n] == Side::Before);
        let (between, rest) = behind.iter().partition(|v| separates(v));
        let cut = Cut {
            before: before.to_vec(),
            behind: rest,
            between,
        };
        vertices.iter().for_each(|&v| side[v] = Side::Outside);
        Some(cut)
    }
}

#[cfg(test)]
#[path = "../../tests/units/sparse/dissection.rs"]
mod tests;
