//! Laws of blocks in motion: energy without drift, its exact balance in every step, Gauss's law, momenta.

use crate::common::solid::{VOLTAGE, clamped, crooked, placed, system};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proboscis::dynamics::{
    DiscreteTrajectory, Newton, Solving, Start, Stepper, energies, observations, simulate,
};
use proboscis::mesh::Mesh;
use proboscis::model::Model;
use proboscis::model::system::{ElectricConstants, Electrode, Solid};
use std::ops::ControlFlow;

fn run(solid: Solid, h: f64, steps: usize, voltage: f64) -> (Model, DiscreteTrajectory) {
    let model = Model::new(system(vec![solid]), None, h, &[]).unwrap();
    let z = model.coordinates_at(&[]);
    let start = match model.node_rates() {
        Some(rates) => Start::with_rates(&model, z, &rates),
        None => Start::at_rest(&model, z),
    };
    let (discrete, failure) = simulate(
        &model,
        &start,
        h,
        steps,
        |_, _| vec![voltage],
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    assert_eq!(discrete.report.halved, 0);
    (model, discrete)
}

/// One Gauss point of a hexahedron: shape functions, their gradients in the reference, weight.
struct Point {
    values: [f64; 8],
    gradients: [Vector3<f64>; 8],
    weight: f64,
}

/// The eight Gauss points of a hexahedron at places in the reference.
fn points(nodes: &[Vector3<f64>; 8]) -> Vec<Point> {
    let corner = |i: usize| {
        let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][i % 4];
        Vector3::new(x, y, if i < 4 { -1.0 } else { 1.0 })
    };
    let point = |g: usize| {
        let at = corner(g) / 3.0_f64.sqrt();
        let parts = |i: usize| corner(i).component_mul(&at).add_scalar(1.0) * 0.5;
        let slopes: [Vector3<f64>; 8] = std::array::from_fn(|i| {
            let (c, p) = (corner(i) * 0.5, parts(i));
            Vector3::new(c.x * p.y * p.z, p.x * c.y * p.z, p.x * p.y * c.z)
        });
        let jacobian: Matrix3<f64> = (0..8).map(|i| nodes[i] * slopes[i].transpose()).sum();
        let back = jacobian.try_inverse().unwrap().transpose();
        Point {
            values: std::array::from_fn(|i| parts(i).product()),
            gradients: slopes.map(|s| back * s),
            weight: jacobian.determinant(),
        }
    };
    (0..8).map(point).collect()
}

/// The consistent mass of a mesh between its nodes.
fn mass(mesh: &Mesh, density: f64) -> DMatrix<f64> {
    let mut mass = DMatrix::zeros(mesh.nodes.len(), mesh.nodes.len());
    for nodes in &mesh.hexahedra {
        for p in points(&nodes.map(|n| mesh.nodes[n])) {
            for (i, &a) in nodes.iter().enumerate() {
                for (j, &b) in nodes.iter().enumerate() {
                    mass[(a, b)] += density * p.values[i] * p.values[j] * p.weight;
                }
            }
        }
    }
    mass
}

/// ∂V/∂x and −∂V/∂φ of all nodes at places x under potentials φ, and the viscous forces on nodes that move with v.
fn loads(
    solid: &Solid,
    x: &[Vector3<f64>],
    phi: &[f64],
    v: &[Vector3<f64>],
) -> (Vec<Vector3<f64>>, Vec<f64>, Vec<Vector3<f64>>) {
    let material = &solid.materials[0];
    let (mu, lambda) = (material.shear_modulus, material.lame_lambda.unwrap());
    let ElectricConstants {
        c1,
        c2,
        permittivity: eps,
    } = material.electric.unwrap();
    let eta = material.viscosity.unwrap_or(0.0);
    let mut slopes = vec![Vector3::zeros(); x.len()];
    let mut charges = vec![0.0; x.len()];
    let mut viscous = vec![Vector3::zeros(); x.len()];
    for nodes in &solid.mesh.hexahedra {
        for p in points(&nodes.map(|n| solid.mesh.nodes[n])) {
            let each = || nodes.iter().zip(&p.gradients);
            let f: Matrix3<f64> = each().map(|(&n, g)| x[n] * g.transpose()).sum();
            let rate: Matrix3<f64> = each().map(|(&n, g)| v[n] * g.transpose()).sum();
            let field: Vector3<f64> = each().map(|(&n, g)| g * -phi[n]).sum();
            let (j, inverse) = (f.determinant(), f.try_inverse().unwrap());
            let back = inverse.transpose();
            let e = back * field;
            let w = inverse * e;
            let stress = (f - back) * mu
                + back * (lambda * j.ln())
                + f * field * field.transpose() * (2.0 * c2)
                + (e * w.transpose() - back * (0.5 * e.norm_squared())) * (eps * j);
            let displacement =
                field * (-2.0 * c1) - f.transpose() * f * field * (2.0 * c2) + w * (eps * j);
            let d = (rate * inverse).symmetric_part();
            let friction = d * back * (eta * j);
            for (&n, g) in each() {
                slopes[n] += stress * g * p.weight;
                charges[n] -= displacement.dot(g) * p.weight;
                viscous[n] -= friction * g * p.weight;
            }
        }
    }
    (slopes, charges, viscous)
}

/// Midpoint and rate of two instants.
fn interval(
    model: &Model,
    discrete: &DiscreteTrajectory,
    k: usize,
    h: f64,
) -> [Vec<Vector3<f64>>; 2] {
    let [a, b] = [k, k + 1].map(|k| placed(model, &discrete.z[k]));
    let pairs = || a.iter().zip(&b);
    let middle = pairs().map(|(a, b)| (a + b) * 0.5).collect();
    [middle, pairs().map(|(a, b)| (b - a) / h).collect()]
}

#[test]
fn the_balance_of_energy_closes_in_every_step() {
    let h = 0.1;
    let (steps, solid) = (60, clamped(Some(0.02)));
    let (model, discrete) = run(solid.clone(), h, steps, VOLTAGE);
    // All nodes above the clamped face have three coordinates each, in the order of the mesh.
    let free: Vec<usize> = (0..solid.mesh.nodes.len())
        .filter(|n| !solid.supports[0].nodes.contains(n))
        .collect();
    let of_nodes = &model.action.map.of_nodes;
    assert_eq!(of_nodes.len(), 3 * free.len());
    let mass = mass(&solid.mesh, 1e-3)
        .select_rows(&free)
        .select_columns(&free);
    let inverse = mass.cholesky().unwrap().inverse();
    let kinetic = |momentum: &[f64]| {
        let of = |axis: usize| {
            let mut p = DVector::zeros(free.len());
            for (&(node, a), value) in of_nodes.iter().zip(momentum) {
                if a == axis {
                    p[node] = *value;
                }
            }
            0.5 * p.dot(&(&inverse * &p))
        };
        of(0) + of(1) + of(2)
    };
    let (mut largest, mut worst, mut dissipated) = (0.0_f64, 0.0_f64, 0.0);
    let seen = observations(&model, &discrete).columns;
    let column = |name: &str| &seen.iter().find(|c| c.name == name).unwrap().values;
    for k in 0..steps {
        let [middle, rates] = interval(&model, &discrete, k, h);
        let phi = model.solids[0].potentials(&discrete.scalars[k]);
        let (slopes, _, viscous) = loads(&solid, &middle, &phi, &rates);
        let work = |forces: &[Vector3<f64>]| -> f64 {
            h * forces
                .iter()
                .zip(&rates)
                .map(|(f, v)| f.dot(v))
                .sum::<f64>()
        };
        let [before, after] = [k, k + 1].map(|k| kinetic(&discrete.momenta[k]));
        let lost = -work(&viscous);
        assert!(lost >= 0.0);
        dissipated += lost;
        largest = largest.max(after).max(work(&slopes).abs());
        worst = worst.max((after - before + work(&slopes) + lost).abs());
        let other = column("dissipated_energy")[k + 1];
        assert!(
            (dissipated - other).abs() < 1e-11 * dissipated,
            "{dissipated} {other}"
        );
    }
    println!("balance: {worst:e} of {largest}, {dissipated} dissipated");
    assert!(dissipated > 0.05 * largest && largest > 0.1);
    assert!(worst < 1e-12 * largest, "{worst:e}");
}

#[test]
fn gauss_holds_in_every_interval() {
    let (h, steps) = (0.1, 40);
    let solid = clamped(Some(0.02));
    let (model, discrete) = run(solid.clone(), h, steps, VOLTAGE);
    let seen = observations(&model, &discrete).columns;
    let column = |name: &str| &seen.iter().find(|c| c.name == name).unwrap().values;
    let mut island = (f64::INFINITY, 0.0_f64);
    let mut before = None;
    for k in 0..steps {
        let [middle, rates] = interval(&model, &discrete, k, h);
        let phi = model.solids[0].potentials(&discrete.scalars[k]);
        let (_, charges, _) = loads(&solid, &middle, &phi, &rates);
        let of = |e: &Electrode| e.nodes.iter().map(|&n| charges[n]).sum::<f64>();
        let [bottom, floating, top] = [0, 1, 2].map(|e| of(&solid.electrodes[e]));
        let parts: f64 = solid.electrodes[1]
            .nodes
            .iter()
            .map(|&n| charges[n].abs())
            .sum();
        assert!(top > 1e-5, "{top}");
        assert!(parts > 1e-2 * top, "the island is polarised: {parts:e}");
        // The potential of the island follows the motion.
        let potential = phi[solid.electrodes[1].nodes[0]];
        island = (island.0.min(potential), island.1.max(potential));
        // Tables hold charges at instants: the mean of the intervals that meet there.
        let here = [bottom, floating, top];
        for (e, name) in ["bottom", "island", "top"].into_iter().enumerate() {
            let Some(before) = before else { break };
            let before: [f64; 3] = before;
            let charge = 0.5 * (before[e] + here[e]);
            let other = column(&format!("block_{name}_charge"))[k];
            assert!(
                (charge - other).abs() < 1e-11 * top,
                "{name}: {charge:e} {other:e}"
            );
        }
        before = Some(here);
        assert!(floating.abs() < 1e-11 * top, "{floating:e}");
        assert!((bottom + top).abs() < 1e-11 * top);
        for (n, charge) in charges.iter().enumerate() {
            if solid.electrodes.iter().all(|e| !e.nodes.contains(&n)) {
                assert!(charge.abs() < 1e-11 * top, "node {n}: {charge:e}");
            }
        }
    }
    assert!(island.0 > 0.3 * VOLTAGE && island.1 < 0.7 * VOLTAGE);
    assert!(island.1 - island.0 > 1e-3 * VOLTAGE, "{island:?}");
}

#[test]
fn a_free_block_keeps_its_momenta() {
    let mut solid = crooked(Some(0.02));
    let omega = Vector3::new(0.2, -0.4, 0.3);
    let velocity = |x: &Vector3<f64>| omega.cross(x) + Vector3::new(0.5, 0.0, 0.02 * x.z);
    solid.velocities = solid.mesh.nodes.iter().map(velocity).collect();
    let (steps, volume) = (200, 2000.0);
    let (model, discrete) = run(solid, 0.1, steps, VOLTAGE);
    let seen = observations(&model, &discrete).columns;
    let column = |name: &str| &seen.iter().find(|c| c.name == name).unwrap().values;
    assert!(column("dissipated_energy")[steps] > 0.3);
    let turned = |k: usize| {
        let x = placed(&model, &discrete.z[k]);
        (x[44] - x[0]).normalize()
    };
    assert!(
        (0..steps).any(|k| turned(k).dot(&turned(0)) < -0.5),
        "the block turns over"
    );
    // Masses of the block, at a place some 20 mm from the origin and moving with some mm/ms.
    let scale = 1e-3 * volume * 5.0;
    for (name, size) in [
        ("linear_momentum", scale),
        ("angular_momentum", 20.0 * scale),
    ] {
        for axis in ["x", "y", "z"] {
            let list = column(&format!("{name}_{axis}"));
            let drift = list.iter().fold(0.0_f64, |m, v| m.max((v - list[0]).abs()));
            println!("{name} {axis}: {} moves by {drift:e}", list[0]);
            assert!(list[0].abs() > 1e-2 * size);
            assert!(
                drift < 4.0 * f64::EPSILON * steps as f64 * size,
                "{drift:e}"
            );
        }
    }
}

/// Mean of a list.
fn mean(list: &[f64]) -> f64 {
    list.iter().sum::<f64>() / list.len() as f64
}

#[test]
fn the_energy_of_an_elastic_block_does_not_drift() {
    // A fiftieth of the period of the first longitudinal mode, 4 L √(ρ/E).
    let h = 0.1;
    let model = Model::new(system(vec![clamped(None)]), None, h, &[]).unwrap();
    let steps = 10_000;
    let z = model.coordinates_at(&[]);
    let momentum = vec![0.0; z.len()];
    // The steps are the same to rounding, and cost a fraction.
    let solving = Solving {
        newton: Newton::Modified,
        ..Solving::default()
    };
    let mut stepper = Stepper::new(&model, &z, &momentum, solving);
    let mut before = stepper.instant().clone();
    let mut errors = Vec::new();
    let (mut kinetic, mut first) = (0.0_f64, None);
    for _ in 0..steps {
        stepper.step(h, &[0.5 * VOLTAGE]).unwrap();
        let energy = energies(&model, &before, stepper.instant(), stepper.scalars(), h);
        kinetic = kinetic.max(energy.kinetic);
        errors.push(energy.total() - *first.get_or_insert(energy.total()));
        before.clone_from(stepper.instant());
    }
    assert_eq!(stepper.report().halved, 0);
    let m = mean(&errors);
    let square = |e: &f64| (e - m).powi(2);
    let deviation = mean(&errors.iter().map(square).collect::<Vec<_>>()).sqrt();
    // What the regression line climbs over the whole time; an error that grows evenly has √12 deviations.
    let centred = |i: usize| (i as f64 + 0.5) / steps as f64 - 0.5;
    let products = errors.iter().enumerate().map(|(i, e)| centred(i) * e);
    let climb = 12.0 * products.sum::<f64>() / steps as f64;
    let [early, late] = [&errors[..steps / 2], &errors[steps / 2..]]
        .map(|half| half.iter().fold(0.0_f64, |m, e| m.max(e.abs())));
    println!(
        "kinetic {kinetic}, deviation {deviation:e}, climb {climb:e}, bound {early:e}, {late:e}"
    );
    assert!(kinetic > 0.04);
    // The energy at midpoints errs by O(h²) of each mode, and wanders as modes exchange energy.
    assert!(
        deviation > 1e-5 * kinetic,
        "the test needs errors that could drift"
    );
    assert!(early.max(late) < 1e-3 * kinetic);
    assert!(late < 1.3 * early);
    assert!(climb.abs() < 1.2 * deviation);
}
