//! One thread and two give the same bits.

mod common;

use common::cases::{control, open_end, rest_to_rest};
use common::solid::{DRIVEN, electrode, held};
use common::systems::blocks;
use common::trunk;
use nalgebra::Vector3;
use proboscis::control::problem::Control;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::dynamics::{Start, simulate};
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{Potential, System};
use proboscis::nlp::Nlp;
use std::ops::ControlFlow;

/// Rows, Jacobian and Hessian of the trunk at a point between guess and noise.
fn values() -> [Vec<f64>; 3] {
    let (intervals, duration) = (64, 600.0);
    let control = rest_to_rest(3, intervals, duration);
    of_program(&trunk(3), &control, duration / intervals as f64)
}

fn of_program(system: &System, control: &Control, h: f64) -> [Vec<f64>; 3] {
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let mut x = program.start(&initial).x;
    for (i, value) in x.iter_mut().enumerate() {
        *value += 0.01 * (i as f64).sin();
    }
    let costates: Vec<f64> = (0..program.constraints().lower.len())
        .map(|i| (i as f64).cos())
        .collect();
    let mut rows = vec![0.0; costates.len()];
    let mut jacobian = vec![0.0; program.jacobian_structure().rows.len()];
    let mut hessian = vec![0.0; program.hessian_structure().rows.len()];
    program.constraint(&x, &mut rows);
    program.jacobian(&x, &mut jacobian);
    program.hessian(&x, 0.7, &costates, &mut hessian);
    [rows, jacobian, hessian]
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let pair = std::thread::spawn(values).join().unwrap();
    // A thread that belongs to a pool already gets no helper.
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap()
        .install(values);
    assert!(pair.iter().all(|list| list.iter().any(|v| v.abs() > 1e-3)));
    for (a, b) in pair.iter().flatten().zip(alone.iter().flatten()) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
}

/// A clamped block of 320 elements: more than one stretch of elements that a thread takes.
fn large() -> System {
    let size = Vector3::new(16.0, 16.0, 10.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [8, 8, 5]).mesh();
    let mut solid = common::solid::block(mesh, blocks().muscles[0].material);
    let mesh = &solid.mesh;
    solid.supports = vec![held(mesh, "z_min", [true; 3])];
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        electrode(mesh, "top", 10.0, DRIVEN),
    ];
    common::solid::system(vec![solid])
}

#[test]
fn a_large_block_has_the_same_bits_on_one_thread_and_two() {
    let motion = || {
        let model = Model::new(large(), None, 0.5, &[]).unwrap();
        let start = Start::at_rest(&model, model.coordinates_at(&[]));
        let (history, failure) = simulate(
            &model,
            &start,
            0.5,
            3,
            |_, _| vec![2e5],
            |_| ControlFlow::Continue(()),
        );
        assert_eq!(failure, None);
        let z = |k: usize| history.z[k].iter().zip(&history.z[0]).map(|(a, b)| a - b);
        [
            z(3).collect(),
            history.momenta[3].clone(),
            history.scalars[2].clone(),
        ]
    };
    let program = || {
        let system = large();
        let control = Control {
            goal: open_end(),
            ..control(&system, 2)
        };
        of_program(&system, &control, 10.0)
    };
    let runs: [&(dyn Fn() -> [Vec<f64>; 3] + Sync); 2] = [&motion, &program];
    for run in runs {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(run)
        });
        let sizes = one
            .iter()
            .map(|list| list.iter().filter(|v| v.abs() > 1e-9).count());
        assert!(
            sizes.clone().all(|count| count > 100),
            "{:?}",
            sizes.collect::<Vec<_>>()
        );
        for (a, b) in one.iter().flatten().zip(two.iter().flatten()) {
            assert_eq!(a.to_bits(), b.to_bits());
        }
    }
}
