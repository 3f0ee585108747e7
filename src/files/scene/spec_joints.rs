//! Joints of a scene file as they are written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::files::scene::point::Point;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{
    Angle, JointCoordinate, JointDamping, JointStiffness, Length, Quantity,
};

/// A joint: exactly one of `revolute`, `prismatic`, `universal`, `cylindrical`, `planar`, `spherical`, `floating`, `fixed`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointSpec {
    /// Unique name.
    pub name: String,
    /// Rotation about an axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revolute: Option<AxisSpec>,
    /// Translation along an axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prismatic: Option<AxisSpec>,
    /// Rotation about an axis of the parent and a perpendicular one of the child: a Cardan or Hooke joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub universal: Option<AxesSpec>,
    /// Translation along an axis and rotation about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylindrical: Option<AxisSpec>,
    /// Translation in a plane and rotation about its normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planar: Option<NormalSpec>,
    /// Rotation about a point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spherical: Option<Nothing>,
    /// Any motion: the child is as free as without the joint, and results give its orientation in the first body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floating: Option<Nothing>,
    /// No motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed: Option<Nothing>,
    /// Body on the side of the root, or `ground`.
    pub parent: String,
    /// Body on the other side.
    pub child: String,
    /// Place, SI unit m.
    pub at: Point,
    /// True if the joint is locked as it stands in the reference configuration: it is then `fixed`, and the bodies that it connects are one
    /// body.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
    /// Damping of the joint coordinate, SI unit N m s/rad (revolute) or N s/m (prismatic).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<Quantity<JointDamping>>,
    /// Stiffness of a spring of the joint coordinate, SI unit N m/rad (revolute) or N/m (prismatic).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Quantity<JointStiffness>>,
    /// Angle of a revolute joint at which its spring exerts no torque, SI unit rad; 0 where absent: the reference configuration. It counts whole
    /// turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_angle: Option<Quantity<Angle>>,
    /// Displacement of a prismatic joint at which its spring exerts no force, SI unit m; 0 where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_displacement: Option<Quantity<Length>>,
    /// Elastic stops of the joint coordinate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<StopsSpec>,
    /// Prescribed coordinate as a function of time, SI unit rad or m: a constant, or an object with `ramp`, `sine`, `table` or `csv`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<SignalSpec<JointCoordinate>>,
}

/// Elastic stops of a joint coordinate: `min`, `max` or both.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StopsSpec {
    /// Lowest coordinate without force, SI unit rad or m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<Quantity<JointCoordinate>>,
    /// Highest coordinate without force, SI unit rad or m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<Quantity<JointCoordinate>>,
    /// Stiffness beyond, SI unit N m/rad (revolute) or N/m (prismatic).
    pub stiffness: Quantity<JointStiffness>,
    /// Width around a stop over which the stiffness grows from zero, SI unit rad or m, for optimal control; it jumps where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<Quantity<JointCoordinate>>,
}

/// An axis.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisSpec {
    /// Direction, of any length.
    pub axis: [f64; 3],
}

/// Two axes.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxesSpec {
    /// Directions of any length, perpendicular to each other: that of the parent, then that of the child.
    pub axes: [[f64; 3]; 2],
}

/// A plane.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalSpec {
    /// Direction across the plane, of any length.
    pub normal: [f64; 3],
}

/// An object without entries.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Nothing {}
