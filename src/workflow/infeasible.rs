//! Explanation of an infeasible control problem by its closest motion, with the changes that may help.

use crate::control::problem::{BoundaryState, Control, Duration};
use crate::control::{BoundaryConditions, Place, Rests};
use crate::coordinates::Configuration;
use crate::dynamics::trajectory::Trajectory;
use crate::kinematics::Pose;
use crate::math::{no_smaller, significant};
use crate::model::components::Tendon;
use crate::model::system::JointKind;
use crate::model::{Component, Model, System, joint_unit};
use crate::nlp::Status;
use crate::workflow::optimum::{Active, Optimum, Shortest};
use crate::workflow::resimulate::Repeat;

/// Maximum number of bounds listed.
const TOLD: usize = 6;
/// Parts of the rest length of a tendon that are near to its kink.
const KINK: f64 = 5e-3;
/// Of the length of the system in the duration: markers that are slower than this rest.
const SLOW: f64 = 1e-4;

/// Explains a problem whose solve found no motion, line by line.
pub(crate) fn explain(control: &Control, optimum: &Optimum) -> Vec<String> {
    let mut lines: Vec<String> = miss(control, optimum).into_iter().collect();
    lines.extend(optimum.active.iter().take(TOLD).map(Active::message));
    lines.extend(changes(control, optimum));
    lines.extend(kinks(optimum));
    lines
}

/// Tendons that go taut or slack along the last iterate, and jump there.
fn kinks(optimum: &Optimum) -> Vec<String> {
    let system = &optimum.model.system;
    let lengths = |tendon: &Tendon| {
        let reference = |body: usize| system.bodies[body].pose();
        let of = |poses: &Vec<Pose>| {
            let places = tendon.through.iter();
            let places: Vec<_> = places.map(|p| p.place(poses, reference)).collect();
            tendon.observe(&places)[0]
        };
        let all = optimum.motion.poses.iter().map(of);
        all.fold([f64::INFINITY, 0.0], |[low, high], l| {
            [low.min(l), high.max(l)]
        })
    };
    let tendons = system.components.tendons.iter();
    let jumping = tendons.filter(|tendon| tendon.smoothing == 0.0);
    let told = |tendon: &Tendon| {
        let [low, high] = lengths(tendon);
        // The solver goes to and fro at the kink without passing it.
        let near = KINK * tendon.rest_length;
        let rest = tendon.rest_length;
        (low - near < rest && rest < high + near).then(|| {
            format!(
                "change: \"smoothing\": \"{} mm\" of tendon {}; it goes taut and slack along the motion, and its stiffness jumps there",
                significant(2.0 * near, 2),
                tendon.name
            )
        })
    };
    let of_tendons = jumping.filter_map(told);
    of_tendons.chain(at_stops(optimum)).collect()
}

/// Joints that reach a stop along the last iterate whose stiffness jumps.
fn at_stops(optimum: &Optimum) -> impl Iterator<Item = String> + '_ {
    let joints = optimum.model.system.joints.iter();
    joints.enumerate().filter_map(|(j, joint)| {
        let stops = joint.stops.filter(|stops| stops.smoothing == 0.0)?;
        let reached = optimum.motion.joints.iter().map(|row| stops.beyond(row[j]));
        let far = reached.fold(f64::NEG_INFINITY, f64::max);
        let (width, unit) = match joint.kind {
            JointKind::Revolute { .. } => (1.0, "deg"),
            _ => (0.01 * optimum.model.length(), "mm"),
        };
        (far > 0.0).then(|| {
            format!(
                "change: \"smoothing\": \"{} {unit}\" of the stops of {}; it reaches a stop, and the stiffness jumps there",
                significant(width, 2),
                joint.name
            )
        })
    })
}

/// Returns the distance of the end of the motion under the voltages of the last iterate from the goal.
fn miss(control: &Control, optimum: &Optimum) -> Option<String> {
    let Optimum {
        model,
        boundary,
        motion,
        ..
    } = optimum;
    let n = motion.intervals();
    let again = Repeat::from_solution(model, control, &boundary.start, motion, 1);
    if again.failure.is_some() {
        return None;
    }
    let [end, before] = [n, n - 1].map(|k| model.action.map.placed(&again.discrete.z[k]));
    let parts = distances(model, boundary, &control.goal, &end);
    let (what, _) = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let h = motion.times[n] / n as f64;
    let speed = |v: &usize| (end.x[*v] - before.x[*v]).norm() / h;
    let fastest = model.markers.iter().map(speed).fold(0.0, f64::max);
    let is_slow = fastest < SLOW * model.length() / motion.times[n];
    let speed = significant(fastest, 2);
    let moves = match is_slow {
        true => String::new(),
        false => format!(", and markers still move at {speed} m/s"),
    };
    Some(format!("simulated under the inputs found, {what}{moves}"))
}

/// Returns the missed parts of the goal, in words and relative to the size of the system.
fn distances(
    model: &Model,
    boundary: &BoundaryConditions,
    goal: &BoundaryState,
    end: &Configuration,
) -> Vec<(String, f64)> {
    let of_marker = |m: usize, place: &Place| {
        let far = place.distance(&end.x[model.markers[m]]);
        let name = &model.system.markers[m].name;
        let words = format!("{name} comes within {} mm of its goal", significant(far, 3));
        (words, far / model.length())
    };
    let joints =
        |instant: &Configuration| model.joints(instant, &vec![0.0; model.joint_readings.len()]);
    let of_joint = |joint: usize, value: f64, found: f64| {
        let unit = joint_unit(&model.system, joint);
        let far = (found - value).abs();
        let name = &model.system.joints[joint].name;
        let words = format!("{name} ends {} {unit} from its goal", significant(far, 3));
        let size = if unit == "mm" { model.length() } else { 1.0 };
        (words, far / size)
    };
    match goal {
        BoundaryState::Markers { places, .. } => {
            let all = places.iter();
            all.map(|(&m, place)| of_marker(m, place)).collect()
        }
        BoundaryState::JointAngles { angles, .. } => {
            let found = joints(end);
            let all = angles.iter();
            all.map(|(&j, &angle)| of_joint(j, angle, found[j]))
                .collect()
        }
        BoundaryState::Free | BoundaryState::Periodic | BoundaryState::EndOf(_) => Vec::new(),
        BoundaryState::RestAtVoltages(..) => {
            let Some(rest) = &boundary.goal.rest else {
                return Vec::new();
            };
            let there = model.action.map.placed(&rest.z);
            let markers = 0..model.markers.len();
            let places = markers.map(|m| of_marker(m, &there.x[model.markers[m]].into()));
            let (asked, found) = (joints(&there), joints(end));
            let turned = (0..asked.len()).map(|j| of_joint(j, asked[j], found[j]));
            let places: Vec<_> = places.collect();
            match places.is_empty() {
                true => turned.collect(),
                false => places,
            }
        }
    }
}

/// Returns the changes that may help.
fn changes(control: &Control, optimum: &Optimum) -> Vec<String> {
    let model = &optimum.model;
    let mut lines = durations(control, optimum);
    if optimum.active.iter().any(|active| active.is_voltage) {
        lines.push("change: wider voltage_bounds, if the muscles withstand them".to_owned());
    }
    let has_nodes = !model.action.map.of_nodes.is_empty();
    if has_nodes && optimum.boundary.goal.rests == Rests::Everything {
        let few = "a few voltages cannot bring every node of an elastic block to rest";
        lines.push(format!("change: \"rest\": \"bodies\" in the goal; {few}"));
    }
    if has_nodes && control.objective.rate == 0.0 {
        let jumps =
            "without a cost voltages jump from interval to interval and excite the elements";
        lines.push(format!("change: \"rate\": 0.002 in the objective; {jumps}"));
    }
    if lines.is_empty() && optimum.solution.status == Status::IterationLimit {
        let more = "change: more iterations, more intervals, another guess";
        lines.push(match control.objective.rate == 0.0 {
            true => format!("{more}, a cost of rate in the objective"),
            false => more.to_owned(),
        });
    }
    lines
}

/// Says which durations are possible, by solves with a free one and by the slowest mode.
fn durations(control: &Control, optimum: &Optimum) -> Vec<String> {
    let mut lines = Vec::new();
    match optimum.shortest {
        Shortest::Longer(ms) => lines.push(format!(
            "change: a longer duration{}; with the duration free the shortest motion found takes {} s",
            match control.waypoints.is_empty() {
                true => "",
                false => ", and the times of waypoints in proportion",
            },
            no_smaller(ms / 1e3, 3)
        )),
        Shortest::NotUpTo(ms) => lines.push(format!(
            "a longer duration does not help: with the duration free none was found up to {} s",
            significant(ms / 1e3, 3)
        )),
        Shortest::AsGiven => lines.push(
            "a motion of this duration exists: one was found with the duration free; change: more iterations, a cost of rate in the objective"
                .to_owned(),
        ),
        Shortest::Unknown => {}
    }
    let longest = match (optimum.shortest, control.duration) {
        (Shortest::AsGiven, _) => f64::INFINITY,
        (Shortest::NotUpTo(ms), _) => ms,
        (_, Duration::Given(ms) | Duration::Free { max: ms, .. }) => ms,
    };
    if let Some(ms) = optimum.half_period.filter(|ms| *ms > longest) {
        let asks = match optimum.shortest {
            Shortest::Longer(_) => "",
            _ => "change: a longer duration; ",
        };
        lines.push(format!(
            "{asks}half a period of the slowest mode takes {} s, and a shorter motion excites faster ones",
            no_smaller(ms / 1e3, 3)
        ));
    }
    lines
}

/// The warning where a direct solver took over from an iteration.
pub(crate) fn stalled_warning(fallbacks: usize) -> Option<String> {
    (fallbacks > 0).then(|| {
        "the iteration with multigrid did not converge, and a direct solver took over: \"linear_solver\": \"faer\" takes it from the start"
            .to_owned()
    })
}

/// The warning where an equilibrium was found without factors, whose inertia would prove its stability, and the lowest mode does not; as it was
/// `stopped` perhaps.
pub(crate) fn undecided(stopped: Option<Status>) -> String {
    match stopped {
        Some(status) => format!(
            "stability is not known: the search for the lowest mode was stopped ({})",
            status.word().replace('_', " ")
        ),
        None => "stability is not known: the matrix is too large to be factorised, and the lowest mode was not found within a bound that decides"
            .to_owned(),
    }
}

/// For each joint that passes a stop, how far and when.
pub(crate) fn stop_notes(system: &System, motion: &Trajectory) -> Vec<String> {
    let joints = system.joints.iter().filter(|joint| joint.has_coordinate());
    let units = motion.coordinates(system);
    let joints = joints.zip(units).enumerate();
    let passed = joints.filter_map(|(u, (joint, of))| {
        let stops = joint.stops?;
        let beyond = motion.joints.iter().map(|row| stops.beyond(row[u]));
        let (k, far) = beyond.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (far, unit) = match of.unit {
            "rad" => (far.to_degrees(), "deg"),
            other => (far, other),
        };
        let (size, time) = (significant(far, 3), significant(motion.times[k] / 1e3, 4));
        let name = &joint.name;
        (far > 0.0)
            .then(|| format!("{name} is pressed into its stop by up to {size} {unit}, at {time} s"))
    });
    passed.collect()
}
