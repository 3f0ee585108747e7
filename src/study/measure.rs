//! Measures of a point: their names and units, and the points that have them.

use serde::Serialize;
use std::fmt;

use crate::control::problem::Task;
use crate::files::Loaded;
use crate::model::{Coordinates, Graph};

pub use crate::files::study::MeasureSpec as StudyMeasure;

/// Task of the problems of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StudyTask {
    /// Optimal voltages.
    Control,
    /// A motion under given voltages.
    Motion,
    /// A static equilibrium.
    Rest,
}

impl StudyTask {
    /// In messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Control => "a control problem",
            Self::Motion => "a simulation",
            Self::Rest => "an equilibrium",
        }
    }
}

/// Unit of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// In mm, and in m in `study.json`.
    Length,
    /// As a number.
    Relative,
}

impl Unit {
    /// Behind a name in tables and figures.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Length => " [mm]",
            Self::Relative => "",
        }
    }

    /// A number of `study.json` for one of tables and figures.
    pub fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Length => value / 1e3,
            Self::Relative => value,
        }
    }
}

impl fmt::Display for StudyMeasure {
    /// The word in files.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl StudyMeasure {
    /// All of them, in the order of tables and pages.
    pub const ALL: [Self; 10] = [
        Self::End,
        Self::Path,
        Self::Place,
        Self::Objective,
        Self::ResimulatedEnd,
        Self::ResimulatedPath,
        Self::EnergyBalance,
        Self::EnergyDrift,
        Self::ConstraintViolation,
        Self::Infeasibility,
    ];

    /// Name in tables.
    pub fn name(self) -> String {
        self.to_string().replace('_', " ")
    }

    /// Head of a column.
    pub fn head(self) -> String {
        format!("{}{}", self.name(), self.unit().suffix())
    }

    /// Label of an axis, without the unit.
    pub fn label(self) -> &'static str {
        match self {
            Self::End => "error of the place at the end",
            Self::Path => "greatest error along the path",
            Self::Place => "error of the place at rest",
            Self::Objective => "relative error of the objective",
            Self::ResimulatedEnd => "distance at the end when simulated 16 times finer",
            Self::ResimulatedPath => "greatest distance when simulated 16 times finer",
            Self::EnergyBalance => "greatest change of the energy",
            Self::EnergyDrift => "drift of the energy",
            Self::ConstraintViolation => "violation of the constraints",
            Self::Infeasibility => "violation that the solver left",
        }
    }

    /// Unit of its error.
    pub fn unit(self) -> Unit {
        match self {
            Self::End | Self::Path | Self::Place | Self::ResimulatedEnd | Self::ResimulatedPath => {
                Unit::Length
            }
            _ => Unit::Relative,
        }
    }

    /// Returns true if it is an error against a reference; the others are errors by themselves.
    pub fn has_reference(self) -> bool {
        matches!(self, Self::End | Self::Path | Self::Place | Self::Objective)
    }

    /// Returns true if it falls with a power of the refined quantity; residuals that a solver left do not.
    pub fn has_order(self) -> bool {
        !matches!(self, Self::ConstraintViolation | Self::Infeasibility)
    }

    /// Numbers that make one place of it.
    pub fn width(self) -> usize {
        match self {
            Self::End | Self::Path | Self::Place => 3,
            _ => 1,
        }
    }
}

/// Returns the measures that points have: a violation needs constraints that are left open, an energy that stays the same
/// needs constant voltages, a place a marker.
pub fn available<'a>(
    asked: StudyTask,
    points: impl Iterator<Item = &'a Loaded> + Clone,
) -> Vec<StudyMeasure> {
    let places = points.clone().all(|point| !point.system.markers.is_empty());
    let conserved = points.clone().all(|point| match &point.task {
        Task::Simulate(task) => task.voltages.are_constant(),
        _ => false,
    });
    let open = points.clone().any(|point| match &point.task {
        Task::Simulate(task) => {
            task.coordinates == Some(Coordinates::Redundant)
                || !Graph::new(&point.system).loops().is_empty()
        }
        _ => false,
    });
    let is_there = |measure: &StudyMeasure| match measure {
        StudyMeasure::End | StudyMeasure::Path => asked != StudyTask::Rest && places,
        StudyMeasure::Place => asked == StudyTask::Rest && places,
        StudyMeasure::ResimulatedEnd | StudyMeasure::ResimulatedPath => {
            asked == StudyTask::Control && places
        }
        StudyMeasure::Objective | StudyMeasure::Infeasibility => asked == StudyTask::Control,
        StudyMeasure::EnergyBalance | StudyMeasure::EnergyDrift => conserved,
        StudyMeasure::ConstraintViolation => open,
    };
    StudyMeasure::ALL.into_iter().filter(is_there).collect()
}
