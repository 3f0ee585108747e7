//! Places of the variables and constraints of programs in the whole that they are joined to.
//!
//! The greatest of the objectives f of programs in place of their sum, by its epigraph:
//!
//! ```text
//! minimise t   subject to   f − t ≤ 0 of each program.
//! ```
//!
//! The variable is s t, with the factor s that brings objectives near 1. The multipliers of these rows are the weights with which the
//! objectives count at the optimum: s times their sum is 1, and those of programs below the greatest one are zero.

use crate::math::join_if;
use crate::nlp::Nlp;
use std::sync::Arc;

/// A variable of several programs that has one value: for each program that has it its number there, and the factor by which its value
/// there is larger.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedVariable(pub Vec<Option<(usize, f64)>>);

impl SharedVariable {
    /// A variable of all programs.
    pub fn of_all(places: impl IntoIterator<Item = (usize, f64)>) -> Self {
        Self(places.into_iter().map(Some).collect())
    }

    /// The first program that has it.
    fn first(&self) -> Option<usize> {
        self.0.iter().position(Option::is_some)
    }
}

/// Rows of programs that are one equation: their sum, each times a factor, is zero. Each has its program, its number there and the factor.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedRow(pub Vec<(usize, usize, f64)>);

/// The variables or rows of a program in the whole: the place of each, and a factor.
pub(super) type Shares = Arc<[(usize, f64)]>;

/// Places of the variables and constraints of each program.
#[derive(Clone, Debug)]
pub struct Places {
    /// For each variable of a program the variable of the whole, and the factor by which its value in the program is larger.
    pub(super) columns: Vec<Shares>,
    /// For each row of a program the row of the whole to which it is added, and its factor there.
    pub(super) rows: Vec<Shares>,
    /// Number of rows of all programs.
    pub(super) row_count: usize,
    /// Number of variables, and the first one that is shared.
    pub(super) count: usize,
    pub(super) first_shared: usize,
    /// For each shared variable the first program that has it, and the number of those that do.
    shared: Vec<[usize; 2]>,
}

impl Places {
    /// Of programs of these numbers of variables and constraints.
    pub(super) fn new(
        sizes: &[[usize; 2]],
        shared: &[SharedVariable],
        shared_rows: &[SharedRow],
    ) -> Self {
        let has = |number: usize| shared.iter().filter(move |one| one.0[number].is_some());
        let own = sizes.iter().enumerate();
        let variables: usize = own.map(|(number, [n, _])| n - has(number).count()).sum();
        let owner = |one: &SharedVariable| {
            let first = one.first().expect("a variable of a program");
            [first, one.0.iter().flatten().count()]
        };
        let mut next = 0;
        let mut out = Self {
            columns: Vec::with_capacity(sizes.len()),
            rows: Vec::new(),
            row_count: 0,
            count: variables + shared.len(),
            first_shared: variables,
            shared: shared.iter().map(owner).collect(),
        };
        for (number, &[n, _]) in sizes.iter().enumerate() {
            let mut columns = vec![None; n];
            for (place, one) in shared.iter().enumerate() {
                if let Some((own, factor)) = one.0[number] {
                    columns[own] = Some((variables + place, factor));
                }
            }
            let mut own = || {
                next += 1;
                (next - 1, 1.0)
            };
            let columns = columns
                .into_iter()
                .map(|shared| shared.unwrap_or_else(&mut own));
            out.columns.push(columns.collect());
        }
        (out.rows, out.row_count) = rows(sizes, shared_rows);
        out
    }

    /// Number of programs.
    #[must_use]
    pub fn programs(&self) -> usize {
        self.rows.len()
    }

    /// Multipliers of the rows of a program.
    #[must_use]
    pub fn row_multipliers_of(&self, number: usize, multipliers: &[f64]) -> Vec<f64> {
        let rows = self.rows[number].iter();
        rows.map(|&(from, factor)| factor * multipliers[from])
            .collect()
    }

    /// Multipliers of all rows from those of the programs: of shared ones those of the first.
    #[must_use]
    pub fn row_multipliers(&self, of_parts: &[&[f64]]) -> Vec<f64> {
        let mut all = vec![0.0; self.row_count];
        for (rows, multipliers) in self.rows.iter().zip(of_parts).rev() {
            for (&(to, factor), value) in rows.iter().zip(*multipliers) {
                all[to] = value / factor;
            }
        }
        all
    }

    /// Values of the variables of a program.
    #[must_use]
    pub fn values_of(&self, number: usize, x: &[f64]) -> Vec<f64> {
        let columns = self.columns[number].iter();
        columns.map(|&(from, factor)| factor * x[from]).collect()
    }

    /// The variable of the whole that one of a program is, and the factor by which its value in the program is larger.
    #[must_use]
    pub fn variable_of(&self, number: usize, own: usize) -> (usize, f64) {
        self.columns[number][own]
    }

    /// Values of all variables, from those of the programs: of shared ones those of the first.
    #[must_use]
    pub fn values(&self, of_parts: &[&[f64]]) -> Vec<f64> {
        let mut x = vec![0.0; self.count];
        for (columns, values) in self.columns.iter().zip(of_parts).rev() {
            for (&(to, factor), value) in columns.iter().zip(*values) {
                x[to] = value / factor;
            }
        }
        x
    }

    /// Number of programs that have a variable of the whole.
    pub(super) fn programs_of(&self, variable: usize) -> usize {
        let shared = variable.checked_sub(self.first_shared);
        let shared = shared.and_then(|place| self.shared.get(place));
        shared.map_or(1, |[_, count]| *count)
    }

    /// Multipliers of the bounds of the variables of a program; of a shared variable the first one that has it.
    #[must_use]
    pub fn multipliers_of(&self, number: usize, multipliers: &[f64]) -> Vec<f64> {
        let own = |&(from, factor): &(usize, f64)| {
            let shared = from.checked_sub(self.first_shared);
            match shared.is_none_or(|place| self.shared[place][0] == number) {
                true => multipliers[from] / factor,
                false => 0.0,
            }
        };
        self.columns[number].iter().map(own).collect()
    }

    /// Multipliers of the bounds of all variables: of shared ones the sum of those of the programs.
    #[must_use]
    pub fn multipliers(&self, of_parts: &[&[f64]]) -> Vec<f64> {
        let mut sums = vec![-0.0; self.count];
        for (columns, multipliers) in self.columns.iter().zip(of_parts) {
            for (&(to, factor), value) in columns.iter().zip(*multipliers) {
                sums[to] += factor * value;
            }
        }
        sums
    }
}

/// The row of the whole to which each row of each program is added, with its factor, and the number of these. A shared row stands where the first
/// program has it.
fn rows(sizes: &[[usize; 2]], shared: &[SharedRow]) -> (Vec<Shares>, usize) {
    let mut all: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut is_further: Vec<Vec<bool>> = Vec::new();
    for &[_, m] in sizes {
        all.push(vec![(0, 1.0); m]);
        is_further.push(vec![false; m]);
    }
    for &(program, row, _) in shared.iter().flat_map(|one| &one.0[1..]) {
        is_further[program][row] = true;
    }
    let mut count = 0;
    let each = all.iter_mut().flatten().zip(is_further.iter().flatten());
    for ((to, _), _) in each.filter(|(_, is_further)| !**is_further) {
        *to = count;
        count += 1;
    }
    for one in shared {
        let (first, row, _) = one.0[0];
        let (place, _) = all[first][row];
        for &(program, row, factor) in &one.0 {
            all[program][row] = (place, factor);
        }
    }
    (all.into_iter().map(Into::into).collect(), count)
}

/// Part of the greatest objective by which the first bound lies above it.
const ABOVE: f64 = 0.1;

/// The bound of all objectives.
pub(super) struct Worst {
    /// Its variable, the last one.
    pub(super) column: usize,
    /// Row of the first program, behind those of all of them.
    pub(super) first_row: usize,
    /// s.
    pub(super) scale: f64,
}

impl Worst {
    /// t.
    pub(super) fn objective(&self, x: &[f64]) -> f64 {
        x[self.column] / self.scale
    }

    /// ∇t.
    pub(super) fn gradient(&self, grad: &mut [f64]) {
        grad.fill(0.0);
        grad[self.column] = 1.0 / self.scale;
    }

    /// Factor of the objective of a program in the Lagrangian.
    pub(super) fn weight(&self, number: usize, costates: &[f64]) -> f64 {
        self.scale * costates[self.first_row + number]
    }

    /// Puts the bound above all objectives into a point of the variables of programs, and shares it out among multipliers.
    pub(super) fn complete<N: Nlp + Send>(
        &self,
        parts: &mut [Part<N>],
        x: &mut [f64],
        multipliers: Option<&mut Vec<f64>>,
    ) {
        each(parts, &mut [], &|_| 0, &|part, _| part.evaluate(x));
        let objectives = parts.iter().map(|part| self.scale * part.objective);
        let greatest = objectives.fold(f64::NEG_INFINITY, f64::max);
        x[self.column] = greatest + ABOVE * greatest.abs();
        if let Some(multipliers) = multipliers {
            let share = 1.0 / (self.scale * parts.len() as f64);
            multipliers.resize(self.first_row + parts.len(), share);
        }
    }

    /// The rows s f − s t.
    pub(super) fn rows<N: Nlp + Send>(&self, parts: &mut [Part<N>], x: &[f64], rows: &mut [f64]) {
        each(parts, &mut [], &|_| 0, &|part, _| part.evaluate(x));
        for (row, part) in rows.iter_mut().zip(parts) {
            *row = self.scale * part.objective - x[self.column];
        }
    }

    /// Their gradients.
    pub(super) fn entries<N: Nlp + Send>(
        &self,
        parts: &mut [Part<N>],
        x: &[f64],
        values: &mut [f64],
    ) {
        each(parts, &mut [], &|_| 0, &|part, _| part.differentiate(x));
        let of_rows = parts.iter().flat_map(|part| {
            let columns = part.columns.iter().zip(&part.gradient);
            let own = columns.map(|((_, factor), slope)| self.scale * factor * slope);
            own.chain([-1.0])
        });
        for (value, entry) in values.iter_mut().zip(of_rows) {
            *value = entry;
        }
    }
}

/// A program and its part of the whole.
pub(super) struct Part<N> {
    pub(super) program: N,
    pub(super) name: String,
    /// Variable of the whole that each of its variables is, and the factor by which its value is larger.
    pub(super) columns: Shares,
    /// Row of the whole to which each of its rows is added, and its factor there.
    pub(super) rows: Shares,
    /// Numbers of entries of Jacobian and Hessian.
    pub(super) entries: [usize; 2],
    /// Entries of Jacobian and Hessian whose value is larger in the whole, and the factors.
    pub(super) scaled: [Vec<(usize, f64)>; 2],
    pub(super) x: Vec<f64>,
    /// Its rows, or their multipliers.
    pub(super) of_rows: Vec<f64>,
    pub(super) objective: f64,
    pub(super) gradient: Vec<f64>,
    /// Factor of its objective in the Lagrangian.
    pub(super) weight: f64,
}

impl<N: Nlp> Part<N> {
    /// Its objective at a point.
    pub(super) fn evaluate(&mut self, x: &[f64]) {
        self.read(x);
        self.objective = self.program.objective(&self.x);
    }

    /// The gradient of its objective at a point.
    pub(super) fn differentiate(&mut self, x: &[f64]) {
        self.read(x);
        self.program.gradient(&self.x, &mut self.gradient);
    }
}

impl<N> Part<N> {
    /// Reads its variables of a point.
    pub(super) fn read(&mut self, x: &[f64]) {
        for (value, &(from, factor)) in self.x.iter_mut().zip(self.columns.iter()) {
            *value = factor * x[from];
        }
    }

    /// Scales entries of Jacobian or Hessian as the whole reads them.
    pub(super) fn scale(&self, kind: usize, values: &mut [f64]) {
        for &(entry, factor) in &self.scaled[kind] {
            values[entry] *= factor;
        }
    }

    pub(super) fn named(&self, name: String) -> String {
        match self.name.is_empty() {
            true => name,
            false => format!("{}: {name}", self.name),
        }
    }
}

/// Does work on each part and its share of some values, the halves of a list at once: what is computed does not depend on threads.
pub(super) fn each<N: Send>(
    parts: &mut [Part<N>],
    values: &mut [f64],
    count: &(dyn Fn(&Part<N>) -> usize + Sync),
    work: &(dyn Fn(&mut Part<N>, &mut [f64]) + Sync),
) {
    match parts {
        [part] => work(part, values),
        _ => {
            let (first, second) = parts.split_at_mut(parts.len() / 2);
            let (a, b) = values.split_at_mut(first.iter().map(count).sum());
            let halves = [(first, a), (second, b)]
                .map(|(parts, values)| move || each(parts, values, count, work));
            let [first, second] = halves;
            join_if(true, first, second);
        }
    }
}
