//! The conditions of an optimum at a point, over the squares of those variables that enter by squares alone.
//!
//! The linear system of the derivatives of an optimum, over unknowns that no bound holds and equations that hold.
//!
//! Bounds that an optimum has reached: the multiplier of such a bound is greater than the distance from it.

use crate::kkt::{Plan, Solver, Unknown};
use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Multipliers, Nlp, Stage};
use crate::sensitivity::check::NoSensitivity;

/// A program at a point with multipliers, and its derivatives there.
#[derive(Debug)]
pub(super) struct Conditions<N> {
    program: InSquares<N>,
    pub(super) squares: Squares,
    /// Factor of the objective in the Lagrangian and in its multipliers.
    pub(super) scale: f64,
    pub(super) hessian: Entries,
    pub(super) jacobian: Entries,
    /// Bounds of the unknowns and of the constraints.
    pub(super) bounds: Bounds,
    pub(super) row_bounds: Bounds,
    /// The unknowns, and the multipliers of constraints.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    pub(super) g: Vec<f64>,
    /// The unknowns at which the constraints have these values.
    constrained: Vec<f64>,
    pub(super) jacobian_values: Vec<f64>,
    pub(super) hessian_values: Vec<f64>,
}

impl<N: Nlp> Conditions<N> {
    /// A program at a point with its constraints; its multipliers become those of the unknowns and of the scaled objective. `squares` are the variables that enter by
    /// their squares where the program does not know.
    pub(super) fn new(
        program: N,
        (x, multipliers): (&[f64], &mut Multipliers),
        squares: Option<&[usize]>,
    ) -> Self {
        let list = squares.map_or_else(|| program.squares(), <[usize]>::to_vec);
        let squares = Squares::of(&program, list);
        let scale = program.objective_scale();
        let [hessian, jacobian] = [program.hessian_structure(), program.jacobian_structure()];
        let mut bounds = program.variables().clone();
        squares.square(&mut bounds.lower);
        squares.square(&mut bounds.upper);
        let row_bounds = program.constraints().clone();
        squares.of_squares(x, multipliers);
        for list in [
            &mut multipliers.constraints,
            &mut multipliers.lower,
            &mut multipliers.upper,
        ] {
            list.iter_mut().for_each(|value| *value *= scale);
        }
        let mut unknowns = x.to_vec();
        squares.square(&mut unknowns);
        let mut out = Self {
            program: InSquares::new(program, squares.clone(), &jacobian, &hessian),
            squares,
            scale,
            gradient: vec![0.0; x.len()],
            g: vec![0.0; multipliers.constraints.len()],
            jacobian_values: vec![0.0; jacobian.rows.len()],
            hessian_values: vec![0.0; hessian.rows.len()],
            hessian,
            jacobian,
            bounds,
            row_bounds,
            constrained: unknowns.clone(),
            x: unknowns,
            y: multipliers.constraints.clone(),
        };
        out.program.constraint(&out.x, &mut out.g);
        out
    }

    /// Puts a variable that is nearer to a bound than this to the bound.
    pub(super) fn round(&mut self, i: usize, distance: f64) {
        for bound in [self.bounds.lower[i], self.bounds.upper[i]] {
            if (self.x[i] - bound).abs() < distance {
                self.x[i] = bound;
            }
        }
    }

    /// Evaluates first derivatives and constraints.
    pub(super) fn evaluate(&mut self) {
        self.program.gradient(&self.x, &mut self.gradient);
        self.gradient
            .iter_mut()
            .for_each(|value| *value *= self.scale);
        if self.constrained != self.x {
            self.program.constraint(&self.x, &mut self.g);
            self.constrained.copy_from_slice(&self.x);
        }
        self.program.jacobian(&self.x, &mut self.jacobian_values);
    }

    /// Evaluates second derivatives.
    pub(super) fn evaluate_hessian(&mut self) {
        let (x, y) = (&self.x, &self.y);
        self.program
            .hessian(x, self.scale, y, &mut self.hessian_values);
    }

    /// ∇f + Jᵀy.
    pub(super) fn slopes(&self) -> Vec<f64> {
        let mut out = self.gradient.clone();
        self.add_transposed(&self.y, &mut out);
        out
    }

    /// Adds Jᵀ v to a list.
    pub(super) fn add_transposed(&self, v: &[f64], to: &mut [f64]) {
        for (&row, &col, value) in entries(&self.jacobian, &self.jacobian_values) {
            to[col as usize] += value * v[row as usize];
        }
    }

    /// Adds J v to a list.
    pub(super) fn add_times(&self, v: &[f64], to: &mut [f64]) {
        for (&row, &col, value) in entries(&self.jacobian, &self.jacobian_values) {
            let v = v[col as usize];
            // Few columns change at once.
            if v != 0.0 {
                to[row as usize] += value * v;
            }
        }
    }

    /// Adds ∇²L v to a list.
    pub(super) fn add_curved(&self, v: &[f64], to: &mut [f64]) {
        for (&row, &col, value) in entries(&self.hessian, &self.hessian_values) {
            let (row, col) = (row as usize, col as usize);
            if v[col] != 0.0 {
                to[row] += value * v[col];
            }
            if row != col && v[row] != 0.0 {
                to[col] += value * v[row];
            }
        }
    }

    /// Stages of the variables.
    pub(super) fn stages(&self) -> Option<Vec<Stage>> {
        self.program.stages()
    }

    /// The program.
    pub(super) fn program(&self) -> &N {
        &self.program.program
    }

    /// Bounds of the variables of the program.
    pub(super) fn given_bounds(&self) -> &Bounds {
        self.program.program.variables()
    }

    /// The variables of the program.
    pub(super) fn point(&self) -> Vec<f64> {
        let mut x = self.x.clone();
        self.squares.root(&mut x);
        x
    }

    /// Returns the name of a variable.
    pub(super) fn variable_name(&self, i: usize) -> String {
        self.program.program.variable_name(i)
    }

    /// Returns the name of a constraint.
    pub(super) fn constraint_name(&self, i: usize) -> String {
        self.program.program.constraint_name(i)
    }
}

/// Rows, columns and values of a matrix.
pub(super) fn entries<'a>(
    entries: &'a Entries,
    values: &'a [f64],
) -> impl Iterator<Item = (&'a u32, &'a u32, &'a f64)> {
    let places = entries.rows.iter().zip(&entries.cols);
    places
        .zip(values)
        .map(|((row, col), value)| (row, col, value))
}

/// Steps of refinement.
const REFINED: usize = 3;
/// Residual of a solution, relative to the terms of its equations, that is that of rounding.
pub(super) const EXACT: f64 = 1e-9;

/// The system with its factors.
#[derive(Debug)]
pub(super) struct Linear {
    /// Number of each variable among the unknowns, and of each constraint.
    columns: Vec<Option<usize>>,
    rows: Vec<Option<usize>>,
    /// Entries of Hessian and Jacobian that are in the matrix.
    kept: [Vec<usize>; 2],
    matrix: Matrix,
    values: Vec<f64>,
    /// Unknowns that are variables.
    free: usize,
    solver: Solver,
}

impl Linear {
    /// Lays out the matrix of Hessian (lower triangle) and Jacobian.
    pub(super) fn new(
        [columns, rows]: [&[Place]; 2],
        [hessian, jacobian]: [&Entries; 2],
        stages: Option<&[Stage]>,
    ) -> Result<Self, NoSensitivity> {
        let mut free = 0;
        let mut number = |is_kept: bool| {
            is_kept.then(|| {
                free += 1;
                free - 1
            })
        };
        let columns: Vec<_> = columns.iter().map(|c| number(*c == Place::Free)).collect();
        let is_row = |row: &Place| row.is_reached() || *row == Place::Equation;
        let rows: Vec<_> = rows.iter().map(|r| number(is_row(r))).collect();
        let order = free;
        let free = columns.iter().flatten().count();
        if order - free > free {
            return Err(NoSensitivity::Overdetermined {
                rows: order - free,
                columns: free,
            });
        }
        let mut matrix = Matrix::default();
        let kept = [
            matrix.add(hessian, (&columns, &columns)),
            matrix.add(jacobian, (&rows, &columns)),
        ];
        let kinds = stages.map(|stages| {
            let all = columns.iter().zip(stages).filter(|(c, _)| c.is_some());
            let mut kinds: Vec<Unknown> = all.map(|(_, &stage)| stage.into()).collect();
            kinds.resize(order, Unknown::Equality);
            kinds
        });
        let plan = Plan::new(order, &matrix.rows, &matrix.cols, kinds.as_deref());
        Ok(Self {
            solver: Solver::new(plan),
            values: vec![0.0; matrix.rows.len()],
            columns,
            rows,
            kept,
            matrix,
            free,
        })
    }

    /// Factorises the matrix with these values.
    pub(super) fn factor(
        &mut self,
        hessian: &[f64],
        jacobian: &[f64],
    ) -> Result<(), NoSensitivity> {
        let all = self.kept[0].iter().map(|&entry| hessian[entry]);
        let all = all.chain(self.kept[1].iter().map(|&entry| jacobian[entry]));
        self.values
            .iter_mut()
            .zip(all)
            .for_each(|(value, new)| *value = new);
        let equations = self.order() - self.free;
        let found = self.solver.factor(&self.values);
        match (found.zero, found.negative) {
            (0, negative) if negative == equations => Ok(()),
            (0, negative) if negative > equations => {
                Err(NoSensitivity::NoMinimum(negative - equations))
            }
            _ => Err(NoSensitivity::Singular),
        }
    }

    /// Number of unknowns.
    fn order(&self) -> usize {
        self.free + self.rows.iter().flatten().count()
    }

    /// Replaces right-hand sides, by variable and by constraint, by the solution; entries of what is not in the system become zero.
    pub(super) fn solve(&mut self, x: &mut [f64], y: &mut [f64]) -> Result<(), NoSensitivity> {
        let mut right = vec![0.0; self.order()];
        let all = self
            .columns
            .iter()
            .zip(x.iter())
            .chain(self.rows.iter().zip(y.iter()));
        for (number, value) in all {
            number.iter().for_each(|&i| right[i] = *value);
        }
        let mut solution = right.clone();
        self.solver.solve(&mut solution);
        let size = self.size(&solution, &right);
        let mut left = right.clone();
        let mut error = self.residual(&solution, size, &mut left);
        for _ in 0..REFINED {
            if error <= f64::EPSILON {
                break;
            }
            self.solver.solve(&mut left);
            let all = solution.iter_mut().zip(&left);
            all.for_each(|(value, more)| *value += more);
            left.copy_from_slice(&right);
            error = self.residual(&solution, size, &mut left);
        }
        if error > EXACT {
            return Err(NoSensitivity::Inexact(error));
        }
        let all = self.columns.iter().zip(x).chain(self.rows.iter().zip(y));
        for (number, value) in all {
            *value = number.map_or(0.0, |i| solution[i]);
        }
        Ok(())
    }

    /// Greatest sum of the sizes of the terms of an equation.
    fn size(&self, solution: &[f64], right: &[f64]) -> f64 {
        let mut sizes: Vec<f64> = right.iter().map(|value| value.abs()).collect();
        self.each_term(solution, |row, term| sizes[row] += term.abs());
        sizes.into_iter().fold(0.0, f64::max)
    }

    /// Turns right-hand sides into residuals of the equations, and returns the greatest one relative to a size.
    fn residual(&self, solution: &[f64], size: f64, right: &mut [f64]) -> f64 {
        self.each_term(solution, |row, term| right[row] -= term);
        let worst = largest(right);
        if worst == 0.0 { 0.0 } else { worst / size }
    }

    /// Hands on each term of the product of the matrix with a solution, with its row.
    #[inline(always)]
    fn each_term(&self, solution: &[f64], mut add: impl FnMut(usize, f64)) {
        let places = self.matrix.rows.iter().zip(&self.matrix.cols);
        for ((&row, &col), value) in places.zip(&self.values) {
            let (row, col) = (row as usize, col as usize);
            add(row, value * solution[col]);
            if row != col {
                add(col, value * solution[row]);
            }
        }
    }
}

/// Rows and columns of the entries of a matrix of conditions.
#[derive(Debug, Default)]
pub(crate) struct Matrix {
    pub(crate) rows: Vec<u32>,
    pub(crate) cols: Vec<u32>,
}

impl Matrix {
    pub(crate) fn push(&mut self, row: usize, col: usize) {
        self.rows.push(row as u32);
        self.cols.push(col as u32);
    }

    /// Adds the entries whose row and column are unknowns; returns which they are.
    pub(crate) fn add(
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

/// The greatest size in a list; infinite where a number is not.
pub(super) fn largest(list: &[f64]) -> f64 {
    list.iter()
        .fold(0.0, |largest: f64, value| match value.is_nan() {
            true => f64::INFINITY,
            false => largest.max(value.abs()),
        })
}

/// A variable or an inequality relative to its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Between its bounds: it follows from the conditions of the optimum.
    Free,
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
    /// An equation.
    Equation,
    /// Held at its value, or left out.
    Held,
}

impl Place {
    /// Returns true if a multiplier holds it.
    pub(super) fn is_reached(self) -> bool {
        matches!(self, Self::Lower | Self::Upper)
    }

    /// Sign of the multiplier in `∇f + Jᵀy + z = 0`: negative at a lower bound.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            _ => 1.0,
        }
    }
}

/// Places of variables; `multipliers` of their lower and upper bounds.
pub(super) fn of_variables(
    (x, bounds): (&[f64], &Bounds),
    [lower, upper]: [&[f64]; 2],
    is_held: &[bool],
) -> Vec<Place> {
    let place = |i: usize| {
        let distances = [x[i] - bounds.lower[i], bounds.upper[i] - x[i]];
        match is_held[i] || bounds.lower[i] == bounds.upper[i] {
            true => Place::Held,
            false => nearest(distances, [lower[i], upper[i]]),
        }
    };
    (0..x.len()).map(place).collect()
}

/// Places of constraints with these values and multipliers.
pub(super) fn of_constraints(
    (g, bounds): (&[f64], &Bounds),
    multipliers: &[f64],
    is_left_out: &[bool],
) -> Vec<Place> {
    let place = |i: usize| {
        let distances = [g[i] - bounds.lower[i], bounds.upper[i] - g[i]];
        match bounds.lower[i] == bounds.upper[i] {
            _ if is_left_out[i] => Place::Held,
            true => Place::Equation,
            false => nearest(distances, [-multipliers[i], multipliers[i]]),
        }
    };
    (0..g.len()).map(place).collect()
}

/// The bound whose multiplier is greater than the distance from it.
fn nearest(distances: [f64; 2], multipliers: [f64; 2]) -> Place {
    let over = |side: usize| multipliers[side] - distances[side].max(0.0);
    match (over(0) > 0.0, over(1) > 0.0) {
        (true, false) => Place::Lower,
        (false, true) => Place::Upper,
        (true, true) if over(0) >= over(1) => Place::Lower,
        (true, true) => Place::Upper,
        (false, false) => Place::Free,
    }
}

/// Parts of a program that are no parts of the optimum.
#[derive(Clone, Debug)]
pub struct Held {
    /// True for each variable that is held at its value; its bounds do not count.
    pub variables: Vec<bool>,
    /// True for each constraint that is left out.
    pub constraints: Vec<bool>,
    /// Variables that enter by their squares alone while these are held, in the place of those of the program.
    pub squares: Option<Vec<usize>>,
}

/// Side of a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

/// Changes with a parameter p while all unknowns stay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Direction {
    /// Derivatives of variables that are held.
    pub held: Vec<(usize, f64)>,
    /// Derivatives of bounds of variables.
    pub bounds: Vec<(usize, Side, f64)>,
    /// Derivatives of bounds of constraints; both of an equation.
    pub constraint_bounds: Vec<(usize, Side, f64)>,
    /// Derivatives of constraints beside those through variables that are held.
    pub constraints: Vec<(usize, f64)>,
    /// Derivatives of the gradient of the objective beside those.
    pub gradient: Vec<(usize, f64)>,
    /// Derivative of the objective beside those.
    pub objective: f64,
}

impl Side {
    /// The place of a variable that has reached it.
    pub(super) fn place(self) -> Place {
        match self {
            Self::Lower => Place::Lower,
            Self::Upper => Place::Upper,
        }
    }

    /// The bounds of this side.
    pub(super) fn of(self, bounds: &Bounds) -> &[f64] {
        match self {
            Self::Lower => &bounds.lower,
            Self::Upper => &bounds.upper,
        }
    }
}
