//! The tree of fronts: the rows that each one eliminates, the later rows that it updates, and the positions of its numbers.

use std::ops::Range;

use crate::math::compact_index;
use crate::sparse::dissection::{Dissection, DissectionPart};
use crate::sparse::pattern::Pattern;

/// Columns of a front whose products with their pivots are in memory at once.
pub(super) const STRIP: usize = 256;
/// Multiplications below which a second core is not worth being woken: some milliseconds.
const MUCH: f64 = 1e8;
/// Two parts are worked on at once where each has more than this part of all multiplications.
const SHARE: f64 = 1.0 / 8.0;

/// A front: a dense matrix with the rows that it eliminates first and those that it updates after them.
#[derive(Debug)]
pub(super) struct Front {
    /// Number of rows that it eliminates.
    pub(super) own: usize,
    /// Later rows that it updates, as places in the order of elimination, ascending.
    pub(super) boundary: Vec<u32>,
    /// Positions of these rows in the front that takes the update.
    pub(super) above: Vec<u32>,
    /// Fronts whose updates it takes.
    pub(super) sides: Option<Sides>,
    /// First row of its subtree.
    pub(super) first: usize,
    /// Values of the matrix that enter it: (slot, place in the panel).
    pub(super) entries: Range<usize>,
    /// Numbers of its panel and of those of its subtree.
    pub(super) panels: usize,
    /// Rows that its subtree updates, each front counted by itself.
    pub(super) updates: usize,
    /// Numbers that its subtree needs in passing, while it is factorised.
    pub(super) space: usize,
}

/// The two fronts below a front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub(super) fronts: [usize; 2],
    /// Offset at which the space of the second one begins.
    pub(super) second: usize,
    /// True if both are worked on in parallel; it follows from the pattern alone.
    pub(super) at_once: bool,
}

impl Front {
    /// Rows of the front.
    pub(super) fn rows(&self) -> usize {
        self.own + self.boundary.len()
    }

    /// Numbers of the panel: the columns that are eliminated, with all their rows.
    pub(super) fn panel(&self) -> usize {
        self.rows() * self.own
    }

    /// Numbers of the update while it is computed.
    pub(super) fn square(&self) -> usize {
        self.boundary.len().pow(2)
    }

    /// Numbers of the update as it waits: its lower triangle, column by column.
    pub(super) fn triangle(&self) -> usize {
        self.boundary.len() * (self.boundary.len() + 1) / 2
    }

    /// Numbers of the products of columns with their pivots.
    pub(super) fn strip(&self) -> usize {
        self.boundary.len() * self.own.min(STRIP)
    }

    fn multiplications(&self) -> f64 {
        (self.rows() as f64).powi(2) * self.own as f64
    }
}

/// All fronts, each after those below it; the last one updates nothing.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) fronts: Vec<Front>,
    /// Place of each row in the order of elimination.
    pub(super) places: Vec<usize>,
    /// (slot of the pattern, place in the panel), front by front.
    pub(super) entries: Vec<(u32, u32)>,
}

impl Tree {
    /// For a symmetric pattern.
    ///
    /// # Panics
    /// The pattern or a front is too large to be counted.
    pub(super) fn new(pattern: &Pattern, dissection: &Dissection) -> Self {
        let Dissection { order, parts } = dissection;
        let (mut places, mut of_place) = (vec![0; order.len()], vec![0; order.len()]);
        for (place, &row) in order.iter().enumerate() {
            places[row] = place;
        }
        for (f, part) in parts.iter().enumerate() {
            of_place[part.own.clone()].fill(f);
        }
        let mut tree = Self {
            fronts: Vec::with_capacity(parts.len()),
            places,
            entries: Vec::with_capacity(pattern.rows.len()),
        };
        let slots = tree.slots_by_front(pattern, &of_place, parts.len());
        let mut work = Vec::with_capacity(parts.len());
        for (part, slots) in parts.iter().zip(&slots) {
            let front = tree.front(part, slots);
            let below: f64 = front.sides.map_or(0.0, |sides| {
                sides.fronts.into_iter().map(|side| work[side]).sum()
            });
            work.push(front.multiplications() + below);
            tree.fronts.push(front);
        }
        tree.share_out(&work);
        tree
    }

    /// Slots of the matrix as (slot, earlier place, later place), for the front that eliminates the earlier one.
    fn slots_by_front(
        &self,
        pattern: &Pattern,
        of_place: &[usize],
        fronts: usize,
    ) -> Vec<Vec<[u32; 3]>> {
        let mut by_front = vec![Vec::new(); fronts];
        for col in 0..pattern.size {
            for slot in pattern.slots(col) {
                let pair = [self.places[pattern.rows[slot]], self.places[col]];
                let [earlier, later] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
                by_front[of_place[earlier]].push([slot, earlier, later].map(compact_index));
            }
        }
        by_front
    }

    /// The front of a part whose sides have theirs; its space is not known yet.
    fn front(&mut self, part: &DissectionPart, slots: &[[u32; 3]]) -> Front {
        let Range { start, end } = part.own;
        let is_later = |place: &u32| *place as usize >= end;
        let mut boundary: Vec<u32> = slots.iter().map(|&[.., later]| later).collect();
        for side in part.sides.into_iter().flatten() {
            boundary.extend(&self.fronts[side].boundary);
        }
        boundary.retain(is_later);
        boundary.sort_unstable();
        boundary.dedup();
        let own = end - start;
        let within = |place: u32| match boundary.binary_search(&place) {
            Ok(i) => own + i,
            Err(_) => place as usize - start,
        };
        let rows = own + boundary.len();
        let first_entry = self.entries.len();
        for &[slot, earlier, later] in slots {
            let place = within(later) + rows * (earlier as usize - start);
            self.entries.push((slot, compact_index(place)));
        }
        let [mut first, mut panels, mut updates] = [start, rows * own, boundary.len()];
        for side in part.sides.into_iter().flatten() {
            let side = &mut self.fronts[side];
            side.above = side
                .boundary
                .iter()
                .map(|&b| compact_index(within(b)))
                .collect();
            first = first.min(side.first);
            panels += side.panels;
            updates += side.updates;
        }
        Front {
            own,
            above: Vec::new(),
            sides: part.sides.map(|fronts| Sides {
                fronts,
                second: 0,
                at_once: false,
            }),
            first,
            entries: first_entry..self.entries.len(),
            panels,
            updates,
            space: 0,
            boundary,
        }
    }

    /// Decides which parts are worked on at once, and where their numbers stand in passing.
    fn share_out(&mut self, work: &[f64]) {
        let all = work.last().copied().unwrap_or_default();
        let is_much = |side: usize| work[side] > MUCH.max(SHARE * all);
        for f in 0..self.fronts.len() {
            let front = &self.fronts[f];
            let own = front.square() + front.strip();
            let (sides, space) = match front.sides {
                None => (None, own),
                Some(Sides { fronts, .. }) => {
                    let [a, b] = fronts.map(|side| &self.fronts[side]);
                    let at_once = fronts.into_iter().all(is_much);
                    let second = if at_once { a.space } else { a.triangle() };
                    let both = a.space.max(second + b.space);
                    let sides = Sides {
                        fronts,
                        second,
                        at_once,
                    };
                    (Some(sides), both.max(second + b.triangle() + own))
                }
            };
            self.fronts[f].sides = sides;
            self.fronts[f].space = space;
        }
    }

    /// The last front, which holds all others.
    pub(super) fn whole(&self) -> &Front {
        self.fronts.last().expect("a front")
    }
}
