//! A thousand trunks that differ from that of their plan, with and without feedback.
//!
//! `cargo bench --bench feedback -- [--write]`: the trunk of `problems/elephant_trunk.json` is planned once, with the gains of the usual weights.
//! Robots of other shear moduli, viscosities and masses start with joints off their places, and follow the plan. With `--write` the page goes
//! to `results/gallery/feedback.md`.

#[path = "../tests/common/random.rs"]
#[expect(dead_code, unreachable_pub, reason = "tests draw vectors too")]
mod random;

use proboscis::control::problem::{
    BoundaryState, Control, FeedbackControl, Noise, Regulator, Simulation, Task, Voltages,
};
use proboscis::dynamics::Solving;
use proboscis::feedback::Law;
use proboscis::files::read_problem;
use proboscis::model::System;
use proboscis::tasks::{SimulationRequest, SolveRequest, simulate, solve};
use proboscis::workflow::Iterate;
use proboscis::workflow::closed_loop::{ClosedLoop, Deviation};
use proboscis::workflow::regulator::{Along, regulator};
use random::Random;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// Number of robots that are drawn, and the seed.
const SAMPLES: usize = 1000;
const SEED: u64 = 35;
/// Greatest changes, as parts of the constants of the scene.
const MODULUS: f64 = 0.1;
const VISCOSITY: f64 = 0.2;
const MASS: f64 = 0.05;
/// Greatest angle of a joint at the start in rad.
const ANGLE: f64 = 0.01;
/// Length of a simulation in ms: that of the plan, and as long again.
const DURATION: f64 = 600.0;

fn main() {
    let writes = std::env::args().any(|argument| argument == "--write");
    let text = page();
    println!("{text}");
    if writes {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery/feedback.md");
        fs::write(file, text).expect("a written file");
    }
}

/// The plan: the system, and the law of its regulator.
fn plan() -> (System, Law) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let loaded = read_problem(&path, &[]).expect("a kept problem");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let law = law(&loaded.system, &control);
    (loaded.system, law)
}

fn law(system: &System, control: &Control) -> Law {
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve(system, control, SolveRequest::default(), go_on).expect("a right problem");
    assert!(found.verdict.is_solved);
    let along = Along::new(&found.optimum, &found.discrete, control);
    let regulated = regulator(along, &Regulator::default()).expect("gains");
    assert!(
        regulated.warnings().is_empty(),
        "{:?}",
        regulated.warnings()
    );
    regulated.law
}

/// A robot that differs from that of the plan, and its start.
fn robot(system: &System, random: &mut Random) -> (System, BoundaryState) {
    let mut system = system.clone();
    let mut factor = |part: f64| random.between(1.0 - part, 1.0 + part);
    let [modulus, viscosity, mass] = [MODULUS, VISCOSITY, MASS].map(&mut factor);
    for muscle in &mut system.muscles {
        muscle.material.shear_modulus *= modulus;
        muscle.material.viscosity = muscle.material.viscosity.map(|one| viscosity * one);
    }
    for body in &mut system.bodies {
        body.mass *= mass;
        body.inertia = body.inertia.map(|moment| mass * moment);
    }
    let joints = 0..system.joints.len();
    let start = BoundaryState::JointAngles {
        angles: joints.map(|j| (j, random.between(-ANGLE, ANGLE))).collect(),
        rates: [].into(),
        velocities: [].into(),
    };
    (system, start)
}

fn closed_loop(system: &System, start: BoundaryState, law: &Arc<Law>) -> ClosedLoop {
    let task = Simulation {
        duration: DURATION,
        step: law.h / 5.0,
        tolerance: None,
        start,
        voltages: Voltages::constant(&vec![0.0; system.sources().len()]),
        coordinates: None,
        solving: Solving::default(),
        controller: Some(Box::new(FeedbackControl {
            law: law.clone(),
            path: "the plan".into(),
            sample: law.h,
            delay: 0.0,
            noise: Noise::default(),
            ahead: None,
        })),
    };
    let go_on = &mut |_: usize, _: &_, _: &_| ControlFlow::Continue(());
    let found = simulate(system, &task, SimulationRequest::default(), go_on);
    let found = found.expect("a right problem");
    assert!(found.simulated.failure.is_none());
    found.closed_loop.expect("a controller")
}

fn page() -> String {
    let (system, law) = plan();
    let law = Arc::new(law);
    let mut random = Random(SEED);
    let robots: Vec<_> = (0..SAMPLES).map(|_| robot(&system, &mut random)).collect();
    let all: Vec<ClosedLoop> = robots
        .into_iter()
        .map(|(system, start)| closed_loop(&system, start, &law))
        .collect();
    let within = all
        .iter()
        .filter(|one| one.samples_at_upper_bound == 0)
        .count();
    let mut text = format!(
        "# A thousand trunks under feedback\n\nWritten by `cargo bench --bench feedback -- --write`.\n\n\
         The trunk of [`elephant_trunk`](../../problems/elephant_trunk.json) is planned once; the gains of its regulator are those \
         of `\"feedback\": {{}}`. {SAMPLES} other trunks follow the plan: their shear moduli differ by up to {:.0} %, their viscosities by \
         {:.0} %, their masses by {:.0} %, and each joint starts up to {ANGLE} rad off. All samples of {:.0} % of them keep the upper \
         bound of the voltages; muscles that would have to push stay at 0 V.\n\n\
         | distance of the tip from the plan, mm | feedback: median | 95 % | greatest | none: median | 95 % | greatest |\n\
         |:--|--:|--:|--:|--:|--:|--:|\n",
        100.0 * MODULUS,
        100.0 * VISCOSITY,
        100.0 * MASS,
        100.0 * within as f64 / SAMPLES as f64,
    );
    type Of = fn(&Deviation) -> f64;
    let rows: [(&str, Of); 3] = [
        ("the greatest of the motion", |one| one.greatest),
        ("the greatest after the end of the plan", |one| {
            one.greatest_held.unwrap_or(f64::NAN)
        }),
        ("at the end of the simulation", |one| one.last),
    ];
    for (name, of) in rows {
        let tips = || all.iter().map(|one| one.markers["tip"]);
        let with = parts(tips().map(|tip| of(&tip.feedback)));
        let without = parts(tips().map(|tip| of(&tip.open_loop.expect("a motion"))));
        let cells: Vec<String> = [with, without]
            .concat()
            .iter()
            .map(|x| format!("{x:.3}"))
            .collect();
        text.push_str(&format!("| {name} | {} |\n", cells.join(" | ")));
    }
    text
}

/// Median, 95 % and greatest in mm of lengths in m.
fn parts(list: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut list: Vec<f64> = list.map(|x| 1e3 * x).collect();
    list.sort_by(f64::total_cmp);
    let part = |p: f64| list[(p * (list.len() - 1) as f64).round() as usize];
    vec![part(0.5), part(0.95), part(1.0)]
}
