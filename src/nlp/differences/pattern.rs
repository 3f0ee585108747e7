//! Groups of variables along which differences are taken at once (Curtis, Powell and Reid, 1974).
//!
//! No row of the Jacobian and of the Hessian reads two variables of a group, so that each change of a value is along one of them. A
//! variable that couples with many, such as the duration, would leave no groups: entries of the Hessian with it are compared along it
//! alone, as the matrix is symmetric. A variable of a row of the Jacobian that reads many is a group by itself.

use crate::nlp::Entries;

/// A row that reads more than one of so many variables reads many.
const MANY: usize = 4;

/// The structures of Jacobian and Hessian by columns.
pub(super) struct Pattern {
    /// Rows of each column: those of the Jacobian, then those of the whole Hessian.
    rows: [Vec<Vec<usize>>; 2],
    /// Variables moved alone, for a row of the Jacobian or for their column of the Hessian.
    is_alone: Vec<bool>,
    /// Variables whose entries of the Hessian are compared along them alone.
    is_shared: Vec<bool>,
}

impl Pattern {
    /// The pattern of a program with `n` variables.
    pub(super) fn new(jacobian: &Entries, hessian: &Entries, n: usize) -> Self {
        let mut whole = hessian.clone();
        mirror(&mut whole, &mut Vec::new());
        let rows = [jacobian, &whole].map(|entries| {
            let mut rows = vec![Vec::new(); n];
            entries.places().for_each(|(row, col)| rows[col].push(row));
            for column in &mut rows {
                column.sort_unstable();
                column.dedup();
            }
            rows
        });
        let is_shared: Vec<bool> = rows[1].iter().map(|rows| rows.len() > n / MANY).collect();
        let mut reads = Vec::new();
        for &row in rows[0].iter().flatten() {
            reads.resize(reads.len().max(row + 1), 0);
            reads[row] += 1;
        }
        let reads_many = |&row: &usize| reads[row] > n / MANY;
        let is_alone = (0..n).map(|j| is_shared[j] || rows[0][j].iter().any(reads_many));
        Self {
            is_alone: is_alone.collect(),
            rows,
            is_shared,
        }
    }

    /// Returns true if the entry of the Hessian in row `i` and column `j` is compared along variable j rather than i.
    pub(super) fn is_along(&self, j: usize, i: usize) -> bool {
        match (self.is_shared[j], self.is_shared[i]) {
            (true, false) => true,
            (false, true) => false,
            _ => i >= j,
        }
    }

    /// Variables in groups, of a program with `m` constraints: each goes to the first group with which it has no row in common.
    pub(super) fn groups(&self, m: usize) -> Vec<Vec<usize>> {
        let all = 0..self.is_alone.len();
        let (alone, moved): (Vec<usize>, Vec<usize>) = all.partition(|&j| self.is_alone[j]);
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut met = vec![Vec::new(); m + self.is_alone.len()];
        let mut is_taken = Vec::new();
        for j in moved {
            let of_hessian = self.rows[1][j].iter().filter(|&&i| !self.is_shared[i]);
            let rows = self.rows[0][j]
                .iter()
                .copied()
                .chain(of_hessian.map(|i| m + i));
            is_taken.clear();
            is_taken.resize(groups.len() + 1, false);
            for row in rows.clone() {
                met[row]
                    .iter()
                    .for_each(|&group: &usize| is_taken[group] = true);
            }
            let free = is_taken.iter().position(|taken| !taken);
            let group = free.unwrap_or(groups.len());
            groups.resize_with(groups.len().max(group + 1), Vec::new);
            groups[group].push(j);
            rows.for_each(|row| met[row].push(group));
        }
        groups.extend(alone.into_iter().map(|j| vec![j]));
        groups
    }
}

/// Adds to the lower triangle of a symmetric matrix its upper one.
///
/// # Panics
/// If an entry is above the diagonal.
pub(super) fn mirror(entries: &mut Entries, values: &mut Vec<f64>) {
    for index in 0..entries.count() {
        let (row, col) = (entries.rows[index], entries.cols[index]);
        assert!(row >= col, "column {col} has an entry above the diagonal");
        if row > col {
            entries.rows.push(col);
            entries.cols.push(row);
            values.extend(values.get(index).copied());
        }
    }
}
