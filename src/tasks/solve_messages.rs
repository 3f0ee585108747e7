//! Messages about the end of a solve.

use crate::control::Carried;
use crate::control::problem::{Control, Hold};
use crate::math::{shortest, significant};
use crate::model::Model;
use crate::nlp::Status;
use crate::workflow::optimum::{Optimum, Restarted, Stages};
use crate::workflow::reasons::Cause;
use crate::workflow::tracking::{FinalValue, Tracked};

/// Maximum number of final values listed.
const TOLD: usize = 6;

/// A further reason why a solve failed, where there is one.
pub(crate) fn redundancy(redundant: &[String]) -> String {
    match redundant {
        [] => String::new(),
        names => format!(
            "; constraints are redundant at the start: {} more than is needed, such as {}",
            names.len(),
            names.join(", ")
        ),
    }
}

/// Returns the meaning of a status for the problem.
pub(crate) fn meaning(status: Status) -> &'static str {
    match status {
        Status::Infeasible | Status::RestorationFailed => {
            "no motion that satisfies the goal and the limits was found from this guess; the files hold the iterate that violates them least"
        }
        Status::IterationLimit => {
            "the iterations allowed were used up; the files hold the last iterate"
        }
        Status::TimeLimit => "the time allowed was used up; the files hold the last iterate",
        Status::Interrupted => "interrupted; the files hold the last iterate",
        Status::InvalidNumber => {
            "an equation or a derivative has no value at an iterate: the ends of a muscle meet there, an element is inverted, or a voltage is beyond the range of numbers; the files hold the last iterate; take another guess or more intervals"
        }
        Status::TooFewDegreesOfFreedom => "there are more equations than unknowns",
        _ => "the solver stopped early; the files hold the last iterate",
    }
}

/// Describes a first start without an answer, whose further starts were stopped.
pub(crate) fn stopped_after(first: Status, stopped: Status) -> String {
    let reason = match stopped {
        Status::Interrupted => "interrupted",
        _ => "the time allowed was used up",
    };
    format!(
        "{reason} while other starts were tried; the first start ended {first}; the files hold its last iterate"
    )
}

/// Describes an optimum to a weaker tolerance whose solve was stopped before it met its own.
pub(crate) fn cut_short(stopped: Status) -> String {
    format!(
        "the solver was stopped ({}) before it met its tolerance: without the stop it may end at a better point",
        stopped.word().replace('_', " ")
    )
}

/// Describes the changes of an earlier solution that serves as a guess.
pub(crate) fn carried(carried: &Carried) -> Vec<String> {
    let stretched = carried.stretched.map(|[from, to]| {
        let [from, to] = [from / 1e3, to / 1e3];
        format!("the guess lasts {from} s; it was stretched in time to {to} s")
    });
    let simulated = carried.simulated.then(|| {
        "the earlier solution does not tell where the nodes of these finite elements are; the guess is the motion under its voltages"
            .to_owned()
    });
    stretched.into_iter().chain(simulated).collect()
}

/// Explains why the discrete optimum is not a solution of the continuous problem.
pub(crate) fn unresolved(model: &Model, interval: usize, muscle: usize) -> String {
    format!(
        "muscle \"{}\" turns by a right angle or more in interval {interval}: its ends meet on the way, or the intervals are \
         too long for the motion; take more intervals or another guess",
        model.system.muscles[muscle].name
    )
}

/// Describes an optimum that the first start did not find.
pub(crate) fn restarted(restarted: Restarted) -> String {
    let Restarted { first, from } = restarted;
    format!("found from {from}; the first start ended {first}")
}

/// Describes the stages of contacts that led to an optimum.
pub(crate) fn stages(optimum: &Optimum) -> Option<String> {
    let Stages {
        solved,
        is_simulated,
        is_softer,
    } = optimum.stages;
    let plural = if solved == 1 { "" } else { "s" };
    let from = match is_simulated {
        true => ", the first from a simulation that came near the goal",
        false => "",
    };
    match is_softer {
        true => Some(format!(
            "stopped in a stage with softer contacts than those of the scene, after {solved} that were solved"
        )),
        false => (solved > 0).then(|| {
            format!(
                "solved after {solved} stage{plural} with softer contacts, each from the one before{from}"
            )
        }),
    }
}

/// Lists the values of a motion at its end or at waypoints for which costs ask; of many the farthest of each unit in turn.
pub(crate) fn ends(values: &[FinalValue]) -> Vec<String> {
    let mut order: Vec<&FinalValue> = values.iter().collect();
    if order.len() > TOLD {
        let farther = |one: &FinalValue| {
            let others = values.iter().filter(|other| other.unit == one.unit);
            let farther = others.filter(|other| other.deviation > one.deviation);
            farther.count()
        };
        order.sort_by_key(|one| farther(one));
    }
    let mut lines: Vec<String> = order.iter().take(TOLD).map(|one| end(one)).collect();
    if order.len() > TOLD {
        let more = order.len() - TOLD;
        let (kind, key) = match values[0].time {
            Some(_) => ("values at waypoints", "waypoint_values"),
            None => ("final values", "final_values"),
        };
        lines.push(format!("{more} more {kind}: see \"{key}\" in summary.json"));
    }
    lines
}

/// Describes one value: lengths in mm, angles in degrees.
fn end(value: &FinalValue) -> String {
    let shown = |number: f64| match value.unit {
        "m" => format!("{} mm", significant(1e3 * number, 4)),
        "rad" => format!("{}°", significant(number.to_degrees(), 4)),
        unit => format!("{} {unit}", significant(number, 4)),
    };
    let (at, cost) = match value.time {
        Some(time) => (format!("passes at {} s", shortest(time, 4)), "waypoint"),
        None => ("ends".to_owned(), "final cost"),
    };
    format!(
        "{} {at} at {}, {} from the {} of its {cost}",
        value.name,
        shown(value.reached),
        shown(value.deviation),
        shown(value.asked)
    )
}

/// The verdict on a motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Its status: `solved`, `not_reproduced`, `not_held`, `infeasible`, ….
    pub word: &'static str,
    /// True if the motion is what was asked for.
    pub is_solved: bool,
    /// Reason why it is not, in words.
    pub message: Option<String>,
}

impl Verdict {
    /// The verdict on an optimum whose end is not kept for a reason, if any.
    pub(super) fn from_optimum(
        control: &Control,
        optimum: &Optimum,
        not_kept: Option<&str>,
    ) -> Self {
        let Optimum {
            model, boundary, ..
        } = optimum;
        let refuted = optimum.reversed.map(|(k, m)| unresolved(model, k, m));
        let refuted = refuted.or_else(|| optimum.cause().map(Cause::message));
        let is_interrupted = optimum.stopped == Some(Status::Interrupted);
        let mut is_solved = optimum.is_solved() && !is_interrupted;
        let mut word = optimum.word();
        let has_to_hold = is_solved && control.hold == Hold::Required;
        let not_held = not_kept.filter(|_| has_to_hold).map(str::to_owned);
        if not_held.is_some() {
            (is_solved, word) = (false, "not_held");
        }
        let mut message = refuted.or(not_held);
        if message.is_none() && !is_solved {
            let status = optimum.solution.status;
            message = Some(match optimum.stopped {
                Some(stopped) => stopped_after(status, stopped),
                None => meaning(status).to_owned(),
            });
        }
        if let (Some(message), false) = (&mut message, optimum.meets_equations()) {
            message.push_str(&redundancy(&model.redundant_constraints(&boundary.start.z)));
        }
        Self {
            word,
            is_solved,
            message,
        }
    }
}

/// Most joints that notes name one by one.
const NAMED: usize = 3;

/// Deviations in words.
pub(crate) fn deviation_words(of: &Tracked) -> String {
    let shown = |value: f64| match of.unit {
        "m" => format!("{} mm", significant(1e3 * value, 3)),
        unit => format!("{} {unit}", significant(value, 3)),
    };
    let [rms, most] = [of.error.rms, of.error.maximum].map(shown);
    format!("{rms} rms and at most {most}")
}

/// Lines about the tracking errors of a motion; of many joints the worst.
pub(crate) fn tracking_notes(tracked: &[Tracked]) -> Vec<String> {
    let joints = tracked.iter().filter(|one| one.kind == "joint");
    let count = joints.clone().count();
    let worst = joints.max_by(|a, b| a.error.maximum.total_cmp(&b.error.maximum));
    let line = |one: &Tracked| {
        let Tracked {
            kind, name, error, ..
        } = one;
        let time = significant(error.time_of_maximum, 3);
        let words = deviation_words(one);
        format!("{kind} {name} deviates from its path by {words} (at {time} s)")
    };
    let is_told = |one: &&Tracked| one.kind == "marker" || count <= NAMED;
    let mut lines: Vec<String> = tracked.iter().filter(is_told).map(line).collect();
    if let Some(worst) = worst.filter(|_| count > NAMED) {
        lines.push(format!("of {count} joints that follow, {}", line(worst)));
    }
    lines
}
