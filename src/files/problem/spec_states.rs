//! Start and goal as they are written.

use crate::control::problem::{Hold, Rest};
use crate::files::problem::spec_voltages::VoltageMap;
use crate::files::scene::point::Point;
use crate::files::units::quantity::{
    AngularVelocity, JointCoordinate, JointRate, Quantity, Velocity,
};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A state at the start: exactly one of `rest_at_voltages` and joint coordinates.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartSpec {
    /// Static equilibrium under these voltages, SI unit V; 0 where not named.
    #[serde(default)]
    pub rest_at_voltages: Option<VoltageMap>,
    /// Joint coordinates by joint, SI unit rad or m; 0 where not named.
    #[serde(default)]
    pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
    /// Rates of joint coordinates by joint, SI unit rad/s or m/s; 0 where not named.
    #[serde(default)]
    pub joint_rates: Option<BTreeMap<String, Quantity<JointRate>>>,
    /// Velocities by body, of bodies that are free or hang on a spherical or floating joint; with what the joints before them do where not
    /// named.
    #[serde(default)]
    pub body_velocities: Option<BTreeMap<String, BodyVelocitySpec>>,
}

/// The velocity of a body at the start, in the ground frame.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyVelocitySpec {
    /// Velocity of the centre of mass, SI unit m/s; 0 where not written. On a spherical joint it follows from `angular`.
    #[serde(default)]
    pub linear: Option<[Quantity<Velocity>; 3]>,
    /// Angular velocity, SI unit rad/s; 0 where not written.
    #[serde(default)]
    pub angular: Option<[Quantity<AngularVelocity>; 3]>,
}

/// A state at the end, at rest: exactly one of the three.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalSpec {
    /// Static equilibrium under these voltages, SI unit V; 0 where not named.
    #[serde(default)]
    pub rest_at_voltages: Option<VoltageMap>,
    /// Joint coordinates by joint, SI unit rad or m; free where not named.
    #[serde(default)]
    pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
    /// Positions by marker, SI unit m.
    #[serde(default)]
    pub markers: Option<BTreeMap<String, Point>>,
    /// What comes to rest at positions of markers: `everything` (where not written), or bodies and these `markers` alone, for
    /// elastic blocks, which a few voltages cannot bring to rest everywhere.
    #[serde(default)]
    pub rest: Option<RestSpec>,
    /// Voltages that are held after positions of markers are reached, SI unit V; 0 where not named.
    #[serde(default)]
    pub hold: Option<VoltageMap>,
}

/// What comes to rest at a goal.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RestSpec {
    /// Every coordinate.
    #[default]
    Everything,
    /// Bodies and the markers of the goal.
    Markers,
}

/// What becomes of a goal that cannot be kept.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HoldSpec {
    /// A line says so.
    #[default]
    Reported,
    /// It is no solution.
    Required,
}

impl From<HoldSpec> for Hold {
    fn from(spec: HoldSpec) -> Self {
        match spec {
            HoldSpec::Reported => Self::Reported,
            HoldSpec::Required => Self::Required,
        }
    }
}

impl From<RestSpec> for Rest {
    fn from(spec: RestSpec) -> Self {
        match spec {
            RestSpec::Everything => Self::Everything,
            RestSpec::Markers => Self::Markers,
        }
    }
}
