//! Coordinates, rates, forces and torques of joints in limits, costs and recordings.

use crate::control::problem::{During, Limit, QuantityCost};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::quantities::entry::{
    CostEntry, LimitEntry, Named, Recorded, SiUnit, bounds, check_bounds, limits_of, square, weight,
};
use crate::files::problem::solution_document::solution_document;
use crate::files::problem::state::{joint_value, joint_with_coordinate};
use crate::files::problem::voltages::SOLUTION_PATH;
use crate::files::scene::names::names;
use crate::files::scene::point::unit_axis;
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{
    Angle, AngularVelocity, Force, JointCoordinate, JointRate, Kind, Length, PhysicalQuantity,
    Quantity as Written, Torque, Velocity,
};
use crate::math::{Signal, Vector};
use crate::model::system::System;
use crate::model::{Quantity, Reaction, What, joint_unit};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Limits of a joint coordinate: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointAngleLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Lower bound, SI unit rad or m.
    #[serde(default)]
    pub min: Option<Written<JointCoordinate>>,
    /// Upper bound, SI unit rad or m.
    #[serde(default)]
    pub max: Option<Written<JointCoordinate>>,
}

/// Limits of the mean rate of a joint coordinate in each interval: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointRateLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Lower bound, SI unit rad/s or m/s.
    #[serde(default)]
    pub min: Option<Written<JointRate>>,
    /// Upper bound, SI unit rad/s or m/s.
    #[serde(default)]
    pub max: Option<Written<JointRate>>,
}

/// Limits of the component, along a direction of the ground frame, of the force from the parent of a joint on its child: `min`, `max` or both.
///
/// It is the force of the columns of reactions, at the instants between intervals. Joints in loops are refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionForceLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Direction of the ground frame, of any length.
    pub along: [f64; 3],
    /// Lower bound, SI unit N.
    #[serde(default)]
    pub min: Option<Written<Force>>,
    /// Upper bound, SI unit N.
    #[serde(default)]
    pub max: Option<Written<Force>>,
}

/// Limits of the component, about a direction of the ground frame, of the torque from the parent of a joint on its child: `min`, `max` or both.
///
/// It is the torque of the columns of reactions, about the point of the joint, at the instants between intervals. Spherical joints and joints in
/// loops are refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionTorqueLimitSpec {
    /// Name of the joint.
    pub joint: String,
    /// Direction of the ground frame, of any length.
    pub about: [f64; 3],
    /// Lower bound, SI unit N m.
    #[serde(default)]
    pub min: Option<Written<Torque>>,
    /// Upper bound, SI unit N m.
    #[serde(default)]
    pub max: Option<Written<Torque>>,
}

/// A joint and the function that its coordinate follows.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackJointSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// The function of time, SI unit rad or m.
    pub along: SignalSpec<JointCoordinate>,
    /// Weight of ∫ (θ − r)² dt in rad² s, or mm² s of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// All joints along an earlier solution.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackJointsSpec {
    /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder; linear between its instants, constant after
    /// the last.
    pub solution: String,
    /// Weight of the sum over all joints of ∫ (θ − r)² dt in rad² s, or mm² s of prismatic joints; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// A joint and where it is to end.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalJointSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// The value, SI unit rad or m.
    pub at: Written<JointCoordinate>,
    /// Weight of (θ − r)² at the final instant, in rad², or mm² of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The mean rate of the coordinate of a joint in the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointRateCostSpec {
    /// Name of the joint, revolute or prismatic.
    pub joint: String,
    /// Rate that is asked for, SI unit rad/s or m/s; 0 where not written.
    #[serde(default)]
    pub at: Option<Written<JointRate>>,
    /// Weight of the squared deviation in (rad/s)², or (m/s)² of a prismatic joint; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// Kinds of coordinates of joints, and of their rates: of rotations and of translations.
fn coordinates() -> [Kind; 2] {
    [Angle::kind(), Length::kind()]
}

fn rates() -> [Kind; 2] {
    [AngularVelocity::kind(), Velocity::kind()]
}

/// A joint, and the bounds of its coordinate or rate, of which one at least is written.
fn of_joint<M: PhysicalQuantity>(
    joint: &str,
    [min, max]: [&Option<Written<M>>; 2],
    kinds: [Kind; 2],
    system: &System,
    scope: &Scope<'_>,
) -> Result<(What, [f64; 2])> {
    let joint = joint_with_coordinate(joint, system, &scope.key("joint"))?;
    let bound = |key: &str, quantity: &Option<Written<M>>, absent: f64| match quantity {
        Some(quantity) => joint_value(quantity, &kinds, joint, system, &scope.key(key)),
        None => Ok(absent),
    };
    let bounds = [
        bound("min", min, f64::NEG_INFINITY)?,
        bound("max", max, f64::INFINITY)?,
    ];
    let is_written = min.is_some() || max.is_some();
    let what = What::Joint { joint, near: 0.0 };
    Ok((what, check_bounds(bounds, is_written, scope)?))
}

impl LimitEntry for JointAngleLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let bounds = [&self.min, &self.max];
        let (what, bounds) = of_joint(&self.joint, bounds, coordinates(), system, scope)?;
        Ok(vec![Limit::new(what, bounds)])
    }
}

impl LimitEntry for JointRateLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let bounds = [&self.min, &self.max];
        let (what, bounds) = of_joint(&self.joint, bounds, rates(), system, scope)?;
        Ok(vec![Limit::of_rate(what, bounds)])
    }
}

impl LimitEntry for ReactionForceLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], scope)?;
        let joint = transmitting(&self.joint, Reaction::Force, system, &scope.key("joint"))?;
        let along = unit_axis(&self.along, &scope.key("along"))?;
        let of = Reaction::Force;
        Ok(limits_of([What::Reaction { joint, of, along }], bounds))
    }
}

impl LimitEntry for ReactionTorqueLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let joint = transmitting(&self.joint, Reaction::Torque, system, &scope.key("joint"))?;
        let bounds = bounds([&self.min, &self.max], scope)?;
        let along = unit_axis(&self.about, &scope.key("about"))?;
        let of = Reaction::Torque;
        Ok(limits_of([What::Reaction { joint, of, along }], bounds))
    }
}

/// A joint that transmits a force or torque.
fn transmitting(name: &str, of: Reaction, system: &System, place: &Scope<'_>) -> Result<usize> {
    let joints = names(&system.joints, |joint| &joint.name);
    let joint = place.find(name, &joints, "the name of a joint")?;
    if of == Reaction::Torque && !system.joints[joint].has_torque() {
        let found = format!("{name:?}, a spherical joint");
        return Err(place.wrong(found, "a joint that transmits a torque"));
    }
    Ok(joint)
}

impl CostEntry for JointRateCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let joint = joint_with_coordinate(&self.joint, system, &scope.key("joint"))?;
        let at = self.at.as_ref().map_or(Ok(0.0), |at| {
            joint_value(at, &rates(), joint, system, &scope.key("at"))
        })?;
        let quantity = Quantity::joint_rate(joint);
        let at = quantity.rate_factor(system).unwrap_or(1.0) * at;
        Ok(vec![square(quantity, at, weight, during)])
    }
}

impl CostEntry for TrackJointSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let joint = joint_with_coordinate(&self.joint, system, &scope.key("joint"))?;
        let kind = match joint_unit(system, joint) {
            "mm" => Length::kind(),
            _ => Angle::kind(),
        };
        let reference = signal(&self.along, &kind, &scope.key("along"))?;
        let weight = weight(self.weight, scope)?;
        let quantity = Quantity::joint(joint, 0.0);
        Ok(vec![square(quantity, reference, weight, during)])
    }
}

impl CostEntry for TrackJointsSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let place = scope.key("solution");
        let weight = weight(self.weight, scope)?;
        let path = place.solution_file(&self.solution, SOLUTION_PATH)?;
        let joints = read_solution_joints(&path, system)?;
        if joints.is_empty() {
            let found = "a scene without a revolute or prismatic joint";
            return Err(place.wrong(found, "joints that follow the solution"));
        }
        let cost = |(joint, reference): (usize, Signal)| {
            square(Quantity::joint(joint, 0.0), reference, weight, during)
        };
        Ok(joints.into_iter().map(cost).collect())
    }
}

impl CostEntry for FinalJointSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let joint = joint_with_coordinate(&self.joint, system, &scope.key("joint"))?;
        let at = joint_value(&self.at, &coordinates(), joint, system, &scope.key("at"))?;
        let weight = weight(self.weight, scope)?;
        let quantity = Quantity::joint(joint, 0.0);
        Ok(vec![square(quantity, at, weight, during)])
    }
}

pub(super) fn coordinate(of: &Named<'_>) -> Result<Recorded> {
    let joint = joint_with_coordinate(of.name, of.system, of.place)?;
    let unit = match joint_unit(of.system, joint) {
        "mm" => (Length::kind(), ("m", 1e-3)),
        _ => (Angle::kind(), ("rad", 1.0)),
    };
    let quantity = Quantity::joint(joint, 0.0);
    Ok(Recorded::plain(of.name, of.name.to_owned(), quantity, unit))
}

pub(super) fn rate(of: &Named<'_>) -> Result<Recorded> {
    let joint = joint_with_coordinate(of.name, of.system, of.place)?;
    let unit = match joint_unit(of.system, joint) {
        "mm" => (Velocity::kind(), ("m/s", 1.0)),
        _ => (AngularVelocity::kind(), ("rad/s", 1e3)),
    };
    let quantity = Quantity::joint_rate(joint);
    Ok(Recorded::named("rate", of.name, quantity, unit))
}

pub(super) fn reaction_force(of: &Named<'_>) -> Result<Recorded> {
    let along = written_direction(of.along, &of.scope.key("along"));
    let unit = (Force::kind(), ("N", 1.0));
    reaction(of, Reaction::Force, along, unit)
}

pub(super) fn reaction_torque(of: &Named<'_>) -> Result<Recorded> {
    let along = written_direction(of.about, &of.scope.key("about"));
    let unit = (Torque::kind(), ("N m", 1e-3));
    reaction(of, Reaction::Torque, along, unit)
}

/// Force or torque that a joint transmits along a direction.
fn reaction(
    named: &Named<'_>,
    of: Reaction,
    along: Result<Vector>,
    unit: (Kind, SiUnit),
) -> Result<Recorded> {
    let joint = transmitting(named.name, of, named.system, named.place)?;
    let what = What::Reaction {
        joint,
        of,
        along: along?,
    };
    let word = match of {
        Reaction::Force => "force",
        Reaction::Torque => "torque",
    };
    Ok(Recorded::named(
        word,
        named.name,
        Quantity::jump(what, 1.0, 1.0),
        unit,
    ))
}

/// The unit vector of a direction that has to be written.
pub(super) fn written_direction(direction: Option<[f64; 3]>, place: &Scope<'_>) -> Result<Vector> {
    let Some(direction) = direction else {
        let expected = "a direction, such as [1, 0, 0]";
        return Err(place.wrong("no direction", expected));
    };
    unit_axis(&direction, place)
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
pub(crate) fn read_solution_joints(path: &Path, system: &System) -> Result<Vec<(usize, Signal)>> {
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
