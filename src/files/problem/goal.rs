//! Conversion of the goal of a problem file to indices, places and orientations.

use std::collections::BTreeMap;

use crate::control::problem::{BoundaryState, Orientation, Place, Rest};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_voltages::VoltageMap;
use crate::files::problem::state::{
    GoalSpec, GoalWord, HeldSpec, OrientationSpec, RestGoalSpec, by_joint, moving_marker, voltages,
};
use crate::files::scene::names::names;
use crate::files::scene::point::{PartialPoint, unit_axis};
use crate::files::units::quantity::{Angle, Length, Quantity};
use crate::model::system::System;

/// A state at the end.
pub(crate) fn goal_state(
    spec: &GoalSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BoundaryState> {
    let spec = match spec {
        GoalSpec::Word(GoalWord::Free) => return Ok(BoundaryState::Free),
        GoalSpec::Word(GoalWord::Periodic) => return Ok(BoundaryState::Periodic),
        GoalSpec::Rest(spec) => spec.as_ref(),
    };
    let key = given_key(spec, scope)?;
    check_companions(spec, key, scope)?;
    match (&spec.rest_at_voltages, &spec.joint_angles) {
        (Some(map), _) => equilibrium(map, reached(spec), system, scope),
        (None, Some(_)) => coordinates(spec, system, &scope.key(key)),
        (None, None) => positions(spec, system, scope),
    }
}

fn is_of_places(spec: &RestGoalSpec) -> bool {
    spec.markers.is_some() || spec.orientations.is_some()
}

/// The key that says what a goal gives.
fn given_key(spec: &RestGoalSpec, scope: &Scope<'_>) -> Result<&'static str> {
    let of_places = match (&spec.markers, &spec.orientations) {
        (None, Some(_)) => "orientations",
        _ => "markers",
    };
    let is_given = [
        ("rest_at_voltages", spec.rest_at_voltages.is_some()),
        ("joint_angles", spec.joint_angles.is_some()),
        (of_places, is_of_places(spec)),
    ];
    scope.exactly_one(is_given.map(|(key, is_given)| (key, is_given.then_some(key))))
}

/// Refuses `hold` and `rest` where they have no meaning next to `key`.
fn check_companions(spec: &RestGoalSpec, key: &str, scope: &Scope<'_>) -> Result<()> {
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
        if is_ignored {
            let found = format!("{name:?} beside {key:?}");
            return Err(scope.key(name).wrong(found, expected));
        }
    }
    Ok(())
}

/// Part of the system that comes to rest.
fn reached(spec: &RestGoalSpec) -> Rest {
    spec.rest.map_or(Rest::Attainable, Rest::from)
}

/// A state of rest under voltages.
fn equilibrium(
    map: &VoltageMap,
    rest: Rest,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BoundaryState> {
    if rest == Rest::Bodies && system.bodies.is_empty() {
        let expected = "a scene with bodies; goals of elastic blocks alone are \"markers\"";
        return Err(scope.key("rest").wrong("a scene without bodies", expected));
    }
    let row = voltages(map, system, &scope.key("rest_at_voltages"))?;
    Ok(BoundaryState::RestAtVoltages(row, rest))
}

/// Positions of markers and orientations of bodies.
fn positions(spec: &RestGoalSpec, system: &System, scope: &Scope<'_>) -> Result<BoundaryState> {
    let written = (spec.markers.as_ref(), spec.orientations.as_ref());
    let (places, orientations) = places(written, system, scope)?;
    let held = match &spec.hold {
        Some(HeldSpec::Given(map)) => Some(voltages(map, system, &scope.key("hold"))?),
        Some(HeldSpec::Word(_)) | None => None,
    };
    Ok(BoundaryState::Markers {
        places,
        orientations,
        rest: reached(spec),
        hold: held,
    })
}

/// Coordinates of joints; `scope` is that of the map.
fn coordinates(spec: &RestGoalSpec, system: &System, scope: &Scope<'_>) -> Result<BoundaryState> {
    let kinds = [Angle::kind(), Length::kind()];
    let angles = by_joint(&spec.joint_angles, &kinds, system, scope)?;
    if angles.is_empty() {
        return Err(scope.wrong("no joint", "the coordinate of a joint or more"));
    }
    Ok(BoundaryState::JointAngles {
        angles,
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    })
}

/// Markers and orientations as they are written, each map only where there is one.
type WrittenPlaces<'a> = (
    Option<&'a BTreeMap<String, PartialPoint>>,
    Option<&'a BTreeMap<String, OrientationSpec>>,
);

/// Places by marker, and orientations by body.
type Places = (BTreeMap<usize, Place>, BTreeMap<usize, Orientation>);

/// Places of markers and orientations of bodies that are written under `markers` and `orientations`.
pub(crate) fn places(
    (markers, orientations): WrittenPlaces<'_>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Places> {
    let places = markers.map(|map| of_markers(map, system, &scope.key("markers")));
    let turned = orientations.map(|map| of_bodies(map, system, &scope.key("orientations")));
    Ok((
        places.transpose()?.unwrap_or_default(),
        turned.transpose()?.unwrap_or_default(),
    ))
}

fn of_markers(
    markers: &BTreeMap<String, PartialPoint>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BTreeMap<usize, Place>> {
    let mut goals = BTreeMap::new();
    for (name, at) in markers {
        let place = scope.key(name);
        let index = moving_marker(name, system, &place)?;
        if at.iter().all(Option::is_none) {
            return Err(place.wrong("no coordinate", "one that is not null, or more"));
        }
        let value = |entry: &Option<Quantity<Length>>| entry.as_ref().map(Quantity::value);
        goals.insert(index, Place(at.each_ref().map(value)));
    }
    match goals.is_empty() {
        true => Err(scope.wrong("no marker", "the position of a marker or more")),
        false => Ok(goals),
    }
}

fn of_bodies(
    bodies: &BTreeMap<String, OrientationSpec>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BTreeMap<usize, Orientation>> {
    let all = names(&system.bodies, |body| &body.name);
    let mut goals = BTreeMap::new();
    for (name, spec) in bodies {
        let place = scope.key(name);
        let index = place.find(name, &all, "the name of a body")?;
        let axis = unit_axis(&spec.axis, &place.key("axis"))?;
        place.exactly_one([
            ("towards", spec.towards.as_ref().map(|_| ())),
            ("angle", spec.angle.as_ref().map(|_| ())),
        ])?;
        let orientation = match &spec.towards {
            Some(towards) => Orientation::Towards {
                axis,
                towards: unit_axis(towards, &place.key("towards"))?,
            },
            None => Orientation::Turned {
                axis,
                angle: spec.angle.as_ref().map_or(0.0, Quantity::value),
            },
        };
        goals.insert(index, orientation);
    }
    match goals.is_empty() {
        true => Err(scope.wrong("no body", "the orientation of a body or more")),
        false => Ok(goals),
    }
}
