//! Steps and equilibria of blocks on meshes without a grid, by multigrid with smoothed aggregation.

use crate::common::solid::system;
use crate::common::stacks::{LENGTH, cubes, rubber, scattered, sliding, thin_layers};
use crate::multigrid::{MULTIGRID, apart, compare, motion};
use nalgebra::Vector3;
use proboscis::dynamics::{
    DiscreteTrajectory, Lengths, MultigridUse, Solving, Start, go_on, stable_equilibrium,
    stable_equilibrium_by,
};
use proboscis::model::Model;
use std::ops::ControlFlow;

/// Distance by which nodes inside are moved, as a part of that of their neighbours.
const PART: f64 = 0.15;

#[test]
fn the_motion_is_that_of_the_direct_solver() {
    for viscosity in [None, Some(1.0)] {
        let solid = scattered(cubes(4, rubber(0.4, viscosity)), PART);
        assert_eq!(solid.mesh.box_planes(), None);
        compare(&system(vec![solid]), (0.5, 4), 3e5);
    }
}

#[test]
fn thin_layers_do_no_harm() {
    let iterated = compare(&system(vec![scattered(thin_layers(), 0.0)]), (0.5, 3), 3e4);
    let report = iterated.report;
    let each = report.multigrid.iterations as f64 / report.iterations as f64;
    assert!(each < 10.0, "{each} iterations for each update");
}

#[test]
fn a_mesh_and_a_box_are_solved_together() {
    let first = cubes(4, rubber(0.4, None));
    let second = scattered(sliding(), PART);
    compare(&system(vec![second, first]), (0.5, 3), 2e5);
}

#[test]
fn iterations_do_not_grow_with_the_mesh() {
    for viscosity in [None, Some(1.0)] {
        let counts = [3, 5, 9].map(|n| {
            let solid = scattered(cubes(n, rubber(0.4, viscosity)), PART);
            let report = motion(&system(vec![solid]), MULTIGRID, (0.5, 1), 3e5).report;
            println!("{n}: {report:?}");
            assert_eq!(report.fallbacks, 0);
            let multigrid = report.multigrid;
            (report.iterations, multigrid.iterations, multigrid.levels)
        });
        assert!(counts[0].2 < counts[2].2, "levels are added: {counts:?}");
        for (newton, krylov, _) in counts {
            assert!(newton <= 14 && krylov <= 60, "{counts:?}");
        }
    }
}

/// Under weight and voltages; the inertia proves stability.
#[test]
fn the_equilibrium_is_that_of_the_direct_solver() {
    let mut system = system(vec![scattered(cubes(4, rubber(0.4, None)), PART)]);
    system.gravity = Some(Vector3::new(0.0, 2e-3, -9.81e-3));
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let start = model.reference_coordinates();
    let direct = stable_equilibrium(&model, &start, &[3e5]).unwrap();
    let by = MultigridUse::Always;
    let iterated = stable_equilibrium_by(&model, &start, &[3e5], by).unwrap();
    println!("{:?} {}", iterated.on_grids, iterated.iterations);
    assert!(apart(&direct.z, &start) > 1e-3 * LENGTH);
    assert!(apart(&direct.z, &iterated.z) < 1e-9 * LENGTH);
    assert!(apart(&direct.scalars, &iterated.scalars) < 1e-9 * 3e5);
    let (report, fallbacks) = iterated.on_grids.unwrap();
    assert!(direct.on_grids.is_none() && report.iterations > 0 && fallbacks == 0);
    assert_eq!(iterated.is_stable(), Some(true));
    assert_eq!(iterated.unstable, direct.unstable);
}

/// A direct solver takes over where the volume at each point is kept, as on boxes.
#[test]
fn a_direct_solver_takes_over_where_the_iteration_stalls() {
    let system = system(vec![scattered(cubes(3, rubber(1e4, None)), PART)]);
    let iterated = motion(&system, MULTIGRID, (20.0, 1), 1e5);
    let direct = motion(&system, Solving::default(), (20.0, 1), 1e5);
    println!("{:?}", iterated.report);
    assert_eq!(iterated.report.fallbacks, 1);
    assert!(iterated.report.factorisations > 0);
    assert!(apart(&direct.z[1], &direct.z[0]) > 1e-3);
    assert!(apart(&direct.z[1], &iterated.z[1]) < 1e-6);
}

/// Steps that go on from a motion that ended, on one thread and on two.
#[test]
fn a_resumed_motion_has_the_same_bits_on_any_number_of_threads() {
    let solid = scattered(cubes(4, rubber(0.4, Some(1.0))), PART);
    let model = Model::new(system(vec![solid]), None, 0.5, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let go = |begun: DiscreteTrajectory, steps: usize, threads: usize| {
        let lengths = Lengths::Equal { h: 0.5, steps };
        let drive = |_: f64, _: f64| vec![3e5];
        let observer = |_: &_| ControlFlow::Continue(());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let (discrete, failure) = (pool.build().unwrap())
            .install(|| go_on(MULTIGRID, &model, begun, lengths, &drive, observer));
        assert_eq!(failure, None);
        discrete
    };
    let whole = go(DiscreteTrajectory::at(&start), 6, 1);
    assert!(apart(&whole.z[6], &whole.z[0]) > 1e-4 * LENGTH);
    assert!(whole.report.multigrid.hierarchies < 6, "tangents are kept");
    let resumed = go(go(DiscreteTrajectory::at(&start), 4, 2), 6, 2);
    assert!(whole.z == resumed.z && whole.scalars == resumed.scalars);
    let counts = [&whole, &resumed].map(|motion| motion.report.multigrid.iterations);
    assert_eq!(counts[0], counts[1]);
}
