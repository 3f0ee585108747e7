//! Which unknowns may be condensed: states that equations determine stage by stage.
//!
//! Where a stage has as many equations as variables, and these equations reach no later stage, they determine its states from earlier
//! ones and from the rest: inputs, multipliers of further equations, a free duration. With states s, multipliers y of their equations and the rest w
//!
//! ```text
//! ⎡ H  Aᵀ Kᵀ ⎤
//! ⎢ A  0  Gᵀ ⎥      A block lower triangular along the horizon.
//! ⎣ K  G  M  ⎦
//! ```

use std::ops::Range;

use super::order::Unknown;

/// Multiplications by condensing must be fewer than this part of those along the horizon.
const WORTH: f64 = 0.5;

/// An entry of one of the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// Its number among the entries.
    pub(super) entry: u32,
    pub(super) row: u32,
    pub(super) column: u32,
}

/// States, their equations and the rest, each numbered by itself; a state and its equation have one number.
#[derive(Clone, Debug, Default)]
pub(super) struct Condensation {
    /// Unknown of each state.
    pub(super) states: Vec<u32>,
    /// Unknown of each of their equations.
    pub(super) equations: Vec<u32>,
    /// Unknown of each of the rest.
    pub(super) rest: Vec<u32>,
    /// States of each stage.
    pub(super) stages: Vec<Range<usize>>,
    /// How many of the rest, the first ones, reach the states of each stage.
    pub(super) reach: Vec<usize>,
    /// Entries of A within its diagonal blocks, and below them, by the stage of the row.
    pub(super) diagonal: Vec<Vec<Item>>,
    pub(super) below: Vec<Vec<Item>>,
    /// Entries of −G, row an equation.
    pub(super) inputs: Vec<Vec<Item>>,
    /// Entries of H, each once.
    pub(super) curvature: Vec<Item>,
    /// Entries of K, row one of the rest.
    pub(super) coupling: Vec<Item>,
    /// Entries of M, each once, row not before the column.
    pub(super) corner: Vec<Item>,
    /// Entries that must be zero.
    pub(super) zeros: Vec<u32>,
}

/// What an unknown is, with its number among its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    State(u32),
    Equation(u32),
    Rest(u32),
}

impl Condensation {
    /// What may be condensed of a pattern that takes so many multiplications along the horizon, if that is worth it.
    pub(super) fn new(
        unknowns: &[Unknown],
        rows: &[u32],
        cols: &[u32],
        multiplications: f64,
    ) -> Option<Self> {
        let mut condensation = Self::default();
        let kinds = condensation.classify(unknowns, rows, cols);
        condensation.sort(&kinds, rows, cols);
        let worth = condensation.multiplications() < WORTH * multiplications;
        // Without inputs, as where start and goal leave nothing to choose, there is nothing to condense to.
        let has_both = !condensation.states.is_empty() && !condensation.rest.is_empty();
        (worth && has_both).then_some(condensation)
    }

    fn classify(&mut self, unknowns: &[Unknown], rows: &[u32], cols: &[u32]) -> Vec<Kind> {
        let last = last_stages(unknowns, rows, cols);
        let stages = unknowns.iter().filter_map(|unknown| match unknown {
            Unknown::Variable(stage) => Some(*stage as usize + 1),
            _ => None,
        });
        let count = stages.max().unwrap_or(0);
        let (mut variables, mut equations) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (i, unknown) in unknowns.iter().enumerate() {
            match (unknown, last[i]) {
                (Unknown::Variable(stage), _) => variables[*stage as usize].push(i as u32),
                (Unknown::Equality, Some(stage)) => equations[stage as usize].push(i as u32),
                _ => {}
            }
        }
        let mut kinds = vec![Kind::Rest(0); unknowns.len()];
        for (variables, equations) in variables.iter().zip(&equations) {
            if variables.is_empty() || equations.len() < variables.len() {
                continue;
            }
            let begin = self.states.len();
            for (&variable, &equation) in variables.iter().zip(equations) {
                let number = self.states.len() as u32;
                kinds[variable as usize] = Kind::State(number);
                kinds[equation as usize] = Kind::Equation(number);
                self.states.push(variable);
                self.equations.push(equation);
            }
            self.stages.push(begin..self.states.len());
        }
        self.number_rest(unknowns, &mut kinds);
        kinds
    }

    /// The border first, then variables by stage, then all others.
    fn number_rest(&mut self, unknowns: &[Unknown], kinds: &mut [Kind]) {
        let rest = (0..unknowns.len() as u32).filter(|&i| kinds[i as usize] == Kind::Rest(0));
        self.rest.extend(rest);
        self.rest.sort_by_key(|&i| match unknowns[i as usize] {
            Unknown::Border => (0, 0),
            Unknown::Variable(stage) => (1, stage),
            _ => (2, 0),
        });
        for (number, &i) in self.rest.iter().enumerate() {
            kinds[i as usize] = Kind::Rest(number as u32);
        }
    }

    fn sort(&mut self, kinds: &[Kind], rows: &[u32], cols: &[u32]) {
        let stages = self.stages.len();
        self.diagonal = vec![Vec::new(); stages];
        self.below = vec![Vec::new(); stages];
        self.inputs = vec![Vec::new(); stages];
        self.reach = vec![0; stages];
        let mut stage_of = vec![0; self.states.len()];
        for (stage, range) in self.stages.iter().enumerate() {
            stage_of[range.clone()].fill(stage);
        }
        for (entry, (&row, &col)) in rows.iter().zip(cols).enumerate() {
            let (a, b) = (kinds[row as usize], kinds[col as usize]);
            let item = |row, column| Item {
                entry: entry as u32,
                row,
                column,
            };
            match (a.min(b), a.max(b)) {
                (Kind::State(a), Kind::State(b)) => self.curvature.push(item(a, b)),
                (Kind::State(state), Kind::Equation(equation)) => {
                    let stage = stage_of[equation as usize];
                    let block = match stage_of[state as usize] == stage {
                        true => &mut self.diagonal,
                        false => &mut self.below,
                    };
                    block[stage].push(item(equation, state));
                }
                (Kind::State(state), Kind::Rest(rest)) => self.coupling.push(item(rest, state)),
                (Kind::Equation(equation), Kind::Rest(rest)) => {
                    let stage = stage_of[equation as usize];
                    self.inputs[stage].push(item(equation, rest));
                    self.reach[stage] = self.reach[stage].max(rest as usize + 1);
                }
                (Kind::Rest(a), Kind::Rest(b)) => self.corner.push(item(a.max(b), a.min(b))),
                _ => self.zeros.push(entry as u32),
            }
        }
        for stage in 1..stages {
            self.reach[stage] = self.reach[stage].max(self.reach[stage - 1]);
        }
    }

    fn multiplications(&self) -> f64 {
        let m = self.rest.len() as f64;
        let of_stage = |(range, &reach): (&Range<usize>, &usize)| {
            let (n, reach) = (range.len() as f64, reach as f64);
            n * n * (n / 3.0 + reach) + n * m * reach
        };
        let stages: f64 = self.stages.iter().zip(&self.reach).map(of_stage).sum();
        let entries = self.curvature.len() + self.below.iter().map(Vec::len).sum::<usize>();
        stages + 2.0 * m * entries as f64 + m * m * m / 6.0
    }
}

/// Last stage of the variables in each row.
fn last_stages(unknowns: &[Unknown], rows: &[u32], cols: &[u32]) -> Vec<Option<u32>> {
    let mut last = vec![None; unknowns.len()];
    let mut see = |row: u32, col: u32| {
        if let Unknown::Variable(stage) = unknowns[col as usize] {
            let last = &mut last[row as usize];
            *last = (*last).max(Some(stage));
        }
    };
    for (&row, &col) in rows.iter().zip(cols) {
        see(row, col);
        see(col, row);
    }
    last
}
