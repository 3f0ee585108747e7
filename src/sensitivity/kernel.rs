//! Derivatives of the solution of a program with respect to fixed variables, bounds and user-supplied parameter derivatives.
//!
//! Derivatives of few outcomes of an optimum by many numbers: one solution for each outcome in the place of one for each number.
//!
//! An outcome `ψ = a·x + b·y` of unknowns and multipliers changes with p by `a·ẋ + b·ẏ`. The matrix K of the conditions is symmetric: with the solution λ
//! of `K λ = (a, b)` its change is that of what is given, less λ times the right-hand side of p,
//!
//! ```text
//! ψ̇ = (a − ∇²L λₓ − Jᵀ λ_y)·ẋ_given − λₓ·∂∇L/∂p − λ_y·∂c/∂p.
//! ```

use crate::nlp::{Multipliers, Nlp};
use crate::sensitivity::conditions::{
    Conditions, Direction, EXACT, Held, NoSensitivity, Place, Places, Saddle, Side, WEAK, largest,
};
use crate::sensitivity::margins::{Margin, Of, Range};

/// Most steps of Newton's method to the optimum.
const STEPS: usize = 6;
/// A step that is so small ends them, and one that is rounding is not made.
const SMALL: f64 = 1e-9;
const ROUNDING: f64 = 1e-12;
/// Conditions hold that are met up to this.
const MET: f64 = 1e-8;
/// Two derivatives of the objective that differ by less, relative to their terms, are one.
const SAME: f64 = 1e-6;

/// Derivatives of an optimum.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivative {
    /// Of all variables, those that are held included.
    pub variables: Vec<f64>,
    /// Of the multipliers of constraints, by the unscaled objective.
    pub multipliers: Vec<f64>,
    /// Of the objective.
    pub objective: f64,
    /// Changes of p for which the same bounds are reached, to first order.
    pub range: Range,
    /// Bounds that are reached or left with p at once: the derivatives hold to one side alone.
    pub weak: Vec<String>,
}

/// Changes with a number while the unknowns that are free stay, in the units of the conditions.
pub(super) struct Change {
    /// Of unknowns that are held, and of those at bounds.
    pub(super) given: Vec<f64>,
    /// Of the gradient of the Lagrangian, and of the equations with bounds that are reached.
    pub(super) slopes: Vec<f64>,
    pub(super) rows: Vec<f64>,
    /// Of the constraints alone.
    values: Vec<f64>,
    /// Of the objective by multipliers.
    pub(super) envelope: f64,
}

/// An optimum with the factors of its conditions.
#[derive(Debug)]
pub struct Kernel<N> {
    pub(super) conditions: Conditions<N>,
    linear: Saddle,
}

impl<N: Nlp> Kernel<N> {
    /// An optimum x of a program with its multipliers. Newton's method moves it to where the conditions hold with the bounds that it has reached.
    ///
    /// # Errors
    /// The conditions do not hold, or derivatives do not exist.
    ///
    /// # Panics
    /// If lengths contradict each other.
    pub fn new(
        program: N,
        x: &[f64],
        multipliers: &Multipliers,
        held: &Held,
    ) -> Result<Self, NoSensitivity> {
        let (squares, places) = (held.squares.as_deref(), Places::Shown(held));
        Self::of(Conditions::new(program, x, multipliers, squares, places))
    }

    /// That of conditions at a point near the optimum.
    pub(super) fn of(conditions: Conditions<N>) -> Result<Self, NoSensitivity> {
        let mut out = Self {
            linear: Saddle::of(&conditions)?,
            conditions,
        };
        out.approach()?;
        out.check_bounds()?;
        Ok(out)
    }

    /// Newton's method for the conditions.
    fn approach(&mut self) -> Result<(), NoSensitivity> {
        for _ in 0..STEPS {
            self.conditions.evaluate_hessian();
            self.linear.factor_of(&self.conditions)?;
            let [mut dx, mut dy] = self.residuals();
            dx.iter_mut()
                .chain(&mut dy)
                .for_each(|value| *value = -*value);
            self.linear.solve(&mut dx, &mut dy)?;
            let Conditions { x, y, .. } = &mut self.conditions;
            let size = largest(y).max(1.0);
            let step = largest(&dx).max(largest(&dy) / size);
            if step <= ROUNDING {
                break;
            }
            x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += dx);
            y.iter_mut().zip(&dy).for_each(|(y, dy)| *y += dy);
            self.conditions.evaluate();
            if step <= SMALL {
                break;
            }
        }
        let [of_x, of_y] = self.residuals();
        let size = largest(&self.conditions.gradient).max(1.0);
        let error = largest(&of_y).max(largest(&of_x) / size);
        match error <= MET {
            true => Ok(()),
            false => Err(NoSensitivity::NotOptimal(error)),
        }
    }

    /// Residuals of the conditions of unknowns and of equations; zero of all others.
    fn residuals(&self) -> [Vec<f64>; 2] {
        let of = &self.conditions;
        let mut of_x = of.slopes.clone();
        for (value, place) in of_x.iter_mut().zip(&of.columns) {
            if *place != Place::Free {
                *value = 0.0;
            }
        }
        let of_row = |i: usize| match of.rows[i] {
            Place::Lower | Place::Equation => of.g[i] - of.row_bounds.lower[i],
            Place::Upper => of.g[i] - of.row_bounds.upper[i],
            Place::Free | Place::Held => 0.0,
        };
        [of_x, (0..of.rows.len()).map(of_row).collect()]
    }

    /// Distances from bounds, and multipliers, as they are.
    fn margins(&self) -> Vec<Margin> {
        let Conditions { columns, rows, .. } = &self.conditions;
        let [columns, rows] = [columns, rows].map(|list| vec![0.0; list.len()]);
        let none = [&columns[..], &rows[..]];
        self.conditions.margins(none, none, &Direction::default())
    }

    /// Checks that bounds push the right way and are kept.
    fn check_bounds(&self) -> Result<(), NoSensitivity> {
        match self.margins().iter().find(|margin| margin.distance < -WEAK) {
            Some(margin) => Err(NoSensitivity::Undecided(self.conditions.words(margin.of))),
            None => Ok(()),
        }
    }

    /// The variables at the optimum.
    pub fn point(&self) -> Vec<f64> {
        self.conditions.point()
    }

    /// The multipliers of the constraints there, by the unscaled objective.
    pub fn multipliers(&self) -> Vec<f64> {
        let y = self.conditions.y.iter();
        y.map(|value| value / self.conditions.scale).collect()
    }

    /// The program.
    pub fn program(&self) -> &N {
        self.conditions.program()
    }

    /// Changes of all that a direction gives, in the units of the conditions.
    pub(super) fn change(&self, direction: &Direction) -> Change {
        let conditions = &self.conditions;
        let (columns, rows) = (conditions.columns.len(), conditions.rows.len());
        let x = conditions.point();
        let mut given = vec![0.0; columns];
        let reached = direction.bounds.iter();
        let reached = reached.filter(|(i, side, _)| conditions.columns[*i] == side.place());
        let held = direction.held.iter().copied();
        for (i, value) in held.chain(reached.map(|&(i, _, value)| (i, value))) {
            given[i] += conditions.squares.rate(i, x[i]) * value;
        }
        let mut slopes = vec![0.0; columns];
        for &(i, value) in &direction.gradient {
            slopes[i] += conditions.scale * value;
        }
        conditions.squares.of_changes(&x, &mut slopes);
        let mut of_rows = vec![0.0; rows];
        for &(i, value) in &direction.constraints {
            of_rows[i] += value;
        }
        // Inequalities that are not reached move by that which is no change of a bound.
        let values = of_rows.clone();
        for &(i, side, value) in &direction.constraint_bounds {
            let is_one = conditions.rows[i] == side.place();
            if is_one || (conditions.rows[i] == Place::Equation && side == Side::Lower) {
                of_rows[i] -= value;
            }
        }
        Change {
            envelope: dot(&conditions.slopes, &given) + dot(&conditions.y, &of_rows),
            given,
            slopes,
            rows: of_rows,
            values,
        }
    }

    /// The derivative of the objective by multipliers, where that along the change of the optimum does not contradict: both are one up to a part of
    /// their `terms`. A linear system is solved up to a part of its largest unknowns; derivatives that differ by no more than this `rounding` are zero
    /// where they are no larger.
    pub(super) fn objective(
        &self,
        direction: &Direction,
        [envelope, along]: [f64; 2],
        [terms, rounding]: [f64; 2],
    ) -> Result<f64, NoSensitivity> {
        let scale = self.conditions.scale;
        let size = terms + envelope.abs() + (direction.objective * scale).abs();
        let difference = (envelope - along).abs();
        let of = |value: f64| value / scale + direction.objective;
        match (difference <= SAME * size, difference <= rounding) {
            (true, _) => Ok(of(envelope)),
            (false, true) if envelope.abs() <= rounding => Ok(of(0.0)),
            (false, true) => Ok(of(envelope)),
            (false, false) => Err(NoSensitivity::Contradicts(of(envelope), of(along))),
        }
    }

    /// Derivatives along a direction.
    ///
    /// # Errors
    /// The linear system is not solved exactly, or what follows from it is contradictory.
    pub fn along(&mut self, direction: &Direction) -> Result<Derivative, NoSensitivity> {
        let Change {
            given,
            slopes,
            rows,
            values,
            envelope,
        } = self.change(direction);
        let conditions = &self.conditions;
        let (mut of_x, mut of_rows) = (slopes.clone(), rows);
        conditions.add_curved(&given, &mut of_x);
        conditions.add_times(&given, &mut of_rows);
        let [mut dx, mut dy] =
            [of_x, of_rows].map(|list| list.iter().map(|v| -v).collect::<Vec<f64>>());
        self.linear.solve(&mut dx, &mut dy)?;
        dx.iter_mut().zip(&given).for_each(|(x, given)| *x += given);
        let gradient = &self.conditions.gradient;
        let along = [envelope, dot(gradient, &dx)];
        let rounding = EXACT * gradient.iter().map(|value| value.abs()).sum::<f64>() * largest(&dx);
        let objective = self.objective(direction, along, [sizes(gradient, &dx), rounding])?;
        let margins = self
            .conditions
            .margins([&dx, &dy], [&slopes, &values], direction);
        let words = |of| self.conditions.words(of);
        let range = Range::new(&margins, words);
        let weak = Range::ends_at_once(&margins, WEAK).map(words).collect();
        let scale = self.conditions.scale;
        let x = self.conditions.point();
        self.conditions.squares.of_changes(&x, &mut dx);
        Ok(Derivative {
            variables: dx,
            multipliers: dy.iter().map(|value| value / scale).collect(),
            objective,
            range,
            weak,
        })
    }
}

/// Sum of the sizes of the terms of a product.
pub(super) fn sizes(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A linear outcome: factors of variables and of multipliers of constraints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Factors of variables.
    pub variables: Vec<(usize, f64)>,
    /// Factors of multipliers of constraints, by the unscaled objective.
    pub multipliers: Vec<(usize, f64)>,
}

impl Outcome {
    /// Its derivative along the direction of that of an optimum.
    pub fn of(&self, derivative: &Derivative) -> f64 {
        let of = |factors: &[(usize, f64)], values: &[f64]| {
            let terms = factors.iter().map(|&(i, factor)| factor * values[i]);
            terms.sum::<f64>()
        };
        of(&self.variables, &derivative.variables) + of(&self.multipliers, &derivative.multipliers)
    }
}

/// An outcome by all that may change.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjoint {
    /// By unknowns that are given.
    given: Vec<f64>,
    /// By changes of the gradient of the Lagrangian, and of constraints.
    slopes: Vec<f64>,
    rows: Vec<f64>,
}

impl<N: Nlp> Kernel<N> {
    /// Solves for an outcome.
    ///
    /// # Errors
    /// The linear system is not solved exactly.
    pub fn adjoint(&mut self, outcome: &Outcome) -> Result<Adjoint, NoSensitivity> {
        let x = self.conditions.point();
        let mut of_x = vec![0.0; self.conditions.columns.len()];
        for &(i, factor) in &outcome.variables {
            of_x[i] += factor;
        }
        self.conditions.squares.of_changes(&x, &mut of_x);
        let mut of_y = vec![0.0; self.conditions.rows.len()];
        for &(i, factor) in &outcome.multipliers {
            of_y[i] += factor / self.conditions.scale;
        }
        self.solved(of_x, of_y)
    }

    /// The adjoint of factors of unknowns and multipliers.
    fn solved(&mut self, of_x: Vec<f64>, mut of_y: Vec<f64>) -> Result<Adjoint, NoSensitivity> {
        let mut slopes = of_x.clone();
        self.linear.solve(&mut slopes, &mut of_y)?;
        let rows = of_y;
        let mut terms = vec![0.0; of_x.len()];
        self.conditions.add_curved(&slopes, &mut terms);
        self.conditions.add_transposed(&rows, &mut terms);
        let given = of_x.iter().zip(&terms);
        Ok(Adjoint {
            given: given.map(|(factor, term)| factor - term).collect(),
            slopes,
            rows,
        })
    }

    /// The derivative of an outcome along a direction.
    pub fn by(&self, adjoint: &Adjoint, direction: &Direction) -> f64 {
        adjoint.by(&self.change(direction))
    }

    /// Bounds that are reached without a multiplier, or nearly so, and are left or reached along one of the directions: derivatives by these hold to one
    /// side alone. None where the change of the optimum along each direction would tell.
    pub fn one_sided(&self, directions: &[Direction]) -> Option<Vec<String>> {
        let mut weak = vec![None; self.conditions.columns.len()];
        for margin in self.margins().iter().filter(|one| one.distance < WEAK) {
            let Of::Variable(i, None) = margin.of else {
                return None;
            };
            weak[i] = Some(Vec::new());
        }
        self.slopes_by_given(&mut weak)?;
        let changes: Vec<Change> = directions.iter().map(|one| self.change(one)).collect();
        let is_moved = |i: usize, row: &[(usize, f64)]| {
            let rate = |change: &Change| {
                let terms = row.iter().map(|&(j, value)| value * change.given[j]);
                change.slopes[i] + terms.sum::<f64>()
            };
            changes.iter().any(|change| rate(change) != 0.0)
        };
        let weak = weak.iter().enumerate();
        let weak = weak.filter_map(|(i, row)| row.as_ref().map(|row| (i, row)));
        let moved = weak.filter(|(i, row)| is_moved(*i, row));
        let words = |i: usize| self.conditions.words(Of::Variable(i, None));
        Some(moved.map(|(i, _)| words(i)).collect())
    }

    /// Fills rows of the Hessian with their entries by unknowns that are given; none where the slope of one depends on others too. By a voltage that is
    /// zero the Lagrangian has slopes of others that are zero too.
    fn slopes_by_given(&self, rows: &mut [Option<Vec<(usize, f64)>>]) -> Option<()> {
        let conditions = &self.conditions;
        for (row, col, value) in conditions.jacobian.with(&conditions.jacobian_values) {
            if conditions.rows[row].holds() && value != 0.0 && rows[col].is_some() {
                return None;
            }
        }
        for (row, col, value) in conditions.hessian.with(&conditions.hessian_values) {
            let both = [(row, col), (col, row)];
            let count = if row == col { 1 } else { 2 };
            for (of, by) in both.into_iter().take(count) {
                if let Some(list) = rows[of].as_mut().filter(|_| value != 0.0) {
                    if conditions.columns[by] == Place::Free {
                        return None;
                    }
                    list.push((by, value));
                }
            }
        }
        Some(())
    }

    /// Derivatives of the objective along directions: by multipliers, and checked by one solution for all of them.
    ///
    /// # Errors
    /// The linear system is not solved exactly, or both ways to a derivative differ.
    pub fn objectives(&mut self, directions: &[Direction]) -> Result<Vec<f64>, NoSensitivity> {
        let no_rows = vec![0.0; self.conditions.rows.len()];
        let of = self.solved(self.conditions.gradient.clone(), no_rows)?;
        let derivative = |direction: &Direction| {
            let change = self.change(direction);
            let terms = sizes(&of.given, &change.given)
                + sizes(&of.slopes, &change.slopes)
                + sizes(&of.rows, &change.rows);
            let ways = [change.envelope, of.by(&change)];
            self.objective(direction, ways, [terms, self.rounding(&of, &change)])
        };
        directions.iter().map(derivative).collect()
    }
}

impl<N: Nlp> Kernel<N> {
    /// Round-off of a derivative by an adjoint, whose unknowns are known up to a part of the largest.
    fn rounding(&self, of: &Adjoint, change: &Change) -> f64 {
        let conditions = &self.conditions;
        let unknown = largest(&of.slopes).max(largest(&of.rows));
        let given = |i: usize| change.given[i].abs();
        let curved = conditions.hessian.with(&conditions.hessian_values);
        let curved = curved.map(|(row, col, value)| value.abs() * (given(row) + given(col)));
        let linear = conditions.jacobian.with(&conditions.jacobian_values);
        let linear = linear.map(|(_, col, value)| value.abs() * given(col));
        let direct = change.slopes.iter().chain(&change.rows);
        let sum = curved.chain(linear).sum::<f64>() + direct.map(|value| value.abs()).sum::<f64>();
        EXACT * unknown * sum
    }
}

impl Adjoint {
    fn by(&self, change: &Change) -> f64 {
        dot(&self.given, &change.given)
            - dot(&self.slopes, &change.slopes)
            - dot(&self.rows, &change.rows)
    }
}
