//! Derivatives of few outcomes of an optimum by many numbers: one solution for each outcome in the place of one for each number.
//!
//! An outcome `ψ = a·x + b·y` of unknowns and multipliers changes with p by `a·ẋ + b·ẏ`. The matrix K of the conditions is symmetric: with the solution λ
//! of `K λ = (a, b)` its change is that of what is given, less λ times the right-hand side of p,
//!
//! ```text
//! ψ̇ = (a − ∇²L λₓ − Jᵀ λ_y)·ẋ_given − λₓ·∂∇L/∂p − λ_y·∂c/∂p.
//! ```

use crate::nlp::Nlp;
use crate::sensitivity::active_set::{Direction, Place};
use crate::sensitivity::check::NoSensitivity;
use crate::sensitivity::conditions::entries;
use crate::sensitivity::kernel::{Change, Derivative, Kernel, WEAK, dot, sizes};
use crate::sensitivity::linear::{EXACT, largest};
use crate::sensitivity::margins::Of;

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
        let mut of_x = vec![0.0; self.columns.len()];
        for &(i, factor) in &outcome.variables {
            of_x[i] += factor;
        }
        self.conditions.squares.of_changes(&x, &mut of_x);
        let mut of_y = vec![0.0; self.rows.len()];
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
        let mut weak = vec![None; self.columns.len()];
        for margin in self.margins().iter().filter(|one| one.distance < WEAK) {
            let Of::MultiplierOfVariable(i) = margin.of else {
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
        let words = |i: usize| self.at().words(Of::MultiplierOfVariable(i));
        Some(moved.map(|(i, _)| words(i)).collect())
    }

    /// Fills rows of the Hessian with their entries by unknowns that are given; none where the slope of one depends on others too. By a voltage that is
    /// zero the Lagrangian has slopes of others that are zero too.
    fn slopes_by_given(&self, rows: &mut [Option<Vec<(usize, f64)>>]) -> Option<()> {
        let conditions = &self.conditions;
        for (&row, &col, value) in entries(&conditions.jacobian, &conditions.jacobian_values) {
            let place = self.rows[row as usize];
            let holds = place.is_reached() || place == Place::Equation;
            if holds && *value != 0.0 && rows[col as usize].is_some() {
                return None;
            }
        }
        for (&row, &col, value) in entries(&conditions.hessian, &conditions.hessian_values) {
            let (row, col) = (row as usize, col as usize);
            let both = [(row, col), (col, row)];
            let count = if row == col { 1 } else { 2 };
            for (of, by) in both.into_iter().take(count) {
                if let Some(list) = rows[of].as_mut().filter(|_| *value != 0.0) {
                    if self.columns[by] == Place::Free {
                        return None;
                    }
                    list.push((by, *value));
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
        let no_rows = vec![0.0; self.rows.len()];
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
        let given = |i: &u32| change.given[*i as usize].abs();
        let curved = entries(&conditions.hessian, &conditions.hessian_values)
            .map(|(row, col, value)| value.abs() * (given(row) + given(col)));
        let linear = entries(&conditions.jacobian, &conditions.jacobian_values)
            .map(|(_, col, value)| value.abs() * given(col));
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
