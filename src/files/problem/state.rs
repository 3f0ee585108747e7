//! States of a problem file at the start, at the end, on the way and at the end of another result, and their conversion to indices, places,
//! orientations and one voltage per source.

use crate::control::EndState;
use crate::control::problem::{
    BoundaryState, Duration, Hold, Orientation, Place, QuantityCost, Rest, SoughtHold, Waypoint,
};
use crate::dynamics::StepState;
use crate::files::continuation;
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, list, refuse, the_one};
use crate::files::problem::at::{At, VoltageMap};
use crate::files::scene::names::names;
use crate::files::scene::point::{PartialPoint, unit_axis, vector};
use crate::files::solution::{Body, ConfigurationRecord, record};
use crate::files::units::quantity::{
    Angle, AngularVelocity, JointCoordinate, JointRate, Length, Quantity, Time, Velocity,
};
use crate::kinematics::Pose;
use crate::math::{Matrix, Vector, shortest};
use crate::model::{Coordinates, Graph};
use nalgebra::Vector3;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A state at the start.
pub(crate) fn start_state(spec: &StartSpec, at: &At<'_>) -> Result<BoundaryState> {
    let moving =
        spec.joint_angles.is_some() || spec.joint_rates.is_some() || spec.body_velocities.is_some();
    let joints = match () {
        () if spec.joint_angles.is_some() || !moving => "joint_angles",
        () if spec.joint_rates.is_some() => "joint_rates",
        () => "body_velocities",
    };
    at.one_key([
        ("rest_at_voltages", spec.rest_at_voltages.is_some()),
        ("end_of", spec.end_of.is_some()),
        (joints, moving),
    ])?;
    if let Some(map) = &spec.rest_at_voltages {
        let row = at.key("rest_at_voltages").voltages(map)?;
        return Ok(BoundaryState::RestAtVoltages(row, Rest::Everything));
    }
    if let Some(path) = &spec.end_of {
        let end = end_of(path, &at.key("end_of"))?;
        return Ok(BoundaryState::EndOf(Box::new(end)));
    }
    Ok(BoundaryState::JointAngles {
        angles: at.key("joint_angles").by_joint(&spec.joint_angles)?,
        rates: at.key("joint_rates").by_joint(&spec.joint_rates)?,
        velocities: velocities(&spec.body_velocities, &at.key("body_velocities"))?,
    })
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
            let bodies = names(&at.system.bodies, |body| &body.name);
            let free = list(floating.iter().chain(&turning).map(|&b| &bodies[b]));
            let expected = match free.is_empty() {
                true => "\"joint_rates\", as no body is free".to_owned(),
                false => format!("one of {free}, and \"joint_rates\" of others"),
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

    /// `"free"`, `"periodic"`, or a state at the end.
    pub either GoalSpec(
        "\"free\", \"periodic\", or an object with \"rest_at_voltages\", \"joint_angles\", \"markers\" or \"orientations\""
    ) {
        /// Anything, in motion or at rest, or the start, which is sought.
        Word: GoalWord,
        /// A state, at rest where it has no rates.
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
        _ if rest.joint_rates.is_some() => SoughtHold::Never,
        Some(HeldSpec::Word(HeldWord::Find)) => SoughtHold::Always,
        Some(HeldSpec::Word(HeldWord::None)) => SoughtHold::Never,
        Some(HeldSpec::Given(_)) | None => SoughtHold::default(),
    }
}

read_objects! {
    /// A state at the end: `rest_at_voltages`, or `joint_angles`, or `markers` and `orientations`; at rest where it has no `joint_rates`.
    pub struct RestGoalSpec {
        /// Static equilibrium under these voltages, SI unit V; 0 where not named.
        pub rest_at_voltages: Option<VoltageMap>,
        /// Joint coordinates by joint, SI unit rad or m; free where not named.
        pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
        /// Rates by joint with which the motion ends, SI unit rad/s or m/s; 0 where not named. Beside `joint_angles` of all joints.
        pub joint_rates: Option<BTreeMap<String, Quantity<JointRate>>>,
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

/// A state at the end.
pub(crate) fn goal_state(spec: &GoalSpec, at: &At<'_>) -> Result<BoundaryState> {
    let spec = match spec {
        GoalSpec::Word(GoalWord::Free) => return Ok(BoundaryState::Free),
        GoalSpec::Word(GoalWord::Periodic) => return Ok(BoundaryState::Periodic),
        GoalSpec::Rest(spec) => spec.as_ref(),
    };
    let key = given_key(spec, at)?;
    check_companions(spec, key, at)?;
    let rest = spec.rest.map_or(Rest::Attainable, Rest::from);
    match (&spec.rest_at_voltages, &spec.joint_angles) {
        (Some(map), _) => equilibrium(map, rest, at),
        (None, Some(_)) => coordinates(spec, at),
        (None, None) => positions(spec, rest, at),
    }
}

fn is_of_places(spec: &RestGoalSpec) -> bool {
    spec.markers.is_some() || spec.orientations.is_some()
}

/// The key that says what a goal gives.
fn given_key(spec: &RestGoalSpec, at: &Scope<'_>) -> Result<&'static str> {
    let of_places = match (&spec.markers, &spec.orientations) {
        (None, Some(_)) => "orientations",
        _ => "markers",
    };
    at.one_key([
        ("rest_at_voltages", spec.rest_at_voltages.is_some()),
        ("joint_angles", spec.joint_angles.is_some()),
        (of_places, is_of_places(spec)),
    ])
}

/// Refuses `hold` and `rest` where they have no meaning next to `key`.
fn check_companions(spec: &RestGoalSpec, key: &str, at: &Scope<'_>) -> Result<()> {
    let is_of_angles = spec.joint_angles.is_some();
    refuse!(if spec.joint_rates.is_some() && !is_of_angles, at.key("joint_rates");
        found format!("\"joint_rates\" beside {key:?}"), expected "them beside \"joint_angles\" of all joints");
    refuse!(if spec.joint_rates.is_some() && spec.hold.is_some(), at.key("hold");
        found "\"hold\" beside \"joint_rates\"", expected "one of them: a state in motion is not held");
    let (is_ignored, expected) = match &spec.hold {
        Some(HeldSpec::Word(_)) => (
            !is_of_places(spec) && !is_of_angles,
            "it beside \"joint_angles\", \"markers\" or \"orientations\"; voltages at rest hold their equilibrium",
        ),
        given => (
            given.is_some() && !is_of_places(spec),
            "it beside \"markers\" or \"orientations\" only",
        ),
    };
    refuse!(if is_ignored, at.key("hold");
        found format!("\"hold\" beside {key:?}"), expected expected);
    refuse!(if spec.rest.is_some() && is_of_angles, at.key("rest");
        found format!("\"rest\" beside {key:?}"),
        expected "it beside \"rest_at_voltages\", \"markers\" or \"orientations\" only");
    Ok(())
}

/// A state of rest under voltages.
fn equilibrium(map: &VoltageMap, rest: Rest, at: &At<'_>) -> Result<BoundaryState> {
    refuse!(if rest == Rest::Bodies && at.system.bodies.is_empty(), at.key("rest");
        found "a scene without bodies",
        expected "a scene with bodies; goals of elastic blocks alone are \"markers\"");
    let row = at.key("rest_at_voltages").voltages(map)?;
    Ok(BoundaryState::RestAtVoltages(row, rest))
}

/// Positions of markers and orientations of bodies.
fn positions(spec: &RestGoalSpec, rest: Rest, at: &At<'_>) -> Result<BoundaryState> {
    Ok(BoundaryState::Markers {
        places: of_markers(&spec.markers, &at.key("markers"))?,
        orientations: of_bodies(&spec.orientations, &at.key("orientations"))?,
        rest,
        hold: match &spec.hold {
            Some(HeldSpec::Given(map)) => Some(at.key("hold").voltages(map)?),
            Some(HeldSpec::Word(_)) | None => None,
        },
    })
}

/// Coordinates of joints, and rates.
fn coordinates(spec: &RestGoalSpec, at: &At<'_>) -> Result<BoundaryState> {
    let place = at.key("joint_angles");
    let angles = place.by_joint(&spec.joint_angles)?;
    refuse!(if angles.is_empty(), place;
        found "no joint", expected "the coordinate of a joint or more");
    let rates = at.key("joint_rates").by_joint(&spec.joint_rates)?;
    Ok(BoundaryState::JointAngles {
        angles,
        rates,
        velocities: BTreeMap::new(),
    })
}

/// Places by marker; of a map that is written one or more.
pub(crate) fn of_markers(
    markers: &Option<BTreeMap<String, PartialPoint>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, Place>> {
    refuse!(if markers.as_ref().is_some_and(BTreeMap::is_empty), at;
        found "no marker", expected "the position of a marker or more");
    at.each_named(markers.iter().flatten(), |name, point, at| {
        let marker = at.moving_marker(name)?;
        refuse!(if point.iter().all(Option::is_none), at;
            found "no coordinate", expected "one that is not null, or more");
        let value = |entry: &Option<Quantity<Length>>| entry.as_ref().map(Quantity::value);
        Ok((marker, Place(point.each_ref().map(value))))
    })
}

/// Orientations by body; of a map that is written one or more.
pub(crate) fn of_bodies(
    bodies: &Option<BTreeMap<String, OrientationSpec>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, Orientation>> {
    refuse!(if bodies.as_ref().is_some_and(BTreeMap::is_empty), at;
        found "no body", expected "the orientation of a body or more");
    at.each_named(bodies.iter().flatten(), |name, spec, at| {
        let body = at.body(name)?;
        let axis = unit_axis(&spec.axis, &at.key("axis"))?;
        let orientation = the_one!(at, spec;
            "towards" towards |at, towards| Orientation::Towards {
                axis,
                towards: unit_axis(towards, at)?,
            };
            "angle" angle |_, angle| Orientation::Turned {
                axis,
                angle: angle.value(),
            };
        );
        Ok((body, orientation))
    })
}

read_objects! {
    /// Places that the motion reaches at a time on its way, at the instant nearest to it: `markers`, `orientations`, `joint_angles`, or several
    /// of them. With a `weight` it passes near them: their squared distances are costs.
    pub struct WaypointSpec {
        /// Time, SI unit s; or give `part`.
        pub time: Option<Quantity<Time>>,
        /// Part of the duration, above 0 and below 1, which may be free; of a periodic motion 1 is its start and its end.
        pub part: Option<f64>,
        /// Positions by marker, SI unit m; directions that are `null` are free.
        pub markers: Option<BTreeMap<String, PartialPoint>>,
        /// Orientations by body.
        pub orientations: Option<BTreeMap<String, OrientationSpec>>,
        /// Joint coordinates by joint, SI unit rad or m.
        pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
        /// Weight of the squared distances at that instant, in mm² of markers and prismatic joints and rad² of revolute ones, as costs in the
        /// objective in place of exact conditions; not of `orientations`.
        pub weight: Option<f64>,
    }
}

/// The motion that waypoints are on the way of.
#[derive(Clone, Copy)]
pub(crate) struct Course {
    pub(crate) duration: Duration,
    pub(crate) is_open: bool,
}

/// The waypoints that are written: those that are conditions, and the costs that others are.
pub(crate) fn waypoints(
    specs: &[WaypointSpec],
    of: Course,
    at: &At<'_>,
) -> Result<(Vec<Waypoint>, Vec<QuantityCost>)> {
    let (mut exact, mut near) = (Vec::new(), Vec::new());
    for (index, spec) in specs.iter().enumerate() {
        let at = at.index(index);
        let waypoint = spec.waypoint(of, &at)?;
        let Some(weight) = spec.weight else {
            exact.push(waypoint);
            continue;
        };
        refuse!(if spec.orientations.is_some(), at.key("orientations");
            found "an orientation with a weight",
            expected "an orientation without \"weight\", which is reached exactly");
        refuse!(if weight <= 0.0, at.key("weight"); found weight, expected "a positive weight");
        near.extend(waypoint.costs(weight));
    }
    Ok((exact, near))
}

impl WaypointSpec {
    fn waypoint(&self, of: Course, at: &At<'_>) -> Result<Waypoint> {
        let (part, name) = self.part_of(of, at)?;
        let waypoint = Waypoint {
            part,
            name,
            places: of_markers(&self.markers, &at.key("markers"))?,
            orientations: of_bodies(&self.orientations, &at.key("orientations"))?,
            angles: at.key("joint_angles").by_joint(&self.joint_angles)?,
        };
        let is_empty = waypoint.places.is_empty()
            && waypoint.orientations.is_empty()
            && waypoint.angles.is_empty();
        refuse!(if is_empty, at;
            found "a waypoint without a place",
            expected "\"markers\", \"orientations\" or \"joint_angles\"");
        Ok(waypoint)
    }

    /// Part of the duration, and the name in messages.
    fn part_of(&self, of: Course, at: &Scope<'_>) -> Result<(f64, String)> {
        let key = at.one_key([("time", self.time.is_some()), ("part", self.part.is_some())])?;
        let (part, name, found, expected) = match (&self.time, of.duration) {
            (Some(time), Duration::Given(duration)) => (
                time.value() / duration,
                format!("waypoint at {time}"),
                time.to_string(),
                "a time after the start and before the end; what is reached at the end is the \"goal\"",
            ),
            (Some(_), Duration::Free { .. }) => {
                let expected = "\"part\", a part of the duration, as the duration is free";
                return Err(at.key(key).wrong("a time", expected));
            }
            (None, _) => {
                let part = self.part.unwrap_or_default();
                let name = format!("waypoint at {} of the duration", shortest(part, 6));
                let expected = match of.is_open {
                    true => "a number above 0 and at most 1",
                    false => "a number above 0 and below 1",
                };
                (part, name, part.to_string(), expected)
            }
        };
        // No goal says where an open motion ends.
        match part > 0.0 && (part < 1.0 || (of.is_open && part == 1.0)) {
            true => Ok((part, name)),
            false => Err(at.key(key).wrong(found, expected)),
        }
    }
}

/// Expected value of a path.
const FOLDER: &str = "the folder of a simulation or of a solved control problem, which holds a solution.json; a state of rest is \"rest_at_voltages\"";
/// Program that writes the expected file.
const WRITTEN: &str = "a result that simulate or solve wrote";
/// Status of solves whose solution is a motion of the robot.
const SOLVED: [&str; 4] = ["solved", "acceptable", "feasible_point", "not_held"];
/// Status of a simulation that came to its end; others go as far as they go.
const SIMULATED: &str = "simulated";

/// Entries that are read of a summary.
#[derive(Deserialize)]
struct Summary {
    status: String,
    /// Of a simulation.
    #[serde(default)]
    steps: Option<IgnoredAny>,
}

/// The last instant of the result that a path names.
pub(crate) fn end_of(path: &str, at: &At<'_>) -> Result<EndState> {
    let file = at.solution_file(path, FOLDER)?;
    let notes = status(&file, at)?;
    let (document, ended) = record(&file, |name| !name.starts_with("costates/"))?;
    let configuration = ended.configuration;
    let configuration =
        configuration.ok_or_else(|| Scope::of(&document).missing_key("configuration"))?;
    let (voltages, loads) = (
        ended.voltages.unwrap_or_default(),
        ended.loads.unwrap_or_default(),
    );
    check_names(&configuration, voltages.keys(), path, at)?;
    let untold = |what: &str| at.wrong(format!("{path:?}, which does not tell {what}"), WRITTEN);
    let coordinates = ended.coordinates.as_deref().and_then(Coordinates::named);
    let coordinates = coordinates.ok_or_else(|| untold("in which \"coordinates\" it is"))?;
    let mut state = ended
        .state
        .ok_or_else(|| untold("the \"state\" of its motion"))?;
    let z = state.z.pop().ok_or_else(|| untold("\"state.z\""))?;
    if state.momentum.is_empty() != z.is_empty() {
        return Err(untold("the \"state.momentum\" at its end"));
    }
    let mut poses = Vec::new();
    for body in &at.system.bodies {
        let Body { centre, directors } = &configuration.bodies[&body.name];
        let (Some(centre), Some(directors)) = (centre.last(), directors.last()) else {
            return Err(untold(&format!("where body {:?} ended", body.name)));
        };
        poses.push(Pose {
            centre: Vector::from(*centre) * 1e3,
            directors: Matrix::from(*directors),
        });
    }
    let mut inputs = Vec::new();
    for source in at.sources.iter() {
        let held = ended.hold.as_ref().and_then(|hold| hold.get(&source.name));
        let all = if source.is_load() { &loads } else { &voltages };
        let last = all.get(&source.name).and_then(|list| list.last());
        let (_, unit) = source.kind.si();
        inputs.push(held.or(last).copied().unwrap_or(0.0) * unit);
    }
    Ok(EndState {
        source: file.parent().unwrap_or(&file).to_owned(),
        coordinates,
        method: method(&file, &z, &state.momentum, at)?,
        z,
        momentum: state.momentum,
        poses,
        meshes: state.meshes_mm,
        voltages: inputs,
        notes,
    })
}

/// Refuses a result that is no motion, and returns notes on one that is.
fn status(file: &Path, at: &Scope<'_>) -> Result<Vec<String>> {
    let beside = file.with_file_name("summary.json");
    let shown = file.display();
    let text = fs::read_to_string(&beside).ok();
    let summary = text.and_then(|text| serde_json::from_str::<Summary>(&text).ok());
    let Some(Summary { status, steps }) = summary else {
        return Ok(vec![format!(
            "no summary.json beside {shown} tells whether it is a motion of the robot"
        )]);
    };
    match (steps.is_some(), status.as_str()) {
        (true, SIMULATED) => Ok(Vec::new()),
        (true, _) => Ok(vec![format!(
            "{shown} ended early ({status}); the motion starts where it ended"
        )]),
        (false, word) if SOLVED.contains(&word) => Ok(Vec::new()),
        (false, _) => {
            let found = format!("{shown}, whose status is {status:?}");
            let solved = list(SOLVED.iter());
            let expected = format!("a motion of the robot: a simulation, or one of {solved}");
            Err(at.wrong(found, expected))
        }
    }
}

/// Refuses a result of other bodies, joints or sources.
fn check_names<'v>(
    configuration: &ConfigurationRecord,
    mut voltages: impl Iterator<Item = &'v String>,
    path: &str,
    at: &At<'_>,
) -> Result<()> {
    let ConfigurationRecord { bodies, joints } = configuration;
    let own_bodies: BTreeSet<_> = at.system.bodies.iter().map(|body| &body.name).collect();
    let own_joints = at.system.joints.iter().filter(|one| one.has_coordinate());
    let own_joints = own_joints.map(|joint| &joint.name).collect();
    for (kind, there, here) in [
        ("body", bodies.keys().collect::<BTreeSet<_>>(), own_bodies),
        ("joint", joints.keys().collect(), own_joints),
    ] {
        refuse!(if let Some(name) = here.difference(&there).next(), at;
            found format!("{path:?}, which has no {kind} {name:?}"),
            expected "a result of the same robot");
        refuse!(if let Some(name) = there.difference(&here).next(), at;
            found format!("{path:?}, whose {kind} {name:?} is not in the scene"),
            expected "a result of the same robot");
    }
    let unknown = voltages.find(|name| !at.sources.iter().any(|source| source.name == **name));
    refuse!(if let Some(name) = unknown, at;
        found format!("{path:?}, whose muscle or electrode {name:?} is not in the scene"),
        expected "a result of the same robot");
    Ok(())
}

/// The state of the method of a simulation; of a solve none is kept.
fn method(file: &Path, z: &[f64], momentum: &[f64], at: &Scope<'_>) -> Result<StepState> {
    let beside = file.with_file_name("continuation.npz");
    if !beside.is_file() {
        return Ok(StepState::default());
    }
    let shown = beside.display();
    let read = continuation::read(&beside);
    let read = read.map_err(|error| at.wrong(format!("{shown}: {error}"), WRITTEN))?;
    let discrete = read.discrete;
    let ends = [&discrete.z, &discrete.momenta].map(|rows| rows.last().map(Vec::as_slice));
    refuse!(if ends != [Some(z), Some(momentum)], at;
        found format!("{shown}, which is not of the motion in {}", file.display()),
        expected "files of one run");
    Ok(discrete.end.begun_anew())
}
