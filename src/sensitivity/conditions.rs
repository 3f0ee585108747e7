//! The conditions of an optimum at a point, over the squares of those variables that enter by squares alone.

use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Multipliers, Nlp, Stage};

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
