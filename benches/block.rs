//! A dielectric block of finite elements: what one Newton iteration and one step cost, against the bare factorisation.
//!
//! `cargo bench --bench block` measures 8 × 8 × 32 elements; other sizes are given as the number n of n × n × 4n elements,
//! `cargo bench --bench block -- 16`; `--write` puts the tables into `benches/README.md`. Numbers of one run are compared with each other, never with those of another.

use nalgebra::Vector3;
use proboscis::dynamics::{Newton, Solving, Start, Stepper};
use proboscis::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Local, NodeState, Passive, Volume,
};
use proboscis::energy::NeoHooke;
use proboscis::model::Model;
use proboscis::model::system::VACUUM_PERMITTIVITY;
use proboscis::sparse::Backend;
use shared::block;
use std::hint::black_box;
use std::time::Instant;

mod shared;

/// Calls in a round, and rounds, of the measurement of one element.
const CALLS: u32 = 2000;
const ROUNDS: usize = 60;
/// Marks around the tables in `benches/README.md`.
const FROM: &str = "<!-- blocks -->";
const TO: &str = "<!-- end of blocks -->";
/// Step in ms.
const STEP: f64 = 0.5;
/// Voltage in V, over layers of 10 mm.
const VOLTAGE: f64 = 3e5;
/// Size from which on only the symmetric tangent is measured.
const LARGE: usize = 20;
/// Steps that are averaged.
const STEPS: usize = 20;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let given: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![8] } else { given };
    let mut text = element();
    text.push_str(
        "\n| elements | unknowns | viscous | solver of reused steps | set-up, s | assembly, s | factorisation, s | by MUMPS, s | solution, s | iteration / (factorisation + solution) | full Newton step, s | reused: s a step | / factorisation, / that of MUMPS | factorisations, iterations in 20 steps |\n\
         |:--|--:|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for n in sizes {
        text.push_str(&row(n, None));
        if n < LARGE {
            text.push_str(&row(n, Some(1.0)));
        }
    }
    println!("{text}");
    if arguments.iter().any(|a| a == "--write") {
        write(&text);
    }
}

/// Puts the tables into `benches/README.md`.
fn write(text: &str) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/README.md");
    let old = std::fs::read_to_string(path).unwrap();
    let (before, rest) = old.split_once(FROM).unwrap();
    let (_, after) = rest.split_once(TO).unwrap();
    std::fs::write(path, format!("{before}{FROM}\n\n{text}\n{TO}{after}")).unwrap();
}

/// Least time of one call in µs.
fn least(mut call: impl FnMut()) -> f64 {
    let round = |call: &mut dyn FnMut()| {
        let began = Instant::now();
        for _ in 0..CALLS {
            call();
        }
        began.elapsed().as_secs_f64() / f64::from(CALLS)
    };
    (0..ROUNDS)
        .map(|_| round(&mut call))
        .fold(f64::INFINITY, f64::min)
        * 1e6
}

/// One hexahedron on one core.
fn element() -> String {
    let places: [Vector3<f64>; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ]
    .map(Vector3::from);
    let shape = ElementGeometry::new(&places).unwrap();
    let x = places.map(|p| p + Vector3::new(0.03 * p.y * p.z, 0.02 * p.x, -0.05 * p.z));
    let potentials = places.map(|p| 2e4 * p.z);
    let mut rows = String::from(
        "| one hexahedron, one core, µs | residual | residual and tangent | with contracted third derivatives |\n|:--|--:|--:|--:|\n",
    );
    let mut passive = Local::default();
    let mut passive_along = Local::default();
    let mut dielectric = Local::default();
    let mut along = Local::default();
    for volume in [Volume::Pointwise, Volume::Mean] {
        let name = match volume {
            Volume::Pointwise => "hex8",
            Volume::Mean => "hex8_q1p0",
        };
        let law = Elastomer {
            shear_modulus: 0.1,
            lame_lambda: 0.4,
            volume,
            field: Passive,
            law: NeoHooke,
        };
        let at = NodeState::new(&shape, &x, &());
        let moving = at.along(&places, &());
        let times = [
            least(|| law.gradient(black_box(&at), &mut passive)),
            least(|| law.tangent(black_box(&at), &mut passive)),
            least(|| law.third(black_box(&moving), &mut passive, &mut passive_along)),
        ];
        rows.push_str(&line(&format!("elastic {name}"), times));
        let law = Elastomer {
            shear_modulus: 0.1,
            lame_lambda: 0.4,
            volume,
            field: Dielectric {
                c1: -2.0 * VACUUM_PERMITTIVITY,
                c2: VACUUM_PERMITTIVITY,
                permittivity: VACUUM_PERMITTIVITY,
            },
            law: NeoHooke,
        };
        let at = NodeState::new(&shape, &x, &potentials);
        let moving = at.along(&places, &potentials);
        let times = [
            least(|| law.gradient(black_box(&at), &mut dielectric)),
            least(|| law.tangent(black_box(&at), &mut dielectric)),
            least(|| law.third(black_box(&moving), &mut dielectric, &mut along)),
        ];
        rows.push_str(&line(&format!("dielectric {name}"), times));
    }
    rows.push_str("| target, dielectric | 1 | 5 | |\n");
    rows
}

fn line(name: &str, [a, b, c]: [f64; 3]) -> String {
    format!("| {name} | {a:.2} | {b:.2} | {c:.2} |\n")
}

fn row(n: usize, viscosity: Option<f64>) -> String {
    let began = Instant::now();
    let model = Model::new(block(n, viscosity), None, STEP, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let mut full = Stepper::new(&model, &start.z, &start.momentum, Solving::default());
    let setup = began.elapsed().as_secs_f64();
    full.step(STEP, &[VOLTAGE]).unwrap();
    let before = full.report();
    let began = Instant::now();
    full.step(STEP, &[VOLTAGE]).unwrap();
    let step = began.elapsed().as_secs_f64();
    let spent = full.report();
    let iterations = (spent.iterations - before.iterations) as f64;
    let part =
        |f: fn(&proboscis::dynamics::StepperReport) -> f64| (f(&spent) - f(&before)) / iterations;
    let assembly = part(|r| r.assembly);
    let factorisation = part(|r| r.factorisation);
    let solution = part(|r| r.solution);
    let ratio = (assembly + factorisation + solution) / (factorisation + solution);
    drop(full);
    let by_mumps = Solving {
        backend: Some(Backend::Mumps),
        ..Solving::default()
    };
    let mut peer = Stepper::new(&model, &start.z, &start.momentum, by_mumps);
    peer.step(STEP, &[VOLTAGE]).unwrap();
    let mumps = peer.report().factorisation / peer.report().factorisations as f64;
    drop(peer);
    let reuse = Solving {
        newton: Newton::Modified,
        ..Solving::default()
    };
    let mut reused = Stepper::new(&model, &start.z, &start.momentum, reuse);
    let began = Instant::now();
    for _ in 0..STEPS {
        reused.step(STEP, &[VOLTAGE]).unwrap();
    }
    let average = began.elapsed().as_secs_f64() / STEPS as f64;
    let report = reused.report();
    format!(
        "| {n} × {n} × {} | {} | {} | {} | {setup:.2} | {assembly:.3} | {factorisation:.3} | {mumps:.3} | {solution:.3} | {ratio:.2} | {step:.2} | {average:.3} | {:.2}, {:.2} | {}, {} |\n",
        4 * n,
        model.variables.unknown_count(),
        if viscosity.is_some() { "yes" } else { "no" },
        reused.solver(),
        average / factorisation,
        average / mumps,
        report.factorisations,
        report.iterations,
    )
}
