//! The order of the equations of a group and of their unknowns, so that factors have entries near the diagonal only.
//!
//! Equations that share an unknown are neighbours. They are taken in the order of Cuthill and McKee (1969) from one that lies at an end, and
//! unknowns in the order in which they appear in them.
//!
//! Envelope of the factors of a block: entries that may be nonzero, whatever unknowns are exchanged.
//!
//! Equations are eliminated one after the other, and unknowns stand in the order in which they first appear. An exchange for the pivot of an
//! equation is then one with an unknown that has appeared before, or appears in it; what it brings reaches no further than the last equation
//! in which one of these appears. Columns of Aᵀ, one for each equation, are taken in panels, each with one such rectangle.

use super::eliminable_groups::Group;
use super::graph::{Graph, Progress};
use crate::math::Stopped;
use std::ops::Range;

const NONE: u32 = u32::MAX;

/// Incidence of the equations of a group and its unknowns.
struct Arrangement<'a> {
    graph: &'a Graph,
    group: &'a Group,
    /// Number of each unknown of the graph among those of the group, and among its equations.
    state_of: &'a [u32],
    equation_of: &'a [u32],
    /// The last search that met an equation, and an unknown.
    met: Vec<u32>,
    seen: Vec<u32>,
    search: u32,
}

/// Brings the equations and unknowns of all groups in order.
pub(super) fn arrange(
    graph: &Graph,
    groups: &mut [Group],
    progress: &mut Progress<'_>,
) -> Result<(), Stopped> {
    let mut state_of = vec![NONE; graph.order()];
    let mut equation_of = vec![NONE; graph.order()];
    for group in groups {
        number(&mut state_of, &group.states);
        number(&mut equation_of, &group.equations);
        let arranged = Arrangement {
            graph,
            group,
            state_of: &state_of,
            equation_of: &equation_of,
            met: vec![0; group.equations.len()],
            seen: vec![0; group.states.len()],
            search: 0,
        }
        .run(progress)?;
        for &i in &group.states {
            state_of[i as usize] = NONE;
        }
        for &i in &group.equations {
            equation_of[i as usize] = NONE;
        }
        *group = arranged;
    }
    Ok(())
}

fn number(numbers: &mut [u32], list: &[u32]) {
    for (number, &i) in list.iter().enumerate() {
        numbers[i as usize] = number as u32;
    }
}

impl Arrangement<'_> {
    fn run(mut self, progress: &mut Progress<'_>) -> Result<Group, Stopped> {
        let count = self.group.equations.len();
        let mut is_done = vec![false; count];
        let mut order = Vec::with_capacity(count);
        for first in 0..count as u32 {
            if is_done[first as usize] {
                continue;
            }
            // What lies farthest from anywhere, then farthest from there, lies at an end.
            let found = self.search(first, progress)?;
            let farthest = *found.last().expect("the first is found");
            let found = self.search(farthest, progress)?;
            let end = *found.last().expect("the first is found");
            let part = self.search(end, progress)?;
            part.iter().for_each(|&i| is_done[i as usize] = true);
            order.extend(part);
        }
        let mut states: Vec<u32> = Vec::with_capacity(self.group.states.len());
        let mut is_taken = vec![false; self.group.states.len()];
        let mut take = |state: u32| {
            if !std::mem::replace(&mut is_taken[state as usize], true) {
                states.push(self.group.states[state as usize]);
            }
        };
        for &equation in &order {
            self.states(equation).for_each(&mut take);
        }
        (0..self.group.states.len() as u32).for_each(take);
        Ok(Group {
            states,
            equations: self.of_group(&order),
        })
    }

    fn of_group(&self, order: &[u32]) -> Vec<u32> {
        let equations = &self.group.equations;
        order.iter().map(|&i| equations[i as usize]).collect()
    }

    /// Unknowns of an equation.
    fn states(&self, equation: u32) -> impl Iterator<Item = u32> {
        let unknown = self.group.equations[equation as usize];
        let others = self.graph.neighbours(unknown as usize).iter();
        let states = others.map(|&i| self.state_of[i as usize]);
        states.filter(|&state| state != NONE)
    }

    /// Equations of an unknown.
    fn equations(&self, state: u32) -> impl Iterator<Item = u32> {
        let unknown = self.group.states[state as usize];
        let others = self.graph.neighbours(unknown as usize).iter();
        let equations = others.map(|&i| self.equation_of[i as usize]);
        equations.filter(|&equation| equation != NONE)
    }

    /// All equations that are connected with one, by their distance from it, those with few unknowns first.
    fn search(&mut self, first: u32, progress: &mut Progress<'_>) -> Result<Vec<u32>, Stopped> {
        self.search += 1;
        let search = self.search;
        let mut order = vec![first];
        self.met[first as usize] = search;
        let mut next = 0;
        while next < order.len() {
            let equation = order[next];
            let begin = order.len();
            let states: Vec<u32> = self.states(equation).collect();
            progress.add(states.len().pow(2))?;
            for state in states {
                if std::mem::replace(&mut self.seen[state as usize], search) == search {
                    continue;
                }
                let others: Vec<u32> = self.equations(state).collect();
                for other in others {
                    if std::mem::replace(&mut self.met[other as usize], search) != search {
                        order.push(other);
                    }
                }
            }
            order[begin..].sort_by_key(|&other| self.states(other).count());
            next += 1;
        }
        Ok(order)
    }
}

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

#[cfg(test)]
#[path = "../../tests/units/kkt/bandwidth_order.rs"]
mod tests;
