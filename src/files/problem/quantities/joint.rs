//! Coordinates, rates, forces and torques of joints in limits, costs and recordings.

use crate::control::problem::Limit;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::At;
use crate::files::problem::inputs::SOLUTION_PATH;
use crate::files::problem::quantities::entry::{
    Cost, CostEntry, LimitEntry, Named, Recorded, bounds, bounds_by, costs, limits, limits_of,
    square,
};
use crate::files::scene::point::unit_axis;
use crate::files::signal::{SignalSpec, signal};
use crate::files::solution::record;
use crate::files::units::quantity::{
    Force, JointCoordinate, JointRate, Kind, PhysicalQuantity, Quantity as Written, Torque,
};
use crate::math::{Signal, Vector};
use crate::model::system::System;
use crate::model::{Quantity, Reaction, What};
use std::path::Path;

limits! {
    /// Limits of a joint coordinate: `min`, `max` or both.
    JointAngleLimitSpec {
        /// Name of the joint.
        pub joint: String,
    } within Written<JointCoordinate>, ", SI unit rad or m" => |of, at| {
        let (what, bounds) = of_joint(&of.joint, [&of.min, &of.max], at)?;
        vec![Limit::new(what, bounds)]
    };

    /// Limits of the mean rate of a joint coordinate in each interval: `min`, `max` or both.
    JointRateLimitSpec {
        /// Name of the joint.
        pub joint: String,
    } within Written<JointRate>, ", SI unit rad/s or m/s" => |of, at| {
        let (what, bounds) = of_joint(&of.joint, [&of.min, &of.max], at)?;
        vec![Limit::of_rate(what, bounds)]
    };

    /// Limits of the component, along a direction of the ground frame, of the force from the parent of a joint on its child: `min`, `max` or both.
    ///
    /// It is the force of the columns of reactions, at the instants between intervals. Joints in loops are refused.
    ReactionForceLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Direction of the ground frame, of any length.
        pub along: [f64; 3],
    } within Written<Force>, ", SI unit N" => |of, at| {
        let bounds = bounds([&of.min, &of.max], at)?;
        let joint = transmitting(&of.joint, Reaction::Force, &at.key("joint"))?;
        let along = unit_axis(&of.along, &at.key("along"))?;
        limits_of([What::Reaction { joint, of: Reaction::Force, along }], bounds)
    };

    /// Limits of the component, about a direction of the ground frame, of the torque from the parent of a joint on its child: `min`, `max` or both.
    ///
    /// It is the torque of the columns of reactions, about the point of the joint, at the instants between intervals. Spherical joints and joints in
    /// loops are refused.
    ReactionTorqueLimitSpec {
        /// Name of the joint.
        pub joint: String,
        /// Direction of the ground frame, of any length.
        pub about: [f64; 3],
    } within Written<Torque>, ", SI unit N m" => |of, at| {
        let bounds = bounds([&of.min, &of.max], at)?;
        let joint = transmitting(&of.joint, Reaction::Torque, &at.key("joint"))?;
        let along = unit_axis(&of.about, &at.key("about"))?;
        limits_of([What::Reaction { joint, of: Reaction::Torque, along }], bounds)
    };
}

costs! {
    /// A joint and the function that its coordinate follows.
    TrackJointSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// The function of time, SI unit rad or m.
        pub along: SignalSpec<JointCoordinate>,
    } weight of "∫ (θ − r)² dt in rad² s, or mm² s of a prismatic joint" => |of, at| {
        let joint = at.key("joint").coordinate(&of.joint)?;
        let kind = at.kind_of(joint);
        let reference = signal(&of.along, &kind, &at.key("along"))?;
        vec![square(Quantity::joint(joint, 0.0), reference)]
    };

    /// All joints along an earlier solution.
    TrackJointsSpec {
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder; linear between its instants, constant after
        /// the last.
        pub solution: String,
    } weight of "the sum over all joints of ∫ (θ − r)² dt in rad² s, or mm² s of prismatic joints" => |of, at| {
        let place = at.key("solution");
        let path = place.solution_file(&of.solution, SOLUTION_PATH)?;
        let joints = read_solution_joints(&path, at.system)?;
        refuse!(if joints.is_empty(), place;
            found "a scene without a revolute or prismatic joint",
            expected "joints that follow the solution");
        let cost = |(joint, reference)| square(Quantity::joint(joint, 0.0), reference);
        joints.into_iter().map(cost).collect()
    };

    /// A joint and where it is to end.
    FinalJointSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// The value, SI unit rad or m.
        pub at: Written<JointCoordinate>,
    } weight of "(θ − r)² at the final instant, in rad², or mm² of a prismatic joint" => |of, at| {
        let joint = at.key("joint").coordinate(&of.joint)?;
        let value = at.key("at").of_joint(joint, &of.at)?;
        vec![square(Quantity::joint(joint, 0.0), value)]
    };

    /// The mean rate of the coordinate of a joint in the intervals.
    JointRateCostSpec {
        /// Name of the joint, revolute or prismatic.
        pub joint: String,
        /// Rate that is asked for, SI unit rad/s or m/s; 0 where not written.
        pub at: Option<Written<JointRate>>,
    } weight of "the squared deviation in (rad/s)², or (m/s)² of a prismatic joint" => |of, at| {
        let joint = at.key("joint").coordinate(&of.joint)?;
        let rate = of.at.as_ref();
        let rate = rate.map_or(Ok(0.0), |rate| at.key("at").of_joint(joint, rate))?;
        let quantity = Quantity::joint_rate(joint);
        let factor = quantity.rate_factor(at.system).unwrap_or(1.0);
        vec![square(quantity, factor * rate)]
    };
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

/// A joint that transmits a force or torque.
fn transmitting(name: &str, of: Reaction, at: &At<'_>) -> Result<usize> {
    let joint = at.joint(name)?;
    refuse!(if of == Reaction::Torque && !at.system.joints[joint].has_torque(), at;
        found format!("{name:?}, a spherical joint"), expected "a joint that transmits a torque");
    Ok(joint)
}

pub(super) fn coordinate(of: &Named<'_>) -> Result<Recorded> {
    let joint = of.place.coordinate(of.name)?;
    let quantity = Quantity::joint(joint, 0.0);
    Ok(Recorded {
        name: of.name.to_owned(),
        ..of.recorded("coordinate", quantity, of.at.kind_of(joint))
    })
}

pub(super) fn rate(of: &Named<'_>) -> Result<Recorded> {
    let joint = of.place.coordinate(of.name)?;
    let quantity = Quantity::joint_rate(joint);
    Ok(of.recorded("rate", quantity, of.at.kind_of_rate(joint)))
}

pub(super) fn reaction_force(of: &Named<'_>) -> Result<Recorded> {
    reaction(of, Reaction::Force, of.along, Force::kind())
}

pub(super) fn reaction_torque(of: &Named<'_>) -> Result<Recorded> {
    reaction(of, Reaction::Torque, of.about, Torque::kind())
}

/// Force or torque that a joint transmits along a direction.
fn reaction(
    named: &Named<'_>,
    of: Reaction,
    along: Option<[f64; 3]>,
    kind: Kind,
) -> Result<Recorded> {
    let (word, key) = match of {
        Reaction::Force => ("force", "along"),
        Reaction::Torque => ("torque", "about"),
    };
    let joint = transmitting(named.name, of, named.place)?;
    let along = written_direction(along, &named.at.key(key))?;
    let quantity = Quantity::jump(What::Reaction { joint, of, along }, 1.0, 1.0);
    Ok(named.recorded(word, quantity, kind))
}

/// The unit vector of a direction that has to be written.
pub(super) fn written_direction(direction: Option<[f64; 3]>, place: &Scope<'_>) -> Result<Vector> {
    let Some(direction) = direction else {
        let expected = "a direction, such as [1, 0, 0]";
        return Err(place.wrong("no direction", expected));
    };
    unit_axis(&direction, place)
}

/// The coordinate of each joint of a solution by index, linear between its instants.
pub(crate) fn read_solution_joints(path: &Path, system: &System) -> Result<Vec<(usize, Signal)>> {
    let is_wanted = |name: &str| name == "time" || name.starts_with("configuration/joints/");
    let (document, solution) = record(path, is_wanted)?;
    let at = At::new(&Scope::of(&document), system);
    let place = at.key("time");
    let times = solution.times(&at)?;
    refuse!(if times.is_empty(), place; found "no instant", expected "one or more");
    let (joints, keys) = solution.joint_columns(&at)?;
    let place = keys.iter().fold(at, |at, key| at.key(key));
    let signal = |(name, values): (&String, &Vec<f64>)| {
        let place = place.key(name);
        let joint = place.coordinate(name)?;
        refuse!(if values.len() != times.len(), place;
            found format!("{} values", values.len()),
            expected format!("{}, one for each instant", times.len()));
        let (_, si) = place.kind_of(joint).unit();
        let values = values.iter().map(|value| si.recip() * value);
        let values = values.collect();
        let times = times.clone();
        Ok((joint, Signal::Table { times, values }))
    };
    joints.iter().map(signal).collect()
}
