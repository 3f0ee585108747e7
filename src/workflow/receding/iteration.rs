//! One iteration of a primal-dual interior-point method with a fixed barrier, in two parts: one before what is measured is known, one after.
//!
//! With the unknowns x of a program and slacks s of its inequalities, bounds l ≤ (x, s) ≤ u and multipliers y, z, Newton's method for
//!
//! ```text
//! ∇f + Jᵀy − z_l + z_u = 0,     g(x) = 0 or s,     z_l (x − l) = μ,     z_u (u − x) = μ
//! ```
//!
//! solves in each iteration (Σ = z_l/(x − l) + z_u/(u − x))
//!
//! ```text
//! ⎡ ∇²L + Σ   Jᵀ ⎤ ⎡ Δx ⎤     ⎡ ∇f + Jᵀy − μ/(x − l) + μ/(u − x) ⎤
//! ⎣ J         0  ⎦ ⎣ Δy ⎦ = − ⎣ g                                 ⎦
//! ```
//!
//! The preparation evaluates and factorises; variables that are held, as the state that will be measured, enter the right side alone, so that the
//! rest is one substitution. If the matrix has not as many negative eigenvalues as there are equations, the curvature of the equations is left out,
//! and that once: the work is bounded.
//!
//! The second part of an iteration: what was measured enters the right side, and each variable goes as far as its bounds allow.

use crate::nlp::{Entries, Nlp};
use crate::sensitivity::Saddle;

/// A point starts no nearer to its bounds than this part of their distance, or of one.
const INSIDE: f64 = 1e-4;
/// A multiplier of a bound differs from μ over the distance by no more than the first factor, that of a slack by no more than the second one.
const NEAR: [f64; 2] = [1e4, 1e2];

/// Conditions that a point does not meet yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Greatest residual of the scaled equations.
    pub equations: f64,
    /// Greatest residual of the gradient of the Lagrangian.
    pub gradient: f64,
}

/// A point with the factors of its next iteration.
#[derive(Debug)]
pub(super) struct Iteration<N> {
    pub(super) program: N,
    pub(super) barrier: f64,
    /// Variables, then the slack of each inequality; multipliers of rows; those of lower and upper bounds.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: [Vec<f64>; 2],
    bounds: [Vec<f64>; 2],
    /// Number of variables of the program.
    pub(super) columns: usize,
    /// Slack of each row.
    slacks: Vec<Option<usize>>,
    /// The matrix, over all that is not held.
    saddle: Saddle,
    jacobian: Entries,
    /// Entries by held variables.
    held: [Vec<HeldEntry>; 2],
    gradient: Vec<f64>,
    /// Values of the rows where they were evaluated last.
    pub(super) g: Vec<f64>,
    jacobian_values: Vec<f64>,
    hessian_values: Vec<f64>,
    zeros: Vec<f64>,
    right: Vec<f64>,
    /// Σ of each variable and slack.
    weights: Vec<f64>,
    solution: Vec<f64>,
    step: Vec<f64>,
    /// True if a bound cut the last step of the slack of a limit.
    pub(super) is_cut: bool,
}

/// An entry of a matrix in the row of an unknown by a held variable.
#[derive(Clone, Copy, Debug)]
struct HeldEntry {
    unknown: usize,
    variable: usize,
    entry: usize,
}

impl<N: Nlp> Iteration<N> {
    /// The iteration of a program in which some variables are held; rows without another variable are left out.
    pub(super) fn new(program: N, x: &[f64], is_held: &[bool], barrier: f64) -> Self {
        let [jacobian, hessian] = [program.jacobian_structure(), program.hessian_structure()];
        let columns = x.len();
        let row_bounds = program.constraints();
        let count = row_bounds.count();
        let mut has_unknown = vec![false; count];
        for (row, col) in jacobian.places() {
            has_unknown[row] |= !is_held[col];
        }
        let mut bounds = program.variables().clone();
        let mut slacks = vec![None; count];
        for row in 0..count {
            let (low, high) = (row_bounds.lower[row], row_bounds.upper[row]);
            if has_unknown[row] && low < high {
                slacks[row] = Some(bounds.count());
                bounds.push(low, high);
            }
        }
        let all = bounds.count();
        let saddle = Saddle::new(
            [&hessian, &jacobian],
            (0..all).map(|i| i >= columns || !is_held[i]),
            has_unknown.into_iter(),
            Some(&slacks),
            program.stages().as_deref(),
        );
        let order = saddle.order();
        let zeros = |length: usize| vec![0.0; length];
        let mut out = Self {
            held: [
                held(&hessian, &saddle.columns, &saddle.columns, true),
                held(&jacobian, &saddle.rows, &saddle.columns, false),
            ],
            x: x.to_vec(),
            y: zeros(count),
            z: [zeros(all), zeros(all)],
            gradient: zeros(columns),
            g: zeros(count),
            jacobian_values: zeros(jacobian.count()),
            hessian_values: zeros(hessian.count()),
            zeros: zeros(count),
            right: zeros(order),
            solution: zeros(order),
            weights: zeros(all),
            step: zeros(all),
            is_cut: false,
            program,
            barrier,
            bounds: [bounds.lower, bounds.upper],
            columns,
            slacks,
            saddle,
            jacobian,
        };
        out.x.resize(all, 0.0);
        out.begin();
        out
    }

    /// Begins anew at the variables that are set: slacks of their values, no multipliers of rows.
    pub(super) fn begin(&mut self) {
        self.y.fill(0.0);
        (0..self.columns).for_each(|i| self.centre(i));
        self.evaluate_rows();
        for row in 0..self.slacks.len() {
            if let Some(slack) = self.slacks[row] {
                self.x[slack] = self.g[row];
                self.centre(slack);
            }
        }
    }

    /// Puts a variable inside its bounds, with the multipliers of its place.
    pub(super) fn centre(&mut self, i: usize) {
        if self.is_unknown(i) {
            self.put_inside(i);
            let distances = self.distances(i);
            self.set_multipliers(i, distances.map(|distance| self.barrier / distance));
        }
    }

    fn is_unknown(&self, i: usize) -> bool {
        self.saddle.columns[i].is_some()
    }

    /// Sets the multipliers of both bounds.
    fn set_multipliers(&mut self, i: usize, values: [f64; 2]) {
        for (z, value) in self.z.iter_mut().zip(values) {
            z[i] = value;
        }
    }

    /// Puts a variable inside its bounds.
    fn put_inside(&mut self, i: usize) {
        let [low, high] = [self.bounds[0][i], self.bounds[1][i]];
        let range = if (high - low).is_finite() {
            high - low
        } else {
            1.0
        };
        let margin = INSIDE * range;
        self.x[i] = self.x[i].max(low + margin).min(high - margin);
    }

    /// A multiplier of a bound of variable or slack `i` at a distance, near that of its place.
    fn near(&self, i: usize, z: f64, distance: f64) -> f64 {
        let of_place = self.barrier / distance;
        let near = NEAR[usize::from(i >= self.columns)];
        z.clamp(of_place / near, of_place * near)
    }

    /// Gives slacks the values of their rows, inside their bounds, so that a limit that is kept leaves no residual.
    fn renew_slacks(&mut self) {
        for row in 0..self.slacks.len() {
            let Some(slack) = self.slacks[row] else {
                continue;
            };
            self.x[slack] = self.g[row];
            self.put_inside(slack);
            let distances = self.distances(slack);
            let near = |side: usize| self.near(slack, self.z[side][slack], distances[side]);
            self.set_multipliers(slack, [near(0), near(1)]);
        }
    }

    /// Evaluates and factorises at the point; false if there are no factors of a minimum.
    pub(super) fn prepare(&mut self) -> bool {
        let (x, y) = (&self.x[..self.columns], &self.y);
        self.program.gradient(x, &mut self.gradient);
        self.program.constraint(x, &mut self.g);
        self.program.jacobian(x, &mut self.jacobian_values);
        self.program.hessian(x, 1.0, y, &mut self.hessian_values);
        self.renew_slacks();
        self.set_right();
        if !self.right.iter().all(|value| value.is_finite()) {
            return false;
        }
        if self.factor() {
            return true;
        }
        let x = &self.x[..self.columns];
        self.program
            .hessian(x, 1.0, &self.zeros, &mut self.hessian_values);
        self.factor()
    }

    fn factor(&mut self) -> bool {
        let (hessian, jacobian) = (&self.hessian_values, &self.jacobian_values);
        let found = self.saddle.factor(hessian, jacobian, &self.weights);
        found.zero == 0 && found.negative == self.saddle.equations
    }

    /// Residuals of the conditions, with the barrier, as a right side; Σ.
    fn set_right(&mut self) {
        self.right.fill(0.0);
        for i in 0..self.weights.len() {
            let Some(number) = self.saddle.columns[i] else {
                continue;
            };
            let [below, above] = self.distances(i);
            self.weights[i] = self.z[0][i] / below + self.z[1][i] / above;
            let gradient = self.gradient.get(i).copied().unwrap_or(0.0);
            self.right[number] = -gradient + self.barrier / below - self.barrier / above;
        }
        for (row, col, value) in self.jacobian.with(&self.jacobian_values) {
            if let Some(number) = self.saddle.columns[col] {
                self.right[number] -= value * self.y[row];
            }
        }
        let target = &self.program.constraints().lower;
        for (row, number) in self.saddle.rows.iter().enumerate() {
            let Some(number) = *number else { continue };
            self.right[number] = match self.slacks[row] {
                None => target[row] - self.g[row],
                Some(slack) => {
                    let place = self.saddle.columns[slack].expect("a slack is no held variable");
                    self.right[place] += self.y[row];
                    self.x[slack] - self.g[row]
                }
            };
        }
    }

    /// Conditions of the point that was prepared.
    pub(super) fn residual(&self) -> Residual {
        let largest = |numbers: &[Option<usize>]| {
            let all = numbers.iter().flatten().map(|&i| self.right[i].abs());
            all.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
        };
        Residual {
            equations: largest(&self.saddle.rows),
            gradient: largest(&self.saddle.columns),
        }
    }

    /// The slack of a row.
    pub(super) fn slack(&self, row: usize) -> Option<usize> {
        self.slacks[row]
    }

    /// Evaluates the rows of the program at the point.
    pub(super) fn evaluate_rows(&mut self) {
        self.program
            .constraint(&self.x[..self.columns], &mut self.g);
    }
}

/// Entries in the row of an unknown by a held variable; of a symmetric matrix in either triangle.
fn held(
    entries: &Entries,
    rows: &[Option<usize>],
    columns: &[Option<usize>],
    is_symmetric: bool,
) -> Vec<HeldEntry> {
    let of = |(entry, (row, col))| {
        let (unknown, variable) = match (rows[row], columns[col]) {
            (Some(unknown), None) => (unknown, col),
            (None, Some(unknown)) if is_symmetric => (unknown, row),
            _ => return None,
        };
        Some(HeldEntry {
            unknown,
            variable,
            entry,
        })
    };
    entries.places().enumerate().filter_map(of).collect()
}

/// Part of the way to a bound that a step may go.
const TOWARDS: f64 = 0.995;
/// A step of a slack is cut if less than this part of it is taken; steps of scaled limits below the other number do not count.
const WHOLE: f64 = 0.5;
const STILL: f64 = 1e-6;

impl<N: Nlp> Iteration<N> {
    /// Takes the step of the point that was prepared, with changes of held variables and of the values of rows; false if it is not finite. The
    /// variables of the whole step go to `full`.
    pub(super) fn advance(
        &mut self,
        changes: &[(usize, f64)],
        rows: &[(usize, f64)],
        full: &mut [f64],
    ) -> bool {
        self.step.fill(0.0);
        changes.iter().for_each(|&(i, value)| self.step[i] = value);
        self.solution.copy_from_slice(&self.right);
        let values = [&self.hessian_values, &self.jacobian_values];
        for (list, values) in self.held.iter().zip(values) {
            for of in list {
                self.solution[of.unknown] -= values[of.entry] * self.step[of.variable];
            }
        }
        for &(row, value) in rows {
            if let Some(number) = self.saddle.rows[row] {
                self.solution[number] -= value;
            }
        }
        self.saddle.solver.solve(&mut self.solution);
        if !self.solution.iter().all(|value| value.is_finite()) {
            return false;
        }
        for (step, number) in self.step.iter_mut().zip(&self.saddle.columns) {
            if let Some(number) = *number {
                *step = self.solution[number];
            }
        }
        let values = self.x.iter().zip(&self.step);
        full.iter_mut()
            .zip(values)
            .for_each(|(to, (x, dx))| *to = x + dx);
        self.is_cut = self.take_step();
        true
    }

    /// Takes the step as far as bounds of variables allow, and that of each slack as far as its own ones do: limits that are reached hold nothing else
    /// back. Returns true if one of them cut the step of its slack.
    fn take_step(&mut self) -> bool {
        let variables = 0..self.columns;
        let allowed = variables.fold([1.0_f64; 2], |[primal, dual], i| {
            let own = self.allowed(i);
            [primal.min(own[0]), dual.min(own[1])]
        });
        let mut is_cut = false;
        for i in 0..self.step.len() {
            let dx = self.step[i];
            if !self.is_unknown(i) {
                self.x[i] += dx;
                continue;
            }
            let is_slack = i >= self.columns;
            let [primal, dual] = if is_slack { self.allowed(i) } else { allowed };
            is_cut |= is_slack && primal < WHOLE && dx.abs() > STILL;
            let distances = self.distances(i);
            let after = [distances[0] + primal * dx, distances[1] - primal * dx];
            for side in 0..2 {
                let z = self.z[side][i] + dual * self.change(side, i, distances[side]);
                self.z[side][i] = self.near(i, z, after[side]);
            }
            self.x[i] += primal * dx;
        }
        for (y, number) in self.y.iter_mut().zip(&self.saddle.rows) {
            if let Some(number) = *number {
                *y += allowed[0] * self.solution[number];
            }
        }
        is_cut
    }

    /// Parts of the steps of a variable or slack and of its multipliers that its bounds allow.
    fn allowed(&self, i: usize) -> [f64; 2] {
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        if !self.is_unknown(i) {
            return [primal, dual];
        }
        let dx = self.step[i];
        for (side, (distance, towards)) in self.distances(i).into_iter().zip([-dx, dx]).enumerate()
        {
            if towards > 0.0 {
                primal = primal.min(TOWARDS * distance / towards);
            }
            let dz = self.change(side, i, distance);
            if dz < 0.0 {
                dual = dual.min(-TOWARDS * self.z[side][i] / dz);
            }
        }
        [primal, dual]
    }

    /// Distances of a variable or slack from its bounds.
    fn distances(&self, i: usize) -> [f64; 2] {
        [self.x[i] - self.bounds[0][i], self.bounds[1][i] - self.x[i]]
    }

    /// Δz of a bound at a distance.
    fn change(&self, side: usize, i: usize, distance: f64) -> f64 {
        let away = if side == 0 {
            self.step[i]
        } else {
            -self.step[i]
        };
        let z = self.z[side][i];
        (self.barrier - z * away) / distance - z
    }
}
