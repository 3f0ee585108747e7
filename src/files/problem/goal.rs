//! Conversion of the goal of a problem file to indices, places and orientations.

use std::collections::BTreeMap;

use crate::control::problem::{BoundaryState, Orientation, Place, Rest};
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::At;
use crate::files::problem::spec_voltages::VoltageMap;
use crate::files::problem::state::{GoalSpec, GoalWord, HeldSpec, OrientationSpec, RestGoalSpec};
use crate::files::scene::point::{PartialPoint, unit_axis};
use crate::files::units::quantity::{Length, Quantity};

/// A state at the end.
pub(crate) fn goal_state(spec: &GoalSpec, at: &At<'_>) -> Result<BoundaryState> {
    let spec = match spec {
        GoalSpec::Word(GoalWord::Free) => return Ok(BoundaryState::Free),
        GoalSpec::Word(GoalWord::Periodic) => return Ok(BoundaryState::Periodic),
        GoalSpec::Rest(spec) => spec.as_ref(),
    };
    let key = given_key(spec, at)?;
    check_companions(spec, key, at)?;
    match (&spec.rest_at_voltages, &spec.joint_angles) {
        (Some(map), _) => equilibrium(map, reached(spec), at),
        (None, Some(_)) => coordinates(spec, &at.key(key)),
        (None, None) => positions(spec, at),
    }
}

fn is_of_places(spec: &RestGoalSpec) -> bool {
    spec.markers.is_some() || spec.orientations.is_some()
}

/// The key that says what a goal gives.
fn given_key(spec: &RestGoalSpec, at: &Scope<'_>) -> Result<&'static str> {
    let of_places = match (&spec.markers, &spec.orientations) {
        (None, Some(_)) => "orientations",
        _ => "markers",
    };
    at.one_key([
        ("rest_at_voltages", spec.rest_at_voltages.is_some()),
        ("joint_angles", spec.joint_angles.is_some()),
        (of_places, is_of_places(spec)),
    ])
}

/// Refuses `hold` and `rest` where they have no meaning next to `key`.
fn check_companions(spec: &RestGoalSpec, key: &str, at: &Scope<'_>) -> Result<()> {
    let beside_places = "it beside \"markers\" or \"orientations\" only";
    let beside_rest = "it beside \"rest_at_voltages\", \"markers\" or \"orientations\" only";
    let beside_goals = "it beside \"joint_angles\", \"markers\" or \"orientations\"; voltages at rest hold their equilibrium";
    let is_of_angles = spec.joint_angles.is_some();
    let is_found = matches!(spec.hold, Some(HeldSpec::Word(_)));
    for (name, is_ignored, expected) in [
        (
            "hold",
            spec.hold.is_some() && !is_of_places(spec) && !(is_found && is_of_angles),
            if is_found {
                beside_goals
            } else {
                beside_places
            },
        ),
        ("rest", spec.rest.is_some() && is_of_angles, beside_rest),
    ] {
        refuse!(if is_ignored, at.key(name);
            found format!("{name:?} beside {key:?}"), expected expected);
    }
    Ok(())
}

/// Part of the system that comes to rest.
fn reached(spec: &RestGoalSpec) -> Rest {
    spec.rest.map_or(Rest::Attainable, Rest::from)
}

/// A state of rest under voltages.
fn equilibrium(map: &VoltageMap, rest: Rest, at: &At<'_>) -> Result<BoundaryState> {
    refuse!(if rest == Rest::Bodies && at.system.bodies.is_empty(), at.key("rest");
        found "a scene without bodies",
        expected "a scene with bodies; goals of elastic blocks alone are \"markers\"");
    let row = at.key("rest_at_voltages").voltages(map)?;
    Ok(BoundaryState::RestAtVoltages(row, rest))
}

/// Positions of markers and orientations of bodies.
fn positions(spec: &RestGoalSpec, at: &At<'_>) -> Result<BoundaryState> {
    Ok(BoundaryState::Markers {
        places: of_markers(&spec.markers, &at.key("markers"))?,
        orientations: of_bodies(&spec.orientations, &at.key("orientations"))?,
        rest: reached(spec),
        hold: match &spec.hold {
            Some(HeldSpec::Given(map)) => Some(at.key("hold").voltages(map)?),
            Some(HeldSpec::Word(_)) | None => None,
        },
    })
}

/// Coordinates of joints, whose map stands here.
fn coordinates(spec: &RestGoalSpec, at: &At<'_>) -> Result<BoundaryState> {
    let angles = at.by_joint(&spec.joint_angles)?;
    refuse!(if angles.is_empty(), at;
        found "no joint", expected "the coordinate of a joint or more");
    Ok(BoundaryState::JointAngles {
        angles,
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    })
}

/// Places by marker; of a map that is written one or more.
pub(crate) fn of_markers(
    markers: &Option<BTreeMap<String, PartialPoint>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, Place>> {
    refuse!(if markers.as_ref().is_some_and(BTreeMap::is_empty), at;
        found "no marker", expected "the position of a marker or more");
    at.each_named(markers.iter().flatten(), |name, point, at| {
        let marker = at.moving_marker(name)?;
        refuse!(if point.iter().all(Option::is_none), at;
            found "no coordinate", expected "one that is not null, or more");
        let value = |entry: &Option<Quantity<Length>>| entry.as_ref().map(Quantity::value);
        Ok((marker, Place(point.each_ref().map(value))))
    })
}

/// Orientations by body; of a map that is written one or more.
pub(crate) fn of_bodies(
    bodies: &Option<BTreeMap<String, OrientationSpec>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, Orientation>> {
    refuse!(if bodies.as_ref().is_some_and(BTreeMap::is_empty), at;
        found "no body", expected "the orientation of a body or more");
    at.each_named(bodies.iter().flatten(), |name, spec, at| {
        let body = at.body(name)?;
        let axis = unit_axis(&spec.axis, &at.key("axis"))?;
        let orientation = the_one!(at, spec;
            "towards" towards |at, towards| Orientation::Towards {
                axis,
                towards: unit_axis(towards, at)?,
            };
            "angle" angle |_, angle| Orientation::Turned {
                axis,
                angle: angle.value(),
            };
        );
        Ok((body, orientation))
    })
}
