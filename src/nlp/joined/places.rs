//! Places of the variables and constraints of programs in the whole that they are joined to.

use std::ops::Range;
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

/// Places of the variables and constraints of each program.
#[derive(Clone, Debug)]
pub struct Places {
    /// For each variable of a program the variable of the whole, and the factor by which its value in the program is larger.
    pub(super) columns: Vec<Arc<[(usize, f64)]>>,
    rows: Vec<Range<usize>>,
    /// Number of variables, and the first one that is shared.
    pub(super) count: usize,
    pub(super) first_shared: usize,
    /// For each shared variable the first program that has it, and the number of those that do.
    shared: Vec<[usize; 2]>,
}

impl Places {
    /// Of programs of these numbers of variables and constraints.
    pub(super) fn new(sizes: &[[usize; 2]], shared: &[SharedVariable]) -> Self {
        let has = |number: usize| shared.iter().filter(move |one| one.0[number].is_some());
        let own = sizes.iter().enumerate();
        let variables: usize = own.map(|(number, [n, _])| n - has(number).count()).sum();
        let owner = |one: &SharedVariable| {
            let first = one.first().expect("a variable of a program");
            [first, one.0.iter().flatten().count()]
        };
        let (mut next, mut first) = (0, 0);
        let mut out = Self {
            columns: Vec::with_capacity(sizes.len()),
            rows: Vec::with_capacity(sizes.len()),
            count: variables + shared.len(),
            first_shared: variables,
            shared: shared.iter().map(owner).collect(),
        };
        for (number, &[n, m]) in sizes.iter().enumerate() {
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
            out.rows.push(first..first + m);
            first += m;
        }
        out
    }

    /// Number of programs.
    #[must_use]
    pub fn programs(&self) -> usize {
        self.rows.len()
    }

    /// Number of rows of all programs.
    pub(super) fn constraints(&self) -> usize {
        self.rows.last().map_or(0, |rows| rows.end)
    }

    /// The rows of a program.
    #[must_use]
    pub fn rows(&self, number: usize) -> Range<usize> {
        self.rows[number].clone()
    }

    /// Values of the variables of a program.
    #[must_use]
    pub fn values_of(&self, number: usize, x: &[f64]) -> Vec<f64> {
        let columns = self.columns[number].iter();
        columns.map(|&(from, factor)| factor * x[from]).collect()
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
