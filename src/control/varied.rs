//! Numbers of a problem by which its optimum is differentiated.

use crate::model::system::System;
use crate::model::{Parameter, SiUnit};

/// A number of a problem by which its optimum is differentiated.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Name for messages and files: its path in the scene or in the problem.
    pub name: String,
    /// The number.
    pub of: VariedOf,
    /// Its value, in the unit inside.
    pub value: f64,
    /// Its tolerance: it may be so much smaller or larger.
    pub tolerance: Option<f64>,
    /// Its unit of the International System.
    pub unit: SiUnit,
}

/// Kind of a number of a problem.
#[derive(Clone, Debug, PartialEq)]
pub enum VariedOf {
    /// Constants of the system, as one that is sought.
    Constants(Parameter),
    /// The duration, where it is given, in ms.
    Duration,
    /// A joint coordinate of the goal, in rad or mm.
    GoalJoint(usize),
    /// A component of the place of a marker at the goal, in mm.
    GoalPlace {
        /// The marker.
        marker: usize,
        /// Its component, 0 to 2.
        axis: usize,
    },
    /// The voltage or load of a source under which the goal is at rest.
    GoalVoltage(usize),
    /// A joint coordinate of the start, in rad or mm.
    StartJoint(usize),
    /// The rate of a joint coordinate at the start, in rad/ms or mm/ms.
    StartRate(usize),
    /// The voltage or load of a source under which the start is at rest.
    StartVoltage(usize),
    /// The lower or the upper bound of voltages in V.
    VoltageBound(usize),
    /// The lower or the upper bound of a load, by its source.
    LoadBound(usize, usize),
    /// A weight of the objective.
    Weight(WeightOf),
}

/// A weight of the objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightOf {
    /// That of the effort.
    Effort,
    /// That of the rate.
    Rate,
    /// That of the duration.
    Duration,
}

/// An outcome of an optimum that is differentiated; times are those of the nearest instant in ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutcomeOf {
    /// A free duration in ms.
    Duration,
    /// A constant that was sought, by its place in the problem.
    Parameter(usize),
    /// The voltage or load of a source at a time, in V, N or N mm.
    Input {
        /// The source.
        source: usize,
        /// The time.
        time: f64,
    },
    /// The coordinate of a joint at a time, in rad or mm; in reduced coordinates.
    Joint {
        /// The joint.
        joint: usize,
        /// The time.
        time: f64,
    },
    /// A component of the place of a marker at a time, in mm.
    Marker {
        /// The marker.
        marker: usize,
        /// Its component, 0 to 2.
        axis: usize,
        /// The time.
        time: f64,
    },
    /// The multiplier of an equation or limit, in the order of the program.
    Multiplier(usize),
}

impl Varied {
    /// Constants of a system at their guess, which is their value there.
    pub fn constants(parameter: Parameter, tolerance: Option<f64>, system: &System) -> Self {
        Self {
            name: parameter.name.clone(),
            value: parameter.guess,
            tolerance,
            unit: parameter.unit(system),
            of: VariedOf::Constants(parameter),
        }
    }

    /// The constants that it is, where it is one of the system.
    pub fn parameter(&self) -> Option<&Parameter> {
        match &self.of {
            VariedOf::Constants(parameter) => Some(parameter),
            _ => None,
        }
    }
}
