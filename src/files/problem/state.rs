//! Conversion of states of a problem file to indices and one voltage per source.

use crate::control::problem::{BoundaryState, Hold, Rest, SoughtHold};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::problem::end_of::end_of;
use crate::files::problem::spec_voltages::VoltageMap;
use crate::files::scene::point::{PartialPoint, vector};
use crate::files::units::quantity::{
    Angle, AngularVelocity, JointCoordinate, JointRate, Quantity, Velocity,
};
use crate::model::Graph;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// The ways to write a start.
enum Written<'a> {
    Rest(&'a VoltageMap),
    EndOf(&'a str),
    Joints,
}

/// A state at the start.
pub(crate) fn start_state(spec: &StartSpec, at: &At<'_>) -> Result<BoundaryState> {
    let moving =
        spec.joint_angles.is_some() || spec.joint_rates.is_some() || spec.body_velocities.is_some();
    let joints = match () {
        () if spec.joint_angles.is_some() || !moving => "joint_angles",
        () if spec.joint_rates.is_some() => "joint_rates",
        () => "body_velocities",
    };
    let (rest, end) = (spec.rest_at_voltages.as_ref(), spec.end_of.as_ref());
    match at.exactly_one([
        ("rest_at_voltages", rest.map(Written::Rest)),
        ("end_of", end.map(|path| Written::EndOf(path))),
        (joints, moving.then_some(Written::Joints)),
    ])? {
        Written::Rest(map) => {
            let row = at.key("rest_at_voltages").voltages(map)?;
            Ok(BoundaryState::RestAtVoltages(row, Rest::Everything))
        }
        Written::EndOf(path) => {
            let end = end_of(path, &at.key("end_of"))?;
            Ok(BoundaryState::EndOf(Box::new(end)))
        }
        Written::Joints => Ok(BoundaryState::JointAngles {
            angles: at.key("joint_angles").by_joint(&spec.joint_angles)?,
            rates: at.key("joint_rates").by_joint(&spec.joint_rates)?,
            velocities: velocities(&spec.body_velocities, &at.key("body_velocities"))?,
        }),
    }
}

/// Velocities at the start of bodies that joints leave free to have them.
fn velocities(
    map: &Option<BTreeMap<String, BodyVelocitySpec>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, [Vector3<f64>; 2]>> {
    let (floating, turning) = Graph::new(at.system).movable(at.system);
    let mut velocities = BTreeMap::new();
    for (name, spec) in map.iter().flatten() {
        let place = at.key(name);
        let body = place.body(name)?;
        if !floating.contains(&body) && !turning.contains(&body) {
            let found = format!("{name:?}, whose motion follows from its joints");
            let free = floating
                .iter()
                .chain(&turning)
                .map(|&b| format!("{:?}", at.system.bodies[b].name));
            let free: Vec<String> = free.collect();
            let expected = match free.is_empty() {
                true => "\"joint_rates\", as no body is free".to_owned(),
                false => format!("one of {}, and \"joint_rates\" of others", free.join(", ")),
            };
            return Err(place.wrong(found, expected));
        }
        refuse!(if spec.linear.is_some() && !floating.contains(&body), place.key("linear");
            found format!("a linear velocity of {name:?}, which a spherical joint holds"),
            expected "its angular velocity alone");
        let linear = spec.linear.as_ref().map_or_else(Vector3::zeros, vector);
        let angular = spec.angular.as_ref().map_or_else(Vector3::zeros, vector);
        velocities.insert(body, [linear, angular]);
    }
    Ok(velocities)
}

read_objects! {
    /// A state at the start: exactly one of `rest_at_voltages`, `end_of` and joint coordinates.
    pub struct StartSpec {
        /// Static equilibrium under these voltages, SI unit V; 0 where not named.
        pub rest_at_voltages: Option<VoltageMap>,
        /// The end of another motion of the same robot, configuration and momentum: the path of the folder of its result, relative to this file or
        /// to the current folder. Time begins at zero.
        pub end_of: Option<String>,
        /// Joint coordinates by joint, SI unit rad or m; 0 where not named.
        pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
        /// Rates of joint coordinates by joint, SI unit rad/s or m/s; 0 where not named.
        pub joint_rates: Option<BTreeMap<String, Quantity<JointRate>>>,
        /// Velocities by body, of bodies that are free or hang on a spherical or floating joint; with what the joints before them do where not
        /// named.
        pub body_velocities: Option<BTreeMap<String, BodyVelocitySpec>>,
    }

    /// The velocity of a body at the start, in the ground frame.
    pub struct BodyVelocitySpec {
        /// Velocity of the centre of mass, SI unit m/s; 0 where not written. On a spherical joint it follows from `angular`.
        pub linear: Option<[Quantity<Velocity>; 3]>,
        /// Angular velocity, SI unit rad/s; 0 where not written.
        pub angular: Option<[Quantity<AngularVelocity>; 3]>,
    }

    /// `"free"`, `"periodic"`, or a state at the end, at rest.
    pub either GoalSpec(
        "\"free\", \"periodic\", or an object with \"rest_at_voltages\", \"joint_angles\", \"markers\" or \"orientations\""
    ) {
        /// Anything, in motion or at rest, or the start, which is sought.
        Word: GoalWord,
        /// A state of rest.
        Rest: Box<RestGoalSpec>,
    }

    /// A word of a goal.
    pub enum GoalWord {
        /// Anything, in motion or at rest.
        Free,
        /// The start, which is sought: the motion is periodic.
        Periodic,
    }
}

/// The search for voltages that hold a goal.
pub(crate) fn sought_hold(goal: Option<&GoalSpec>) -> SoughtHold {
    let Some(GoalSpec::Rest(rest)) = goal else {
        return SoughtHold::default();
    };
    match rest.hold {
        Some(HeldSpec::Word(HeldWord::Find)) => SoughtHold::Always,
        Some(HeldSpec::Word(HeldWord::None)) => SoughtHold::Never,
        Some(HeldSpec::Given(_)) | None => SoughtHold::default(),
    }
}

read_objects! {
    /// A state at the end, at rest: `rest_at_voltages`, or `joint_angles`, or `markers` and `orientations`.
    pub struct RestGoalSpec {
        /// Static equilibrium under these voltages, SI unit V; 0 where not named.
        pub rest_at_voltages: Option<VoltageMap>,
        /// Joint coordinates by joint, SI unit rad or m; free where not named.
        pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
        /// Positions by marker, SI unit m; directions that are `null` are free.
        pub markers: Option<BTreeMap<String, PartialPoint>>,
        /// Orientations by body.
        pub orientations: Option<BTreeMap<String, OrientationSpec>>,
        /// Part that comes to rest at an equilibrium, at positions of markers and at orientations: `everything`, or `bodies` and these markers alone,
        /// also called `markers`. Where not written everything, or, of elastic blocks that have more coordinates than the voltages can bring to rest, bodies
        /// and these markers.
        pub rest: Option<RestSpec>,
        /// Voltages that are held after positions of markers and orientations are reached, SI unit V; 0 where not named. Of elastic blocks the motion
        /// under them is the guess, where no other is written. `"find"`: they are sought with the motion, so that the goal is an equilibrium; also of
        /// `joint_angles`, for lumped muscles. Where not written they are sought if the motion leaves its goal under the last voltages; `"none"`: they
        /// are not.
        pub hold: Option<HeldSpec>,
    }

    /// Voltages that are held after a goal.
    pub either HeldSpec("\"find\", \"none\", or voltages by name") {
        /// Sought with the motion, or not at all.
        Word: HeldWord,
        /// Given ones.
        Given: VoltageMap,
    }

    /// Voltages that are not given.
    pub enum HeldWord {
        /// Sought with the motion.
        Find,
        /// Not sought.
        None,
    }

    /// An orientation of a body: `axis` with exactly one of `towards` and `angle`.
    pub struct OrientationSpec {
        /// A direction of the ground frame, of any length: with `towards` one that moves with the body, as it is in the reference
        /// configuration; with `angle` the axis about which the body is turned.
        pub axis: [f64; 3],
        /// Direction of the ground frame, of any length, to which `axis` points.
        pub towards: Option<[f64; 3]>,
        /// Angle by which the body is turned from its reference configuration, SI unit rad.
        pub angle: Option<Quantity<Angle>>,
    }

    /// Part that comes to rest at a goal.
    pub enum RestSpec: Rest {
        /// Every coordinate.
        Everything,
        /// Bodies and the markers of the goal.
        Bodies,
        /// The same.
        Markers = Bodies,
    }

    /// Treatment of a goal that cannot be kept.
    #[derive(Default)]
    pub enum HoldSpec: Hold {
        /// A line says so.
        #[default]
        Reported,
        /// It is no solution.
        Required,
    }
}
