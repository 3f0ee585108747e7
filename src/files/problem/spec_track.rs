//! References in time and targets at the end of an objective, as written in a problem file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::files::problem::spec_measured::{
    CurrentCostSpec, FieldCostSpec, JointRateCostSpec, MarkerSpeedCostSpec, PowerCostSpec,
    TensionCostSpec,
};
use crate::files::scene::point::PartialPoint;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{JointCoordinate, Length, Quantity};

/// Marker or joints that follow a reference, or a measured quantity whose squared deviation from a value, times `weight`, is integrated over the
/// time in s: exactly one of them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackSpec {
    /// A marker follows a path in time.
    #[serde(default)]
    pub marker: Option<TrackMarkerSpec>,
    /// The coordinate of a joint follows a function of time.
    #[serde(default)]
    pub joint: Option<TrackJointSpec>,
    /// The coordinates of all joints follow an earlier solution.
    #[serde(default)]
    pub joints: Option<TrackJointsSpec>,
    /// The tension of muscles along the motion.
    #[serde(default)]
    pub tension: Option<TensionCostSpec>,
    /// The true electric field of muscles along the motion.
    #[serde(default)]
    pub electric_field: Option<FieldCostSpec>,
    /// The current of sources along the motion.
    #[serde(default)]
    pub current: Option<CurrentCostSpec>,
    /// The power of sources along the motion.
    #[serde(default)]
    pub power: Option<PowerCostSpec>,
    /// The rate of a joint along the motion.
    #[serde(default)]
    pub joint_rate: Option<JointRateCostSpec>,
    /// The speed of a marker along the motion.
    #[serde(default)]
    pub marker_speed: Option<MarkerSpeedCostSpec>,
}

/// A marker and its path.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackMarkerSpec {
    /// Name of the marker.
    pub marker: String,
    /// The path.
    pub along: PathSpec,
    /// Weight of ∫ |x − r|² dt over the directions of the path, in mm² s; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// Coordinates as functions of time, SI unit m; one or more. Directions that are not written are free.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathSpec {
    /// Along x.
    #[serde(default)]
    pub x: Option<SignalSpec<Length>>,
    /// Along y.
    #[serde(default)]
    pub y: Option<SignalSpec<Length>>,
    /// Along z.
    #[serde(default)]
    pub z: Option<SignalSpec<Length>>,
}

/// A joint and the function that its coordinate follows.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackJointSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// The function of time, SI unit rad or m.
    pub along: SignalSpec<JointCoordinate>,
    /// Weight of ∫ (θ − r)² dt in rad² s, or mm² s of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// All joints along an earlier solution.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackJointsSpec {
    /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder; linear between its instants, constant after
    /// the last.
    pub solution: String,
    /// Weight of the sum over all joints of ∫ (θ − r)² dt in rad² s, or mm² s of prismatic joints; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// Marker or joint that ends near a place, or a measured quantity that ends near a value, in the last interval: exactly one of them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalSpec {
    /// A marker ends near a place.
    #[serde(default)]
    pub marker: Option<FinalMarkerSpec>,
    /// The coordinate of a joint ends near a value.
    #[serde(default)]
    pub joint: Option<FinalJointSpec>,
    /// The tension of muscles at the end.
    #[serde(default)]
    pub tension: Option<TensionCostSpec>,
    /// The true electric field of muscles at the end.
    #[serde(default)]
    pub electric_field: Option<FieldCostSpec>,
    /// The current of sources at the end.
    #[serde(default)]
    pub current: Option<CurrentCostSpec>,
    /// The power of sources at the end.
    #[serde(default)]
    pub power: Option<PowerCostSpec>,
    /// The rate of a joint at the end.
    #[serde(default)]
    pub joint_rate: Option<JointRateCostSpec>,
    /// The speed of a marker at the end.
    #[serde(default)]
    pub marker_speed: Option<MarkerSpeedCostSpec>,
}

/// A marker and where it is to end.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalMarkerSpec {
    /// Name of the marker.
    pub marker: String,
    /// The place, SI unit m; directions that are `null` are free.
    pub at: PartialPoint,
    /// Weight of |x − r|² at the final instant, in mm²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// A joint and where it is to end.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalJointSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// The value, SI unit rad or m.
    pub at: Quantity<JointCoordinate>,
    /// Weight of (θ − r)² at the final instant, in rad², or mm² of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}
