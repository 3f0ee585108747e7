//! Blocks in motion: reference motions, conservation, and the balance of energy.

use crate::common::solid::{block, material, mesh, numbers, reference, stack, system};
use nalgebra::Vector3;
use proboscis::dynamics::{
    DiscreteTrajectory, Newton, Solving, Start, observations, simulate, simulate_by,
};
use proboscis::functional::{Order, Sample};
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{Material, Solid, System};
use proboscis::model::{Model, Role};
use proboscis::sparse::Backend;
use serde_json::Value;
use std::ops::ControlFlow;

/// Steps of `h` ms under one voltage from rest or from the velocities of the blocks.
fn run(system: System, h: f64, steps: usize, voltages: &[f64]) -> (Model, DiscreteTrajectory) {
    let model = Model::new(system, None, h, &[]).unwrap();
    let z = model.coordinates_at(&[]);
    let start = match model.node_rates() {
        Some(rates) => Start::with_rates(&model, z, &rates),
        None => Start::at_rest(&model, z),
    };
    let constant = |_: f64, _: f64| voltages.to_vec();
    let (discrete, failure) = simulate(&model, &start, h, steps, constant, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    (model, discrete)
}

/// Places of the nodes of the first block at instant k.
fn places(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> Vec<Vector3<f64>> {
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(&discrete.z[k]);
    model.action.map.place(&mut instant);
    model.solids[0].places(&instant.x)
}

/// Compares the probes of all instants; `scale` is the size of the motion in mm.
fn compare(entry: &Value, model: &Model, discrete: &DiscreteTrajectory, scale: f64) -> f64 {
    let nodes = numbers(&entry["probe_nodes"]);
    let probes = entry["probe_u"].as_array().unwrap();
    let mut worst = 0.0_f64;
    let mut largest = 0.0_f64;
    for (k, row) in probes.iter().enumerate().take(discrete.z.len()) {
        let places = places(model, discrete, k);
        for (node, expected) in nodes.iter().zip(row.as_array().unwrap()) {
            let node = *node as usize;
            let moved = places[node] - model.solids[0].solid.mesh.nodes[node];
            let expected = Vector3::from_vec(numbers(expected)) * 1e3;
            worst = worst.max((moved - expected).amax() / scale);
            largest = largest.max(expected.amax() / scale);
        }
    }
    assert!(largest > 0.5, "the reference moves: {largest}");
    worst
}

#[test]
fn a_voltage_step_is_the_reference() {
    for entry in reference("caseD")["dynamic"].as_array().unwrap() {
        let coarse = numbers(&entry["mesh"]["elements"])[0] < 3.0;
        let steps = if coarse { 100 } else { 10 };
        let h = entry["h"].as_f64().unwrap() * 1e3;
        let (model, discrete) = run(stack(entry), h, steps, &[3e5]);
        let scale = if coarse { 3.0 } else { 1.0 };
        let worst = compare(entry, &model, &discrete, scale);
        assert!(worst < 1e-7, "{worst:e}");
    }
}

/// Case F: free flight with rotation and stretching.
fn flight(entry: &Value) -> System {
    let mut solid = block(mesh(entry), material(entry));
    let omega = Vector3::from_vec(numbers(&entry["omega"])) * 1e-3;
    let centre = Vector3::from_vec(numbers(&entry["Xc"])) * 1e3;
    let velocity =
        |x: &Vector3<f64>| omega.cross(&(x - centre)) + Vector3::z() * (0.5 * (x.z - 20.0) / 20.0);
    solid.velocities = solid.mesh.nodes.iter().map(velocity).collect();
    system(vec![solid])
}

#[test]
fn free_flight_is_the_reference_and_keeps_momenta() {
    for entry in reference("caseF")["runs"].as_array().unwrap() {
        let coarse = numbers(&entry["mesh"]["elements"])[0] < 3.0;
        let steps = if coarse { 500 } else { 15 };
        let (model, discrete) = run(flight(entry), 1.0, steps, &[]);
        let scale = if coarse { 10.0 } else { 1.0 };
        let worst = compare(entry, &model, &discrete, scale);
        assert!(worst < 1e-7, "{worst:e}");
        let columns = observations(&model, &discrete).columns;
        for name in ["linear_momentum", "angular_momentum"] {
            let of = |axis: &str| {
                let column = columns.iter().find(|c| c.name == format!("{name}_{axis}"));
                column.unwrap().values.clone()
            };
            let first: Vec<f64> = ["x", "y", "z"].iter().map(|a| of(a)[0]).collect();
            let size = if name == "angular_momentum" {
                let expected = numbers(&entry["summary"]["angmom0"]);
                for (found, expected) in first.iter().zip(&expected) {
                    // kg m²/s are 10⁶ g mm²/ms.
                    assert!((found / (expected * 1e6) - 1.0).abs() < 1e-9, "{found}");
                }
                11.0
            } else {
                2.0
            };
            for (axis, first) in ["x", "y", "z"].iter().zip(&first) {
                let drift = of(axis)
                    .iter()
                    .fold(0.0_f64, |m, v| m.max((v - first).abs()));
                assert!(drift < 1e-10 * size, "{name} {axis}: {drift:e}");
            }
        }
    }
}

#[test]
fn gauss_holds_in_every_interval_and_the_balance_closes() {
    let case = reference("caseD");
    let entries = case["dynamic"].as_array().unwrap();
    let viscous = |e: &&Value| {
        e["material"]["eta"].as_f64() > Some(0.0) && numbers(&e["mesh"]["elements"])[0] < 3.0
    };
    let entry = entries.iter().find(viscous).unwrap();
    let h = 0.5;
    let (model, discrete) = run(stack(entry), h, 60, &[3e5]);
    let (mut a, mut b) = (model.action.map.instant(), model.action.map.instant());
    let mut scratch = model.action.scratch(Order::Gradient);
    for k in 0..60 {
        for (instant, z) in [(&mut a, &discrete.z[k]), (&mut b, &discrete.z[k + 1])] {
            instant.z.copy_from_slice(z);
            model.action.map.place(instant);
        }
        let interval = Sample::of_interval(&discrete.scalars[k], h);
        model
            .action
            .evaluate_interval(Order::Gradient, [&mut a, &mut b], &interval, &mut scratch);
        let rows = &scratch.interval.plain.rows;
        // The charge on the electrodes in the units of the free rows.
        let charge = rows[0].abs() * model.variables.with(Role::Potential)[0].unit;
        assert!(charge > 0.1);
        for row in &rows[1..] {
            assert!(row.abs() < 1e-9 * charge, "{row:e} of {charge:e}");
        }
    }
    let columns = observations(&model, &discrete).columns;
    let column = |name: &str| {
        let found = columns.iter().find(|c| c.name == name);
        found.unwrap_or_else(|| panic!("{name}")).values.clone()
    };
    let dissipated = column("dissipated_energy");
    assert!(dissipated[60] > 1.0);
    assert!(dissipated.windows(2).all(|pair| pair[1] >= pair[0]));
}

#[test]
fn reused_tangents_and_other_solvers_give_the_same_motion() {
    let case = reference("caseD");
    for entry in case["dynamic"].as_array().unwrap() {
        if numbers(&entry["mesh"]["elements"])[0] > 2.0 {
            continue;
        }
        let steps = 20;
        let motion = |solving: Solving| {
            let model = Model::new(stack(entry), None, 0.5, &[]).unwrap();
            let start = Start::at_rest(&model, model.coordinates_at(&[]));
            let constant = |_: f64, _: f64| vec![3e5];
            let observer = |_: &_| ControlFlow::Continue(());
            let (discrete, failure) =
                simulate_by(solving, &model, &start, 0.5, steps, constant, observer);
            assert_eq!(failure, None);
            discrete
        };
        let full = motion(Solving::default());
        let moved = full.z[steps].iter().zip(&full.z[0]);
        assert!(moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 0.5);
        for (newton, backend) in [
            (Newton::Modified, None),
            (Newton::Full, Some(Backend::Mumps)),
            (Newton::Modified, Some(Backend::Mumps)),
        ] {
            let other = motion(Solving {
                newton,
                backend,
                ..Solving::default()
            });
            let apart = full.z[steps].iter().zip(&other.z[steps]);
            let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-6, "{newton:?} {backend:?}: {apart:e} mm");
            let is_viscous = material(entry).viscosity.is_some();
            let is_part = other.solver.ends_with("of the symmetric part");
            assert_eq!(
                is_part,
                is_viscous && (newton, backend) == (Newton::Modified, None)
            );
            if newton == Newton::Modified {
                assert!(other.report.factorisations < full.report.factorisations / 3);
                assert!(other.report.iterations > full.report.iterations);
            }
        }
    }
}

/// Steps of h ms of a block from the velocities of its nodes, without voltages.
fn released(solid: Solid, solving: Solving, h: f64, steps: usize) -> DiscreteTrajectory {
    let model = Model::new(system(vec![solid]), None, h, &[]).unwrap();
    let rates = model.node_rates().unwrap();
    let start = Start::with_rates(&model, model.coordinates_at(&[]), &rates);
    let observer = |_: &_| ControlFlow::Continue(());
    let none = |_: f64, _: f64| Vec::new();
    let (discrete, failure) = simulate_by(solving, &model, &start, h, steps, none, observer);
    assert_eq!(failure, None);
    discrete
}

/// A few long steps of a very viscous block of 40 mm that stretches and turns.
fn turning(newton: Newton) -> DiscreteTrajectory {
    let size = Vector3::new(10.0, 10.0, 40.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [2, 2, 8]).mesh();
    let soft = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(0.4),
        electric: None,
        viscosity: Some(100.0),
        ..Material::default()
    };
    let mut solid = block(mesh, soft);
    let turn = Vector3::new(0.02, 0.003, 0.04);
    let velocity = |x: &Vector3<f64>| {
        let arm = x - size / 2.0;
        turn.cross(&arm) + Vector3::new(0.0, 0.0, 0.025 * arm.z)
    };
    solid.velocities = solid.mesh.nodes.iter().map(velocity).collect();
    let solving = Solving {
        newton,
        ..Solving::default()
    };
    released(solid, solving, 1.0, 8)
}

#[test]
fn a_tangent_far_from_symmetric_is_factorised_whole() {
    let [full, other] = [Newton::Full, Newton::Modified].map(turning);
    let moved = full.z[8].iter().zip(&full.z[0]);
    assert!(moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 1.0);
    assert_eq!(other.solver, "faer LU");
    let apart = full.z[8].iter().zip(&other.z[8]);
    let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart:e} mm");
}

/// A few steps of a block of 5 568 unknowns that stretches and bends, viscous or not.
fn large(viscosity: Option<f64>, solving: Solving) -> DiscreteTrajectory {
    let size = Vector3::new(10.0, 10.0, 40.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [7, 7, 28]).mesh();
    let rubber = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(0.4),
        electric: None,
        viscosity,
        ..Material::default()
    };
    let mut solid = block(mesh, rubber);
    let lift = |x: &Vector3<f64>| Vector3::new(1e-3 * x.z * x.z, 0.0, 0.01 * x.z);
    solid.velocities = solid.mesh.nodes.iter().map(lift).collect();
    released(solid, solving, 0.5, 2)
}

#[test]
fn factors_in_single_precision_give_the_motion_of_those_in_double_precision() {
    for viscosity in [None, Some(1.0)] {
        let by = |newton, backend| {
            let solving = Solving {
                newton,
                backend,
                ..Solving::default()
            };
            large(viscosity, solving)
        };
        let single = by(Newton::Modified, None);
        let double = by(Newton::Full, Some(Backend::Mumps));
        assert!(
            single.solver.contains("single precision"),
            "{}",
            single.solver
        );
        assert_eq!(
            single.solver.contains("symmetric part"),
            viscosity.is_some()
        );
        assert!(single.report.factorisations < double.report.factorisations / 2);
        let largest = |a: &[f64], b: &[f64]| {
            let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            parts.fold(0.0, f64::max)
        };
        assert!(largest(&double.z[2], &double.z[0]) > 0.5);
        let apart = largest(&single.z[2], &double.z[2]);
        assert!(apart < 1e-7, "{apart:e} mm");
    }
}
