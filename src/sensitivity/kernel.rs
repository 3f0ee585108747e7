//! Derivatives of the solution of a program with respect to fixed variables, bounds and user-supplied parameter derivatives.

use crate::nlp::{Multipliers, Nlp};
use crate::sensitivity::active_set::{Direction, Held, Place, Side, of_constraints, of_variables};
use crate::sensitivity::check::NoSensitivity;
use crate::sensitivity::conditions::Conditions;
use crate::sensitivity::linear::{EXACT, Linear, largest};
use crate::sensitivity::margins::{At, Changes, Of};
use crate::sensitivity::range::{Margin, Range};

/// Most steps of Newton's method to the optimum.
const STEPS: usize = 6;
/// A step that is so small ends them, and one that is rounding is not made.
const SMALL: f64 = 1e-9;
const ROUNDING: f64 = 1e-12;
/// Conditions hold that are met up to this.
const MET: f64 = 1e-8;
/// A bound whose distance and multiplier are both smaller is reached weakly.
pub(super) const WEAK: f64 = 1e-6;
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
    pub(super) linear: Linear,
    pub(super) columns: Vec<Place>,
    pub(super) rows: Vec<Place>,
    /// ∇f + Jᵀy.
    slopes: Vec<f64>,
    moved: f64,
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
        point: (&[f64], &Multipliers),
        held: &Held,
    ) -> Result<Self, NoSensitivity> {
        Self::with_places(program, point, held, None)
    }

    /// As [`new`](Self::new), for the optimum of an equal program to which Newton's method has moved: places of its variables and constraints are known.
    pub(super) fn with_places(
        program: N,
        (x, multipliers): (&[f64], &Multipliers),
        held: &Held,
        places: Option<[Vec<Place>; 2]>,
    ) -> Result<Self, NoSensitivity> {
        let mut multipliers = multipliers.clone();
        let mut conditions =
            Conditions::new(program, (x, &mut multipliers), held.squares.as_deref());
        let is_known = places.is_some();
        let Multipliers {
            constraints,
            lower,
            upper,
        } = &multipliers;
        let [columns, rows] = places.unwrap_or_else(|| {
            let of_columns = (&*conditions.x, &conditions.bounds);
            let of_rows = (&*conditions.g, &conditions.row_bounds);
            [
                of_variables(of_columns, [lower, upper], &held.variables),
                of_constraints(of_rows, constraints, &held.constraints),
            ]
        });
        for (i, place) in columns.iter().enumerate() {
            match place {
                Place::Lower => conditions.x[i] = conditions.bounds.lower[i],
                Place::Upper => conditions.x[i] = conditions.bounds.upper[i],
                // Where a bound is reached without a multiplier nothing of what follows is to be rounding.
                Place::Free if !is_known => conditions.round(i, WEAK),
                _ => {}
            }
        }
        for (i, place) in rows.iter().enumerate() {
            if matches!(place, Place::Free | Place::Held) {
                conditions.y[i] = 0.0;
            }
        }
        conditions.evaluate();
        let linear = Linear::new(
            [&columns, &rows],
            [&conditions.hessian, &conditions.jacobian],
            conditions.stages().as_deref(),
        )?;
        let mut out = Self {
            slopes: Vec::new(),
            moved: 0.0,
            conditions,
            linear,
            columns,
            rows,
        };
        out.approach()?;
        out.slopes = out.conditions.slopes();
        out.check_bounds()?;
        Ok(out)
    }

    /// Newton's method for the conditions.
    fn approach(&mut self) -> Result<(), NoSensitivity> {
        for _ in 0..STEPS {
            self.conditions.evaluate_hessian();
            let Conditions {
                hessian_values,
                jacobian_values,
                ..
            } = &self.conditions;
            self.linear.factor(hessian_values, jacobian_values)?;
            let [mut dx, mut dy] = self.residuals();
            dx.iter_mut()
                .chain(&mut dy)
                .for_each(|value| *value = -*value);
            self.linear.solve(&mut dx, &mut dy)?;
            let Conditions { x, y, .. } = &mut self.conditions;
            let size = largest(y).max(1.0);
            let step = largest(&dx).max(largest(&dy) / size);
            self.moved = self.moved.max(step);
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
        let Conditions { g, row_bounds, .. } = &self.conditions;
        let mut of_x = self.conditions.slopes();
        for (value, place) in of_x.iter_mut().zip(&self.columns) {
            if *place != Place::Free {
                *value = 0.0;
            }
        }
        let of_row = |(i, place): (usize, &Place)| match place {
            Place::Lower | Place::Equation => g[i] - row_bounds.lower[i],
            Place::Upper => g[i] - row_bounds.upper[i],
            Place::Free | Place::Held => 0.0,
        };
        [of_x, self.rows.iter().enumerate().map(of_row).collect()]
    }

    pub(super) fn at(&self) -> At<'_, N> {
        At {
            conditions: &self.conditions,
            columns: &self.columns,
            rows: &self.rows,
            slopes: &self.slopes,
        }
    }

    /// Distances from bounds, and multipliers, as they are.
    pub(super) fn margins(&self) -> Vec<Margin<Of>> {
        let [columns, rows] = [&self.columns, &self.rows].map(|list| vec![0.0; list.len()]);
        self.at().margins(Changes {
            x: &columns,
            y: &rows,
            slopes: &columns,
            constraints: &rows,
            direction: &Direction::default(),
        })
    }

    /// Checks that bounds push the right way and are kept.
    fn check_bounds(&self) -> Result<(), NoSensitivity> {
        match self.margins().iter().find(|margin| margin.distance < -WEAK) {
            Some(margin) => Err(NoSensitivity::Undecided(self.at().words(margin.of))),
            None => Ok(()),
        }
    }

    /// Places of variables and constraints.
    pub(super) fn places(&self) -> [&[Place]; 2] {
        [&self.columns, &self.rows]
    }

    /// Greatest step of Newton's method to the optimum, in the scales of the program.
    pub fn moved(&self) -> f64 {
        self.moved
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
        let (columns, rows) = (self.columns.len(), self.rows.len());
        let x = conditions.point();
        let mut given = vec![0.0; columns];
        let reached = direction.bounds.iter();
        let reached = reached.filter(|(i, side, _)| self.columns[*i] == side.place());
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
            let is_one = self.rows[i] == side.place();
            if is_one || (self.rows[i] == Place::Equation && side == Side::Lower) {
                of_rows[i] -= value;
            }
        }
        Change {
            envelope: dot(&self.slopes, &given) + dot(&conditions.y, &of_rows),
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
        let at = self.at();
        let margins = at.margins(Changes {
            x: &dx,
            y: &dy,
            slopes: &slopes,
            constraints: &values,
            direction,
        });
        let words = |of| at.words(of);
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
