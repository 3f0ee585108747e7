//! Conversion of a joint of a scene file: its kind, axis, damper, spring, stops and prescribed motion.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::names::find_body;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{
    Angle, Damping, JointCoordinate, JointDamping, JointStiffness, Kind, Length, PhysicalQuantity,
    Quantity, RotationalDamping, RotationalStiffness, Stiffness,
};
use crate::math::{Signal, Vector, shortest};
use crate::model::system::{Joint, JointKind, JointSpring, JointStops};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Cosine up to which axes count as perpendicular.
const PERPENDICULAR: f64 = 1e-3;

/// Kinds of a joint, with the one key that names each.
#[derive(Clone, Copy, PartialEq)]
enum JointKey {
    Revolute,
    Prismatic,
    Universal,
    Cylindrical,
    Planar,
    Spherical,
    Floating,
    Fixed,
}

pub(super) fn joint(
    spec: &JointSpec,
    bodies: &[String],
    scope: &Scope<'_>,
) -> Result<Joint, SceneError> {
    let key = key(spec, scope)?;
    let kind = kind(spec, key, scope)?;
    let damping = constant(
        spec.damping.as_ref(),
        of_coordinate(key, RotationalDamping::kind(), Damping::kind()),
        &scope.key("damping"),
    )?;
    let spring = spring(spec, key, scope)?;
    let parent = find_body(&spec.parent, bodies, &scope.key("parent"))?;
    let place = scope.key("child");
    let child = place.find(&spec.child, bodies, "the name of a body")?;
    if parent == Some(child) {
        let found = format!("{:?}, which is the parent too", spec.child);
        return Err(place.wrong(found, "another body than the parent"));
    }
    let joint = Joint {
        name: spec.name.clone(),
        kind,
        parent,
        child,
        at: vector(&spec.at),
        damping,
        spring,
        stops: stops(spec, key, scope)?,
        motion: motion(spec, key, scope)?,
    };
    Ok(match spec.locked {
        true => Joint {
            kind: JointKind::Fixed,
            damping: None,
            spring: None,
            stops: None,
            motion: None,
            ..joint
        },
        false => joint,
    })
}

fn key(spec: &JointSpec, scope: &Scope<'_>) -> Result<JointKey, SceneError> {
    scope.exactly_one([
        (
            "revolute",
            spec.revolute.as_ref().map(|_| JointKey::Revolute),
        ),
        (
            "prismatic",
            spec.prismatic.as_ref().map(|_| JointKey::Prismatic),
        ),
        (
            "universal",
            spec.universal.as_ref().map(|_| JointKey::Universal),
        ),
        (
            "cylindrical",
            spec.cylindrical.as_ref().map(|_| JointKey::Cylindrical),
        ),
        ("planar", spec.planar.as_ref().map(|_| JointKey::Planar)),
        (
            "spherical",
            spec.spherical.as_ref().map(|_| JointKey::Spherical),
        ),
        (
            "floating",
            spec.floating.as_ref().map(|_| JointKey::Floating),
        ),
        ("fixed", spec.fixed.as_ref().map(|_| JointKey::Fixed)),
    ])
}

fn kind(spec: &JointSpec, key: JointKey, scope: &Scope<'_>) -> Result<JointKind, SceneError> {
    let axis = |key: &str, spec: &Option<AxisSpec>| {
        let axis = spec.as_ref().map_or([0.0; 3], |spec| spec.axis);
        unit_axis(&axis, &scope.key(key).key("axis"))
    };
    Ok(match key {
        JointKey::Revolute => JointKind::Revolute {
            axis: axis("revolute", &spec.revolute)?,
        },
        JointKey::Prismatic => JointKind::Prismatic {
            axis: axis("prismatic", &spec.prismatic)?,
        },
        JointKey::Universal => JointKind::Universal {
            axes: perpendicular(&spec.universal, &scope.key("universal").key("axes"))?,
        },
        JointKey::Cylindrical => JointKind::Cylindrical {
            axis: axis("cylindrical", &spec.cylindrical)?,
        },
        JointKey::Planar => {
            let normal = spec.planar.as_ref().map_or([0.0; 3], |spec| spec.normal);
            let normal = unit_axis(&normal, &scope.key("planar").key("normal"))?;
            JointKind::Planar { normal }
        }
        JointKey::Spherical => JointKind::Spherical,
        JointKey::Floating => JointKind::Floating,
        JointKey::Fixed => JointKind::Fixed,
    })
}

/// The axes of a universal joint, which are perpendicular to each other up to the digits that are written.
fn perpendicular(spec: &Option<AxesSpec>, scope: &Scope<'_>) -> Result<[Vector; 2], SceneError> {
    let written = spec.as_ref().map_or([[0.0; 3]; 2], |spec| spec.axes);
    let first = unit_axis(&written[0], &scope.index(0))?;
    let second = unit_axis(&written[1], &scope.index(1))?;
    let cosine = first.dot(&second);
    if cosine.abs() > PERPENDICULAR {
        let found = format!("axes at {} deg", shortest(cosine.acos().to_degrees(), 5));
        return Err(scope.wrong(found, "axes at 90 deg to each other"));
    }
    Ok([first, (second - first * cosine).normalize()])
}

/// The kind of a constant of the joint coordinate; `None` where a joint has not exactly one.
fn of_coordinate(key: JointKey, angular: Kind, linear: Kind) -> Option<Kind> {
    match key {
        JointKey::Revolute => Some(angular),
        JointKey::Prismatic => Some(linear),
        _ => None,
    }
}

/// A constant that is not negative, of the kind of the joint; zero is absent.
fn constant<M: PhysicalQuantity>(
    written: Option<&Quantity<M>>,
    kind: Option<Kind>,
    place: &Scope<'_>,
) -> Result<Option<f64>, SceneError> {
    let Some(written) = written else {
        return Ok(None);
    };
    let Some(kind) = kind else {
        let expected = "no such constant, as the joint is neither revolute nor prismatic";
        return Err(place.wrong(written.to_string(), expected));
    };
    let value = written.value_as(&kind);
    let value = value.map_err(|found| place.wrong(found, kind.expected()))?;
    if value < 0.0 {
        let expected = format!("zero or a positive value: {}", kind.expected());
        return Err(place.wrong(written.to_string(), expected));
    }
    Ok(Some(value).filter(|&value| value > 0.0))
}

fn spring(
    spec: &JointSpec,
    key: JointKey,
    scope: &Scope<'_>,
) -> Result<Option<JointSpring>, SceneError> {
    let stiffness = constant(
        spec.stiffness.as_ref(),
        of_coordinate(key, RotationalStiffness::kind(), Stiffness::kind()),
        &scope.key("stiffness"),
    )?;
    let rest = at_rest(spec, key, scope)?;
    Ok(stiffness.map(|stiffness| JointSpring { stiffness, rest }))
}

/// The prescribed coordinate, of the kind of the joint.
fn motion(
    spec: &JointSpec,
    key: JointKey,
    scope: &Scope<'_>,
) -> Result<Option<Signal>, SceneError> {
    let Some(written) = &spec.motion else {
        return Ok(None);
    };
    let scope = scope.key("motion");
    let Some(kind) = of_coordinate(key, Angle::kind(), Length::kind()) else {
        let expected = "no motion, as the joint is neither revolute nor prismatic";
        return Err(scope.wrong("motion", expected));
    };
    signal(written, &kind, &scope).map(Some)
}

fn stops(
    spec: &JointSpec,
    key: JointKey,
    scope: &Scope<'_>,
) -> Result<Option<JointStops>, SceneError> {
    let Some(spec) = &spec.stops else {
        return Ok(None);
    };
    let scope = scope.key("stops");
    let stiffness = constant(
        Some(&spec.stiffness),
        of_coordinate(key, RotationalStiffness::kind(), Stiffness::kind()),
        &scope.key("stiffness"),
    )?;
    let Some(kind) = of_coordinate(key, Angle::kind(), Length::kind()) else {
        let expected = "no stops, as the joint is neither revolute nor prismatic";
        return Err(scope.wrong("stops", expected));
    };
    let read = |written: &Option<Quantity<JointCoordinate>>, name: &str, absent: f64| {
        let value = written.as_ref().map(|w| w.value_as(&kind)).transpose();
        let value = value.map_err(|found| scope.key(name).wrong(found, kind.expected()));
        value.map(|value| value.unwrap_or(absent))
    };
    let at = [
        read(&spec.min, "min", f64::NEG_INFINITY)?,
        read(&spec.max, "max", f64::INFINITY)?,
    ];
    if at == [f64::NEG_INFINITY, f64::INFINITY] {
        return Err(scope.wrong("neither \"min\" nor \"max\"", "one of them, or both"));
    }
    if at[0] >= at[1] {
        let found = spec
            .max
            .as_ref()
            .map_or_else(String::new, Quantity::to_string);
        let expected = "more than \"min\"";
        return Err(scope.key("max").wrong(found, expected));
    }
    let smoothing = read(&spec.smoothing, "smoothing", 0.0)?;
    if smoothing < 0.0 {
        let found = spec
            .smoothing
            .as_ref()
            .map_or_else(String::new, Quantity::to_string);
        return Err(scope
            .key("smoothing")
            .wrong(found, "zero or a positive width"));
    }
    Ok(stiffness.map(|stiffness| JointStops {
        at,
        stiffness,
        smoothing,
    }))
}

/// The coordinate without force: zero where none is written.
fn at_rest(spec: &JointSpec, key: JointKey, scope: &Scope<'_>) -> Result<f64, SceneError> {
    let belongs = |to: JointKey| key == to && spec.stiffness.is_some();
    let wrong = |name: &str, found: String, joint: &str| {
        let expected = format!("a {joint} joint with a \"stiffness\"");
        Err(scope.key(name).wrong(found, expected))
    };
    match (&spec.rest_angle, &spec.rest_displacement) {
        (Some(angle), _) if !belongs(JointKey::Revolute) => {
            wrong("rest_angle", angle.to_string(), "revolute")
        }
        (_, Some(place)) if !belongs(JointKey::Prismatic) => {
            wrong("rest_displacement", place.to_string(), "prismatic")
        }
        (Some(angle), _) => Ok(angle.value()),
        (None, Some(place)) => Ok(place.value()),
        (None, None) => Ok(0.0),
    }
}

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
