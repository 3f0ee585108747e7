//! Conversion of the `track` and `final` entries of a problem file to costs of quantities.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::measured::Measured;
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

/// Possible entries of a specification by their keys, each with its key.
macro_rules! entries {
    ($spec:ident, $($key:ident: $make:expr;)*) => {
        [$((
            stringify!($key),
            $spec.$key.as_ref().map(|one| (stringify!($key), $make(one))),
        ),)*]
    };
}

/// A path that an entry names.
enum Path<'a> {
    Marker(&'a TrackMarkerSpec),
    Joint(&'a TrackJointSpec),
    Joints(&'a TrackJointsSpec),
    Measured(Measured<'a>),
}

/// The costs that one entry stands for.
pub(crate) fn track(
    spec: &TrackSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let (key, path) = scope.exactly_one(entries! { spec,
        marker: Path::Marker;
        joint: Path::Joint;
        joints: Path::Joints;
        tension: |one| Path::Measured(Measured::Tension(one));
        electric_field: |one| Path::Measured(Measured::Field(one));
        current: |one| Path::Measured(Measured::Current(one));
        power: |one| Path::Measured(Measured::Power(one));
        joint_rate: |one| Path::Measured(Measured::JointRate(one));
        marker_speed: |one| Path::Measured(Measured::MarkerSpeed(one));
    })?;
    let scope = scope.key(key);
    match path {
        Path::Marker(spec) => of_marker(spec, system, &scope),
        Path::Joint(spec) => of_joint(spec, system, &scope),
        Path::Joints(spec) => of_joints(spec, system, &scope),
        Path::Measured(spec) => spec.costs(During::Motion, system, &scope),
    }
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
            let quantity = Quantity::marker_place(marker, axis);
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

/// A part that an entry names at the end.
enum End<'a> {
    Marker(&'a FinalMarkerSpec),
    Joint(&'a FinalJointSpec),
    Measured(Measured<'a>),
}

/// The costs of an end that one entry stands for.
pub(crate) fn at_the_end(
    spec: &FinalSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let (key, end) = scope.exactly_one(entries! { spec,
        marker: End::Marker;
        joint: End::Joint;
        tension: |one| End::Measured(Measured::Tension(one));
        electric_field: |one| End::Measured(Measured::Field(one));
        current: |one| End::Measured(Measured::Current(one));
        power: |one| End::Measured(Measured::Power(one));
        joint_rate: |one| End::Measured(Measured::JointRate(one));
        marker_speed: |one| End::Measured(Measured::MarkerSpeed(one));
    })?;
    let scope = scope.key(key);
    match end {
        End::Marker(spec) => marker_at_end(spec, system, &scope),
        End::Joint(spec) => {
            let joint = joint_with_coordinate(&spec.joint, system, &scope.key("joint"))?;
            let kinds = [Angle::kind(), Length::kind()];
            let at = joint_value(&spec.at, &kinds, joint, system, &scope.key("at"))?;
            let quantity = Quantity::Joint { joint, near: 0.0 };
            let weight = weight(spec.weight, &scope)?;
            let reference = Signal::Constant(at);
            Ok(vec![square(quantity, reference, weight, During::End)])
        }
        End::Measured(spec) => spec.costs(During::End, system, &scope),
    }
}

fn marker_at_end(
    spec: &FinalMarkerSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let marker = moving_marker(&spec.marker, system, &scope.key("marker"))?;
    let weight = weight(spec.weight, scope)?;
    let given = spec.at.iter().enumerate();
    let given = given.filter_map(|(axis, at)| Some((axis, at.as_ref()?)));
    let costs = given.map(|(axis, at)| {
        let quantity = Quantity::marker_place(marker, axis);
        square(quantity, Signal::Constant(at.value()), weight, During::End)
    });
    let costs: Vec<QuantityCost> = costs.collect();
    match costs.is_empty() {
        true => {
            let expected = "one that is not null, or more";
            Err(scope.key("at").wrong("no coordinate", expected))
        }
        false => Ok(costs),
    }
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
