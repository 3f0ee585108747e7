//! Output entry of a problem file: the part of a motion that is shown.

use crate::files::units::quantity::{Quantity, Time};
use schemars::JsonSchema;
use serde::Deserialize;

/// Part of a motion that tables, figures and page show; all of it stays in the solution.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// Time between the instants shown, SI unit s: those nearest to its multiples. Where not written all, and of a long motion so many that
    /// nothing is lost to the eye.
    #[serde(default)]
    pub every: Option<Quantity<Time>>,
    /// Columns of `trajectory.csv`: `joints`, `rates`, `speeds`, `reactions`, `markers`, `stretches`, `tensions`, `fields`, `charges`, `currents`,
    /// `powers`, `energies`, `momenta`, `constraint_violation`, or all of a joint, marker, muscle, block, spring, tendon or load by its name. All where
    /// not written.
    #[serde(default)]
    pub quantities: Option<Vec<String>>,
}
