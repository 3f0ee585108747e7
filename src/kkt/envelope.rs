//! Envelope of the factors of a block: entries that may be nonzero, whatever unknowns are exchanged.
//!
//! Equations are eliminated one after the other, and unknowns stand in the order in which they first appear. An exchange for the pivot of an
//! equation is then one with an unknown that has appeared before, or appears in it; what it brings reaches no further than the last equation
//! in which one of these appears. Columns of Aᵀ, one for each equation, are taken in panels, each with one such rectangle.

use std::ops::Range;

/// Equations of a panel, where there are several.
const WIDTH: usize = 32;
/// Several panels must take less than this part of the multiplications of a single one.
const WORTH: f64 = 0.5;

/// Equations one behind the other.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) equations: Range<usize>,
    /// First row with an entry, and the one behind the last.
    pub(super) rows: Range<usize>,
    /// The equation behind the last to which eliminations of this panel add.
    pub(super) end: usize,
}

impl Panel {
    fn width(&self) -> usize {
        self.equations.len()
    }

    /// Rows that are left when the panel begins.
    pub(super) fn height(&self) -> usize {
        self.rows.end - self.equations.start
    }

    /// Multiplications to eliminate its equations.
    fn of_factors(&self) -> usize {
        let (width, height) = (self.width(), self.height());
        width * width * (3 * height - width) / 6
            + width * (2 * height - width) * (self.end - self.equations.end) / 2
    }

    /// Multiplications for one right-hand side.
    fn of_solution(&self) -> usize {
        self.width() * self.rows.len()
    }
}

/// The panels of a block, and how its columns are stored: `stride` numbers apart, so that they overlap where they hold nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Envelope {
    pub(super) equations: usize,
    pub(super) unknowns: usize,
    pub(super) panels: Vec<Panel>,
    pub(super) stride: usize,
}

impl Envelope {
    /// That of a block with entries at these pairs of an equation and an unknown.
    pub(super) fn new(
        equations: usize,
        unknowns: usize,
        entries: impl Iterator<Item = (usize, usize)>,
    ) -> Self {
        // Unknowns that have appeared, by equations, and the equation behind the last of each unknown, and of those before it.
        let mut appeared = vec![0; equations];
        let mut last = vec![0; unknowns];
        for (equation, unknown) in entries {
            appeared[equation] = appeared[equation].max(unknown + 1);
            last[unknown] = last[unknown].max(equation + 1);
        }
        running_maximum(&mut appeared);
        running_maximum(&mut last);
        let of_width = |width: usize| {
            let mut out = Self {
                equations,
                unknowns,
                ..Self::default()
            };
            for start in (0..equations).step_by(width) {
                let end = equations.min(start + width);
                let rows = appeared[end - 1].max(end);
                let before = out.panels.iter().find(|panel| panel.end > start);
                out.panels.push(Panel {
                    equations: start..end,
                    rows: before.map_or(start, |panel| panel.equations.start)..rows,
                    end: last[rows - 1].max(end),
                });
            }
            let heights = out.panels.iter().map(|panel| panel.rows.len());
            out.stride = heights.max().unwrap_or(0);
            out
        };
        let (one, several) = (of_width(equations.max(1)), of_width(WIDTH));
        match (several.of_factors() as f64) < WORTH * one.of_factors() as f64 {
            true => several,
            false => one,
        }
    }

    /// Multiplications to factor the block.
    pub(super) fn of_factors(&self) -> usize {
        self.panels.iter().map(Panel::of_factors).sum()
    }

    /// Multiplications for one right-hand side.
    pub(super) fn of_solution(&self) -> usize {
        self.panels.iter().map(Panel::of_solution).sum()
    }

    /// Numbers that are stored.
    pub(super) fn len(&self) -> usize {
        match self.panels.last() {
            Some(panel) => self.stride * (self.equations - 1) + panel.rows.end,
            None => 0,
        }
    }
}

fn running_maximum(numbers: &mut [usize]) {
    for i in 1..numbers.len() {
        numbers[i] = numbers[i].max(numbers[i - 1]);
    }
}

/// An entry of one of the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// Its number among the values; before these are known, among the entries.
    pub(super) value: u32,
    pub(super) row: u32,
    pub(super) column: u32,
    /// Offset of the response of the column among the columns of the block.
    pub(super) place: u32,
}

/// One group. States and equations are counted through all groups, reduced unknowns by themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) states: Range<usize>,
    pub(super) equations: Range<usize>,
    /// Reduced unknowns to which its states respond: by way of earlier groups, directly, and the states that are left over.
    pub(super) reach: Vec<u32>,
    /// Number of those that come by way of earlier groups.
    pub(super) inherited: usize,
    /// Reduced unknowns of the columns of H S + Kᵀ.
    pub(super) weighted: Vec<u32>,
    /// Entries of A: of its own states, with what their factors fill, and of earlier ones.
    pub(super) own: Vec<Item>,
    pub(super) envelope: Envelope,
    pub(super) below: Vec<Item>,
    /// Entries of Gᵀ, column one of the rest.
    pub(super) inputs: Vec<Item>,
    /// Entries of H, each once: row a state of the group, column one of its own or of an earlier one.
    pub(super) curvature: Vec<Item>,
    /// Entries of Kᵀ, column one of the rest.
    pub(super) coupling: Vec<Item>,
    /// Entries on the diagonal of its equations, where the states of the group bear that.
    pub(super) diagonal: Vec<Item>,
}

impl Block {
    /// States that are left over.
    pub(super) fn free(&self) -> usize {
        self.states.len() - self.equations.len()
    }

    /// Finds what its factors fill.
    pub(super) fn fill(&mut self) {
        let (equation, state) = (self.equations.start, self.states.start);
        let entries = self.own.iter();
        let entries =
            entries.map(|item| (item.row as usize - equation, item.column as usize - state));
        self.envelope = Envelope::new(self.equations.len(), self.states.len(), entries);
    }

    /// Number of its entries.
    pub(super) fn items(&self) -> usize {
        let lists = [
            &self.own,
            &self.below,
            &self.inputs,
            &self.curvature,
            &self.coupling,
            &self.diagonal,
        ];
        lists.iter().map(|list| list.len()).sum()
    }

    pub(super) fn multiplications(&self) -> f64 {
        let (n, items) = (
            self.states.len(),
            2 * self.curvature.len() + self.below.len(),
        );
        let (reach, weighted) = (self.reach.len() as f64, self.weighted.len() as f64);
        let (of_factors, of_one) = (self.envelope.of_factors(), self.envelope.of_solution());
        of_factors as f64 + reach * ((of_one + items) as f64 + n as f64 * weighted)
    }
}
