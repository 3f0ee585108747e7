//! Conversion of the `track` and `final` entries of a problem file to costs of quantities.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::measured::Measured;
use crate::files::problem::solution_document::solution_document;
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
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

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
enum Along<'a> {
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
        marker: Along::Marker;
        joint: Along::Joint;
        joints: Along::Joints;
        tension: |one| Along::Measured(Measured::Tension(one));
        electric_field: |one| Along::Measured(Measured::Field(one));
        current: |one| Along::Measured(Measured::Current(one));
        power: |one| Along::Measured(Measured::Power(one));
        joint_rate: |one| Along::Measured(Measured::JointRate(one));
        marker_speed: |one| Along::Measured(Measured::MarkerSpeed(one));
    })?;
    let scope = scope.key(key);
    match path {
        Along::Marker(spec) => of_marker(spec, system, &scope),
        Along::Joint(spec) => of_joint(spec, system, &scope),
        Along::Joints(spec) => of_joints(spec, system, &scope),
        Along::Measured(spec) => spec.costs(During::Motion, system, &scope),
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
    let joints = read_solution_joints(&path, system)?;
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

/// Entries that are read of a solution: coordinates in rad or m by joint, one per instant.
#[derive(Debug, Deserialize)]
struct SolutionRecord {
    /// Instants in s.
    time: Vec<f64>,
    #[serde(default)]
    joints: Option<Coordinates>,
    #[serde(default)]
    configuration: Option<Configuration>,
}

type Coordinates = BTreeMap<String, Vec<f64>>;

#[derive(Debug, Deserialize)]
struct Configuration {
    joints: Coordinates,
}

/// The coordinate of each joint of a solution by index, linear between its instants.
pub(crate) fn read_solution_joints(
    path: &Path,
    system: &System,
) -> Result<Vec<(usize, Signal)>, SceneError> {
    let document = &solution_document(path, |name| {
        name == "time" || name.starts_with("configuration/joints/")
    })?;
    let solution: SolutionRecord = document.parse()?;
    let scope = Scope::of(document);
    let place = scope.key("time");
    let times: Vec<f64> = solution.time.iter().map(|time| 1e3 * time).collect();
    if times.is_empty() {
        return Err(place.wrong("no instant", "one or more"));
    }
    place.increasing(&times)?;
    let (joints, place) = match (solution.configuration, solution.joints) {
        (Some(configuration), _) => (
            configuration.joints,
            scope.key("configuration").key("joints"),
        ),
        (None, Some(joints)) => (joints, scope.key("joints")),
        (None, None) => {
            return Err(scope.wrong("neither of them", "\"configuration\" or \"joints\""));
        }
    };
    let signal = |(name, values): (String, Vec<f64>)| {
        let place = place.key(&name);
        let joint = joint_with_coordinate(&name, system, &place)?;
        if values.len() != times.len() {
            let found = format!("{} values", values.len());
            let expected = format!("{}, one for each instant", times.len());
            return Err(place.wrong(found, expected));
        }
        let unit = match joint_unit(system, joint) {
            "mm" => 1e3,
            _ => 1.0,
        };
        let values = values.into_iter().map(|value| unit * value).collect();
        let times = times.clone();
        Ok((joint, Signal::Table { times, values }))
    };
    joints.into_iter().map(signal).collect()
}
