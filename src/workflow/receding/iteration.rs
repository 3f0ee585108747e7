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

use crate::kkt::{Plan, Solver, Unknown};
use crate::nlp::{Bounds, Entries, Nlp};
use crate::sensitivity::Matrix;

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
    pub(super) bounds: [Vec<f64>; 2],
    /// Number of variables of the program.
    pub(super) columns: usize,
    /// Slack of each row.
    slacks: Vec<Option<usize>>,
    /// Unknown of each variable and slack, and of each row; none of what is held.
    pub(super) unknowns: Vec<Option<usize>>,
    pub(super) rows: Vec<Option<usize>>,
    jacobian: Entries,
    /// Entries of the Hessian and of the Jacobian in the matrix.
    kept: [Vec<usize>; 2],
    /// Entries by held variables: unknown of the row, variable, entry.
    pub(super) held: [Vec<(usize, usize, usize)>; 2],
    gradient: Vec<f64>,
    /// Values of the rows where they were evaluated last.
    pub(super) g: Vec<f64>,
    pub(super) jacobian_values: Vec<f64>,
    pub(super) hessian_values: Vec<f64>,
    zeros: Vec<f64>,
    values: Vec<f64>,
    pub(super) right: Vec<f64>,
    /// Σ of each variable and slack.
    weights: Vec<f64>,
    pub(super) solution: Vec<f64>,
    pub(super) step: Vec<f64>,
    /// True if a bound cut the last step of the slack of a limit.
    pub(super) is_cut: bool,
    pub(super) solver: Solver,
}

impl<N: Nlp> Iteration<N> {
    /// The iteration of a program in which some variables are held; rows without another variable are left out.
    pub(super) fn new(program: N, x: &[f64], is_held: &[bool], barrier: f64) -> Self {
        let [jacobian, hessian] = [program.jacobian_structure(), program.hessian_structure()];
        let columns = x.len();
        let row_bounds = program.constraints();
        let count = row_bounds.lower.len();
        let mut has_unknown = vec![false; count];
        for (&row, &col) in jacobian.rows.iter().zip(&jacobian.cols) {
            has_unknown[row as usize] |= !is_held[col as usize];
        }
        let Bounds { lower, upper } = program.variables().clone();
        let mut bounds = [lower, upper];
        let mut slacks = vec![None; count];
        for row in 0..count {
            let (low, high) = (row_bounds.lower[row], row_bounds.upper[row]);
            if has_unknown[row] && low < high {
                slacks[row] = Some(bounds[0].len());
                bounds[0].push(low);
                bounds[1].push(high);
            }
        }
        let mut order = 0;
        let mut number = |is_one: bool| {
            is_one.then(|| {
                order += 1;
                order - 1
            })
        };
        let all = bounds[0].len();
        let unknowns: Vec<_> = (0..all)
            .map(|i| number(i >= columns || !is_held[i]))
            .collect();
        let rows: Vec<_> = has_unknown.iter().map(|one| number(*one)).collect();
        let kinds = kinds(&program, (&unknowns, &rows), &slacks, columns);
        let mut matrix = Matrix::default();
        let kept = [
            matrix.add(&hessian, (&unknowns, &unknowns)),
            matrix.add(&jacobian, (&rows, &unknowns)),
        ];
        unknowns.iter().flatten().for_each(|&i| matrix.push(i, i));
        for (row, slack) in slacks.iter().enumerate() {
            if let (Some(row), Some(slack)) = (rows[row], slack) {
                matrix.push(row, unknowns[*slack].expect("a slack is no held variable"));
            }
        }
        let plan = Plan::new(order, &matrix.rows, &matrix.cols, kinds.as_deref());
        let zeros = |length: usize| vec![0.0; length];
        let mut out = Self {
            held: [
                held(&hessian, (&unknowns, &unknowns), true),
                held(&jacobian, (&rows, &unknowns), false),
            ],
            solver: Solver::new(plan),
            x: x.to_vec(),
            y: zeros(count),
            z: [zeros(all), zeros(all)],
            gradient: zeros(columns),
            g: zeros(count),
            jacobian_values: zeros(jacobian.rows.len()),
            hessian_values: zeros(hessian.rows.len()),
            zeros: zeros(count),
            values: zeros(matrix.rows.len()),
            right: zeros(order),
            solution: zeros(order),
            weights: zeros(all),
            step: zeros(all),
            is_cut: false,
            program,
            barrier,
            bounds,
            columns,
            slacks,
            unknowns,
            rows,
            jacobian,
            kept,
        };
        out.x.resize(all, 0.0);
        out.begin();
        out
    }

    /// Begins anew at the variables that are set: slacks of their values, no multipliers of rows.
    pub(super) fn begin(&mut self) {
        self.y.fill(0.0);
        (0..self.columns).for_each(|i| self.centre(i));
        self.program
            .constraint(&self.x[..self.columns], &mut self.g);
        for row in 0..self.slacks.len() {
            if let Some(slack) = self.slacks[row] {
                self.x[slack] = self.g[row];
                self.centre(slack);
            }
        }
    }

    /// Puts a variable inside its bounds, with the multipliers of its place.
    pub(super) fn centre(&mut self, i: usize) {
        if self.unknowns[i].is_some() {
            self.put_inside(i);
            self.z[0][i] = self.barrier / (self.x[i] - self.bounds[0][i]);
            self.z[1][i] = self.barrier / (self.bounds[1][i] - self.x[i]);
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
    pub(super) fn near(&self, i: usize, z: f64, distance: f64) -> f64 {
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
            let below = self.x[slack] - self.bounds[0][slack];
            let above = self.bounds[1][slack] - self.x[slack];
            self.z[0][slack] = self.near(slack, self.z[0][slack], below);
            self.z[1][slack] = self.near(slack, self.z[1][slack], above);
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
        let hessian = self.kept[0].iter().map(|&entry| self.hessian_values[entry]);
        let jacobian = self.kept[1]
            .iter()
            .map(|&entry| self.jacobian_values[entry]);
        let weights = self.unknowns.iter().zip(&self.weights);
        let weights = weights.filter_map(|(number, weight)| number.map(|_| *weight));
        let slacks = self.slacks.iter().flatten().map(|_| -1.0);
        let all = hessian.chain(jacobian).chain(weights).chain(slacks);
        self.values
            .iter_mut()
            .zip(all)
            .for_each(|(to, value)| *to = value);
        let found = self.solver.factor(&self.values);
        let equations = self.rows.iter().flatten().count();
        found.zero == 0 && found.negative == equations
    }

    /// Residuals of the conditions, with the barrier, as a right side; Σ.
    fn set_right(&mut self) {
        self.right.fill(0.0);
        for (i, number) in self.unknowns.iter().enumerate() {
            let Some(number) = *number else { continue };
            let below = self.x[i] - self.bounds[0][i];
            let above = self.bounds[1][i] - self.x[i];
            self.weights[i] = self.z[0][i] / below + self.z[1][i] / above;
            let gradient = self.gradient.get(i).copied().unwrap_or(0.0);
            self.right[number] = -gradient + self.barrier / below - self.barrier / above;
        }
        let entries = self.jacobian.rows.iter().zip(&self.jacobian.cols);
        for ((&row, &col), value) in entries.zip(&self.jacobian_values) {
            if let Some(number) = self.unknowns[col as usize] {
                self.right[number] -= value * self.y[row as usize];
            }
        }
        let target = &self.program.constraints().lower;
        for (row, number) in self.rows.iter().enumerate() {
            let Some(number) = *number else { continue };
            self.right[number] = match self.slacks[row] {
                None => target[row] - self.g[row],
                Some(slack) => {
                    let place = self.unknowns[slack].expect("a slack is no held variable");
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
            equations: largest(&self.rows),
            gradient: largest(&self.unknowns),
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
        for (list, values) in self
            .held
            .iter()
            .zip([&self.hessian_values, &self.jacobian_values])
        {
            for &(row, variable, entry) in list {
                self.solution[row] -= values[entry] * self.step[variable];
            }
        }
        for &(row, value) in rows {
            if let Some(number) = self.rows[row] {
                self.solution[number] -= value;
            }
        }
        self.solver.solve(&mut self.solution);
        if !self.solution.iter().all(|value| value.is_finite()) {
            return false;
        }
        for (step, number) in self.step.iter_mut().zip(&self.unknowns) {
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
        for i in 0..self.unknowns.len() {
            let dx = self.step[i];
            if self.unknowns[i].is_none() {
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
        for (y, number) in self.y.iter_mut().zip(&self.rows) {
            if let Some(number) = *number {
                *y += allowed[0] * self.solution[number];
            }
        }
        is_cut
    }

    /// Parts of the steps of a variable or slack and of its multipliers that its bounds allow.
    fn allowed(&self, i: usize) -> [f64; 2] {
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        if self.unknowns[i].is_none() {
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
