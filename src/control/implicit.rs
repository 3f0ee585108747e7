//! Derivatives of a motion, or of a state of rest, that the rows of a program determine.
//!
//! The rows `c(y, p) = 0` of a transcription hold along the motion y. By the theorem of implicit functions its derivatives S by what is
//! known, p, solve
//!
//! ```text
//! ∂c/∂y S = −∂c/∂p,
//! ```
//!
//! where ∂c/∂y is square: instant by instant it has blocks on the diagonal and below it. At rest all instants are one.

use crate::control::numbering::{Column, Row};
use crate::control::problem::Regime;
use crate::control::transcription::Transcription;
use crate::nlp::Nlp;
use crate::sparse::Direct;
use nalgebra::DMatrix;

/// Part of a column of a program in the equations of the derivatives.
#[derive(Clone, Debug)]
pub enum Argument {
    /// Unknown of this number.
    Unknown(usize),
    /// Coordinate of the start of a motion.
    Start(usize),
    /// A function of known numbers: the index of each, and the derivative of the column by it.
    Known(Vec<(usize, f64)>),
}

/// Derivatives of the start of a motion by what is known: coordinates, and momenta.
#[derive(Clone, Debug)]
pub struct StartDerivatives {
    /// A row for each coordinate.
    pub coordinates: DMatrix<f64>,
    /// A row for each momentum.
    pub momenta: DMatrix<f64>,
}

/// The unknowns of a program as a function of what is known.
#[derive(Debug)]
pub struct ImplicitFunction {
    /// Equation of each row of the program; the start meets its constraints.
    rows: Vec<Option<usize>>,
    /// Part of each column of the program.
    pub columns: Vec<Argument>,
    size: usize,
}

impl ImplicitFunction {
    /// Numbers the equations of a program of one motion with a free start. `known` tells which columns of parameters and intervals are
    /// functions of known numbers. None where there are not as many equations as unknowns.
    pub fn new(
        program: &Transcription<'_>,
        regime: Regime,
        known: impl Fn(&Column) -> Option<Vec<(usize, f64)>>,
    ) -> Option<Self> {
        let n = program.model().coordinate_count();
        let mut size = 0;
        let mut of_rest = vec![None; n];
        let mut next = || {
            size += 1;
            size - 1
        };
        let mut part = |column: &Column| match (*column, regime) {
            (Column::Instant { k: 0, i }, Regime::Motion) if i < n => Argument::Start(i),
            (Column::Instant { i, .. }, Regime::Rest) if i < n => {
                Argument::Unknown(*of_rest[i].get_or_insert_with(&mut next))
            }
            _ => match known(column) {
                Some(slopes) => Argument::Known(slopes),
                None => Argument::Unknown(next()),
            },
        };
        let all = program.unknowns();
        let columns = all.columns.iter().map(&mut part).collect();
        let mut count = 0;
        let row = |row: &Row| {
            let is_met = matches!(*row, Row::Instant { k: 0, i } if i >= n);
            (!is_met).then(|| {
                count += 1;
                count - 1
            })
        };
        let rows = all.rows.iter().map(row).collect();
        (count == size).then_some(Self {
            rows,
            columns,
            size,
        })
    }

    /// Derivatives of the unknowns, a row for each, by `count` known numbers at a point x of the program.
    ///
    /// At rest, where there is no start, the multipliers of constraints are found first and put into x. None where the equations are singular.
    pub fn derivatives(
        &self,
        program: &mut Transcription<'_>,
        x: &mut [f64],
        count: usize,
        start: Option<&StartDerivatives>,
    ) -> Option<DMatrix<f64>> {
        if start.is_none() && program.model().action.map.multipliers > 0 {
            let (solver, _) = self.factored(program, x, count, start)?;
            self.balance(program, x, solver);
        }
        let (mut solver, mut right) = self.factored(program, x, count, start)?;
        for mut column in right.column_iter_mut() {
            solver.solve(column.as_mut_slice());
        }
        Some(right)
    }

    /// The factorised matrix of the equations at a point, and minus their derivatives by what is known.
    fn factored(
        &self,
        program: &mut Transcription<'_>,
        x: &[f64],
        count: usize,
        start: Option<&StartDerivatives>,
    ) -> Option<(Direct, DMatrix<f64>)> {
        let entries = program.jacobian_structure();
        let mut values = vec![0.0; entries.count()];
        program.jacobian(x, &mut values);
        let mut right = DMatrix::zeros(self.size, count);
        let (mut places, mut left) = (Vec::new(), Vec::new());
        for (row, col, value) in entries.with(&values) {
            let Some(row) = self.rows[row] else {
                continue;
            };
            let value = value / program.column_scale(col);
            match &self.columns[col] {
                Argument::Unknown(unknown) => {
                    places.push((row, *unknown));
                    left.push(value);
                }
                Argument::Start(i) => {
                    let by = start.map(|start| &start.coordinates);
                    (0..count)
                        .for_each(|j| right[(row, j)] -= value * by.map_or(0.0, |by| by[(*i, j)]));
                }
                Argument::Known(slopes) => {
                    let each = slopes.iter();
                    each.for_each(|&(number, slope)| right[(row, number)] -= value * slope);
                }
            }
        }
        if let Some(start) = start {
            for (r, row) in program.unknowns().rows.iter().enumerate() {
                if let (Row::Instant { k: 0, i }, Some(at)) = (*row, self.rows[r]) {
                    let scale = program.row_scale(r);
                    (0..count).for_each(|j| right[(at, j)] -= scale * start.momenta[(i, j)]);
                }
            }
        }
        let mut solver = Direct::new(self.size, &places);
        solver.factor(&left).ok()?;
        Some((solver, right))
    }

    /// Finds the multipliers of the constraints, in which the equations are linear: at a state of rest a step of Newton's method changes them
    /// alone.
    fn balance(&self, program: &mut Transcription<'_>, x: &mut [f64], mut solver: Direct) {
        let n = program.model().coordinate_count();
        let mut g = vec![0.0; program.constraints().lower.len()];
        program.constraint(x, &mut g);
        let bounds = &program.constraints().lower;
        let mut step = vec![0.0; self.size];
        for (row, (value, bound)) in self.rows.iter().zip(g.iter().zip(bounds)) {
            row.iter().for_each(|&row| step[row] = bound - value);
        }
        solver.solve(&mut step);
        let columns = program.unknowns().columns.iter().zip(&self.columns);
        for (number, (column, part)) in columns.enumerate() {
            if let (Column::Instant { i, .. }, &Argument::Unknown(unknown)) = (*column, part)
                && i >= n
            {
                x[number] += step[unknown] / program.column_scale(number);
            }
        }
    }
}
