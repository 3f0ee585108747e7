//! Explanation of an infeasible control problem by its closest motion, with the changes that may help.

use std::ops::ControlFlow;

use crate::control::problem::{BoundaryState, Control, Duration, Objective};
use crate::control::{BoundaryConditions, Place, Rests};
use crate::coordinates::Configuration;
use crate::dynamics::simulate;
use crate::kinematics::Pose;
use crate::math::significant;
use crate::model::components::Tendon;
use crate::model::{Component, Model, System, joint_unit};
use crate::workflow::iterate::Iterate;
use crate::workflow::optimise::{Optimum, SolveLimits, optimise};
use crate::workflow::second_start::is_infeasible;

/// Maximum number of bounds listed.
const TOLD: usize = 6;
/// Largest ratio of the free duration to the given one.
const LONGEST: f64 = 20.0;
/// Iterations of the solve with a free duration.
const ITERATIONS: usize = 200;
/// Seconds of that solve: those of the solve before, and no less than this.
const PATIENCE: f64 = 2.0;
/// Parts of the rest length of a tendon that are near to its kink.
const KINK: f64 = 5e-3;
/// Of the length of the system in the duration: markers that are slower than this rest.
const SLOW: f64 = 1e-4;

/// Explains a problem whose solve found no motion, line by line; `seconds` are left of the time allowed.
pub(crate) fn explain(
    system: &System,
    control: &Control,
    optimum: &Optimum,
    seconds: Option<f64>,
) -> Vec<String> {
    let mut lines: Vec<String> = miss(control, optimum).into_iter().collect();
    lines.extend(optimum.active.iter().take(TOLD).map(|active| active.told()));
    let longer = longer(system, control, optimum, seconds);
    lines.extend(changes(control, optimum, longer));
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
    jumping.filter_map(told).collect()
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
    let h = motion.times[n] / n as f64;
    let scalars = |from: f64, _: f64| {
        let k = ((from / h).round() as usize).min(n - 1);
        model.scalars(&motion.voltages[k])
    };
    let (history, failure) = simulate(model, &boundary.start, h, n, scalars, |_| {
        ControlFlow::Continue(())
    });
    if failure.is_some() || history.intervals() < n {
        return None;
    }
    let placed = |z: &[f64]| {
        let mut instant = model.action.motion.instant();
        instant.z[..z.len()].copy_from_slice(z);
        model.action.motion.place(&mut instant);
        instant
    };
    let [end, before] = [n, n - 1].map(|k| placed(&history.z[k]));
    let parts = distances(model, boundary, &control.goal, &end);
    let (what, _) = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let speed = |v: &usize| (end.x[*v] - before.x[*v]).norm() / h;
    let fastest = model.markers.iter().map(speed).fold(0.0, f64::max);
    let is_slow = fastest < SLOW * model.length() / motion.times[n];
    let moves = match is_slow {
        true => String::new(),
        false => format!(
            ", and markers still move at {} m/s",
            significant(fastest, 2)
        ),
    };
    Some(format!("simulated under the voltages found, {what}{moves}"))
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
    let joints = |instant: &Configuration| model.joints(instant, &vec![0.0; model.gauges.len()]);
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
        BoundaryState::Free | BoundaryState::EndOf(_) => Vec::new(),
        BoundaryState::RestAtVoltages(..) => {
            let Some(rest) = &boundary.goal.rest else {
                return Vec::new();
            };
            let mut there = model.action.motion.instant();
            there.z.copy_from_slice(&rest.z);
            model.action.motion.place(&mut there);
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

/// Result of a solve with a free duration.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Longer {
    /// A motion of this length in ms was found.
    Found(f64),
    /// None was found up to this length.
    NotUpTo(f64),
    /// It was not tried, or not to the end.
    Unknown,
}

/// Looks for a motion of the shortest duration that is no shorter than the one asked for.
fn longer(system: &System, control: &Control, optimum: &Optimum, seconds: Option<f64>) -> Longer {
    let Duration::Given(given) = control.duration else {
        return Longer::Unknown;
    };
    let mut free = control.clone();
    let most = LONGEST * given;
    free.duration = Duration::Free {
        min: given,
        max: most,
        guess: 2.0 * given,
    };
    free.objective = Objective {
        duration: 1.0,
        ..Objective::default()
    };
    let patience = optimum.solution.seconds.solver.max(PATIENCE);
    let allowed = SolveLimits {
        iterations: Some(ITERATIONS),
        seconds: Some(seconds.map_or(patience, |left| left.min(patience))),
    };
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let Ok(found) = optimise(system, &free, None, allowed, &mut go_on) else {
        return Longer::Unknown;
    };
    let duration = found.motion.times[found.motion.intervals()];
    match found.solution.status {
        _ if found.is_solved() => Longer::Found(duration),
        status if is_infeasible(status) => Longer::NotUpTo(most),
        _ => Longer::Unknown,
    }
}

/// Returns the changes that may help.
fn changes(control: &Control, optimum: &Optimum, longer: Longer) -> Vec<String> {
    let model = &optimum.model;
    let seconds = |ms: f64| significant(ms / 1e3, 3);
    let mut lines = Vec::new();
    match longer {
        Longer::Found(ms) => lines.push(format!(
            "change: a longer duration; with the duration free a motion of {} s was found",
            seconds(ms)
        )),
        Longer::NotUpTo(ms) => lines.push(format!(
            "a longer duration does not help: with the duration free none was found up to {} s",
            seconds(ms)
        )),
        Longer::Unknown => {}
    }
    if optimum.active.iter().any(|active| active.is_voltage) {
        lines.push("change: wider voltage_bounds, if the muscles withstand them".to_owned());
    }
    let has_nodes = !model.action.motion.of_nodes.is_empty();
    if has_nodes && optimum.boundary.goal.rests == Rests::Everything {
        let few = "a few voltages cannot bring every node of an elastic block to rest";
        lines.push(format!("change: \"rest\": \"bodies\" in the goal; {few}"));
    }
    if has_nodes && control.objective.rate == 0.0 {
        let jumps =
            "without a cost voltages jump from interval to interval and excite the elements";
        lines.push(format!("change: \"rate\": 0.002 in the objective; {jumps}"));
    }
    lines
}
