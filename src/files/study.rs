//! A study as it is written: the serde types of the study file.

use crate::files::json::objects::read_objects;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Overrides by their place in the problem, or in its scene after `scene.`: `"control.intervals": 80`.
pub type ChangesSpec = BTreeMap<String, Value>;

read_objects! {
    /// A study: one question asked in several ways, each ever finer, to see what accuracy costs in time.
    pub struct StudySpec {
        /// JSON Schema of this file, for editors.
        #[serde(rename = "$schema", default)]
        #[expect(dead_code, reason = "read by editors only")]
        pub(crate) schema: Option<String>,
        /// Title of the page.
        pub title: String,
        /// Subject of the comparison and its reason, for the page.
        pub about: Option<String>,
        /// Path of the problem file, relative to this file.
        pub problem: String,
        /// Overrides of all points.
        pub set?: ChangesSpec,
        /// The methods that are compared, a curve each.
        pub methods: Vec<MethodSpec>,
        /// Entry that is refined from point to point; a method may refine something else.
        pub refine: Option<RefineSpec>,
        /// Whose limit errors are measured against; each method has its own where not written.
        pub reference: Option<ReferenceSpec>,
        /// The markers whose places are compared; all of them where not written.
        pub markers: Option<Vec<String>>,
        /// Quantities that are measured; all that there are of the kind of problem where not written.
        pub measures: Option<Vec<MeasureSpec>>,
        /// Number of timed runs of each point, 5 or more; 5 where not written.
        pub runs: Option<usize>,
    }

    /// A way to answer the question.
    pub struct MethodSpec {
        /// Name in legends and tables.
        pub name: String,
        /// Path of another problem file, relative to the study.
        pub problem: Option<String>,
        /// Overrides of its points, after those of all points.
        pub set?: ChangesSpec,
        /// Entry that it refines, in place of that of the study.
        pub refine: Option<RefineSpec>,
    }
}

/// Refinement: one value of each override per point, the coarsest first.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineSpec {
    /// Name of the refinement: `intervals`, `step`, `elements across`.
    pub name: String,
    /// Lists of values by their place, as long as each other, after all other overrides.
    pub set: BTreeMap<String, Vec<Value>>,
    /// Fineness of each point: growing, such as numbers of intervals, or falling, such as steps. Where not written, the
    /// values of the one place, if these are numbers or quantities of one unit.
    #[serde(default)]
    pub sizes: Option<Vec<f64>>,
}

read_objects! {
    /// Whose limit errors are measured against.
    pub struct ReferenceSpec {
        /// Name of the method.
        pub method: String,
        /// Points of the method that are run for the reference alone, and not timed; its points in the study where not written.
        pub refine: Option<RefineSpec>,
    }
}

/// Quantity that is measured at a point.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum MeasureSpec {
    /// Place of the markers at the end of a motion.
    End,
    /// Places of the markers at the instants that all points have in common.
    Path,
    /// Place of the markers at rest.
    Place,
    /// Objective of an optimal control problem.
    Objective,
    /// Distance of the markers at the end from where the optimal voltages bring them on a grid 16 times finer.
    ResimulatedEnd,
    /// The same at all instants.
    ResimulatedPath,
    /// Greatest change of the energy, what was dissipated included, relative to the greatest kinetic energy; under constant
    /// voltages.
    EnergyBalance,
    /// Its mean over the last quarter less that over the first, relative to the greatest kinetic energy.
    EnergyDrift,
    /// Greatest violation of a constraint that the coordinates leave open.
    ConstraintViolation,
    /// Greatest violation of an equation or limit that the solver left.
    Infeasibility,
}
