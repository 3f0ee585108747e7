//! Coordinates, rates, forces and torques of joints in limits, costs and recordings.

use crate::control::problem::Limit;
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::{At, SiUnit};
use crate::files::problem::quantities::entry::{
    Cost, CostEntry, LimitEntry, Named, Recorded, bounds, bounds_by, limits_of, square,
};
use crate::files::problem::voltages::{SOLUTION_PATH, solution_document};
use crate::files::scene::point::unit_axis;
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{
    Force, JointCoordinate, JointRate, Kind, PhysicalQuantity, Quantity as Written, Torque,
};
use crate::math::{Signal, Vector};
use crate::model::system::System;
use crate::model::{Quantity, Reaction, What};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

read_objects! {
    /// Limits of a joint coordinate: `min`, `max` or both.
    pub struct JointAngleLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Lower bound, SI unit rad or m.
        pub min: Option<Written<JointCoordinate>>,
        /// Upper bound, SI unit rad or m.
        pub max: Option<Written<JointCoordinate>>,
    }

    /// Limits of the mean rate of a joint coordinate in each interval: `min`, `max` or both.
    pub struct JointRateLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Lower bound, SI unit rad/s or m/s.
        pub min: Option<Written<JointRate>>,
        /// Upper bound, SI unit rad/s or m/s.
        pub max: Option<Written<JointRate>>,
    }

    /// Limits of the component, along a direction of the ground frame, of the force from the parent of a joint on its child: `min`, `max` or both.
    ///
    /// It is the force of the columns of reactions, at the instants between intervals. Joints in loops are refused.
    pub struct ReactionForceLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Direction of the ground frame, of any length.
        pub along: [f64; 3],
        /// Lower bound, SI unit N.
        pub min: Option<Written<Force>>,
        /// Upper bound, SI unit N.
        pub max: Option<Written<Force>>,
    }

    /// Limits of the component, about a direction of the ground frame, of the torque from the parent of a joint on its child: `min`, `max` or both.
    ///
    /// It is the torque of the columns of reactions, about the point of the joint, at the instants between intervals. Spherical joints and joints in
    /// loops are refused.
    pub struct ReactionTorqueLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Direction of the ground frame, of any length.
        pub about: [f64; 3],
        /// Lower bound, SI unit N m.
        pub min: Option<Written<Torque>>,
        /// Upper bound, SI unit N m.
        pub max: Option<Written<Torque>>,
    }

    /// A joint and the function that its coordinate follows.
    pub struct TrackJointSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// The function of time, SI unit rad or m.
        pub along: SignalSpec<JointCoordinate>,
        /// Weight of ∫ (θ − r)² dt in rad² s, or mm² s of a prismatic joint; 1 where not written.
        pub weight: Option<f64>,
    }

    /// All joints along an earlier solution.
    pub struct TrackJointsSpec {
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder; linear between its instants, constant after
        /// the last.
        pub solution: String,
        /// Weight of the sum over all joints of ∫ (θ − r)² dt in rad² s, or mm² s of prismatic joints; 1 where not written.
        pub weight: Option<f64>,
    }

    /// A joint and where it is to end.
    pub struct FinalJointSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// The value, SI unit rad or m.
        pub at: Written<JointCoordinate>,
        /// Weight of (θ − r)² at the final instant, in rad², or mm² of a prismatic joint; 1 where not written.
        pub weight: Option<f64>,
    }

    /// The mean rate of the coordinate of a joint in the intervals.
    pub struct JointRateCostSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// Rate that is asked for, SI unit rad/s or m/s; 0 where not written.
        pub at: Option<Written<JointRate>>,
        /// Weight of the squared deviation in (rad/s)², or (m/s)² of a prismatic joint; 1 where not written.
        pub weight: Option<f64>,
    }
}

impl LimitEntry for JointAngleLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let (what, bounds) = of_joint(&self.joint, [&self.min, &self.max], at)?;
        Ok(vec![Limit::new(what, bounds)])
    }
}

impl LimitEntry for JointRateLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let (what, bounds) = of_joint(&self.joint, [&self.min, &self.max], at)?;
        Ok(vec![Limit::of_rate(what, bounds)])
    }
}

/// A joint, and the bounds of its coordinate or rate, of which one at least is written.
fn of_joint<M: PhysicalQuantity>(
    joint: &str,
    bounds: [&Option<Written<M>>; 2],
    at: &At<'_>,
) -> Result<(What, [f64; 2])> {
    let joint = at.key("joint").coordinate(joint)?;
    let bounds = bounds_by(bounds, at, |at, bound| at.of_joint(joint, bound))?;
    Ok((What::Joint { joint, near: 0.0 }, bounds))
}

impl LimitEntry for ReactionForceLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], at)?;
        let joint = transmitting(&self.joint, Reaction::Force, &at.key("joint"))?;
        let along = unit_axis(&self.along, &at.key("along"))?;
        let of = Reaction::Force;
        Ok(limits_of([What::Reaction { joint, of, along }], bounds))
    }
}

impl LimitEntry for ReactionTorqueLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], at)?;
        let joint = transmitting(&self.joint, Reaction::Torque, &at.key("joint"))?;
        let along = unit_axis(&self.about, &at.key("about"))?;
        let of = Reaction::Torque;
        Ok(limits_of([What::Reaction { joint, of, along }], bounds))
    }
}

/// A joint that transmits a force or torque.
fn transmitting(name: &str, of: Reaction, at: &At<'_>) -> Result<usize> {
    let joint = at.joint(name)?;
    refuse!(if of == Reaction::Torque && !at.system.joints[joint].has_torque(), at;
        found format!("{name:?}, a spherical joint"), expected "a joint that transmits a torque");
    Ok(joint)
}

impl CostEntry for JointRateCostSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let joint = at.key("joint").coordinate(&self.joint)?;
        let rate = self.at.as_ref();
        let rate = rate.map_or(Ok(0.0), |rate| at.key("at").of_joint(joint, rate))?;
        let quantity = Quantity::joint_rate(joint);
        let factor = quantity.rate_factor(at.system).unwrap_or(1.0);
        Ok(vec![square(quantity, factor * rate)])
    }
}

impl CostEntry for TrackJointSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let joint = at.key("joint").coordinate(&self.joint)?;
        let (kind, _) = at.unit_of(joint);
        let reference = signal(&self.along, &kind, &at.key("along"))?;
        Ok(vec![square(Quantity::joint(joint, 0.0), reference)])
    }
}

impl CostEntry for TrackJointsSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let place = at.key("solution");
        let path = place.solution_file(&self.solution, SOLUTION_PATH)?;
        let joints = read_solution_joints(&path, at.system)?;
        refuse!(if joints.is_empty(), place;
            found "a scene without a revolute or prismatic joint",
            expected "joints that follow the solution");
        let cost = |(joint, reference)| square(Quantity::joint(joint, 0.0), reference);
        Ok(joints.into_iter().map(cost).collect())
    }
}

impl CostEntry for FinalJointSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let joint = at.key("joint").coordinate(&self.joint)?;
        let value = at.key("at").of_joint(joint, &self.at)?;
        Ok(vec![square(Quantity::joint(joint, 0.0), value)])
    }
}

pub(super) fn coordinate(of: &Named<'_>) -> Result<Recorded> {
    let joint = of.place.coordinate(of.name)?;
    let quantity = Quantity::joint(joint, 0.0);
    Ok(Recorded {
        name: of.name.to_owned(),
        ..of.recorded("coordinate", quantity, of.at.unit_of(joint))
    })
}

pub(super) fn rate(of: &Named<'_>) -> Result<Recorded> {
    let joint = of.place.coordinate(of.name)?;
    let quantity = Quantity::joint_rate(joint);
    Ok(of.recorded("rate", quantity, of.at.unit_of_rate(joint)))
}

pub(super) fn reaction_force(of: &Named<'_>) -> Result<Recorded> {
    let along = written_direction(of.along, &of.at.key("along"));
    let unit = (Force::kind(), ("N", 1.0));
    reaction(of, Reaction::Force, along, unit)
}

pub(super) fn reaction_torque(of: &Named<'_>) -> Result<Recorded> {
    let along = written_direction(of.about, &of.at.key("about"));
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
    let joint = transmitting(named.name, of, named.place)?;
    let along = along?;
    let quantity = Quantity::jump(What::Reaction { joint, of, along }, 1.0, 1.0);
    let word = match of {
        Reaction::Force => "force",
        Reaction::Torque => "torque",
    };
    Ok(named.recorded(word, quantity, unit))
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
    let at = At::new(&Scope::of(document), system);
    let place = at.key("time");
    let times: Vec<f64> = solution.time.iter().map(|time| 1e3 * time).collect();
    refuse!(if times.is_empty(), place; found "no instant", expected "one or more");
    place.increasing(&times)?;
    let (joints, place) = match (solution.configuration, solution.joints) {
        (Some(configuration), _) => (configuration.joints, at.key("configuration").key("joints")),
        (None, Some(joints)) => (joints, at.key("joints")),
        (None, None) => {
            return Err(at.wrong("neither of them", "\"configuration\" or \"joints\""));
        }
    };
    let signal = |(name, values): (String, Vec<f64>)| {
        let place = place.key(&name);
        let joint = place.coordinate(&name)?;
        refuse!(if values.len() != times.len(), place;
            found format!("{} values", values.len()),
            expected format!("{}, one for each instant", times.len()));
        let (_, (_, si)) = place.unit_of(joint);
        let values = values.into_iter().map(|value| si.recip() * value);
        let values = values.collect();
        let times = times.clone();
        Ok((joint, Signal::Table { times, values }))
    };
    joints.into_iter().map(signal).collect()
}
