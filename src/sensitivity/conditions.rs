//! The conditions of an optimum at a point, over the squares of those variables that enter by squares alone.
//!
//! The linear system of the derivatives of an optimum, over unknowns that no bound holds and equations that hold.
//!
//! Bounds that an optimum has reached: the multiplier of such a bound is greater than the distance from it.

use crate::kkt::{Inertia, Plan, Solver, Unknown};
use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Multipliers, Nlp, Stage};
use std::iter;

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
    /// Places of both.
    pub(super) columns: Vec<Place>,
    pub(super) rows: Vec<Place>,
    /// The unknowns, and the multipliers of constraints.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// ∇f + Jᵀy.
    pub(super) slopes: Vec<f64>,
    pub(super) g: Vec<f64>,
    /// The unknowns at which the constraints have these values.
    constrained: Vec<f64>,
    pub(super) jacobian_values: Vec<f64>,
    pub(super) hessian_values: Vec<f64>,
}

/// Places of variables and constraints.
pub(super) enum Places<'a> {
    /// Those of the optimum of an equal program to which Newton's method has moved.
    Known([Vec<Place>; 2]),
    /// Those that the multipliers show, of all that is not held.
    Shown(&'a Held),
}

impl<N: Nlp> Conditions<N> {
    /// A program at a point x with its constraints. `squares` are the variables that enter by their squares where the program does not know. Variables that
    /// have reached a bound are moved to it.
    pub(super) fn new(
        program: N,
        x: &[f64],
        multipliers: &Multipliers,
        squares: Option<&[usize]>,
        places: Places<'_>,
    ) -> Self {
        let list = squares.map_or_else(|| program.squares(), <[usize]>::to_vec);
        let squares = Squares::of(&program, list);
        let scale = program.objective_scale();
        let [hessian, jacobian] = [program.hessian_structure(), program.jacobian_structure()];
        let mut bounds = program.variables().clone();
        squares.square(&mut bounds.lower);
        squares.square(&mut bounds.upper);
        let mut unknowns = x.to_vec();
        squares.square(&mut unknowns);
        // Those of the unknowns and of the scaled objective.
        let mut multipliers = multipliers.clone();
        squares.of_squares(x, &mut multipliers);
        let Multipliers {
            constraints: y,
            lower,
            upper,
        } = &mut multipliers;
        for list in [&mut *y, lower, upper] {
            list.iter_mut().for_each(|value| *value *= scale);
        }
        let mut out = Self {
            row_bounds: program.constraints().clone(),
            program: InSquares::new(program, squares.clone(), &jacobian, &hessian),
            squares,
            scale,
            gradient: vec![0.0; x.len()],
            slopes: vec![0.0; x.len()],
            g: vec![0.0; y.len()],
            jacobian_values: vec![0.0; jacobian.count()],
            hessian_values: vec![0.0; hessian.count()],
            hessian,
            jacobian,
            bounds,
            columns: Vec::new(),
            rows: Vec::new(),
            constrained: unknowns.clone(),
            x: unknowns,
            y: y.clone(),
        };
        out.program.constraint(&out.x, &mut out.g);
        out.take_places(places, &multipliers);
        out.evaluate();
        out
    }

    /// Takes the places of variables and constraints, and puts variables at bounds that they have reached.
    fn take_places(&mut self, places: Places<'_>, multipliers: &Multipliers) {
        let is_known = matches!(places, Places::Known(_));
        [self.columns, self.rows] = match places {
            Places::Known(places) => places,
            Places::Shown(held) => [
                self.of_variables(multipliers, &held.variables),
                self.of_constraints(&held.constraints),
            ],
        };
        for (i, place) in self.columns.iter().enumerate() {
            let bounds = [self.bounds.lower[i], self.bounds.upper[i]];
            let x = &mut self.x[i];
            match place {
                Place::Lower => *x = bounds[0],
                Place::Upper => *x = bounds[1],
                // Where a bound is reached without a multiplier nothing of what follows is to be rounding.
                Place::Free if !is_known => {
                    for bound in bounds {
                        if (*x - bound).abs() < WEAK {
                            *x = bound;
                        }
                    }
                }
                _ => {}
            }
        }
        for (y, place) in self.y.iter_mut().zip(&self.rows) {
            if matches!(place, Place::Free | Place::Held) {
                *y = 0.0;
            }
        }
    }

    /// Places of variables, by the multipliers of their lower and upper bounds.
    fn of_variables(&self, multipliers: &Multipliers, is_held: &[bool]) -> Vec<Place> {
        let (x, bounds) = (&self.x, &self.bounds);
        let Multipliers { lower, upper, .. } = multipliers;
        let place = |i: usize| {
            let distances = [x[i] - bounds.lower[i], bounds.upper[i] - x[i]];
            match is_held[i] || bounds.are_equal(i) {
                true => Place::Held,
                false => nearest(distances, [lower[i], upper[i]]),
            }
        };
        (0..x.len()).map(place).collect()
    }

    /// Places of constraints, by their values and multipliers.
    fn of_constraints(&self, is_left_out: &[bool]) -> Vec<Place> {
        let (g, y, bounds) = (&self.g, &self.y, &self.row_bounds);
        let place = |i: usize| {
            let distances = [g[i] - bounds.lower[i], bounds.upper[i] - g[i]];
            match bounds.are_equal(i) {
                _ if is_left_out[i] => Place::Held,
                true => Place::Equation,
                false => nearest(distances, [-y[i], y[i]]),
            }
        };
        (0..g.len()).map(place).collect()
    }

    /// Evaluates first derivatives and constraints.
    pub(super) fn evaluate(&mut self) {
        self.program.gradient(&self.x, &mut self.gradient);
        let gradient = self.gradient.iter_mut();
        gradient.for_each(|value| *value *= self.scale);
        if self.constrained != self.x {
            self.program.constraint(&self.x, &mut self.g);
            self.constrained.copy_from_slice(&self.x);
        }
        self.program.jacobian(&self.x, &mut self.jacobian_values);
        self.slopes.copy_from_slice(&self.gradient);
        let (values, slopes) = (&self.jacobian_values, &mut self.slopes);
        self.jacobian.add_transposed(values, &self.y, slopes);
    }

    /// Evaluates second derivatives.
    pub(super) fn evaluate_hessian(&mut self) {
        let (x, y, values) = (&self.x, &self.y, &mut self.hessian_values);
        self.program.hessian(x, self.scale, y, values);
    }

    /// Adds Jᵀ v to a list.
    pub(super) fn add_transposed(&self, v: &[f64], to: &mut [f64]) {
        self.jacobian.add_transposed(&self.jacobian_values, v, to);
    }

    /// Adds J v to a list.
    pub(super) fn add_times(&self, v: &[f64], to: &mut [f64]) {
        for (row, col, value) in self.jacobian.with(&self.jacobian_values) {
            // Few columns change at once.
            if v[col] != 0.0 {
                to[row] += value * v[col];
            }
        }
    }

    /// Adds ∇²L v to a list.
    pub(super) fn add_curved(&self, v: &[f64], to: &mut [f64]) {
        for (row, col, value) in self.hessian.with(&self.hessian_values) {
            if v[col] != 0.0 {
                to[row] += value * v[col];
            }
            if row != col && v[row] != 0.0 {
                to[col] += value * v[row];
            }
        }
    }

    /// The program.
    pub(super) fn program(&self) -> &N {
        &self.program.program
    }

    /// The variables of the program.
    pub(super) fn point(&self) -> Vec<f64> {
        let mut x = self.x.clone();
        self.squares.root(&mut x);
        x
    }
}

/// The matrix of conditions over some of the variables and slacks of a program, and some of its constraints, with its factors.
#[derive(Debug)]
pub(crate) struct Saddle {
    /// Number of each variable and slack among the unknowns, and of each constraint.
    pub(crate) columns: Vec<Option<usize>>,
    pub(crate) rows: Vec<Option<usize>>,
    /// Entries of Hessian and Jacobian that are in the matrix.
    kept: [Vec<usize>; 2],
    entries: Entries,
    values: Vec<f64>,
    /// Unknowns that are constraints.
    pub(crate) equations: usize,
    pub(crate) solver: Solver,
}

impl Saddle {
    /// Lays out the matrix of Hessian (lower triangle) and Jacobian; with `slacks` of constraints, which stand behind the variables, also Σ and their columns.
    pub(crate) fn new(
        [hessian, jacobian]: [&Entries; 2],
        is_free: impl Iterator<Item = bool>,
        holds: impl Iterator<Item = bool>,
        slacks: Option<&[Option<usize>]>,
        stages: Option<&[Stage]>,
    ) -> Self {
        let mut order = 0;
        let mut number = |is_one: bool| {
            is_one.then(|| {
                order += 1;
                order - 1
            })
        };
        let columns: Vec<_> = is_free.map(&mut number).collect();
        let rows: Vec<_> = holds.map(&mut number).collect();
        let mut entries = Entries::default();
        let mut keep = |from: &Entries, rows: &[Option<usize>]| {
            let mut kept = Vec::new();
            for (entry, (row, col)) in from.places().enumerate() {
                if let (Some(row), Some(col)) = (rows[row], columns[col]) {
                    entries.push(row, col);
                    kept.push(entry);
                }
            }
            kept
        };
        let kept = [keep(hessian, &columns), keep(jacobian, &rows)];
        if slacks.is_some() {
            let diagonal = columns.iter().flatten();
            diagonal.for_each(|&i| entries.push(i, i));
        }
        let slack = |row: usize| slacks.and_then(|slacks| slacks[row]);
        let of_slack = |row: usize| Some((rows[row]?, columns[slack(row)?]?));
        let of_slacks = (0..rows.len()).filter_map(of_slack);
        of_slacks.for_each(|(row, column)| entries.push(row, column));
        let kinds = stages.map(|stages| {
            let unknown = |i: usize| stages.get(i).map_or(Unknown::Slack, |&stage| stage.into());
            let free = (0..columns.len()).filter(|&i| columns[i].is_some());
            let held = (0..rows.len()).filter(|&row| rows[row].is_some());
            let equation = |row| slack(row).map_or(Unknown::Equality, |_| Unknown::Inequality);
            free.map(unknown).chain(held.map(equation)).collect()
        });
        let kinds: Option<Vec<Unknown>> = kinds;
        let plan = Plan::new(order, &entries.rows, &entries.cols, kinds.as_deref());
        Self {
            solver: Solver::new(plan),
            values: vec![0.0; entries.count()],
            equations: rows.iter().flatten().count(),
            columns,
            rows,
            kept,
            entries,
        }
    }

    /// Number of unknowns.
    pub(crate) fn order(&self) -> usize {
        self.solver.plan().order()
    }

    /// Factorises the matrix with values of Hessian and Jacobian, and Σ of each variable and slack, if slacks are laid out.
    pub(crate) fn factor(&mut self, hessian: &[f64], jacobian: &[f64], sigma: &[f64]) -> Inertia {
        let hessian = self.kept[0].iter().map(|&entry| hessian[entry]);
        let jacobian = self.kept[1].iter().map(|&entry| jacobian[entry]);
        let sigma = self.columns.iter().zip(sigma);
        let sigma = sigma.filter_map(|(number, sigma)| number.map(|_| *sigma));
        let of_slacks = iter::repeat(-1.0);
        let all = hessian.chain(jacobian).chain(sigma).chain(of_slacks);
        let values = self.values.iter_mut().zip(all);
        values.for_each(|(to, value)| *to = value);
        self.solver.factor(&self.values)
    }
}

/// Steps of refinement.
const REFINED: usize = 3;
/// Residual of a solution, relative to the terms of its equations, that is that of rounding.
pub(super) const EXACT: f64 = 1e-9;
/// A bound whose distance and multiplier are both smaller is reached weakly.
pub(super) const WEAK: f64 = 1e-6;

/// The linear system of the derivatives of an optimum.
impl Saddle {
    /// That of conditions, over unknowns that no bound holds and equations that hold.
    pub(super) fn of<N: Nlp>(conditions: &Conditions<N>) -> Result<Self, NoSensitivity> {
        let is_free = conditions.columns.iter().map(|place| *place == Place::Free);
        let holds = conditions.rows.iter().map(|place| place.holds());
        let free = is_free.clone().filter(|is_free| *is_free).count();
        let equations = holds.clone().filter(|holds| *holds).count();
        if equations > free {
            return Err(NoSensitivity::Overdetermined {
                rows: equations,
                columns: free,
            });
        }
        let structures = [&conditions.hessian, &conditions.jacobian];
        let stages = conditions.program.stages();
        Ok(Self::new(
            structures,
            is_free,
            holds,
            None,
            stages.as_deref(),
        ))
    }

    /// Factorises the matrix of conditions, where they are those of a strict minimum.
    pub(super) fn factor_of<N>(&mut self, conditions: &Conditions<N>) -> Result<(), NoSensitivity> {
        let Conditions {
            hessian_values,
            jacobian_values,
            ..
        } = conditions;
        let found = self.factor(hessian_values, jacobian_values, &[]);
        match (found.zero, found.negative.checked_sub(self.equations)) {
            (0, Some(0)) => Ok(()),
            (0, Some(falling)) => Err(NoSensitivity::NoMinimum(falling)),
            _ => Err(NoSensitivity::Singular),
        }
    }

    /// Replaces right-hand sides, by variable and by constraint, by the solution; entries of what is not in the system become zero.
    pub(super) fn solve(&mut self, x: &mut [f64], y: &mut [f64]) -> Result<(), NoSensitivity> {
        let mut right = vec![0.0; self.order()];
        let all = self.columns.iter().chain(&self.rows);
        for (number, value) in all.zip(x.iter().chain(&*y)) {
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
        let all = self.columns.iter().chain(&self.rows);
        for (number, value) in all.zip(x.iter_mut().chain(y)) {
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
        for (row, col, value) in self.entries.with(&self.values) {
            add(row, value * solution[col]);
            if row != col {
                add(col, value * solution[row]);
            }
        }
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

    /// Returns true of an equation, or an inequality whose bound is reached.
    pub(super) fn holds(self) -> bool {
        self.is_reached() || self == Self::Equation
    }

    /// Sign of the multiplier in `∇f + Jᵀy + z = 0`: negative at a lower bound.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Lower => -1.0,
            _ => 1.0,
        }
    }
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

/// A reason why derivatives of an optimum do not exist, or are not known to be right.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSensitivity {
    /// The point is none at which the conditions of an optimum hold.
    #[error("the conditions of an optimum hold up to {0:.1e} only: solve with a smaller tolerance")]
    NotOptimal(f64),
    /// A bound that counts as reached pushes the wrong way, or one that counts as free is violated.
    #[error("it is not known whether {0} is reached: solve with a smaller tolerance")]
    Undecided(String),
    /// The matrix is singular.
    #[error(
        "the equations and bounds that are reached depend on each other, or the optimum is not unique to second order"
    )]
    Singular,
    /// There are directions along which the objective falls.
    #[error(
        "it is no strict minimum: along {0} independent directions the Lagrangian falls to second order"
    )]
    NoMinimum(usize),
    /// There are more equations and bounds than unknowns.
    #[error("more equations and bounds are reached ({rows}) than there are unknowns ({columns})")]
    Overdetermined {
        /// Equations and limits.
        rows: usize,
        /// Unknowns that no bound holds.
        columns: usize,
    },
    /// The linear system was not solved to the accuracy of numbers.
    #[error("its linear system is solved up to {0:.1e} only")]
    Inexact(f64),
    /// Two ways to the same derivative differ.
    #[error(
        "the derivative of the objective is {0:.9e} by multipliers and {1:.9e} along the change of the optimum"
    )]
    Contradicts(f64, f64),
    /// Something that the derivatives need is not offered.
    #[error("{0}")]
    Refused(String),
}

impl NoSensitivity {
    /// A refusal in words.
    pub(crate) fn refused(reason: impl ToString) -> Self {
        Self::Refused(reason.to_string())
    }
}
