//! Reasons why an effect is present or absent, in words.

use crate::control::problem::{Control, Duration, SourceEnergy};
use crate::model::system::{InputKind, JointKind, Source};
use crate::model::{BodyLocation, Model};
use crate::workflow::motion::Distance;
use serde::Serialize;

/// A model term that is inactive, with its reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// Name of the effect, or of the part that is no unknown.
    pub name: String,
    /// Reason why it is absent.
    pub why: String,
}

/// Largest number of names listed.
const LISTED: usize = 6;

/// Returns the reasons for a term that a model has.
pub(crate) fn why(term: &str, model: &Model) -> String {
    let reasons = model.present.iter().filter(|present| present.term == term);
    let told = reasons.map(|present| {
        let names: Vec<&str> = present.of.iter().map(String::as_str).collect();
        format!("{} {}", present.why, listed(&names))
    });
    told.collect::<Vec<_>>().join("; ")
}

/// Returns the absent terms of a model, and the parts of the scene that are no unknowns.
pub fn absent(model: &Model, control: Option<&Control>) -> Vec<Absent> {
    let mut list = Vec::new();
    let mut add = |name: String, why: String| list.push(Absent { name, why });
    for left_out in &model.left_out {
        add(left_out.term.to_owned(), left_out.why.to_owned());
    }
    let names = |sources: &[usize]| {
        let names = sources.iter().map(|&s| model.sources[s].name.as_str());
        listed(&names.collect::<Vec<_>>())
    };
    let absent = model.reached.iter().copied();
    let absent = absent.filter(|s| model.variables.input(*s).is_none());
    let of = |is_load: bool, is_zero: bool| {
        let zero_inputs = &model.analysis.zero_inputs;
        let own = absent
            .clone()
            .filter(|&s| model.sources[s].is_load() == is_load);
        let own = own.filter(|s| is_load || zero_inputs.contains(s) == is_zero);
        own.collect::<Vec<usize>>()
    };
    let [loads, zero_inputs, cut] = [of(true, true), of(false, true), of(false, false)];
    if !loads.is_empty() {
        let what = "zero all the time, or on what does not move";
        let why = format!("{what}: {}", names(&loads));
        add("load".to_owned(), why);
    }
    if !zero_inputs.is_empty() {
        let why = format!("0 V all the time at {}", names(&zero_inputs));
        add("voltage".to_owned(), why);
    }
    if !cut.is_empty() {
        let why = format!("{} have no field without the others", names(&cut));
        add("voltage".to_owned(), why);
    }
    let joints = model.system.joints.iter();
    for joint in joints.filter(|j| j.kind == JointKind::Fixed) {
        let why = "it is fixed or locked: what it connects is one body";
        add(format!("joint {}", joint.name), why.to_owned());
    }
    for (body, place) in model.system.bodies.iter().zip(&model.presolved.bodies) {
        let mut bodies = model.system.bodies.iter();
        let b = bodies.position(|other| other.name == body.name);
        let is_immobile = b.is_some_and(|b| model.presolved.immobile.bodies[b]);
        let why = match place {
            BodyLocation::Body(_) => continue,
            BodyLocation::Ground if is_immobile => {
                "it starts at rest and nothing moves it".to_owned()
            }
            BodyLocation::Ground => "it is fixed to the ground".to_owned(),
            BodyLocation::Welded { to, .. } => {
                let name = &model.presolved.system.bodies[*to].name;
                format!("it is one body with {name}")
            }
        };
        add(format!("body {}", body.name), why);
    }
    for block in model.solids.iter().filter(|c| c.is_immobile) {
        let why = "it starts at rest and nothing moves it";
        add(format!("block {}", block.solid.name), why.to_owned());
    }
    if let Some(control) = control {
        absent_of_control(model, control, &mut add);
    }
    list
}

fn absent_of_control(model: &Model, control: &Control, add: &mut impl FnMut(String, String)) {
    let is_absent = |&s: &usize| {
        control.is_given(s) && !control.follows_time(s) && model.variables.input(s).is_some()
    };
    for source in (0..model.sources.len()).filter(is_absent) {
        let Source { name, kind, .. } = &model.sources[source];
        let name = match kind {
            InputKind::Voltage => format!("unknown of the voltage of {name}"),
            _ => format!("unknown of the load {name}"),
        };
        add(name, "the problem gives it".to_owned());
    }
    if let Duration::Given(_) = control.duration {
        let why = "the problem gives it".to_owned();
        add("unknown duration".to_owned(), why);
    }
    let weights = [
        ("cost of effort", control.objective.effort),
        ("cost of rates", control.objective.rate),
        ("cost of duration", control.objective.duration),
    ];
    let energy = |energy: SourceEnergy| {
        let costs = control.objective.energies.iter();
        let own = costs.filter(|cost| cost.energy == energy);
        own.map(|cost| cost.weight).sum::<f64>()
    };
    let [electrical, mechanical] = [SourceEnergy::Electrical, SourceEnergy::Mechanical].map(energy);
    let weights = weights.into_iter().chain([
        ("cost of electrical energy", electrical),
        ("cost of mechanical work", mechanical),
    ]);
    for (name, _) in weights.filter(|(_, weight)| *weight == 0.0) {
        add(name.to_owned(), "the objective names no weight".to_owned());
    }
    if control.limits.is_empty() {
        add("limits".to_owned(), "the problem names none".to_owned());
    }
}

/// Names in a row: all of a few, the ends of many.
fn listed(names: &[&str]) -> String {
    match names {
        [first, .., last] if names.len() > LISTED => {
            format!("{first} … {last} ({})", names.len())
        }
        _ => names.join(", "),
    }
}

/// Reason why the discrete optimum is not a motion of the system.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// In one interval it is another root of the equations of a step than a step forward finds.
    Root {
        /// The interval, from 0.
        interval: usize,
        /// Its time in s.
        time: f64,
        /// The joint that turns farthest in it, and its angle in rad.
        turns: Option<(String, f64)>,
        /// Distance of the simulation from the optimum after it.
        distance: Distance,
    },
    /// It violates a closing constraint that was left out.
    Open {
        /// The constraint.
        constraint: String,
        /// Its violation, in rad or relative to the length of the system.
        gap: f64,
    },
    /// A simulation with this number of steps for an interval ends early.
    Ends {
        /// Steps for an interval.
        steps: usize,
        /// Reason.
        failure: String,
    },
    /// Rounding grows until the motion is another one.
    Unstable {
        /// Rate of growth in 1/s.
        rate: f64,
        /// Greatest distance from the optimum.
        distance: Distance,
    },
    /// The grid does not resolve the motion.
    Coarse {
        /// Estimated error as a part of the path length.
        error: f64,
        /// Greatest distance from the optimum with finer steps.
        distance: Distance,
        /// True if two refinements agree on it.
        is_confirmed: bool,
    },
}

impl Cause {
    /// In words.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Root {
                interval,
                time,
                turns,
                distance,
            } => {
                let turn = turns.as_ref().map_or(String::new(), |(joint, angle)| {
                    format!(", where joint \"{joint}\" turns by {angle:.2} rad")
                });
                format!(
                    "forward simulation under the optimal inputs gives another motion: in interval {interval} (from \
                     {time:.4} s){turn}, the equations have several roots, and the optimum has another one than a forward step \
                     ({distance} apart after it); the intervals are too long for the motion"
                )
            }
            Self::Open { constraint, gap } => format!(
                "the optimum opens a loop: {constraint} was left out, as it follows from the others near the reference, and is violated by \
                 {gap:.1e} (rad, or of the length of the system)"
            ),
            Self::Ends { steps: 1, failure } => {
                format!("forward simulation under the optimal inputs ends early: {failure}")
            }
            Self::Ends { steps, failure } => format!(
                "forward simulation under the optimal inputs with {steps} steps per interval ends early: {failure}"
            ),
            Self::Unstable { rate, distance } => format!(
                "forward simulation under the optimal inputs leaves the optimum ({distance}): the motion is unstable, round-off grows at a rate of {rate:.3} 1/s"
            ),
            Self::Coarse {
                error,
                distance,
                is_confirmed,
            } => {
                let further = match is_confirmed {
                    true => "",
                    false => {
                        "; steps that are still finer lead elsewhere, so that more is possible"
                    }
                };
                format!(
                    "the intervals do not resolve the motion: under the same inputs the motion with finer steps deviates \
                     from it by up to {:.0} % of the path length ({distance}){further}",
                    100.0 * error
                )
            }
        }
    }
}
