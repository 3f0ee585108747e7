//! The matrix of an iteration: entries by unknowns, and by variables that are held.

use crate::kkt::Unknown;
use crate::nlp::{Entries, Nlp};

/// Rows and columns of the matrix.
#[derive(Default)]
pub(super) struct Matrix {
    pub(super) rows: Vec<u32>,
    pub(super) cols: Vec<u32>,
}

impl Matrix {
    pub(super) fn push(&mut self, row: usize, col: usize) {
        self.rows.push(row as u32);
        self.cols.push(col as u32);
    }

    /// Adds the entries whose row and column are unknowns; returns which they are.
    pub(super) fn add(
        &mut self,
        entries: &Entries,
        (rows, cols): (&[Option<usize>], &[Option<usize>]),
    ) -> Vec<usize> {
        let mut kept = Vec::new();
        for (entry, (&row, &col)) in entries.rows.iter().zip(&entries.cols).enumerate() {
            if let (Some(row), Some(col)) = (rows[row as usize], cols[col as usize]) {
                self.push(row, col);
                kept.push(entry);
            }
        }
        kept
    }
}

/// Entries in the row of an unknown by a held variable; of a symmetric matrix in either triangle.
pub(super) fn held(
    entries: &Entries,
    (rows, cols): (&[Option<usize>], &[Option<usize>]),
    is_symmetric: bool,
) -> Vec<(usize, usize, usize)> {
    let mut out = Vec::new();
    for (entry, (&row, &col)) in entries.rows.iter().zip(&entries.cols).enumerate() {
        let (row, col) = (row as usize, col as usize);
        match (rows[row], cols[col]) {
            (Some(number), None) => out.push((number, col, entry)),
            (None, Some(number)) if is_symmetric => out.push((number, row, entry)),
            _ => {}
        }
    }
    out
}

/// Kinds of the unknowns along the horizon.
pub(super) fn kinds(
    program: &impl Nlp,
    (unknowns, rows): (&[Option<usize>], &[Option<usize>]),
    slacks: &[Option<usize>],
    columns: usize,
) -> Option<Vec<Unknown>> {
    let stages = program.stages()?;
    let mut kinds = Vec::new();
    for (i, number) in unknowns.iter().enumerate() {
        if number.is_some() {
            let stage = stages.get(i).filter(|_| i < columns);
            kinds.push(stage.map_or(Unknown::Slack, |&stage| stage.into()));
        }
    }
    for (number, slack) in rows.iter().zip(slacks) {
        if number.is_some() {
            kinds.push(match slack {
                Some(_) => Unknown::Inequality,
                None => Unknown::Equality,
            });
        }
    }
    Some(kinds)
}
