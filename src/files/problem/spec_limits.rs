//! Path limits as they are written: a part of the problem file.

use crate::files::problem::spec_source_limits::{
    All, CurrentLimitSpec, PowerLimitSpec, VoltageRateLimitSpec,
};
use crate::files::scene::point::{CornersSpec, Point};
use crate::files::units::quantity::{
    ElectricField, Force, JointCoordinate, JointRate, Length, Mass, Quantity, Torque, Velocity,
    Volume,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// A path limit: exactly one of the keys but `part`. `min` and `max` may be equal with `part`: the quantity is then prescribed there.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitSpec {
    /// Part of the duration, above 0 and at most 1, at which alone the limit holds: at the instant nearest to it, or in the interval before
    /// that instant; 1 is the end. Where not written it holds from start to end.
    #[serde(default)]
    pub part: Option<f64>,
    /// Limits of a joint coordinate.
    #[serde(default)]
    pub joint_angle: Option<JointAngleLimitSpec>,
    /// Limits of the rate of a joint coordinate.
    #[serde(default)]
    pub joint_rate: Option<JointRateLimitSpec>,
    /// Limits of the stretch of a muscle.
    #[serde(default)]
    pub stretch: Option<StretchLimitSpec>,
    /// Limits of the tension of lumped muscles.
    #[serde(default)]
    pub tension: Option<TensionLimitSpec>,
    /// Breakdown field of muscles or elastic blocks.
    #[serde(default)]
    pub electric_field: Option<ElectricFieldLimitSpec>,
    /// Region of a marker.
    #[serde(default)]
    pub marker: Option<MarkerLimitSpec>,
    /// Limits of the force that a joint transmits.
    #[serde(default)]
    pub reaction_force: Option<ReactionForceLimitSpec>,
    /// Limits of the torque that a joint transmits.
    #[serde(default)]
    pub reaction_torque: Option<ReactionTorqueLimitSpec>,
    /// Limits of the speed of a marker.
    #[serde(default)]
    pub marker_speed: Option<MarkerSpeedLimitSpec>,
    /// Limits of the current of sources.
    #[serde(default)]
    pub current: Option<CurrentLimitSpec>,
    /// Limits of the power of sources.
    #[serde(default)]
    pub power: Option<PowerLimitSpec>,
    /// Limits of the rate of the voltage of sources.
    #[serde(default)]
    pub voltage_rate: Option<VoltageRateLimitSpec>,
    /// Limits of the volume of muscles.
    #[serde(default)]
    pub muscle_volume: Option<MuscleVolumeLimitSpec>,
    /// Limits of the mass of muscles.
    #[serde(default)]
    pub muscle_mass: Option<MuscleMassLimitSpec>,
}

/// Limits of a joint coordinate: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointAngleLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Lower bound, SI unit rad or m.
    #[serde(default)]
    pub min: Option<Quantity<JointCoordinate>>,
    /// Upper bound, SI unit rad or m.
    #[serde(default)]
    pub max: Option<Quantity<JointCoordinate>>,
}

/// Limits of the mean rate of a joint coordinate in each interval: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointRateLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Lower bound, SI unit rad/s or m/s.
    #[serde(default)]
    pub min: Option<Quantity<JointRate>>,
    /// Upper bound, SI unit rad/s or m/s.
    #[serde(default)]
    pub max: Option<Quantity<JointRate>>,
}

/// Limits of the component, along a direction of the ground frame, of the force from the parent of a joint on its child: `min`, `max` or both.
///
/// It is the force of the columns of reactions, at the instants between intervals. Joints in loops are refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionForceLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Direction of the ground frame, of any length.
    pub along: [f64; 3],
    /// Lower bound, SI unit N.
    #[serde(default)]
    pub min: Option<Quantity<Force>>,
    /// Upper bound, SI unit N.
    #[serde(default)]
    pub max: Option<Quantity<Force>>,
}

/// Limits of the component, about a direction of the ground frame, of the torque from the parent of a joint on its child: `min`, `max` or both.
///
/// It is the torque of the columns of reactions, about the point of the joint, at the instants between intervals. Spherical joints and joints in
/// loops are refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionTorqueLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Direction of the ground frame, of any length.
    pub about: [f64; 3],
    /// Lower bound, SI unit N m.
    #[serde(default)]
    pub min: Option<Quantity<Torque>>,
    /// Upper bound, SI unit N m.
    #[serde(default)]
    pub max: Option<Quantity<Torque>>,
}

/// Limits of the size of the mean velocity of a marker in each interval: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerSpeedLimitSpec {
    /// Name of the marker.
    pub marker: String,
    /// Lower bound, SI unit m/s.
    #[serde(default)]
    pub min: Option<Quantity<Velocity>>,
    /// Upper bound, SI unit m/s.
    #[serde(default)]
    pub max: Option<Quantity<Velocity>>,
}

/// Limits of the stretch of a muscle: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StretchLimitSpec {
    /// Name of the muscle.
    pub muscle: String,
    /// Lower bound.
    #[serde(default)]
    pub min: Option<f64>,
    /// Upper bound.
    #[serde(default)]
    pub max: Option<f64>,
}

/// Limits of the force with which one lumped muscle (`"muscle": name`) or each (`"muscles": "all"`) pulls its ends together, of elasticity,
/// field, viscosity and Maxwell branches: `min`, `max` or both.
///
/// It bounds the tension in the middle of every interval, under the voltage there; the column of the table is its mean in both intervals
/// beside an instant.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TensionLimitSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Lower bound, SI unit N. With `0` the muscle is never slack.
    #[serde(default)]
    pub min: Option<Quantity<Force>>,
    /// Upper bound, SI unit N.
    #[serde(default)]
    pub max: Option<Quantity<Force>>,
}

/// Breakdown field of one muscle (`"muscle": name`) or all (`"muscles": "all"`), of one elastic block (`"solid": name`, or a
/// `region` of it) or all (`"solids": "all"`).
///
/// It bounds the true field at every instant and in the middle of every interval; in finite elements at their centres and Gauss
/// points.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElectricFieldLimitSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All muscles with an electric term.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Name of the elastic block.
    #[serde(default)]
    pub solid: Option<String>,
    /// All elastic blocks that a field reaches.
    #[serde(default)]
    pub solids: Option<All>,
    /// Name of a region of the mesh of `solid`; all elements that a field reaches where not written.
    #[serde(default)]
    pub region: Option<String>,
    /// Largest true field, SI unit V/m.
    pub max: Quantity<ElectricField>,
}

/// Region of a marker: exactly one of `inside` and `outside`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerLimitSpec {
    /// Name of the marker.
    pub marker: String,
    /// Region in which it stays.
    #[serde(default)]
    pub inside: Option<RegionSpec>,
    /// Region outside which it stays.
    #[serde(default)]
    pub outside: Option<RegionSpec>,
}

/// A region: exactly one of the two.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Box between two corners.
    #[serde(rename = "box", default)]
    pub cuboid: Option<CornersSpec>,
    /// Ball.
    #[serde(default)]
    pub sphere: Option<BallSpec>,
}

/// A ball.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// Centre, SI unit m.
    pub centre: Point,
    /// Radius, SI unit m.
    pub radius: Quantity<Length>,
}

/// Declares limits of an amount of lumped muscles, together: `min`, `max` or both.
macro_rules! amount_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal;)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Names of lumped muscles; all of them where not written.
                #[serde(default)]
                pub muscles: Option<Vec<String>>,
                #[doc = concat!("Lower bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub min: Option<Quantity<$measure>>,
                #[doc = concat!("Upper bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub max: Option<Quantity<$measure>>,
            }
        )*
    };
}

amount_limits! {
    /// Limits of the volume of lumped muscles at rest, together, which follows from sought constants: `min`, `max` or both.
    MuscleVolumeLimitSpec: Volume, "m^3";
    /// Limits of the mass of lumped muscles with a density, together, which follows from sought constants: `min`, `max` or both.
    MuscleMassLimitSpec: Mass, "kg";
}
