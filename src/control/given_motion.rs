//! A motion under given inputs as a control problem.

use crate::control::inputs::Voltages;
use crate::control::problem::{
    BoundaryState, Control, Duration, Guess, Hold, Objective, Solver, SoughtHold,
};
use std::collections::BTreeMap;

impl Control {
    /// The motion from a start under given inputs over `duration` ms, as a problem without a choice.
    pub fn of_course(
        start: &BoundaryState,
        inputs: &Voltages,
        duration: f64,
        intervals: usize,
    ) -> Self {
        Self {
            duration: Duration::Given(duration),
            intervals,
            is_refined: false,
            varied: Vec::new(),
            outcomes: Vec::new(),
            start: start.clone(),
            goal: BoundaryState::Free,
            voltage_bounds: [f64::NEG_INFINITY, f64::INFINITY],
            load_bounds: BTreeMap::new(),
            given: BTreeMap::new(),
            course: Some(inputs.clone()),
            parameters: Vec::new(),
            sought_hold: SoughtHold::Never,
            hold: Hold::Reported,
            objective: Objective::default(),
            limits: Vec::new(),
            waypoints: Vec::new(),
            coordinates: None,
            guess: Guess::Interpolate,
            solver: Solver::default(),
        }
    }
}
