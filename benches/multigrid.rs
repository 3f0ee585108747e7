//! Steps and equilibria of large blocks by GMRES with multigrid: seconds, iterations and memory against the number of unknowns.
//!
//! `cargo bench --bench multigrid` measures 8 × 8 × 32 and 16 × 16 × 64 elements; other sizes are given as the number n of n × n × 4n
//! elements, `cargo bench --bench multigrid -- 24 40`; `--rest` measures equilibria in place of steps, `--direct` factorises. The peak of memory is
//! that of the process: one size at a time tells what it needs.

use proboscis::dynamics::{MultigridUse, Newton, Solving, Start, Stepper, stable_equilibrium_by};
use proboscis::model::Model;
use proboscis::sparse::Backend;
use shared::block;
use std::time::Instant;

mod shared;

/// Step in ms, and number of steps.
const STEP: f64 = 0.5;
const STEPS: usize = 3;
/// Voltage in V over layers of 10 mm, switched on at once.
const VOLTAGE: f64 = 3e5;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let given: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![8, 16] } else { given };
    let has = |name: &str| arguments.iter().any(|a| a == name);
    println!(
        "| elements | unknowns | | set-up, s | seconds | Newton, Krylov iterations | grids, MB | peak of memory, GB |\n|:--|--:|:--|--:|--:|--:|--:|--:|"
    );
    for n in sizes {
        if has("--rest") {
            rest(n);
            continue;
        }
        for viscosity in [Some(1.0), None] {
            steps(n, viscosity, has("--direct"));
        }
    }
}

/// Steps under a voltage that is switched on at once.
fn steps(n: usize, viscosity: Option<f64>, is_direct: bool) {
    let began = Instant::now();
    let model = Model::new(block(n, viscosity), None, STEP, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let solving = Solving {
        newton: Newton::Modified,
        backend: is_direct.then_some(Backend::Faer),
        multigrid: match is_direct {
            true => MultigridUse::WhereFaster,
            false => MultigridUse::Always,
        },
        ..Solving::default()
    };
    let mut stepper = Stepper::new(&model, &start.z, &start.momentum, solving);
    let setup = began.elapsed().as_secs_f64();
    let what = match viscosity {
        Some(_) => "viscous step of 0.5 ms",
        None => "step of 0.5 ms without viscosity",
    };
    for _ in 0..STEPS {
        let before = stepper.report();
        let began = Instant::now();
        stepper.step(STEP, &[VOLTAGE]).unwrap();
        let seconds = began.elapsed().as_secs_f64();
        let report = stepper.report();
        let spent = |f: fn(&proboscis::dynamics::StepperReport) -> f64| f(&report) - f(&before);
        println!(
            "| {n} × {n} × {} | {} | {what} | {setup:.1} | {seconds:.2} ({:.2}, {:.2}, {:.2}) | {}, {} | {} | {:.2} |",
            4 * n,
            model.variables.unknown_count(),
            spent(|r| r.assembly),
            spent(|r| r.factorisation),
            spent(|r| r.solution),
            report.iterations - before.iterations,
            report.multigrid.iterations - before.multigrid.iterations,
            report.multigrid.bytes / 1_000_000,
            peak(),
        );
    }
}

/// The stable equilibrium under all of the voltage.
fn rest(n: usize) {
    let began = Instant::now();
    let model = Model::new(block(n, None), None, 1.0, &[]).unwrap();
    let setup = began.elapsed().as_secs_f64();
    let began = Instant::now();
    let start = model.reference_coordinates();
    let found = stable_equilibrium_by(&model, &start, &[VOLTAGE], MultigridUse::Always).unwrap();
    let (report, _) = found.on_grids.unwrap();
    println!(
        "| {n} × {n} × {} | {} | equilibrium, stable: {:?} | {setup:.1} | {:.2} | {}, {} | {} | {:.2} |",
        4 * n,
        model.variables.unknown_count(),
        found.is_stable(),
        began.elapsed().as_secs_f64(),
        found.iterations,
        report.iterations,
        report.bytes / 1_000_000,
        peak(),
    );
}

/// Peak of the memory of this process in GB, where the system tells.
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.map_or(f64::NAN, |number| number.parse::<f64>().unwrap() / 1e6)
}
