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

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::error::BoundaryError;
use crate::control::guess::InitialGuess;
use crate::control::numbering::{Column, Numbering, Row};
use crate::control::problem::Control;
use crate::control::transcription::Transcription;
use crate::dynamics::{DiscreteTrajectory, Start};
use crate::model::Model;
use crate::nlp::Nlp;
use crate::sparse::Direct;
use nalgebra::{DMatrix, RowDVector};

/// Derivatives of the start of a motion by what is known: coordinates, and momenta.
#[derive(Clone, Debug)]
pub struct StartDerivatives {
    /// A row for each coordinate.
    pub coordinates: DMatrix<f64>,
    /// A row for each momentum.
    pub momenta: DMatrix<f64>,
}

/// Derivatives of a motion, or of a state of rest, by what is known.
#[derive(Clone, Debug)]
pub struct MotionDerivatives {
    unknowns: Numbering,
    /// Those of each column of its program.
    rows: Vec<RowDVector<f64>>,
}

impl MotionDerivatives {
    /// Those by `count` known numbers of a motion from a start, or of a state of rest where there is no start. `known` tells which columns of parameters
    /// and intervals are functions of known numbers. None where the equations are singular, or not as many as the unknowns.
    ///
    /// # Errors
    /// There is no program with a free start.
    pub fn new(
        model: &Model,
        control: &Control,
        from: Option<(&Start, &StartDerivatives)>,
        discrete: &DiscreteTrajectory,
        count: usize,
        known: impl Fn(&Column) -> Option<Vec<(usize, f64)>>,
    ) -> Result<Option<Self>, BoundaryError> {
        let start = match from {
            Some((start, _)) => start.clone(),
            None => Start::at_rest(model, discrete.z[0].clone()),
        };
        let boundary = BoundaryConditions::without_goal(start, model.coordinate_count());
        let h = discrete.times[1] - discrete.times[0];
        let initial = InitialGuess::of_motion(discrete.clone(), h);
        let program = Transcription::of_any(model, &boundary, control, &initial)?;
        let equations = Equations::new(program, from.map(|(_, by)| by), count, known);
        Ok(equations.and_then(|equations| equations.solved(discrete, h)))
    }

    /// Those of coordinate `i` at instant `k`; none of one that is given.
    pub fn of_coordinate(&self, k: usize, i: usize) -> Option<&RowDVector<f64>> {
        Some(&self.rows[self.unknowns.unknown(k, i)?])
    }

    /// Those of scalar `s` in interval `k`; none of one that is given.
    pub fn of_scalar(&self, k: usize, s: usize) -> Option<&RowDVector<f64>> {
        Some(&self.rows[self.unknowns.scalar(k, s)?])
    }
}

/// Part of a column of a program in the equations of the derivatives.
enum Argument {
    /// Unknown of this number.
    Unknown(usize),
    /// A function of what is known, with its derivatives.
    Known(RowDVector<f64>),
}

/// The equations of a program by which its unknowns are functions of what is known.
struct Equations<'a> {
    program: Transcription<'a>,
    /// Equation of each row of the program; the start meets its constraints.
    rows: Vec<Option<usize>>,
    /// Part of each column of the program.
    columns: Vec<Argument>,
    size: usize,
    /// Derivatives of the start; none of a state of rest.
    start: Option<&'a StartDerivatives>,
    /// Number of known numbers.
    count: usize,
}

impl<'a> Equations<'a> {
    /// Numbers the equations of a program of one motion with a free start; none where there are not as many equations as unknowns.
    fn new(
        program: Transcription<'a>,
        start: Option<&'a StartDerivatives>,
        count: usize,
        known: impl Fn(&Column) -> Option<Vec<(usize, f64)>>,
    ) -> Option<Self> {
        let n = program.model().coordinate_count();
        let (mut size, mut equations) = (0, 0);
        let next = |number: &mut usize| {
            *number += 1;
            *number - 1
        };
        let mut of_rest = vec![None; n];
        let part = |column: &Column| match (*column, start) {
            (Column::Instant { k: 0, i }, Some(start)) if i < n => {
                Argument::Known(start.coordinates.row(i).into_owned())
            }
            (Column::Instant { i, .. }, None) if i < n => {
                Argument::Unknown(*of_rest[i].get_or_insert_with(|| next(&mut size)))
            }
            _ => match known(column) {
                Some(slopes) => {
                    let mut by = RowDVector::zeros(count);
                    (slopes.iter()).for_each(|&(number, slope)| by[number] = slope);
                    Argument::Known(by)
                }
                None => Argument::Unknown(next(&mut size)),
            },
        };
        let columns = program.unknowns().columns.iter().map(part).collect();
        let row = |row: &Row| {
            let is_met = matches!(*row, Row::Instant { k: 0, i } if i >= n);
            (!is_met).then(|| next(&mut equations))
        };
        let rows = program.unknowns().rows.iter().map(row).collect();
        (equations == size).then_some(Self {
            program,
            rows,
            columns,
            size,
            start,
            count,
        })
    }

    /// The derivatives along a motion in steps of h ms.
    ///
    /// At rest, where there is no start, the multipliers of constraints are found first. None where the equations are singular.
    fn solved(mut self, discrete: &DiscreteTrajectory, h: f64) -> Option<MotionDerivatives> {
        let mut x = self.program.encode(discrete, h);
        if self.start.is_none() && self.program.model().action.map.multipliers > 0 {
            let (solver, _) = self.factored(&x)?;
            self.balance(&mut x, solver);
        }
        let (mut solver, mut right) = self.factored(&x)?;
        for mut column in right.column_iter_mut() {
            solver.solve(column.as_mut_slice());
        }
        let row = |argument| match argument {
            Argument::Unknown(unknown) => right.row(unknown).into_owned(),
            Argument::Known(by) => by,
        };
        Some(MotionDerivatives {
            unknowns: self.program.unknowns().clone(),
            rows: self.columns.into_iter().map(row).collect(),
        })
    }

    /// The factorised matrix of the equations at a point, and minus their derivatives by what is known.
    fn factored(&mut self, x: &[f64]) -> Option<(Direct, DMatrix<f64>)> {
        let (program, count) = (&mut self.program, self.count);
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
                Argument::Known(by) => {
                    (0..count).for_each(|j| right[(row, j)] -= value * by[j]);
                }
            }
        }
        if let Some(start) = self.start {
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
    fn balance(&mut self, x: &mut [f64], mut solver: Direct) {
        let program = &mut self.program;
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
