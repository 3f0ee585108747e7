//! A simulation as it is written.

use crate::dynamics::{MultigridUse, Newton};
use crate::files::problem::loads::LoadMap;
use crate::files::problem::spec_coordinates::CoordinatesSpec;
use crate::files::problem::spec_feedback::ControllerSpec;
use crate::files::problem::spec_integrator::IntegratorSpec;
use crate::files::problem::spec_states::StartSpec;
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::units::quantity::{Quantity, Time};
use crate::sparse::Backend;
use schemars::JsonSchema;
use serde::de::{Error, IntoDeserializer, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A forward simulation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SimulateSpec {
    /// Length, SI unit s.
    pub duration: Quantity<Time>,
    /// Step, SI unit s, or `"auto"`, as where it is not written: steps as short as the tolerance needs, by the midpoint rule.
    #[serde(default)]
    pub step: Option<StepSpec>,
    /// Sum of the estimated local errors that `"auto"` allows over the duration, of angles in rad, of lengths relative to the
    /// robot's size; 1e-3 where not written.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// Constant voltages, those of a solution, or a table; 0 where not written.
    #[serde(default)]
    pub voltages: VoltagesSpec,
    /// Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
    #[serde(default)]
    pub loads: LoadMap,
    /// A controller that gives the voltages which it has gains for.
    #[serde(default)]
    pub controller: Option<ControllerSpec>,
    /// Start of the motion; the reference configuration at rest where not written.
    #[serde(default)]
    pub start: Option<StartSpec>,
    /// Coordinates.
    #[serde(default)]
    pub coordinates: Option<CoordinatesSpec>,
    /// The method; the midpoint variational integrator where not written.
    #[serde(default)]
    pub integrator: Option<IntegratorSpec>,
    /// Occasions at which the tangent of a step is factorised; where not written `modified` with finite elements, otherwise `full`.
    #[serde(default)]
    pub newton: Option<NewtonSpec>,
    /// Method by which its linear systems are solved; `auto` where not written.
    #[serde(default)]
    pub linear_solver: Option<LinearSolverSpec>,
}

/// Length of the steps.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum StepSpec {
    /// `"auto"`.
    Word(StepWord),
    /// A length of time.
    Given(Quantity<Time>),
}

/// Steps of no given length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StepWord {
    /// By an estimate of their local error.
    Auto,
}

impl<'de> Deserialize<'de> for StepSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StepVisitor)
    }
}

struct StepVisitor;

impl Visitor<'_> for StepVisitor {
    type Value = StepSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a time, such as \"10 ms\", or \"auto\"")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<StepSpec, E> {
        match text {
            "auto" => Ok(StepSpec::Word(StepWord::Auto)),
            _ => Quantity::deserialize(text.into_deserializer()).map(StepSpec::Given),
        }
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<StepSpec, E> {
        Quantity::deserialize(number.into_deserializer()).map(StepSpec::Given)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<StepSpec, E> {
        self.visit_f64(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<StepSpec, E> {
        self.visit_f64(number as f64)
    }
}

/// Occasions at which the tangent of a step is factorised.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NewtonSpec {
    /// In every iteration.
    Full,
    /// Modified Newton, only where the last factorisation converges too slowly: for large meshes, whose factorisation is the cost.
    Modified,
    /// The former name of `modified`.
    Reused,
}

impl From<NewtonSpec> for Newton {
    fn from(spec: NewtonSpec) -> Self {
        match spec {
            NewtonSpec::Full => Self::Full,
            NewtonSpec::Modified | NewtonSpec::Reused => Self::Modified,
        }
    }
}

/// Method by which linear systems with the tangent are solved.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolverSpec {
    /// The one that is fastest as a rule.
    Auto,
    /// LDLᵀ or LU of faer.
    Faer,
    /// LDLᵀ or LU of MUMPS.
    Mumps,
    /// GMRES with multigrid, for blocks beside which nothing moves.
    Multigrid,
}

impl LinearSolverSpec {
    /// The factorisation that is named, and the use of multigrid.
    pub(crate) fn taken(self) -> (Option<Backend>, MultigridUse) {
        match self {
            Self::Auto => (None, MultigridUse::WhereFaster),
            Self::Faer => (Some(Backend::Faer), MultigridUse::WhereFaster),
            Self::Mumps => (Some(Backend::Mumps), MultigridUse::WhereFaster),
            Self::Multigrid => (None, MultigridUse::Always),
        }
    }
}
