//! Bounds that an optimum has reached: the multiplier of such a bound is greater than the distance from it.

use crate::nlp::Bounds;

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
