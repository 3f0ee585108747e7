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
mod tests {
    use std::collections::BTreeSet;

    use crate::sparse::Symmetry;
    use crate::sparse::dissection::Dissection;
    use crate::sparse::pattern::Pattern;

    /// A box of nodes with two unknowns each, coupled to all nodes around them, and one unknown without a place, coupled to all.
    fn grid(nodes: [usize; 3]) -> (Pattern, Vec<Option<[f64; 3]>>) {
        let [nx, ny, nz] = nodes;
        let triples = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
        let triples: Vec<_> = triples.collect();
        let mut entries = Vec::new();
        for (a, p) in triples.iter().enumerate() {
            for (b, q) in triples.iter().enumerate() {
                if (0..3).all(|axis| p[axis].abs_diff(q[axis]) <= 1) {
                    let couple = |i, j| (1 + 2 * a + i, 1 + 2 * b + j);
                    entries.extend([couple(0, 0), couple(0, 1), couple(1, 0), couple(1, 1)]);
                }
            }
            entries.extend([(1 + 2 * a, 0), (2 + 2 * a, 0)]);
        }
        entries.push((0, 0));
        let place = |p: &[usize; 3]| Some([p[0] as f64, 1.5 * p[1] as f64, p[2] as f64 * 2.0]);
        let mut places = vec![None];
        places.extend(triples.iter().flat_map(|p| [place(p); 2]));
        let size = places.len();
        (
            Pattern::new(size, entries.into_iter(), Symmetry::Symmetric),
            places,
        )
    }

    /// Numbers below the diagonal of the factor, by elimination of one unknown after the other.
    fn fill(pattern: &Pattern, order: &[usize]) -> usize {
        let mut neighbours = vec![BTreeSet::new(); pattern.size];
        for col in 0..pattern.size {
            for &row in &pattern.rows[pattern.slots(col)] {
                if row != col {
                    neighbours[row].insert(col);
                    neighbours[col].insert(row);
                }
            }
        }
        let mut count = 0;
        for &eliminated in order {
            let around = std::mem::take(&mut neighbours[eliminated]);
            count += around.len();
            for &i in &around {
                neighbours[i].extend(around.iter().filter(|&&j| j != i));
                neighbours[i].remove(&eliminated);
            }
        }
        count
    }

    #[test]
    fn the_middle_plane_across_the_longest_direction_comes_last() {
        let (pattern, places) = grid([3, 4, 9]);
        let Dissection { order, parts } = Dissection::new(&pattern, &places);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..pattern.size));
        assert_eq!(order.last(), Some(&0), "what has no place");
        let plane = &order[pattern.size - 1 - 2 * 12..pattern.size - 1];
        assert!(plane.iter().all(|&row| places[row].unwrap()[2] == 8.0));
        let whole = parts.last().unwrap();
        assert_eq!(whole.own, pattern.size - 1 - 2 * 12..pattern.size);
        assert_eq!(whole.sides.unwrap()[1], parts.len() - 2);
    }

    #[test]
    fn dissection_leaves_less_fill_than_the_order_of_the_nodes() {
        let (pattern, places) = grid([6, 6, 6]);
        let by_nodes: Vec<usize> = (1..pattern.size).chain([0]).collect();
        let [cut, band] = [Dissection::new(&pattern, &places).order, by_nodes]
            .map(|order| fill(&pattern, &order));
        assert!(10 * cut < 9 * band, "{cut} {band}");
    }
}
