//! Changes of a program with a parameter, and what of it is held.

use crate::nlp::Bounds;
use crate::sensitivity::active_set::Place;

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
