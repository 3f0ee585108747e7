//! Static condensation, symbolic part: groups of equations are eliminated first, with the unknowns that they determine.
//!
//! With states s, their equations (or whatever stands in their place) y and the rest w a system is
//!
//! ```text
//! ⎡ H  Aᵀ Kᵀ ⎤
//! ⎢ A  0  Gᵀ ⎥      A block lower triangular in the order of the groups.
//! ⎣ K  G  M  ⎦
//! ```
//!
//! A group has as many states as equations, or more; those that are left over stay. They and the rest are the **reduced** unknowns.

use crate::kkt::bandwidth_order::{Block, Item, arrange};
use crate::kkt::eliminable_groups;
use crate::kkt::eliminable_groups::Group;
use crate::kkt::fronts::Fronts;
use crate::kkt::graph::{Graph, Pattern, Progress};
use crate::kkt::order::Unknown;
use crate::math::{IsOver, Stopped};
use std::collections::{BTreeMap, BTreeSet};
use std::mem;

/// Multiplications by condensing must be fewer than this part of those along the horizon.
const WORTH: f64 = 0.5;
/// Least part of the unknowns that equations determine.
const SHARE: f64 = 0.2;
const NONE: u32 = u32::MAX;

/// States, their equations and the rest, each numbered by itself.
#[derive(Clone, Debug, Default)]
pub(super) struct Condensation {
    /// Unknown of each state.
    pub(super) states: Vec<u32>,
    /// Unknown of each of their equations.
    pub(super) equations: Vec<u32>,
    /// Unknown of each of the rest: the first reduced unknowns.
    pub(super) rest: Vec<u32>,
    pub(super) blocks: Vec<Block>,
    /// Entries of M, each once.
    pub(super) corner: Vec<Item>,
    /// Entries that must be zero.
    pub(super) zeros: Vec<u32>,
    /// Value to which each entry is added, those of a block and kind side by side and row by row; 0 belongs to no place.
    pub(super) values: Vec<u32>,
    /// Number of values.
    pub(super) count: usize,
    /// Entries that must be zero where the diagonal of equations is not.
    pub(super) exclusive: Vec<u32>,
    /// The reduced system. Its entries are, block by block, one for each pair of `reach` and `weighted`, then M; where equations have a
    /// diagonal, also one for each pair of `weighted` of their blocks.
    pub(super) plans: Vec<Fronts>,
    /// Its entries from pairs that stand on the diagonal, which count twice.
    pub(super) twice: Vec<u32>,
}

/// Kind of an unknown, with the number of its block, and its number among its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum UnknownKind {
    State(usize, u32),
    Equation(usize, u32),
    Rest(u32),
}

impl Condensation {
    /// Condenses a pattern that takes this number of multiplications along the horizon, if that is worth it.
    pub(super) fn new(
        graph: &Graph,
        unknowns: &[Unknown],
        pattern: Pattern<'_>,
        multiplications: f64,
        progress: &mut Progress<'_>,
    ) -> Result<Option<Self>, Stopped> {
        let most = WORTH * multiplications;
        let mut all = Vec::new();
        for choose in [eliminable_groups::constraints, eliminable_groups::squares] {
            progress.add(pattern.len())?;
            let mut groups = choose(graph, unknowns);
            arrange(graph, &mut groups, progress)?;
            let condensed = Self::of_groups(&groups, unknowns, pattern, most, progress)?;
            all.extend(condensed);
        }
        let all = all.into_iter();
        let cheapest = all.min_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(cheapest.map(|(_, condensation)| condensation))
    }

    /// With its multiplications, if these are fewer than `most`.
    fn of_groups(
        groups: &[Group],
        unknowns: &[Unknown],
        pattern: Pattern<'_>,
        most: f64,
        progress: &mut Progress<'_>,
    ) -> Result<Option<(f64, Self)>, Stopped> {
        let determined: usize = groups.iter().map(|group| group.equations.len()).sum();
        if determined == 0 || (determined as f64) < SHARE * unknowns.len() as f64 {
            return Ok(None);
        }
        let mut out = Self::default();
        let kinds = out.number(groups, unknowns.len());
        progress.add(pattern.len())?;
        if !out.sort(&kinds, pattern) {
            return Ok(None);
        }
        let mut kinds: Vec<Unknown> = out.rest.iter().map(|&i| unknowns[i as usize]).collect();
        let Some(of_blocks) = out.reach(unknowns, &mut kinds, most, progress)? else {
            return Ok(None);
        };
        // Without inputs, as where start and goal leave nothing to choose, there is nothing to condense to.
        if kinds.is_empty() {
            return Ok(None);
        }
        out.merge(pattern.len(), progress)?;
        out.reduce(&kinds, progress)?;
        let all = of_blocks + out.plans[0].multiplications();
        Ok((all < most).then_some((all, out)))
    }

    fn number(&mut self, groups: &[Group], count: usize) -> Vec<UnknownKind> {
        let mut kinds = vec![UnknownKind::Rest(NONE); count];
        for (block, group) in groups.iter().enumerate() {
            let (states, equations) = (self.states.len(), self.equations.len());
            for &state in &group.states {
                kinds[state as usize] = UnknownKind::State(block, self.states.len() as u32);
                self.states.push(state);
            }
            for &equation in &group.equations {
                kinds[equation as usize] =
                    UnknownKind::Equation(block, self.equations.len() as u32);
                self.equations.push(equation);
            }
            self.blocks.push(Block {
                states: states..self.states.len(),
                equations: equations..self.equations.len(),
                ..Block::default()
            });
        }
        for (i, kind) in kinds.iter_mut().enumerate() {
            if let UnknownKind::Rest(number) = kind {
                *number = self.rest.len() as u32;
                self.rest.push(i as u32);
            }
        }
        kinds
    }

    /// Gives each entry to a block, and returns true if no equation holds a state of a later group.
    fn sort(&mut self, kinds: &[UnknownKind], pattern: Pattern<'_>) -> bool {
        let mut is_triangular = true;
        for (entry, (row, col)) in pattern.places().enumerate() {
            let (a, b) = (kinds[row as usize], kinds[col as usize]);
            let item = |row, column| Item {
                value: entry as u32,
                row,
                column,
                place: NONE,
            };
            match (a.min(b), a.max(b)) {
                (UnknownKind::State(_, a), UnknownKind::State(block, b)) => {
                    self.blocks[block].curvature.push(item(b, a));
                }
                (UnknownKind::State(of, state), UnknownKind::Equation(block, equation)) => {
                    is_triangular &= of <= block;
                    let list = match of == block {
                        true => &mut self.blocks[block].own,
                        false => &mut self.blocks[block].below,
                    };
                    list.push(item(equation, state));
                }
                (UnknownKind::State(block, state), UnknownKind::Rest(rest)) => {
                    self.blocks[block].coupling.push(item(state, rest));
                }
                (UnknownKind::Equation(block, equation), UnknownKind::Rest(rest)) => {
                    self.blocks[block].inputs.push(item(equation, rest));
                }
                (UnknownKind::Rest(a), UnknownKind::Rest(b)) => self.corner.push(item(a, b)),
                (UnknownKind::Equation(block, a), UnknownKind::Equation(_, b)) if a == b => {
                    self.blocks[block].diagonal.push(item(a, a));
                }
                _ => self.zeros.push(entry as u32),
            }
        }
        self.sort_diagonals();
        self.blocks.iter_mut().for_each(Block::fill);
        is_triangular
    }

    /// Leaves a diagonal to the equations of blocks whose states no later block knows, and that are coupled among themselves by nothing but a
    /// diagonal, which is zero then.
    fn sort_diagonals(&mut self) {
        let block_of = self.block_of();
        let mut bears: Vec<bool> = self.blocks.iter().map(|b| !b.diagonal.is_empty()).collect();
        for (k, block) in self.blocks.iter().enumerate() {
            let earlier = block.below.iter().chain(&block.curvature);
            for item in earlier {
                let other = block_of[item.column as usize];
                bears[other] &= other == k && item.row == item.column;
            }
        }
        for (k, block) in self.blocks.iter_mut().enumerate() {
            if bears[k] {
                let own = block
                    .curvature
                    .iter()
                    .filter(|item| item.row == item.column);
                self.exclusive.extend(own.map(|item| item.value));
            } else {
                let entries = block.diagonal.drain(..).map(|item| item.value);
                self.zeros.extend(entries);
            }
        }
    }

    /// Block of each state.
    fn block_of(&self) -> Vec<usize> {
        let blocks = self.blocks.iter().enumerate();
        let of_block = blocks.flat_map(|(k, block)| block.states.clone().map(move |_| k));
        of_block.collect()
    }

    /// Finds what the states of each block respond to, and appends the states left over to the reduced unknowns; the multiplications of all
    /// blocks, if they are no more than `most`.
    fn reach(
        &mut self,
        unknowns: &[Unknown],
        kinds: &mut Vec<Unknown>,
        most: f64,
        progress: &mut Progress<'_>,
    ) -> Result<Option<f64>, Stopped> {
        let block_of = self.block_of();
        let mut multiplications = 0.0;
        for k in 0..self.blocks.len() {
            let (before, block) = self.blocks.split_at_mut(k);
            let block = &mut block[0];
            progress.add(block.items())?;
            block.reach.clear();
            place_states(&mut block.reach, &mut block.below, before, &block_of);
            block.inherited = block.reach.len();
            place_rest(&mut block.reach, &mut block.inputs);
            for _ in 0..block.free() {
                block.reach.push(kinds.len() as u32);
                kinds.push(unknowns[self.states[block.states.start] as usize]);
            }
            let (mut weighted, mut items) = (Vec::new(), mem::take(&mut block.curvature));
            place_states(&mut weighted, &mut items, &self.blocks[..=k], &block_of);
            let block = &mut self.blocks[k];
            place_rest(&mut weighted, &mut block.coupling);
            (block.weighted, block.curvature) = (weighted, items);
            multiplications += block.multiplications();
            if multiplications > most {
                return Ok(None);
            }
        }
        Ok(Some(multiplications))
    }

    /// Gives the entries at one place one value.
    fn merge(&mut self, entries: usize, progress: &mut Progress<'_>) -> Result<(), Stopped> {
        self.values = vec![0; entries];
        self.count = 1;
        for block in &mut self.blocks {
            progress.add(block.items())?;
            let lists = [
                &mut block.own,
                &mut block.below,
                &mut block.inputs,
                &mut block.curvature,
                &mut block.coupling,
                &mut block.diagonal,
            ];
            for list in lists {
                merge(list, &mut self.values, &mut self.count);
            }
        }
        merge(&mut self.corner, &mut self.values, &mut self.count);
        Ok(())
    }

    /// The plans of the reduced system of these unknowns.
    fn reduce(&mut self, kinds: &[Unknown], progress: &mut Progress<'_>) -> Result<(), Stopped> {
        // Row, column, and whether a pair on the diagonal stands for two.
        let mut pairs = Vec::new();
        for block in &self.blocks {
            progress.add(block.reach.len() * block.weighted.len())?;
            for &row in &block.reach {
                pairs.extend(block.weighted.iter().map(|&column| (row, column, true)));
            }
        }
        let of_corner = self.corner.iter();
        pairs.extend(of_corner.map(|item| (item.row, item.column, false)));
        let plain = pairs.len();
        for block in self.blocks.iter().filter(|b| !b.diagonal.is_empty()) {
            progress.add(block.weighted.len().pow(2))?;
            for (i, &row) in block.weighted.iter().enumerate() {
                let columns = block.weighted[..=i].iter().enumerate();
                pairs.extend(columns.map(|(j, &column)| (row, column, i != j)));
            }
        }
        let rows: Vec<u32> = pairs.iter().map(|pair| pair.0).collect();
        let cols: Vec<u32> = pairs.iter().map(|pair| pair.1).collect();
        let twice = pairs.iter().enumerate();
        let twice = twice.filter(|(_, pair)| pair.0 == pair.1 && pair.2);
        self.twice = twice.map(|(at, _)| at as u32).collect();
        let lengths = match pairs.len() > plain {
            true => vec![plain, pairs.len()],
            false => vec![plain],
        };
        for length in lengths {
            let pattern = Pattern::new(&rows[..length], &cols[..length]);
            let (_, plan) = Fronts::new(kinds.len(), pattern, Some(kinds), progress)?;
            self.plans.push(plan);
        }
        Ok(())
    }
}

/// Sorts items by rows, joins those at one place and numbers the remaining ones; `values` notes the number of each entry.
fn merge(items: &mut Vec<Item>, values: &mut [u32], count: &mut usize) {
    items.sort_unstable_by_key(|item| (item.row, item.column, item.value));
    let mut before = (NONE, NONE);
    items.retain_mut(|item| {
        let is_new = before != (item.row, item.column);
        before = (item.row, item.column);
        *count += usize::from(is_new);
        let number = (*count - 1) as u32;
        values[item.value as usize] = number;
        item.value = number;
        is_new
    });
}

/// Places of the responses of states of `blocks` in a list of columns, which grows where they are not in it side by side.
fn place_states(columns: &mut Vec<u32>, items: &mut [Item], blocks: &[Block], block_of: &[usize]) {
    let met: BTreeSet<usize> = items
        .iter()
        .map(|item| block_of[item.column as usize])
        .collect();
    let mut met: Vec<usize> = met.into_iter().collect();
    // Lists that hold others first.
    met.sort_by_key(|&k| std::cmp::Reverse(blocks[k].reach.len()));
    let places: BTreeMap<usize, u32> = met
        .into_iter()
        .map(|k| (k, place(columns, &blocks[k].reach)))
        .collect();
    for item in items {
        item.place = places[&block_of[item.column as usize]];
    }
}

/// The same of the rest, which responds to itself.
fn place_rest(columns: &mut Vec<u32>, items: &mut [Item]) {
    let met: BTreeSet<u32> = items.iter().map(|item| item.column).collect();
    let places: BTreeMap<u32, u32> = met
        .into_iter()
        .map(|rest| (rest, place(columns, &[rest])))
        .collect();
    for item in items {
        item.place = places[&item.column];
    }
}

fn place(columns: &mut Vec<u32>, list: &[u32]) -> u32 {
    if list.is_empty() {
        return 0;
    }
    let found = columns.windows(list.len()).position(|part| part == list);
    let place = found.unwrap_or_else(|| {
        columns.extend(list);
        columns.len() - list.len()
    });
    place as u32
}

/// Order of elimination, fronts and maps for all matrices of one pattern.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) fronts: Fronts,
    /// Groups that are eliminated first, where that is worth it.
    pub(super) condensation: Option<Condensation>,
}

impl Plan {
    /// A plan for symmetric matrices of `order` unknowns with entries at `rows` and `cols`, in either triangle; entries at
    /// one place are added. `unknowns` gives the kind of each unknown; without it the order is one of approximate minimum degree.
    ///
    /// # Panics
    ///
    /// If lengths or indices contradict each other.
    #[must_use]
    pub fn new(order: usize, rows: &[u32], cols: &[u32], unknowns: Option<&[Unknown]>) -> Self {
        let planned = Self::new_unless(order, rows, cols, unknowns, &|| false);
        planned.expect("nothing stops it")
    }

    /// The same, unless it is stopped; it calls `is_over` every few milliseconds.
    ///
    /// # Errors
    ///
    /// If `is_over` returned true.
    ///
    /// # Panics
    ///
    /// If lengths or indices contradict each other.
    pub fn new_unless(
        order: usize,
        rows: &[u32],
        cols: &[u32],
        unknowns: Option<&[Unknown]>,
        is_over: IsOver<'_>,
    ) -> Result<Self, Stopped> {
        assert_eq!(rows.len(), cols.len(), "as many rows as columns");
        if let Some(unknowns) = unknowns {
            assert_eq!(unknowns.len(), order, "a word on each unknown");
        }
        let is_inside = |list: &[u32]| list.iter().all(|&i| (i as usize) < order);
        assert!(
            is_inside(rows) && is_inside(cols),
            "a matrix of order {order}"
        );
        let progress = &mut Progress::new(is_over);
        let pattern = Pattern::new(rows, cols);
        let (graph, fronts) = Fronts::new(order, pattern, unknowns, progress)?;
        let multiplications = fronts.multiplications();
        let condensation = match unknowns {
            Some(unknowns) => {
                Condensation::new(&graph, unknowns, pattern, multiplications, progress)?
            }
            None => None,
        };
        Ok(Self {
            fronts,
            condensation,
        })
    }

    /// Number of unknowns.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.fronts.order()
    }

    /// Rows and columns of the entries.
    #[must_use]
    pub fn pattern(&self) -> Pattern<'_> {
        self.fronts.pattern()
    }

    /// Multiplications of a factorisation along the horizon without delays.
    #[must_use]
    pub fn multiplications(&self) -> f64 {
        self.fronts.multiplications()
    }
}
