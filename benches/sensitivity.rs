//! Time of sensitivities as a part of that of the solve: the elephant trunk, with one number and with five, and two outcomes by the five, interleaved.
//!
//! `cargo bench --bench sensitivity`; with `-- --once 5` once to five numbers, for one who counts instructions.

use proboscis::control::problem::{Control, OutcomeOf, Task};
use proboscis::files::read_problem;
use proboscis::model::System;
use proboscis::sensitivity::{gradients, sensitivities};
use proboscis::workflow::{Iterate, Optimum, SolveLimits, optimise};
use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Rounds; medians count.
const ROUNDS: usize = 15;
const NUMBERS: [&str; 5] = [
    "materials.silicone.shear_modulus",
    "materials.silicone.viscosity",
    "materials.silicone.relative_permittivity",
    "chain.mass",
    "duration",
];

/// The place of the tip and a voltage in the middle of the motion.
const OUTCOMES: [OutcomeOf; 2] = [
    OutcomeOf::Marker {
        marker: 0,
        axis: 0,
        time: 150.0,
    },
    OutcomeOf::Input {
        source: 1,
        time: 150.0,
    },
];

fn problem(count: usize) -> (System, Control) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let list: Vec<String> = NUMBERS[..count]
        .iter()
        .map(|name| format!("{name:?}: {{}}"))
        .collect();
    let change = format!("control.sensitivity={{{}}}", list.join(", "));
    let loaded = read_problem(&path, &[change]).expect("a kept problem");
    match loaded.task {
        Task::Control(control) => (loaded.system, *control),
        _ => unreachable!("a control problem"),
    }
}

fn solved((system, control): &(System, Control)) -> Optimum {
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    optimise(system, control, None, SolveLimits::default(), &mut go_on).expect("an optimum")
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}

/// Sensitivities to some numbers, once.
fn once(count: usize) {
    let asked = problem(count);
    let optimum = solved(&asked);
    black_box(sensitivities(&asked.0, &asked.1, &optimum.motion)).expect("sensitivities");
}

fn main() {
    let mut arguments = std::env::args().skip_while(|word| word != "--once");
    if let Some(count) = arguments.nth(1) {
        return once(count.parse().expect("a number after --once"));
    }
    let asked = [1, NUMBERS.len()].map(problem);
    let optimum = solved(&asked[0]);
    let (mut solves, mut one, mut all) = (Vec::new(), Vec::new(), Vec::new());
    let (mut few, mut solutions) = (Vec::new(), 0);
    for _ in 0..ROUNDS {
        let found = solved(&asked[0]);
        solves.push(found.solution.seconds.total + found.setup);
        for (problem, times) in asked.iter().zip([&mut one, &mut all]) {
            let began = Instant::now();
            black_box(sensitivities(&problem.0, &problem.1, &optimum.motion))
                .expect("sensitivities");
            times.push(began.elapsed().as_secs_f64());
        }
        let (system, control) = &asked[1];
        let began = Instant::now();
        let found = gradients(system, control, &optimum.motion, &OUTCOMES).expect("gradients");
        few.push(began.elapsed().as_secs_f64());
        solutions = found.solutions;
    }
    let [solve, one, all, few] = [solves, one, all, few].map(median);
    let each = (all - one) / (NUMBERS.len() - 1) as f64;
    println!(
        "solve {:.1} ms, sensitivities to one number {:.1} ms, to each further one {:.2} ms",
        1e3 * solve,
        1e3 * one,
        1e3 * each
    );
    println!(
        "two outcomes by {} numbers, {solutions} solutions: {:.1} ms in place of {:.1} ms for all",
        NUMBERS.len(),
        1e3 * few,
        1e3 * all
    );
    println!(
        "parts of the solve: {:.1} % for the first number, {:.2} % for each further one",
        100.0 * one / solve,
        100.0 * each / solve
    );
}
