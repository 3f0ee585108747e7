//! The path limits of a problem that a controller plans anew, along the motion that followed.
//!
//! A plan keeps them at its own instants, for the robot that it knows, as it was measured; the motion of another robot, between these instants or under a
//! push, may pass them. All limits are compared that the model of the simulated robot tells.

use crate::control::problem::{Ahead, Simulation};
use crate::control::{PassedLimit, limits_along};
use crate::dynamics::DiscreteTrajectory;
use crate::math::significant;
use crate::model::System;
use crate::workflow::error::WorkflowError;
use crate::workflow::integrate::grid;
use crate::workflow::remark::Remarks;
use serde::Serialize;

/// A part of the larger bound by which a limit may be passed without a warning: that of steps of finite length.
const SLIGHT: f64 = 1e-3;

/// Limits along the motion of a closed loop.
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
        let found = limits_along((&of.system, limits), (system, analysis), motion);
        let mut found =
            found.map_err(|error| WorkflowError::boundary("simulate", &error.into()))?;
        found.passed.sort_by(|a, b| b.part.total_cmp(&a.part));
        let passed = |one: PassedLimit| Passed {
            excess: (one.value - one.bound).abs(),
            limit: one.name,
            value: one.value,
            bound: one.bound,
            unit: one.unit,
            time: one.time / 1e3,
            is_far: one.part > SLIGHT,
        };
        Ok(Some(Self {
            compared: found.compared,
            not_compared: found.left_out,
            passed: found.passed.into_iter().map(passed).collect(),
        }))
    }

    /// Adds a warning of limits that are passed, a note where steps of finite length explain it, and one of limits that are not compared.
    pub(crate) fn remark(&self, remarks: &mut Remarks) {
        match self.passed.first().is_some_and(|worst| worst.is_far) {
            true => remarks.warn("limit_passed", self.message()),
            false => remarks.note("limit_passed", self.message()),
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

    fn message(&self) -> Option<String> {
        let worst = self.passed.first()?;
        let space = if worst.unit.is_empty() { "" } else { " " };
        let number = |value: f64| format!("{}{space}{}", significant(value, 4), worst.unit);
        let others = match self.passed.len() - 1 {
            0 => String::new(),
            1 => "; another limit is passed too".to_owned(),
            others => format!("; {others} other limits are passed too"),
        };
        Some(format!(
            "under the controller a limit is passed, {}: {} at {} s, {} beyond its bound {}{others}",
            worst.limit,
            number(worst.value),
            worst.time,
            number(worst.excess),
            number(worst.bound),
        ))
    }
}
