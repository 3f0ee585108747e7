//! Iterations that an earlier solution, or a simulation, saves as a start.
//!
//! `cargo bench --bench warm -- [GOALS] [--write]`: starts from solutions on other grids, of other goals and of another duration, then
//! so many random goals, 50 where not said, from simulations; with `--write` the page goes to `results/gallery/warm_starts.md`.

#[path = "../tests/common/random_goals.rs"]
mod random_goals;

use random_goals::{Goals, Kind};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Seed of the goals.
const SEED: u64 = 1;
/// Optima whose objectives differ by this part are two.
const OTHER: f64 = 1e-6;

/// A problem in `problems/`, what is changed in it for the earlier solution and for the later one, each in words.
type Case = (&'static str, Vec<String>, Vec<String>, String);

/// End of a solve.
struct Ended {
    folder: TempDir,
    is_solved: bool,
    iterations: u64,
    objective: f64,
}

fn main() {
    let mut count = 50;
    let mut writes = false;
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--write" => writes = true,
            "--bench" => {}
            number => count = number.parse().expect("a number of goals, or --write"),
        }
    }
    let (solutions, [saved, of]) = of_solutions();
    let (simulations, told) = of_simulations(count);
    let text = format!(
        "# Iterations that a start saves\n\n\
         Written by `cargo bench --bench warm -- --write`. All starts from solutions together take {saved} iterations, from the guess of their problems \
         {of}. {told}\n\n\
         An optimum is worse or better where objectives differ by more than {OTHER:e}.\n\n{solutions}\n{simulations}"
    );
    println!("{text}");
    if writes {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery/warm_starts.md");
        fs::write(file, text).expect("a written file");
    }
}

/// The rest of a trunk under two voltages.
fn rest(muscles: [[u8; 3]; 2], kilovolts: [f64; 2]) -> String {
    let pairs = muscles.iter().zip(kilovolts);
    let named = pairs.flat_map(|(three, v)| three.map(|m| (format!("muscle{m}"), json!(v * 1e3))));
    let map: Value = named.collect();
    format!("control.goal={}", json!({ "rest_at_voltages": map }))
}

fn cases() -> Vec<Case> {
    let intervals = |n: usize| vec![format!("control.intervals={n}")];
    let mut all: Vec<Case> = Vec::new();
    let grids: [(&str, &[[usize; 2]]); 4] = [
        (
            "elephant_trunk_effort",
            &[
                [20, 40],
                [40, 80],
                [80, 160],
                [40, 20],
                [80, 40],
                [40, 60],
                [40, 125],
            ],
        ),
        ("elephant_trunk", &[[60, 125], [125, 60], [125, 250]]),
        ("pair", &[[20, 40], [40, 80], [40, 20]]),
        ("pair_time", &[[20, 40], [40, 80], [40, 20]]),
    ];
    for (problem, pairs) in grids {
        for &[a, b] in pairs {
            let told = format!("{b} intervals from {a}");
            all.push((problem, intervals(a), intervals(b), told));
        }
    }
    let longer = vec!["control.duration=0.63 s".to_owned()];
    let told = "0.63 s in place of 0.6 s".to_owned();
    all.push(("elephant_trunk_effort", vec![], longer, told));
    let trunks = [
        ("elephant_trunk_effort", [[2, 6, 10], [3, 7, 11]]),
        ("elephant_trunk", [[1, 5, 9], [3, 7, 11]]),
    ];
    for (problem, muscles) in trunks {
        for kilovolts in [[1.65, 1.6], [1.5, 1.4]] {
            let [a, b] = kilovolts;
            let told = format!("rest at {a} and {b} kV in place of 1.7 and 1.6 kV");
            all.push((problem, vec![], vec![rest(muscles, kilovolts)], told));
        }
    }
    for problem in ["pair", "pair_time"] {
        for volts in [1650, 1500] {
            let goal = json!({ "rest_at_voltages": { "muscle2": volts } });
            let told = format!("rest at {volts} V in place of 1700 V");
            all.push((problem, vec![], vec![format!("control.goal={goal}")], told));
        }
    }
    all.push((
        "elephant_trunk_effort",
        vec![],
        vec![],
        "its own solution".to_owned(),
    ));
    all
}

/// The table of starts from solutions, and iterations of all of them from solutions and from guesses.
fn of_solutions() -> (String, [u64; 2]) {
    let mut out = String::from(
        "## From a solution\n\n| problem | change | from the guess | from the solution | optimum |\n|:--|:--|--:|--:|:--|\n",
    );
    let mut sums = [0, 0];
    for (problem, before, after, told) in cases() {
        let earlier = solve(problem, &before);
        let cold = solve(problem, &after);
        let path = earlier.folder.path().join("out/solution.json");
        let guess = format!("control.guess={}", json!({ "solution": path }));
        let warm = solve(problem, &[after, vec![guess]].concat());
        writeln!(
            out,
            "| `{problem}` | {told} | {} | {} | {} |",
            cold.iterations,
            warm.iterations,
            compared(&warm, &cold)
        )
        .expect("a text grows");
        sums[0] += warm.iterations;
        sums[1] += cold.iterations;
    }
    (out, sums)
}

/// Compares an optimum with another one, in a word.
fn compared(one: &Ended, other: &Ended) -> &'static str {
    match one.objective / other.objective - 1.0 {
        _ if !one.is_solved => "not solved",
        _ if !other.is_solved => "not solved from the guess",
        part if part > OTHER => "worse",
        part if part < -OTHER => "better",
        _ => "the same",
    }
}

/// The table of random goals from simulations under the voltages of the goal, and what it shows.
fn of_simulations(count: usize) -> (String, String) {
    let mut goals = Goals::new(SEED);
    let mut all = [Vec::new(), Vec::new()];
    let (mut fewer, mut words) = (0, Vec::new());
    for _ in 0..count {
        let goal = goals.draw(Kind::Rest).json;
        let voltages = goal["rest_at_voltages"].clone();
        let guess = json!({ "simulate": { "voltages": voltages } });
        let goal = format!("control.goal={goal}");
        let cold = solve("elephant_trunk_effort", std::slice::from_ref(&goal));
        let guess = format!("control.guess={guess}");
        let simulated = solve("elephant_trunk_effort", &[goal, guess]);
        words.push(compared(&simulated, &cold));
        if cold.is_solved && simulated.is_solved {
            fewer += usize::from(simulated.iterations < cold.iterations);
            all[0].push(cold.iterations);
            all[1].push(simulated.iterations);
        }
    }
    let quantiles = |list: &mut Vec<u64>| {
        list.sort_unstable();
        let last = list.len().saturating_sub(1);
        [0.1, 0.5, 0.9, 1.0].map(|part| list[(part * last as f64).round() as usize])
    };
    let [cold, simulated] = all.each_mut().map(quantiles);
    let row = |name: &str, [a, b, c, d]: [u64; 4]| format!("| {name} | {a} | {b} | {c} | {d} |\n");
    let named = |word: &str| words.iter().filter(|w| **w == word).count();
    let out = format!(
        "## From a simulation\n\n\
         {count} random rests of `elephant_trunk_effort` as in [random goals](random_goals/random_goals.md); the guess is interpolated, or a simulation \
         under the voltages of the goal. From the simulation {fewer} of {} take fewer iterations, {} end at a better optimum, {} at a worse one, {} are not solved.\n\n\
         | guess | iterations: 10 % | median | 90 % | most |\n|:--|--:|--:|--:|--:|\n{}{}",
        all[0].len(),
        named("better"),
        named("worse"),
        named("not solved"),
        row("interpolated", cold),
        row("simulated", simulated),
    );
    let told = format!(
        "A simulation as a guess takes {} iterations in the median of {count} random goals, the interpolated guess {}.",
        simulated[1], cold[1]
    );
    (out, told)
}

/// Solves a problem with changes, in a process.
fn solve(problem: &str, changes: &[String]) -> Ended {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("out");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{problem}.json"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_proboscis"));
    command.arg("solve").arg(file).arg("--quiet");
    command.arg("-o").arg(&output);
    for change in changes {
        command.arg("--set").arg(change);
    }
    let done = command.output().expect("the program can be run");
    let told = String::from_utf8_lossy(&done.stderr);
    let text = fs::read_to_string(output.join("summary.json"));
    let text = text.unwrap_or_else(|_| panic!("{problem} {changes:?}: {told}"));
    let summary: Value = serde_json::from_str(&text).expect("a summary");
    Ended {
        folder,
        is_solved: done.status.success(),
        iterations: summary["iterations"].as_u64().expect("a number"),
        objective: summary["objective"].as_f64().expect("a number"),
    }
}
