//! The path limits of a problem along a simulated motion: of a robot under a controller that plans anew, or under the inputs of an optimum.
//!
//! A program keeps them at its own instants and intervals, a plan for the robot that it knows, as it was measured; the motion in finer steps, of
//! another robot, or under a push, may pass them. All limits are compared that the model of the simulated robot tells.

use crate::control::problem::{Ahead, Control, Simulation};
use crate::control::{LimitsAlong, PassedLimit, limits_along};
use crate::dynamics::DiscreteTrajectory;
use crate::math::significant;
use crate::model::{Analysis, System};
use crate::workflow::error::WorkflowError;
use crate::workflow::integrate::grid;
use crate::workflow::optimum::Optimum;
use crate::workflow::remark::Remarks;
use serde::Serialize;
use std::collections::BTreeSet;

/// A part of the larger bound by which a limit may be passed without a warning: that of steps of finite length.
const SLIGHT: f64 = 1e-3;
/// The same of an optimum, of which the intervals are longer.
const BETWEEN: f64 = 0.02;

/// Limits along a simulated motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoopLimits {
    /// Names of those that were compared.
    pub compared: Vec<String>,
    /// Names of those that the simulated robot does not tell.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<String>,
    /// Those that are passed, the one that is passed most in front.
    pub passed: Vec<Passed>,
}

/// A limit that is passed, where that is most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Passed {
    /// Its name.
    pub limit: String,
    /// Distance to the bound.
    pub excess: f64,
    /// Value and bound, in the same unit.
    pub value: f64,
    /// The bound.
    pub bound: f64,
    /// The unit; absent of a pure number.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Instant in s.
    pub time: f64,
    /// True if it is passed by more than steps of finite length explain.
    #[serde(skip)]
    is_far: bool,
}

impl LoopLimits {
    /// Those of a problem along a motion of the robot that is simulated; none where it has none.
    ///
    /// # Errors
    /// There is no model of the robot that measures them.
    pub(crate) fn new(
        of: &Ahead,
        (system, task): (&System, &Simulation),
        motion: &DiscreteTrajectory,
    ) -> Result<Option<Self>, WorkflowError> {
        let limits = &of.control.limits;
        if limits.is_empty() {
            return Ok(None);
        }
        let analysis = task.analysis(system, grid(task).1);
        let found = limits_along(&of.system, limits, system, analysis, motion);
        let found = found.map_err(|error| WorkflowError::boundary("simulate", &error.into()))?;
        Ok(Some(Self::of(found, SLIGHT)))
    }

    /// Those of a problem along the motion under the inputs of its optimum in steps of half the length; none where it has none.
    pub(crate) fn of_optimum(control: &Control, optimum: &Optimum) -> Option<Self> {
        let motion = optimum.resimulation.as_ref()?.half.as_ref()?;
        if control.limits.is_empty() {
            return None;
        }
        let system = &optimum.model.system;
        let analysis = Analysis {
            interval: motion.times[1] - motion.times[0],
            curved: BTreeSet::new(),
            ..optimum.model.analysis.clone()
        };
        let found = limits_along(system, &control.limits, system, analysis, motion);
        found.ok().map(|found| Self::of(found, BETWEEN))
    }

    fn of(mut found: LimitsAlong, slight: f64) -> Self {
        found.passed.sort_by(|a, b| b.part.total_cmp(&a.part));
        let passed = |one: PassedLimit| Passed {
            excess: (one.value - one.bound).abs(),
            limit: one.name,
            value: one.value,
            bound: one.bound,
            unit: one.unit,
            time: one.time / 1e3,
            is_far: one.part > slight,
        };
        Self {
            compared: found.compared,
            not_compared: found.left_out,
            passed: found.passed.into_iter().map(passed).collect(),
        }
    }

    /// Adds a warning of limits that are passed, a note where steps of finite length explain it, and one of limits that are not compared.
    pub(crate) fn remark(&self, remarks: &mut Remarks) {
        let message = self.message("under the controller");
        match self.is_far() {
            true => remarks.warn("limit_passed", message),
            false => remarks.note("limit_passed", message),
        }
        let names = &self.not_compared;
        let not_compared = (!names.is_empty()).then(|| {
            format!(
                "limits that the simulated robot does not tell are not compared with its motion: {}",
                names.join(", ")
            )
        });
        remarks.note("limits_not_compared", not_compared);
    }

    /// The warning of an optimum whose motion in finer steps passes a limit by far.
    pub(crate) fn warning(&self) -> Option<String> {
        let message = self.message("under the optimal inputs, in steps of half the length,");
        message.filter(|_| self.is_far())
    }

    fn is_far(&self) -> bool {
        self.passed.first().is_some_and(|worst| worst.is_far)
    }

    fn message(&self, when: &str) -> Option<String> {
        let worst = self.passed.first()?;
        let space = if worst.unit.is_empty() { "" } else { " " };
        let number = |value: f64| format!("{}{space}{}", significant(value, 4), worst.unit);
        let others = match self.passed.len() - 1 {
            0 => String::new(),
            1 => "; another limit is passed too".to_owned(),
            others => format!("; {others} other limits are passed too"),
        };
        Some(format!(
            "{when} a limit is passed, {}: {} at {} s, {} beyond its bound {}{others}",
            worst.limit,
            number(worst.value),
            worst.time,
            number(worst.excess),
            number(worst.bound),
        ))
    }
}
