//! Costs of measured quantities as they are written, along the motion or at its end: a part of the problem file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::files::problem::spec_source_limits::All;
use crate::files::units::quantity::{Current, Force, JointRate, Power, Quantity};

/// The tension of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TensionCostSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Tension that is asked for, SI unit N; 0 where not written.
    #[serde(default)]
    pub at: Option<Quantity<Force>>,
    /// Weight of the squared deviation in N²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The true electric field of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals; behind a
/// resistor at the instants.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldCostSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles with an electric term.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Weight of the squared field in (V/µm)²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The current of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurrentCostSpec {
    /// Name of the source: that of its muscle.
    #[serde(default)]
    pub source: Option<String>,
    /// All sources.
    #[serde(default)]
    pub sources: Option<All>,
    /// Current that is asked for, SI unit A; 0 where not written.
    #[serde(default)]
    pub at: Option<Quantity<Current>>,
    /// Weight of the squared deviation in mA²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The power of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PowerCostSpec {
    /// Name of the source: that of its muscle.
    #[serde(default)]
    pub source: Option<String>,
    /// All sources.
    #[serde(default)]
    pub sources: Option<All>,
    /// Power that is asked for, SI unit W; 0 where not written.
    #[serde(default)]
    pub at: Option<Quantity<Power>>,
    /// Weight of the squared deviation in W²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The mean rate of the coordinate of a joint in the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointRateCostSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// Rate that is asked for, SI unit rad/s or m/s; 0 where not written.
    #[serde(default)]
    pub at: Option<Quantity<JointRate>>,
    /// Weight of the squared deviation in (rad/s)², or (m/s)² of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The size of the mean velocity of a marker in the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerSpeedCostSpec {
    /// Name of the marker.
    pub marker: String,
    /// Weight of the squared speed in (m/s)²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}
