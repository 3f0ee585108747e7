//! The order of elimination: leaves first, then stage by stage, the border last.
//!
//! A system of optimal control is block tridiagonal along the horizon. Eliminated in its order, with each row right behind the last
//! of its variables, the fronts stay as small as one stage. Two kinds of unknowns go before all others, each by itself:
//!
//! * an inequality of one stage and its slack: what it couples the stage has coupled anyway;
//! * variables with few neighbours, no two of them adjacent, such as voltages.
//!
//! Without stages an approximate minimum degree order takes their place (Amestoy, Davis and Duff, 1996; here of `faer`).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::graph::Graph;

/// Most neighbours of a variable that is eliminated by itself.
const LEAF: usize = 12;
/// Stages over which a leaf may reach.
const REACH: u32 = 2;

/// Kind of an unknown of a system, as far as it determines the order of elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// A variable of a stage.
    Variable(u32),
    /// A variable of a stage that is the multiplier of a constraint.
    Multiplier(u32),
    /// A variable that couples all stages, such as a free duration.
    Border,
    /// The slack variable of an inequality.
    Slack,
    /// The multiplier of an equality.
    Equality,
    /// The multiplier of an inequality.
    Inequality,
}

impl Unknown {
    /// The stage of a variable that has one.
    pub(super) const fn stage(self) -> Option<u32> {
        match self {
            Self::Variable(stage) | Self::Multiplier(stage) => Some(stage),
            _ => None,
        }
    }
}

/// An order of elimination.
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    /// Unknown that is eliminated k-th.
    pub(super) order: Vec<u32>,
    /// For each unknown, true if it is eliminated by itself, not together with others.
    pub(super) alone: Vec<bool>,
}

/// The order along the horizon where stages are known. Constraints make a stage sparse, so that minimum degree is better there.
pub(super) fn elimination(graph: &Graph, unknowns: Option<&[Unknown]>) -> Elimination {
    let has_constraints =
        |list: &&[Unknown]| list.iter().any(|one| matches!(one, Unknown::Multiplier(_)));
    match unknowns.filter(|list| !has_constraints(list)) {
        Some(unknowns) => by_stages(graph, unknowns),
        None => by_degree(graph),
    }
}

/// The order along the horizon.
fn by_stages(graph: &Graph, unknowns: &[Unknown]) -> Elimination {
    let n = graph.order();
    let range = |row: usize| {
        let others = graph.neighbours(row).iter();
        let stages = others.filter_map(|&i| unknowns[i as usize].stage());
        stages.fold([u32::MAX, 0], |[low, high], s| [low.min(s), high.max(s)])
    };
    let slack_row = |slack: usize| {
        let rows = graph.neighbours(slack).iter();
        let mut rows = rows.filter(|&&i| unknowns[i as usize] == Unknown::Inequality);
        rows.next().map_or(slack, |&row| row as usize)
    };
    let alone = leaves(graph, unknowns);
    let key = |i: usize| match unknowns[i] {
        Unknown::Variable(_) if alone[i] => Key::new(1, 0, 0, i),
        Unknown::Variable(stage) | Unknown::Multiplier(stage) => Key::new(2, stage, 0, i),
        Unknown::Border => Key::new(3, 0, 0, i),
        Unknown::Slack => {
            let row = slack_row(i);
            Key::of_inequality(range(row), 0, row, i)
        }
        Unknown::Inequality => Key::of_inequality(range(i), 1, i, i),
        Unknown::Equality => Key::new(2, range(i)[1], 1, i),
    };
    let mut keys: Vec<Key> = (0..n).map(key).collect();
    keys.sort_unstable();
    let order = keys.into_iter().map(|key| key.unknown).collect();
    Elimination { order, alone }
}

/// Position in the order: group, stage, then position within it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    group: u64,
    within: u64,
    unknown: u32,
}

impl Key {
    fn new(group: u64, stage: u32, kind: u64, unknown: usize) -> Self {
        Self {
            group: group << 32 | u64::from(stage),
            within: kind << 32,
            unknown: unknown as u32,
        }
    }

    /// The slack of row `row` (part 0) or the row itself (part 1), which go together.
    fn of_inequality(stages: [u32; 2], part: u64, row: usize, unknown: usize) -> Self {
        let [low, high] = stages;
        let is_local = high < low || high - low <= REACH;
        let key = match is_local {
            true => Self::new(0, 0, 0, unknown),
            false => Self::new(2, high, 2, unknown),
        };
        Self {
            within: key.within | (row as u64) << 1 | part,
            ..key
        }
    }
}

/// Variables with few neighbours, no two adjacent. Inequalities do not count: they are gone by then.
fn leaves(graph: &Graph, unknowns: &[Unknown]) -> Vec<bool> {
    let mut is_leaf = vec![false; unknowns.len()];
    let degree = |i: usize| {
        let others = graph.neighbours(i).iter();
        others
            .filter(|&&j| unknowns[j as usize] != Unknown::Inequality)
            .count()
    };
    let is_variable = |i: &usize| matches!(unknowns[*i], Unknown::Variable(_));
    let mut candidates: Vec<(usize, u32)> = (0..unknowns.len())
        .filter(is_variable)
        .map(|i| (degree(i), i as u32))
        .filter(|(degree, _)| *degree <= LEAF)
        .collect();
    candidates.sort_unstable();
    for (_, i) in candidates {
        let mut others = graph.neighbours(i as usize).iter();
        is_leaf[i as usize] = !others.any(|&j| is_leaf[j as usize]);
    }
    is_leaf
}

/// Approximate minimum degree.
fn by_degree(graph: &Graph) -> Elimination {
    let n = graph.order();
    let (starts, neighbours) = graph.lists();
    let mut order = vec![0u32; n];
    let mut inverse = vec![0u32; n];
    let matrix = SymbolicSparseColMatRef::new_checked(n, n, starts, None, neighbours);
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(n, neighbours.len()));
    let stack = MemStack::new(&mut memory);
    let flops = amd::order(
        &mut order,
        &mut inverse,
        matrix,
        amd::Control::default(),
        stack,
    );
    flops.expect("indices fit where the graph fits");
    Elimination {
        order,
        alone: vec![false; n],
    }
}
