//! The record of a motion: coordinates, momenta and voltages on a time grid.

use crate::dynamics::drive::Inputs;
use crate::dynamics::interval_energies::Work;
use crate::dynamics::step_report::StepperReport;
use crate::dynamics::step_state::StepState;

/// N + 1 instants and N intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiscreteTrajectory {
    /// Times of the instants in ms.
    pub times: Vec<f64>,
    /// Coordinates and multipliers of each instant; multipliers of the last instant are those before it.
    pub z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at each instant.
    pub momenta: Vec<Vec<f64>>,
    /// Rates of the coordinates at the start, where they are known.
    pub rates: Option<Vec<f64>>,
    /// Time in ms to which prescribed motions have come at the start.
    pub begun: f64,
    /// Voltages of each interval in V and potentials in their unit, by scalar of the interval.
    pub scalars: Vec<Vec<f64>>,
    /// Inputs at both ends of each interval; empty where they are constant in all of them.
    pub ends: Vec<[Inputs; 2]>,
    /// Scalars after the last interval, where the inputs that hold the end of the motion were found with it.
    pub held: Option<Vec<f64>>,
    /// Times at which energies and momenta are read.
    pub reading: Reading,
    /// Work of forces without a potential in each interval, where instants alone do not determine it.
    pub works: Vec<Work>,
    /// The method that factorised the tangents of the steps.
    pub solver: String,
    /// Report of the steps.
    pub report: StepperReport,
    /// State from which the motion can be resumed.
    pub end: StepState,
}

/// Times to which the energies and momenta of a method belong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// At the midpoints of intervals, where the midpoint rule sees energies.
    #[default]
    Intervals,
    /// At instants, by their momenta.
    Instants,
    /// At instants, each with the inputs and potentials of the interval that ends there: equilibria.
    States,
}

impl DiscreteTrajectory {
    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.scalars.len()
    }
}
