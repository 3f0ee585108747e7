//! Blocks that are refused by name, and losses of stability that are found: floating, inverted, pulled in, buckled blocks.

use crate::common::solid::{DRIVEN, block, dielectric, electrode, held, placed, system};
use nalgebra::Vector3;
use proboscis::dynamics::{
    DiscreteTrajectory, EquilibriumError, Instability, PathStop, Start, StepError, continuation,
    equilibrium, simulate,
};
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{
    ElectricConstants, Material, Potential, Solid, System, VACUUM_PERMITTIVITY,
};
use proboscis::model::{Model, ModelError};
use std::ops::ControlFlow;

fn silicone() -> Material {
    let electric = ElectricConstants {
        c1: -2.0 * VACUUM_PERMITTIVITY,
        c2: VACUUM_PERMITTIVITY,
        permittivity: VACUUM_PERMITTIVITY,
    };
    Material {
        density: Some(1e-3),
        viscosity: Some(0.02),
        ..dielectric(0.1, 0.5, electric)
    }
}

fn bare(elements: [usize; 3]) -> Solid {
    let size = Vector3::new(10.0, 12.0, 20.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, elements).mesh();
    block(mesh, silicone())
}

/// The motion that is named where no equilibrium is unique.
fn free_motion(change: impl Fn(&mut Solid)) -> String {
    let mut solid = bare([2, 1, 2]);
    change(&mut solid);
    let model = Model::new(system(vec![solid]), None, 1.0, &[]).unwrap();
    let refused = equilibrium(&model, &model.coordinates_at(&[]), &[]).unwrap_err();
    let message = refused.to_string();
    let EquilibriumError::Floating { name, motion } = refused else {
        panic!("{refused}");
    };
    assert_eq!(name, "block");
    assert!(
        message.contains("block") && message.contains(&motion),
        "{message}"
    );
    motion
}

#[test]
fn a_block_that_floats_is_named_with_its_motion() {
    let rollers = |faces: &'static [(&'static str, usize)]| {
        move |solid: &mut Solid| {
            for &(face, axis) in faces {
                let mut directions = [false; 3];
                directions[axis] = true;
                solid.supports.push(held(&solid.mesh, face, directions));
            }
        }
    };
    let any = free_motion(|_| {});
    assert!(
        any.starts_with("translation") || any.starts_with("rotation"),
        "{any}"
    );
    assert_eq!(
        free_motion(rollers(&[("y_min", 1), ("z_min", 2)])),
        "translation along x"
    );
    assert_eq!(
        free_motion(rollers(&[("x_min", 0), ("z_max", 2)])),
        "translation along y"
    );
    assert_eq!(
        free_motion(rollers(&[("x_min", 0), ("y_max", 1)])),
        "translation along z"
    );
    // All three translations are held, but it turns about the line that is held.
    for (axis, lines) in [("x", [1, 2]), ("y", [0, 2]), ("z", [0, 1])] {
        let on_line = |solid: &mut Solid| {
            let mesh = &solid.mesh;
            let on = |n: &usize| lines.iter().all(|&axis| mesh.nodes[*n][axis] == 0.0);
            let mut support = held(mesh, "x_min", [true; 3]);
            support.nodes = (0..mesh.nodes.len()).filter(on).collect();
            assert!(support.nodes.len() > 1);
            solid.supports.push(support);
        };
        assert_eq!(free_motion(on_line), format!("rotation about {axis}"));
    }
    // With all rollers there is an equilibrium.
    let mut solid = bare([2, 1, 2]);
    rollers(&[("x_min", 0), ("y_min", 1), ("z_min", 2)])(&mut solid);
    let model = Model::new(system(vec![solid]), None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[]).unwrap();
    assert_eq!(found.is_stable(), Some(true));
}

#[test]
fn an_inverted_element_is_named() {
    let good = bare([1, 1, 3]);
    let mut inside_out = good.clone();
    inside_out.mesh.hexahedra[2].rotate_left(4);
    let mut pushed = good.clone();
    pushed.mesh.nodes[4].z = 25.0;
    let mut flat = good.clone();
    for node in 8..12 {
        flat.mesh.nodes[node].z = flat.mesh.nodes[node - 4].z;
    }
    for (solid, expected) in [(inside_out, 2), (pushed, 1), (flat, 1)] {
        let mut first = good.clone();
        first.name = "other".into();
        let refused = Model::new(system(vec![first, solid]), None, 1.0, &[]).err();
        let refused = refused.expect("an inverted element");
        let ModelError::Inverted { solid, element } = &refused else {
            panic!("{refused}");
        };
        assert_eq!((solid.as_str(), *element), ("block", expected));
        let message = refused.to_string();
        assert!(message.contains("\"block\"") && message.contains(&expected.to_string()));
    }
    assert!(Model::new(system(vec![good]), None, 1.0, &[]).is_ok());
}

/// Four layers of 10 mm, clamped below, guided above.
fn stack() -> System {
    let size = Vector3::new(10.0, 10.0, 40.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [2, 2, 8]).mesh();
    let mut solid = block(mesh, silicone());
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "z_min", [true; 3]),
        held(mesh, "z_max", [true, true, false]),
    ];
    solid.electrodes = (0..5)
        .map(|layer| {
            let potential = [Potential::Given(0.0), DRIVEN][layer % 2];
            electrode(mesh, &format!("e{layer}"), 10.0 * layer as f64, potential)
        })
        .collect();
    system(vec![solid])
}

#[test]
fn the_stack_pulls_in() {
    let model = Model::new(stack(), None, 1.0, &[]).unwrap();
    let asked = 2e6;
    let refused = equilibrium(&model, &model.coordinates_at(&[]), &[asked]).unwrap_err();
    println!("{refused}");
    assert!(refused.to_string().contains("pull-in: a limit point"));
    let EquilibriumError::LimitPoint { loss, last } = refused else {
        panic!("{refused}");
    };
    assert_eq!(loss.kind, Some(Instability::PullIn));
    let critical = loss.fraction * asked;
    assert_eq!(last.scalars[0], critical);
    // A free homogeneous block of relative permittivity 3 pulls in at 1.08149 √(μ/ε_r ε₀), a clamped one later.
    let homogeneous = 10.0 * 1.081_487_9 * (0.1 / (3.0 * VACUUM_PERMITTIVITY)).sqrt();
    println!("pull-in at {critical} V, without clamps {homogeneous} V");
    assert!(critical > 0.9 * homogeneous && critical < 1.3 * homogeneous);
    // The state is kept: it is where the path to a little less leads, and a little more is refused.
    let height = |z: &[f64]| placed(&model, z).last().unwrap().z;
    let before = equilibrium(
        &model,
        &model.coordinates_at(&[]),
        &[(1.0 - 1e-6) * critical],
    );
    let before = before.unwrap();
    assert_eq!(before.is_stable(), Some(true));
    let (at, near) = (height(&last.z), height(&before.z));
    println!("heights {at}, {near}");
    // Near a fold the state goes with the root of the voltage.
    assert!(at < 0.8 * 40.0 && near > at && near - at < 0.05 * 40.0);
    let beyond = equilibrium(&model, &last.z, &[(1.0 + 1e-5) * critical]);
    assert!(
        matches!(beyond, Err(EquilibriumError::LimitPoint { .. })),
        "{beyond:?}"
    );
}

/// Steps under a voltage, from a motion that makes the stack shorter by `speed` in mm/ms.
fn steps(
    h: f64,
    count: usize,
    voltage: f64,
    speed: f64,
) -> (Model, DiscreteTrajectory, Option<StepError>) {
    let model = Model::new(stack(), None, h, &[]).unwrap();
    let z = model.coordinates_at(&[]);
    let of_nodes = &model.action.map.of_nodes;
    let rate = |(&(_, axis), z): (&(usize, usize), &f64)| match axis {
        2 => -speed * z / 40.0,
        _ => 0.0,
    };
    let rates: Vec<f64> = of_nodes.iter().zip(&z).map(rate).collect();
    let start = Start::with_rates(&model, z, &rates);
    let (discrete, failure) = simulate(
        &model,
        &start,
        h,
        count,
        |_, _| vec![voltage],
        |_| ControlFlow::Continue(()),
    );
    let lists = [&discrete.z, &discrete.momenta, &discrete.scalars];
    assert!(lists.into_iter().flatten().flatten().all(|v| v.is_finite()));
    assert_eq!(discrete.times.len(), discrete.z.len());
    assert_eq!(discrete.times.len(), discrete.momenta.len());
    assert_eq!(discrete.times.len(), discrete.scalars.len() + 1);
    (model, discrete, failure)
}

#[test]
fn far_beyond_pull_in_a_motion_ends_without_nan() {
    for voltage in [8e5, 2e6, 1e8] {
        let (model, discrete, failure) = steps(0.2, 300, voltage, 0.0);
        let height = |k: usize| placed(&model, &discrete.z[k]).last().unwrap().z;
        let last = discrete.z.len() - 1;
        println!(
            "{voltage}: {last} steps to a height of {}, {failure:?}",
            height(last)
        );
        match failure {
            Some(
                StepError::NoConvergence { time, step, .. }
                | StepError::Inverted { time, step }
                | StepError::Reversed { time, step, .. }
                | StepError::BeyondLaw { time, step, .. }
                | StepError::Turned { time, step, .. }
                | StepError::Unbalanced { time, step, .. }
                | StepError::Inaccurate { time, step, .. }
                | StepError::Singular { time, step, .. },
            ) => {
                assert!(time >= discrete.times[last] && time < discrete.times[last] + 0.2);
                assert!(step < 0.2);
            }
            Some(error) => panic!("nobody watches, and there is no loop: {error}"),
            None => assert!(height(last) < 20.0),
        }
    }
}

#[test]
fn a_huge_step_is_halved_or_refused() {
    // Below the voltage of pull-in, thrown against its clamped face: a step of some periods is halved, one of very many is
    // refused, since no part of it closes its energy balance or converges; between them either is right.
    for (h, voltage, is_refused) in [
        (1e6, 3e5, Some(true)),
        (5.0, 6e5, Some(false)),
        (1e3, 6e5, None),
    ] {
        let (model, discrete, failure) = steps(h, 5, voltage, 5.0);
        println!("{h}: {} halved, {failure:?}", discrete.report.halved);
        assert!(discrete.report.halved > 0);
        assert_eq!(failure.is_some(), is_refused.unwrap_or(failure.is_some()));
        assert_eq!(discrete.scalars.len() < 5, failure.is_some());
        if let Some(error) = failure {
            let (StepError::NoConvergence { step, .. }
            | StepError::Unbalanced { step, .. }
            | StepError::Inverted { step, .. }) = error
            else {
                panic!("{error}");
            };
            assert_eq!(step, h / 1024.0);
            let message = error.to_string();
            assert!(
                message.contains(&format!("even with a step of {step} ms")),
                "{message}"
            );
        }
        let height = placed(&model, discrete.z.last().unwrap()).last().unwrap().z;
        assert!(height > 10.0 && height < 45.0, "{height}");
    }
}

/// A column 12 times as high as wide between two clamped faces, with a field across: it wants to grow and cannot.
fn column() -> Model {
    let size = Vector3::new(1.0, 1.2, 12.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [1, 1, 12]).mesh();
    let mut solid = block(mesh, silicone());
    let mesh = &solid.mesh;
    let side = |name: &str, face: &str, potential| proboscis::model::system::Electrode {
        circuit: None,
        name: name.into(),
        nodes: mesh.sets[face].clone(),
        potential,
    };
    solid.electrodes = vec![
        side("left", "x_min", Potential::Given(0.0)),
        side("right", "x_max", DRIVEN),
    ];
    solid.supports = vec![
        held(mesh, "z_min", [true; 3]),
        held(mesh, "z_max", [true; 3]),
    ];
    Model::new(system(vec![solid]), None, 0.2, &[]).unwrap()
}

/// Distance of the middle of the column from its axis.
fn aside(model: &Model, z: &[f64]) -> f64 {
    let places = placed(model, z);
    let middle = places[24..28].iter().sum::<Vector3<f64>>() / 4.0;
    (middle - Vector3::new(0.5, 0.6, 6.0)).norm()
}

#[test]
fn a_column_buckles_while_it_may_stay_straight() {
    let model = column();
    let largest = 6e4;
    let path = continuation(&model, &model.coordinates_at(&[]), &[largest], 60).unwrap();
    let is_lost = |stop: &PathStop| stop.lost.is_some();
    let index = path.iter().position(is_lost).expect("stability is lost");
    let (before, lost) = (&path[..index], &path[index]);
    println!("{} of {}", lost.fraction, path[path.len() - 1].fraction);
    assert_eq!(lost.lost, Some(Instability::Buckling));
    assert!(
        before
            .iter()
            .all(|stop| stop.rest.is_stable() == Some(true))
    );
    // Both neighbours enclose the voltage where it buckles.
    let stable_at = |voltage: f64| {
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[voltage]).unwrap();
        found.is_stable().unwrap()
    };
    let (mut low, mut high) = (
        before[index - 1].fraction * largest,
        lost.fraction * largest,
    );
    assert!(low < high && stable_at(low) && !stable_at(1.000_001 * high));
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        *(if stable_at(middle) {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    let critical = high;
    println!("buckles at {critical} V");
    for (voltage, stable) in [(0.9 * critical, true), (1.1 * critical, false)] {
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[voltage]).unwrap();
        assert_eq!(found.is_stable(), Some(stable), "{voltage}");
        println!("{voltage} V: {:?} unstable", found.unstable);
        // By symmetry the straight column is an equilibrium on both sides.
        assert!(aside(&model, &found.z) < 1e-9);
        // What inertia says is what a push aside does.
        let rates: Vec<f64> = model
            .action
            .map
            .of_nodes
            .iter()
            .map(|&(_, axis)| {
                if axis == 0 {
                    1e-4
                } else {
                    1.1e-4 * f64::from(u8::from(axis == 1))
                }
            })
            .collect();
        let start = Start::with_rates(&model, found.z.clone(), &rates);
        let (discrete, failure) = simulate(
            &model,
            &start,
            0.5,
            400,
            |_, _| vec![voltage],
            |_| ControlFlow::Continue(()),
        );
        assert_eq!(failure, None);
        let largest = discrete
            .z
            .iter()
            .map(|z| aside(&model, z))
            .fold(0.0, f64::max);
        let end = aside(&model, discrete.z.last().unwrap());
        println!("  pushed aside by {largest} mm, at the end {end} mm");
        assert!(largest > 1e-6);
        assert_eq!(end < 1e-4, stable);
        assert_eq!(end > 0.3, !stable);
    }
}

#[test]
fn buckling_is_found_where_stability_is_lost() {
    let model = column();
    let start = model.coordinates_at(&[]);
    let path = continuation(&model, &start, &[6e4], 60).unwrap();
    let mut lost = path.iter().filter(|stop| stop.lost.is_some());
    let &PathStop { fraction, lost, .. } = lost.next().unwrap();
    assert_eq!(lost, Some(Instability::Buckling));
    for (part, stable) in [(0.999, true), (1.001, false)] {
        let found = equilibrium(&model, &start, &[part * fraction * 6e4]).unwrap();
        assert_eq!(found.is_stable(), Some(stable), "{part} of {fraction}");
    }
}
