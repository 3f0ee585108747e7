//! Conversion of the goal of a problem file to indices, places and orientations.

use std::collections::BTreeMap;

use crate::control::problem::{BoundaryState, Orientation, Place, Rest};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_states::{GoalSpec, OrientationSpec, RestGoalSpec};
use crate::files::problem::state::{by_joint, moving_marker, voltages};
use crate::files::scene::body::unit_axis;
use crate::files::scene::names::names;
use crate::files::scene::point::PartialPoint;
use crate::files::units::quantity::{Angle, Length, Quantity};
use crate::model::system::System;

/// A state at the end.
pub(crate) fn goal_state(
    spec: &GoalSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BoundaryState, SceneError> {
    let spec = match spec {
        GoalSpec::Word(_) => return Ok(BoundaryState::Free),
        GoalSpec::Rest(spec) => spec,
    };
    let RestGoalSpec {
        rest_at_voltages,
        joint_angles,
        markers,
        orientations,
        rest,
        hold,
    } = spec.as_ref();
    let of_places = match (markers, orientations) {
        (None, Some(_)) => "orientations",
        _ => "markers",
    };
    let is_of_places = markers.is_some() || orientations.is_some();
    let key = scope.exactly_one([
        (
            "rest_at_voltages",
            rest_at_voltages.as_ref().map(|_| "rest_at_voltages"),
        ),
        (
            "joint_angles",
            joint_angles.as_ref().map(|_| "joint_angles"),
        ),
        (of_places, is_of_places.then_some(of_places)),
    ])?;
    let beside_places = "it beside \"markers\" or \"orientations\" only";
    let beside_rest = "it beside \"rest_at_voltages\", \"markers\" or \"orientations\" only";
    let is_of_angles = joint_angles.is_some();
    for (name, is_ignored, expected) in [
        ("hold", hold.is_some() && !is_of_places, beside_places),
        ("rest", rest.is_some() && is_of_angles, beside_rest),
    ] {
        if is_ignored {
            let found = format!("{name:?} beside {key:?}");
            return Err(scope.key(name).wrong(found, expected));
        }
    }
    let reached = rest.map_or(Rest::Attainable, Rest::from);
    if let Some(map) = rest_at_voltages {
        if reached == Rest::Bodies && system.bodies.is_empty() {
            let expected = "a scene with bodies; goals of elastic blocks alone are \"markers\"";
            return Err(scope.key("rest").wrong("a scene without bodies", expected));
        }
        let row = voltages(map, system, &scope.key(key))?;
        return Ok(BoundaryState::RestAtVoltages(row, reached));
    }
    if is_of_places {
        let places = markers
            .as_ref()
            .map(|map| of_markers(map, system, &scope.key("markers")));
        let turned = orientations
            .as_ref()
            .map(|map| of_bodies(map, system, &scope.key("orientations")));
        let held = |map| voltages(map, system, &scope.key("hold"));
        return Ok(BoundaryState::Markers {
            places: places.transpose()?.unwrap_or_default(),
            orientations: turned.transpose()?.unwrap_or_default(),
            rest: reached,
            hold: hold.as_ref().map(held).transpose()?,
        });
    }
    let place = scope.key(key);
    let angles = by_joint(
        joint_angles,
        &[Angle::kind(), Length::kind()],
        system,
        &place,
    )?;
    if angles.is_empty() {
        return Err(place.wrong("no joint", "the coordinate of a joint or more"));
    }
    Ok(BoundaryState::JointAngles {
        angles,
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    })
}

fn of_markers(
    markers: &BTreeMap<String, PartialPoint>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BTreeMap<usize, Place>, SceneError> {
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
) -> Result<BTreeMap<usize, Orientation>, SceneError> {
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
