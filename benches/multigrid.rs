//! Steps and equilibria of large blocks by GMRES with multigrid: seconds, iterations and memory against the number of unknowns.
//!
//! `cargo bench --bench multigrid` measures 8 × 8 × 32 and 16 × 16 × 64 elements; other sizes are given as the number n of n × n × 4n
//! elements, `cargo bench --bench multigrid -- 24 40`; `--rest` measures equilibria in place of steps, `--direct` factorises, `--mesh` takes
//! a mesh that is no box.
//! `--stiff` measures mean dilatation in steps and at rest for ratios λ/μ from 10 to 10⁴ with n × n × 2n elements. The peak of memory is
//! that of the process: one size at a time tells what it needs.

use proboscis::dynamics::{MultigridUse, Newton, Solving, Start, Stepper, stable_equilibrium_by};
use proboscis::model::Model;
use proboscis::model::system::{ElementKind, System};
use proboscis::sparse::Backend;
use shared::{block, long_block};
use std::time::Instant;

mod shared;

/// Step in ms, and number of steps.
const STEP: f64 = 0.5;
const STEPS: usize = 3;
/// Voltage in V over layers of 10 mm, switched on at once.
const VOLTAGE: f64 = 3e5;
/// The same of nearly incompressible blocks.
const STIFF_STEPS: usize = 2;
const STIFF_VOLTAGE: f64 = 1e5;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let given: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![8, 16] } else { given };
    let has = |name: &str| arguments.iter().any(|a| a == name);
    println!(
        "| elements | unknowns | | set-up, s | seconds | Newton, Krylov iterations | grids, MB | peak of memory, GB |\n|:--|--:|:--|--:|--:|--:|--:|--:|"
    );
    for n in sizes {
        if has("--stiff") {
            stiff(n, has("--direct"), has("--mesh"));
            continue;
        }
        let system = |viscosity: Option<f64>| match has("--mesh") {
            true => without_box(block(n, viscosity), 10.0 / n as f64),
            false => block(n, viscosity),
        };
        if has("--rest") {
            rest(n, system(None));
            continue;
        }
        for viscosity in [Some(1.0), None] {
            steps(n, (viscosity, system(viscosity)), has("--direct"));
        }
    }
}

/// The same block on a mesh that is no box: elements in another order, and nodes between its faces and electrodes elsewhere by a part of the
/// edge of elements.
fn without_box(mut system: System, edge: f64) -> System {
    let mesh = &mut system.solids[0].mesh;
    mesh.hexahedra.reverse();
    mesh.regions.reverse();
    for (number, node) in mesh.nodes.iter_mut().enumerate() {
        let is_inside = |x: &f64| (x / 10.0 - (x / 10.0).round()).abs() > 1e-9;
        if node.iter().all(is_inside) {
            for (axis, place) in node.iter_mut().enumerate() {
                *place += 0.15 * edge * (12.9898 * number as f64 + 2.0 * axis as f64).sin();
            }
        }
    }
    system
}

fn solving(is_direct: bool) -> Solving {
    Solving {
        newton: Newton::Modified,
        backend: is_direct.then_some(Backend::Faer),
        multigrid: match is_direct {
            true => MultigridUse::WhereFaster,
            false => MultigridUse::Always,
        },
        ..Solving::default()
    }
}

/// Steps under a voltage that is switched on at once.
fn steps(n: usize, (viscosity, system): (Option<f64>, System), is_direct: bool) {
    let began = Instant::now();
    let model = Model::new(system, None, STEP, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let mut stepper = Stepper::new(&model, &start.z, &start.momentum, solving(is_direct));
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

/// Two steps, and the equilibrium, of blocks of mean dilatation.
fn stiff(n: usize, is_direct: bool, is_mesh: bool) {
    println!(
        "| elements | unknowns | λ/μ | | Newton, Krylov iterations | levels | systems by factors | seconds | peak of memory, GB |\n|:--|--:|--:|:--|--:|--:|--:|--:|--:|"
    );
    for ratio in [10.0, 100.0, 1e3, 1e4] {
        let mut system = long_block([n, n, 2 * n], None);
        if is_mesh {
            system = without_box(system, 10.0 / n as f64);
        }
        let solid = &mut system.solids[0];
        solid.element = ElementKind::Hex8Q1P0;
        for material in &mut solid.materials {
            material.lame_lambda = Some(ratio * material.shear_modulus);
        }
        for viscosity in [None, Some(1.0)] {
            system.solids[0].materials[0].viscosity = viscosity;
            let model = Model::new(system.clone(), None, STEP, &[]).unwrap();
            let start = Start::at_rest(&model, model.coordinates_at(&[]));
            let mut stepper = Stepper::new(&model, &start.z, &start.momentum, solving(is_direct));
            let began = Instant::now();
            for _ in 0..STIFF_STEPS {
                stepper.step(STEP, &[STIFF_VOLTAGE]).unwrap();
            }
            let report = stepper.report();
            let what = viscosity.map_or("two steps of 0.5 ms", |_| "the same, viscous");
            println!(
                "| {n} × {n} × {} | {} | {ratio} | {what} | {}, {} | {} | {} | {:.2} | {:.2} |",
                2 * n,
                model.variables.unknown_count(),
                report.iterations,
                report.multigrid.iterations,
                report.multigrid.levels,
                report.fallbacks,
                began.elapsed().as_secs_f64(),
                peak(),
            );
        }
        system.solids[0].materials[0].viscosity = None;
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let start = model.reference_coordinates();
        let by = match is_direct {
            true => MultigridUse::WhereFaster,
            false => MultigridUse::Always,
        };
        let began = Instant::now();
        let found = stable_equilibrium_by(&model, &start, &[STIFF_VOLTAGE], by);
        let seconds = began.elapsed().as_secs_f64();
        match found {
            Ok(found) => {
                let (report, fallbacks) = found.on_grids.unwrap_or_default();
                println!(
                    "| | | | equilibrium, stable: {:?} | {}, {} | {} | {fallbacks} | {seconds:.2} | {:.2} |",
                    found.is_stable(),
                    found.iterations,
                    report.iterations,
                    report.levels,
                    peak(),
                );
            }
            Err(error) => println!("| | | | {error} | | | | {seconds:.2} | {:.2} |", peak()),
        }
    }
}

/// The stable equilibrium under all of the voltage.
fn rest(n: usize, system: System) {
    let began = Instant::now();
    let model = Model::new(system, None, 1.0, &[]).unwrap();
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
