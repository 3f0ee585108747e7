//! Why an effect is called for, and why another is not, in words.

use serde::Serialize;

use crate::control::problem::{Control, Duration};
use crate::functional::Effect;
use crate::model::system::{Fidelity, JointKind, Material, Muscle};
use crate::model::{Continuum, Coordinates, Model, Place};

/// Something that a scene or a problem could call for and does not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// Name of the effect, or of what is no unknown.
    pub name: String,
    /// Why it is not there.
    pub why: String,
}

/// So many names are written out.
const LISTED: usize = 6;

/// Names of all effects, in the order of the plan.
pub const EFFECTS: [&str; 16] = [
    "body inertia",
    "muscle inertia",
    "block inertia",
    "section inertia",
    "gravity",
    "block elasticity",
    "block electroelasticity",
    "muscle elasticity",
    "muscle electroelasticity",
    "block viscosity",
    "muscle viscosity",
    "joint damping",
    "rigid bodies",
    "joint directions",
    "joint points",
    "glue",
];

/// What calls for an effect that a model has.
pub(super) fn why(effect: &str, model: &Model) -> String {
    if let Some(present) = model.present.iter().find(|present| present.term == effect) {
        let names: Vec<&str> = present.of.iter().map(String::as_str).collect();
        return format!("{} of {}", present.why, listed(&names));
    }
    let scene = Scene { model };
    let of = |what: &str, names: Vec<&str>| format!("{what} of {}", listed(&names));
    let joints = &model.condensed.system.joints;
    match effect {
        "body inertia" => of("mass", scene.bodies()),
        "muscle inertia" => of("density", scene.lumped(|m| m.density.is_some())),
        "block inertia" => of("density", scene.blocks(|m| m.density.is_some())),
        "section inertia" => {
            let muscles = model.system.muscles.iter();
            let named = muscles.filter(|m| m.section_inertia && m.material.density.is_some());
            of("density and section_inertia", named.map(name).collect())
        }
        "gravity" => "gravity of the scene".to_owned(),
        "block elasticity" => of(
            "elements without a field",
            scene.continua(|c| c.is_dielectric.contains(&false)),
        ),
        "block electroelasticity" => of(
            "elements in a field",
            scene.continua(|c| c.is_dielectric.contains(&true)),
        ),
        "muscle elasticity" => scene.passive_muscles(),
        "muscle electroelasticity" => {
            of("electric constants and a voltage", scene.driven_muscles())
        }
        "block viscosity" => of("viscosity", scene.blocks(|m| m.viscosity.is_some())),
        "muscle viscosity" => of("viscosity", scene.lumped(|m| m.viscosity.is_some())),
        "joint damping" => {
            let damped = joints.iter().filter(|j| j.damping.is_some());
            of("damping", damped.map(|j| j.name.as_str()).collect())
        }
        "rigid bodies" => of("directors", scene.bodies()),
        "joint directions" | "joint points" => {
            let joints = joints.iter().map(|j| j.name.as_str()).collect();
            of("redundant coordinates at the ends", joints)
        }
        "glue" => of(
            "glued nodes",
            scene.continua(|c| c.solid.glued.iter().any(|g| g.body.is_some())),
        ),
        _ => String::new(),
    }
}

/// What a model has not, and what of the scene is no unknown.
pub fn absent(model: &Model, control: Option<&Control>) -> Vec<Absent> {
    let sums = [&model.action.intervals, &model.action.instants];
    let there = |name: &str| {
        let mut effects = sums.iter().flat_map(|sum| &sum.effects);
        effects.any(|effect| Effect::name(effect.as_ref()) == name)
    };
    let scene = Scene { model };
    let mut list = Vec::new();
    let mut add = |name: String, why: String| list.push(Absent { name, why });
    for effect in EFFECTS.iter().filter(|name| !there(name)) {
        add((*effect).to_owned(), scene.why_not(effect));
    }
    for left_out in &model.left_out {
        add(left_out.term.to_owned(), left_out.why.to_owned());
    }
    let names = |sources: &[usize]| {
        let names = sources.iter().map(|&s| model.sources[s].name.as_str());
        listed(&names.collect::<Vec<_>>())
    };
    let (silent, cut): (Vec<usize>, Vec<usize>) = model
        .reached
        .iter()
        .filter(|s| !model.voltages.contains(s))
        .partition(|s| model.question.silent.contains(s));
    if !silent.is_empty() {
        let why = format!("0 V all the time at {}", names(&silent));
        add("voltage".to_owned(), why);
    }
    if !cut.is_empty() {
        let why = format!("no field at {} without the others", names(&cut));
        add("voltage".to_owned(), why);
    }
    let joints = model.system.joints.iter();
    for joint in joints.filter(|j| j.kind == JointKind::Fixed) {
        let why = "it is fixed or locked: what it connects is one body";
        add(format!("joint {}", joint.name), why.to_owned());
    }
    for (body, place) in model.system.bodies.iter().zip(&model.condensed.places) {
        let b = model
            .system
            .bodies
            .iter()
            .position(|other| other.name == body.name);
        let is_still = b.is_some_and(|b| model.condensed.still.bodies[b]);
        let why = match place {
            Place::Body(_) => continue,
            Place::Ground if is_still => "it starts at rest and nothing moves it".to_owned(),
            Place::Ground => "it is fixed to the ground".to_owned(),
            Place::Welded { to, .. } => {
                format!(
                    "it is one body with {}",
                    model.condensed.system.bodies[*to].name
                )
            }
        };
        add(format!("body {}", body.name), why);
    }
    for continuum in model.continua.iter().filter(|c| c.is_still) {
        let why = "it starts at rest and nothing moves it";
        add(format!("block {}", continuum.solid.name), why.to_owned());
    }
    if let Some(control) = control {
        absent_of_control(model, control, &mut add);
    }
    list
}

fn absent_of_control(model: &Model, control: &Control, add: &mut impl FnMut(String, String)) {
    let present = |source: &&usize| model.voltages.contains(source);
    for source in control.given.keys().filter(present) {
        let name = format!("unknown of the voltage of {}", model.sources[*source].name);
        add(name, "the problem gives it".to_owned());
    }
    if let Duration::Given(_) = control.duration {
        add(
            "unknown duration".to_owned(),
            "the problem gives it".to_owned(),
        );
    }
    let weights = [
        ("cost of effort", control.objective.effort),
        ("cost of rates", control.objective.rate),
        ("cost of duration", control.objective.duration),
    ];
    for (name, _) in weights.iter().filter(|(_, weight)| *weight == 0.0) {
        add(
            (*name).to_owned(),
            "the objective names no weight".to_owned(),
        );
    }
    if control.limits.is_empty() {
        add("limits".to_owned(), "the problem names none".to_owned());
    }
}

/// What is read of a model.
struct Scene<'a> {
    model: &'a Model,
}

impl<'a> Scene<'a> {
    fn bodies(&self) -> Vec<&'a str> {
        let bodies = self.model.condensed.system.bodies.iter();
        bodies.map(|body| body.name.as_str()).collect()
    }

    /// Lumped muscles that move, by their material.
    fn lumped(&self, has: impl Fn(&Material) -> bool) -> Vec<&'a str> {
        let muscles = self.moving_lumped();
        let with = muscles.filter(|m| has(&m.material));
        with.map(name).collect()
    }

    fn moving_lumped(&self) -> impl Iterator<Item = &'a Muscle> + use<'a> {
        let still = &self.model.condensed.still.muscles;
        let muscles = self.model.system.muscles.iter().zip(still);
        let moving = muscles.filter(|(m, still)| m.fidelity == Fidelity::Lumped && !**still);
        moving.map(|(muscle, _)| muscle)
    }

    /// Blocks that move, by one of their materials.
    fn blocks(&self, has: impl Fn(&Material) -> bool) -> Vec<&'a str> {
        self.continua(|c| c.solid.materials.iter().any(&has))
    }

    /// Blocks that move.
    fn continua(&self, has: impl Fn(&Continuum) -> bool) -> Vec<&'a str> {
        let moving = self.model.continua.iter().filter(|c| !c.is_still && has(c));
        moving.map(|c| c.solid.name.as_str()).collect()
    }

    fn driven_muscles(&self) -> Vec<&'a str> {
        let is_driven = |m: &&usize| {
            let muscle = self.model.system.muscles.get(**m);
            muscle.is_some_and(|m| m.fidelity == Fidelity::Lumped)
        };
        let driven = self.model.voltages.iter().filter(is_driven);
        driven
            .map(|&m| self.model.sources[m].name.as_str())
            .collect()
    }

    /// Why muscles are only elastic.
    fn passive_muscles(&self) -> String {
        let driven = self.driven_muscles();
        let passive = || {
            self.moving_lumped()
                .filter(|m| !driven.contains(&m.name.as_str()))
        };
        let (silent, plain): (Vec<_>, Vec<_>) =
            passive().partition(|m| m.material.electric.is_some());
        let names = |list: Vec<&'a Muscle>| listed(&list.into_iter().map(name).collect::<Vec<_>>());
        let mut parts = Vec::new();
        if !plain.is_empty() {
            parts.push(format!("no electric constants of {}", names(plain)));
        }
        if !silent.is_empty() {
            parts.push(format!("0 V all the time at {}", names(silent)));
        }
        parts.join("; ")
    }

    /// Why a model has not an effect.
    fn why_not(&self, effect: &str) -> String {
        let model = self.model;
        let at_rest = !model.question.of_motion;
        let has_muscles = self.moving_lumped().next().is_some();
        let has_blocks = !self.continua(|_| true).is_empty();
        let no_blocks = match model.continua.is_empty() {
            true => "no elastic block",
            false => "no elastic block that moves",
        };
        let lumped = |muscle: &Muscle| muscle.fidelity == Fidelity::Lumped;
        let no_muscles = match model.system.muscles.iter().any(lumped) {
            true => "no lumped muscle that moves",
            false => "no lumped muscle",
        };
        let reason = match effect {
            "body inertia" | "muscle inertia" | "block inertia" | "section inertia" if at_rest => {
                "a state of rest has no inertia"
            }
            "block viscosity" | "muscle viscosity" | "joint damping" if at_rest => {
                "a state of rest dissipates nothing"
            }
            "body inertia" => "no body that moves",
            "gravity" if model.system.gravity.is_none() => "the scene names no gravity",
            "gravity" => "nothing that moves has a mass",
            "joint damping" => "no joint that moves names a damping",
            "rigid bodies" | "joint directions" | "joint points" | "glue"
                if model.coordinates == Coordinates::Reduced =>
            {
                "reduced coordinates leave no constraint"
            }
            "rigid bodies" => "no body that moves",
            "joint directions" | "joint points" => "no joint that calls for one",
            "glue" => "no node is glued to a body that moves",
            _ if effect.starts_with("muscle") && !has_muscles => no_muscles,
            _ if effect.starts_with("block") && !has_blocks => no_blocks,
            "muscle inertia" => "no lumped muscle names a density",
            "block inertia" => "no elastic block names a density",
            "section inertia" => "no muscle with a density names section_inertia",
            "muscle viscosity" => "no lumped muscle names a viscosity",
            "block viscosity" => "no elastic block names a viscosity",
            "muscle elasticity" => "every lumped muscle takes a voltage",
            "block elasticity" => "a field reaches every element",
            "muscle electroelasticity" => self.why_no_voltage(),
            "block electroelasticity" => self.why_no_field(),
            _ => "",
        };
        reason.to_owned()
    }

    fn why_no_voltage(&self) -> &'static str {
        let mut muscles = self.moving_lumped();
        match muscles.any(|m| m.material.electric.is_some()) {
            true => "every voltage of a lumped muscle is 0 all the time",
            false => "no lumped muscle names electric constants",
        }
    }

    fn why_no_field(&self) -> &'static str {
        let electric = |m: &Material| m.electric.is_some();
        if self.blocks(electric).is_empty() {
            return match self.model.question.silent.is_empty() {
                true => "no elastic block names electric constants",
                false => "no elastic block names electric constants and takes a voltage",
            };
        }
        match self.continua(|c| !c.solid.electrodes.is_empty()).is_empty() {
            true => "no elastic block has electrodes with a voltage",
            false => "all electrodes of a block have one voltage",
        }
    }
}

fn name(muscle: &Muscle) -> &str {
    &muscle.name
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
