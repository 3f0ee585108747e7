//! A dielectric block of finite elements: what one Newton iteration and one step cost, against the bare factorisation.
//!
//! `cargo bench --bench block` measures 8 × 8 × 32 elements; other sizes are given as the number n of n × n × 4n elements,
//! `cargo bench --bench block -- 16`. Numbers of one run are compared with each other, never with those of another.

use nalgebra::Vector3;
use proboscis::dynamics::{Newton, Solving, Start, Stepper};
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{
    Electric, Electrode, ElementKind, Material, Potential, Solid, Support, System,
    VACUUM_PERMITTIVITY,
};
use proboscis::sparse::Backend;
use std::time::Instant;

/// Step in ms.
const STEP: f64 = 0.5;
/// Voltage in V, over layers of 10 mm.
const VOLTAGE: f64 = 3e5;
/// From this size on only the symmetric tangent is measured.
const LARGE: usize = 12;
/// Steps that are averaged.
const STEPS: usize = 20;

fn block(n: usize, viscosity: Option<f64>) -> System {
    let mesh = Grid::uniform(
        Vector3::zeros(),
        Vector3::new(10.0, 10.0, 40.0),
        [n, n, 4 * n],
    )
    .mesh();
    let electrode = |layer: usize| Electrode {
        name: format!("e{layer}"),
        nodes: mesh.nodes_on_plane(2, 10.0 * layer as f64, 1e-9),
        potential: match layer % 2 {
            0 => Potential::Given(0.0),
            _ => Potential::Driven {
                source: 0,
                factor: 1.0,
            },
        },
    };
    let material = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(0.4),
        electric: Some(Electric {
            c1: -2.0 * VACUUM_PERMITTIVITY,
            c2: VACUUM_PERMITTIVITY,
            permittivity: VACUUM_PERMITTIVITY,
        }),
        viscosity,
    };
    let solid = Solid {
        name: "block".into(),
        materials: vec![material],
        element: ElementKind::Hex8,
        electrodes: (0..5).map(electrode).collect(),
        supports: vec![Support {
            nodes: mesh.sets["z_min"].clone(),
            held: [true; 3],
        }],
        glued: Vec::new(),
        velocities: Vec::new(),
        mesh,
    };
    System {
        name: "block".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        muscles: Vec::new(),
        solids: vec![solid],
        markers: Vec::new(),
        gravity: None,
    }
}

fn main() {
    let given: Vec<usize> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let sizes = if given.is_empty() { vec![8] } else { given };
    println!(
        "| elements | unknowns | viscous | solver | set-up, s | assembly, s | factorisation, s | by MUMPS, s | solution, s | iteration / (factorisation + solution) | full Newton step, s | reused: s a step | reused step / factorisation, / that of MUMPS | factorisations, iterations of {STEPS} steps |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for n in sizes {
        row(n, None);
        if n < LARGE {
            row(n, Some(1.0));
        }
    }
}

fn row(n: usize, viscosity: Option<f64>) {
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
        newton: Newton::Reused,
        ..Solving::default()
    };
    let mut reused = Stepper::new(&model, &start.z, &start.momentum, reuse);
    let began = Instant::now();
    for _ in 0..STEPS {
        reused.step(STEP, &[VOLTAGE]).unwrap();
    }
    let average = began.elapsed().as_secs_f64() / STEPS as f64;
    let report = reused.report();
    println!(
        "| {n} × {n} × {} | {} | {} | {} | {setup:.2} | {assembly:.3} | {factorisation:.3} | {mumps:.3} | {solution:.3} | {ratio:.2} | {step:.2} | {average:.3} | {:.2}, {:.2} | {}, {} |",
        4 * n,
        model.action.motion.unknowns() + model.potentials,
        if viscosity.is_some() { "yes" } else { "no" },
        reused.solver(),
        average / factorisation,
        average / mumps,
        report.factorisations,
        report.iterations,
    );
}
