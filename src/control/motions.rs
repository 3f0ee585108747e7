//! Several motions that are optimised together: each a control problem of its own, with sought constants in common.

use crate::control::problem::Control;
use crate::model::System;

/// Motions whose sought constants are the same, and the inputs that are the same in all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Motions {
    /// The motions.
    pub list: Vec<Motion>,
    /// Names of the sources whose inputs are sought once for all motions.
    pub shared_inputs: Vec<String>,
}

/// A motion among others.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Its name, another one for each motion.
    pub name: String,
    /// The system that moves.
    pub system: System,
    /// Its problem.
    pub control: Control,
}
