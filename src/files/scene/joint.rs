//! Conversion of a joint of a scene file: its kind, axis, damper, spring, stops and prescribed motion.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::names::find_body;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::signal::{SignalSpec, signal};
use crate::files::units::quantity::{
    Angle, Damping, JointCoordinate, JointDamping, JointStiffness, Kind, Length, PhysicalQuantity,
    Quantity, RotationalDamping, RotationalStiffness, Stiffness,
};
use crate::model::check_axes;
use crate::model::system::{Joint, JointKind, JointSpring, JointStops};

/// Cosine up to which axes count as perpendicular.
const PERPENDICULAR: f64 = 1e-3;

/// The joint that is written.
pub(super) fn joint(spec: &JointSpec, bodies: &[String], scope: &Scope<'_>) -> Result<Joint> {
    let kind = kind(spec, scope)?;
    let parent = find_body(&spec.parent, bodies, &scope.key("parent"))?;
    let child = scope.key("child");
    let child = child.find(&spec.child, bodies, "the name of a body")?;
    let entries = kind.check_coordinate([
        spec.damping.is_some(),
        spec.stiffness.is_some(),
        spec.stops.is_some(),
        spec.motion.is_some(),
    ]);
    entries.map_err(|fault| scope.refuse(spec, &fault))?;
    let kinds = kinds(&kind);
    let [coordinate, of_damping, of_stiffness] = &kinds;
    let rest = at_rest(spec, &kind, scope)?;
    let damping = read("damping", &spec.damping, of_damping, scope)?;
    let stiffness = read("stiffness", &spec.stiffness, of_stiffness, scope)?;
    let stops = scope.optional("stops", &spec.stops, |at, stops| {
        stops_of(stops, &kinds, at)
    })?;
    let motion = scope.optional("motion", &spec.motion, |at, motion| {
        signal(motion, coordinate, at)
    })?;
    // A value of zero leaves no trace.
    let stiffness = stiffness.filter(|stiffness| *stiffness != 0.0);
    let joint = Joint {
        name: spec.name.clone(),
        kind,
        parent,
        child,
        at: vector(&spec.at),
        damping: damping.filter(|damping| *damping != 0.0),
        spring: stiffness.map(|stiffness| JointSpring { stiffness, rest }),
        stops: stops.flatten(),
        motion,
    };
    joint.check().map_err(|fault| scope.refuse(spec, &fault))?;
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

fn kind(spec: &JointSpec, scope: &Scope<'_>) -> Result<JointKind> {
    let axis = |written: &AxisSpec, at: &Scope<'_>| unit_axis(&written.axis, &at.key("axis"));
    Ok(the_one!(scope, spec;
        "revolute" revolute |at, of| JointKind::Revolute { axis: axis(of, at)? };
        "prismatic" prismatic |at, of| JointKind::Prismatic { axis: axis(of, at)? };
        "universal" universal |at, axes| perpendicular(axes, at)?;
        "cylindrical" cylindrical |at, of| JointKind::Cylindrical { axis: axis(of, at)? };
        "planar" planar |at, plane| JointKind::Planar {
            normal: unit_axis(&plane.normal, &at.key("normal"))?,
        };
        "spherical" spherical |_, _| JointKind::Spherical;
        "floating" floating |_, _| JointKind::Floating;
        "fixed" fixed |_, _| JointKind::Fixed;
    ))
}

/// A joint of two axes that are perpendicular to each other up to the digits that are written.
fn perpendicular(spec: &AxesSpec, scope: &Scope<'_>) -> Result<JointKind> {
    let place = scope.key("axes");
    let first = unit_axis(&spec.axes[0], &place.index(0))?;
    let second = unit_axis(&spec.axes[1], &place.index(1))?;
    let cosine = first.dot(&second);
    let checked = check_axes("axes", cosine, PERPENDICULAR);
    checked.map_err(|fault| scope.refuse(spec, &fault))?;
    let axes = [first, (second - first * cosine).normalize()];
    Ok(JointKind::Universal { axes })
}

/// Kinds of the coordinate of a joint, its damping and its stiffness.
fn kinds(joint: &JointKind) -> [Kind; 3] {
    match joint {
        JointKind::Prismatic { .. } => [Length::kind(), Damping::kind(), Stiffness::kind()],
        _ => [
            Angle::kind(),
            RotationalDamping::kind(),
            RotationalStiffness::kind(),
        ],
    }
}

/// The value of a kind that is written under a key, where there is one.
fn read<M: PhysicalQuantity>(
    key: &str,
    written: &Option<Quantity<M>>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Option<f64>> {
    scope.optional(key, written, |at, written| at.value_as(written, kind))
}

fn stops_of(
    spec: &StopsSpec,
    [coordinate, _, stiffness]: &[Kind; 3],
    scope: &Scope<'_>,
) -> Result<Option<JointStops>> {
    let bound = |key: &str, written: &Option<Quantity<JointCoordinate>>, unwritten: f64| {
        let bound = read(key, written, coordinate, scope);
        bound.map(|bound| bound.unwrap_or(unwritten))
    };
    let stiffness = scope
        .key("stiffness")
        .value_as(&spec.stiffness, stiffness)?;
    let stops = JointStops {
        at: [
            bound("min", &spec.min, f64::NEG_INFINITY)?,
            bound("max", &spec.max, f64::INFINITY)?,
        ],
        stiffness,
        smoothing: bound("smoothing", &spec.smoothing, 0.0)?,
    };
    Ok((stiffness != 0.0).then_some(stops))
}

/// The coordinate without force: zero where none is written.
fn at_rest(spec: &JointSpec, kind: &JointKind, scope: &Scope<'_>) -> Result<f64> {
    let is_sprung = spec.stiffness.is_some();
    let is_revolute = is_sprung && matches!(kind, JointKind::Revolute { .. });
    let is_prismatic = is_sprung && matches!(kind, JointKind::Prismatic { .. });
    let (angle, place) = (&spec.rest_angle, &spec.rest_displacement);
    refuse!(if let (Some(angle), false) = (angle, is_revolute), scope.key("rest_angle");
        found angle, expected "a revolute joint with a \"stiffness\"");
    refuse!(if let (Some(place), false) = (place, is_prismatic), scope.key("rest_displacement");
        found place, expected "a prismatic joint with a \"stiffness\"");
    let (angle, place) = (angle.as_ref(), place.as_ref());
    let rest = angle.map(Quantity::value).or(place.map(Quantity::value));
    Ok(rest.unwrap_or(0.0))
}

objects! {
    /// A joint: exactly one of `revolute`, `prismatic`, `universal`, `cylindrical`, `planar`, `spherical`, `floating`, `fixed`.
    pub struct JointSpec {
        /// Unique name.
        pub name: String,
        /// Rotation about an axis.
        pub revolute: Option<AxisSpec>,
        /// Translation along an axis.
        pub prismatic: Option<AxisSpec>,
        /// Rotation about an axis of the parent and a perpendicular one of the child: a Cardan or Hooke joint.
        pub universal: Option<AxesSpec>,
        /// Translation along an axis and rotation about it.
        pub cylindrical: Option<AxisSpec>,
        /// Translation in a plane and rotation about its normal.
        pub planar: Option<NormalSpec>,
        /// Rotation about a point.
        pub spherical: Option<Nothing>,
        /// Any motion: the child is as free as without the joint, and results give its orientation in the first body.
        pub floating: Option<Nothing>,
        /// No motion.
        pub fixed: Option<Nothing>,
        /// Body on the side of the root, or `ground`.
        pub parent: String,
        /// Body on the other side.
        pub child: String,
        /// Place, SI unit m.
        pub at: Point,
        /// True if the joint is locked as it stands in the reference configuration: it is then `fixed`, and the bodies that it connects are one
        /// body.
        pub locked: bool,
        /// Damping of the joint coordinate, SI unit N m s/rad (revolute) or N s/m (prismatic).
        pub damping: Option<Quantity<JointDamping>>,
        /// Stiffness of a spring of the joint coordinate, SI unit N m/rad (revolute) or N/m (prismatic).
        pub stiffness: Option<Quantity<JointStiffness>>,
        /// Angle of a revolute joint at which its spring exerts no torque, SI unit rad; 0 where absent: the reference configuration. It counts whole
        /// turns.
        pub rest_angle: Option<Quantity<Angle>>,
        /// Displacement of a prismatic joint at which its spring exerts no force, SI unit m; 0 where absent.
        pub rest_displacement: Option<Quantity<Length>>,
        /// Elastic stops of the joint coordinate.
        pub stops: Option<StopsSpec>,
        /// Prescribed coordinate as a function of time, SI unit rad or m: a constant, or an object with `ramp`, `sine`, `table` or `csv`.
        pub motion: Option<SignalSpec<JointCoordinate>>,
    }

    /// Elastic stops of a joint coordinate: `min`, `max` or both.
    pub struct StopsSpec {
        /// Lowest coordinate without force, SI unit rad or m.
        pub min: Option<Quantity<JointCoordinate>>,
        /// Highest coordinate without force, SI unit rad or m.
        pub max: Option<Quantity<JointCoordinate>>,
        /// Stiffness beyond, SI unit N m/rad (revolute) or N/m (prismatic).
        pub stiffness: Quantity<JointStiffness>,
        /// Width around a stop over which the stiffness grows from zero, SI unit rad or m, for optimal control; it jumps where not written.
        pub smoothing: Option<Quantity<JointCoordinate>>,
    }

    /// An axis.
    pub struct AxisSpec {
        /// Direction, of any length.
        pub axis: [f64; 3],
    }

    /// Two axes.
    pub struct AxesSpec {
        /// Directions of any length, perpendicular to each other: that of the parent, then that of the child.
        pub axes: [[f64; 3]; 2],
    }

    /// A plane.
    pub struct NormalSpec {
        /// Direction across the plane, of any length.
        pub normal: [f64; 3],
    }

    /// An object without entries.
    pub struct Nothing {}
}
