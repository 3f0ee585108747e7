//! Conversion of the `track` and `final` entries of a problem file to costs of quantities.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::solution_joints;
use crate::files::problem::spec_track::{
    FinalJointSpec, FinalMarkerSpec, FinalSpec, TrackJointSpec, TrackJointsSpec, TrackMarkerSpec,
    TrackSpec,
};
use crate::files::problem::state::{joint_value, joint_with_coordinate, moving_marker};
use crate::files::problem::voltages::SOLUTION_PATH;
use crate::files::signal::signal;
use crate::files::units::quantity::{Angle, Length};
use crate::math::Signal;
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
            costs.push(square(quantity, reference, weight, During::Motion));
        }
    }
    match costs.is_empty() {
        true => Err(place.wrong("no direction", "\"x\", \"y\" or \"z\"")),
        false => Ok(costs),
    }
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
    let weight = weight(spec.weight, scope)?;
    Ok(vec![square(quantity, reference, weight, During::Motion)])
}

fn of_joints(
    spec: &TrackJointsSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let place = scope.key("solution");
    let weight = weight(spec.weight, scope)?;
    let path = place.solution_file(&spec.solution, SOLUTION_PATH)?;
    let joints = solution_joints::read(&path, system)?;
    if joints.is_empty() {
        let found = "a scene without a revolute or prismatic joint";
        return Err(place.wrong(found, "joints that follow the solution"));
    }
    let cost = |(joint, reference)| {
        let quantity = Quantity::Joint { joint, near: 0.0 };
        square(quantity, reference, weight, During::Motion)
    };
    Ok(joints.into_iter().map(cost).collect())
}

/// The costs of an end that one entry stands for.
pub(crate) fn at_the_end(
    spec: &FinalSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let marker = spec.marker.as_ref().map(|_| "marker");
    let joint = spec.joint.as_ref().map(|_| "joint");
    let key = scope.exactly_one([("marker", marker), ("joint", joint)])?;
    let scope = scope.key(key);
    let mut costs = Vec::new();
    if let Some(FinalMarkerSpec {
        marker,
        at,
        weight: w,
    }) = &spec.marker
    {
        let marker = moving_marker(marker, system, &scope.key("marker"))?;
        let weight = weight(*w, &scope)?;
        for (axis, at) in at.iter().enumerate() {
            if let Some(at) = at {
                let quantity = Quantity::MarkerPlace { marker, axis };
                let reference = Signal::Constant(at.value());
                costs.push(square(quantity, reference, weight, During::End));
            }
        }
        if costs.is_empty() {
            let expected = "one that is not null, or more";
            return Err(scope.key("at").wrong("no coordinate", expected));
        }
    }
    if let Some(FinalJointSpec {
        joint,
        at,
        weight: w,
    }) = &spec.joint
    {
        let joint = joint_with_coordinate(joint, system, &scope.key("joint"))?;
        let kinds = [Angle::kind(), Length::kind()];
        let at = joint_value(at, &kinds, joint, system, &scope.key("at"))?;
        let quantity = Quantity::Joint { joint, near: 0.0 };
        let weight = weight(*w, &scope)?;
        costs.push(square(quantity, Signal::Constant(at), weight, During::End));
    }
    Ok(costs)
}

fn square(quantity: Quantity, reference: Signal, weight: f64, during: During) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during,
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
