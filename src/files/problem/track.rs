//! From what an objective follows as written to costs of quantities.

use crate::control::Signal;
use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::signal::signal;
use crate::files::problem::solution_joints;
use crate::files::problem::spec_track::{
    TrackJointSpec, TrackJointsSpec, TrackMarkerSpec, TrackSpec,
};
use crate::files::problem::state::joint_with_coordinate;
use crate::files::problem::voltages::existing;
use crate::files::scene::names::names;
use crate::files::units::quantity::{Angle, Length};
use crate::model::system::System;
use crate::model::{Quantity, joint_unit};

/// The costs that one entry stands for.
pub(crate) fn track(
    spec: &TrackSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    type Build<'a> = Box<dyn FnOnce() -> Result<Vec<QuantityCost>, SceneError> + 'a>;
    let marker = spec
        .marker
        .as_ref()
        .map(|spec| -> Build<'_> { Box::new(|| of_marker(spec, system, &scope.key("marker"))) });
    let joint = spec
        .joint
        .as_ref()
        .map(|spec| -> Build<'_> { Box::new(|| of_joint(spec, system, &scope.key("joint"))) });
    let joints = spec
        .joints
        .as_ref()
        .map(|spec| -> Build<'_> { Box::new(|| of_joints(spec, system, &scope.key("joints"))) });
    let build = scope.exactly_one([("marker", marker), ("joint", joint), ("joints", joints)])?;
    build()
}

fn of_marker(
    spec: &TrackMarkerSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let marker = moving_marker(&spec.marker, system, &scope.key("marker"))?;
    let weight = weight(spec.weight, scope)?;
    let place = scope.key("along");
    let axes = [
        ("x", &spec.along.x),
        ("y", &spec.along.y),
        ("z", &spec.along.z),
    ];
    let mut costs = Vec::new();
    for (axis, (key, along)) in axes.into_iter().enumerate() {
        if let Some(along) = along {
            let reference = signal(along, &Length::kind(), &place.key(key))?;
            let quantity = Quantity::MarkerPlace { marker, axis };
            costs.push(followed(quantity, reference, weight));
        }
    }
    match costs.is_empty() {
        true => Err(place.wrong("no direction", "\"x\", \"y\" or \"z\"")),
        false => Ok(costs),
    }
}

/// Index of a marker that may move.
pub(crate) fn moving_marker(
    name: &str,
    system: &System,
    scope: &Scope<'_>,
) -> Result<usize, SceneError> {
    let all = names(&system.markers, |marker| &marker.name);
    let index = scope.find(name, &all, "the name of a marker")?;
    let marker = &system.markers[index];
    if marker.point.body.is_none() && marker.solid.is_none() {
        let found = format!("{name:?}, which is fixed to the ground");
        return Err(scope.wrong(found, "a marker on a body or a block"));
    }
    Ok(index)
}

fn of_joint(
    spec: &TrackJointSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let joint = joint_with_coordinate(&spec.joint, system, &scope.key("joint"))?;
    let kind = match joint_unit(system, joint) {
        "mm" => Length::kind(),
        _ => Angle::kind(),
    };
    let reference = signal(&spec.along, &kind, &scope.key("along"))?;
    let quantity = Quantity::Joint { joint, near: 0.0 };
    Ok(vec![followed(
        quantity,
        reference,
        weight(spec.weight, scope)?,
    )])
}

fn of_joints(
    spec: &TrackJointsSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let place = scope.key("solution");
    let weight = weight(spec.weight, scope)?;
    let path = existing(&spec.solution, &place)?;
    let joints = solution_joints::read(&path, system)?;
    if joints.is_empty() {
        let found = "a scene without a revolute or prismatic joint";
        return Err(place.wrong(found, "joints that follow the solution"));
    }
    let cost = |(joint, reference)| {
        let quantity = Quantity::Joint { joint, near: 0.0 };
        followed(quantity, reference, weight)
    };
    Ok(joints.into_iter().map(cost).collect())
}

fn followed(quantity: Quantity, reference: Signal, weight: f64) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during: During::Motion,
    }
}

fn weight(spec: Option<f64>, scope: &Scope<'_>) -> Result<f64, SceneError> {
    match spec.unwrap_or(1.0) {
        weight if weight > 0.0 => Ok(weight),
        weight => Err(scope
            .key("weight")
            .wrong(weight.to_string(), "a positive weight")),
    }
}
