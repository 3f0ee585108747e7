//! Steps of blocks on boxes by an iteration with multigrid: the motion of the direct solver, at a cost that does not grow with the mesh.

use crate::common::random::Random;
use crate::common::solid::{DRIVEN, system};
use crate::common::stacks::{LENGTH, cubes, rubber, sliding, stack, thin_layers};
use nalgebra::Vector3;
use proboscis::dynamics::{
    DiscreteTrajectory, Lengths, MultigridUse, Newton, Solving, Start, go_on, simulate_by,
    stable_equilibrium, stable_equilibrium_by,
};
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{ElementKind, Potential, Solid, System};
use proboscis::model::{Model, NoGrids};
use proboscis::sparse::Backend;
use std::ops::ControlFlow;

pub(crate) const MULTIGRID: Solving = Solving {
    integrator: proboscis::dynamics::Integrator::Midpoint,
    newton: Newton::Modified,
    backend: None,
    multigrid: MultigridUse::Always,
};
/// Steps of h ms from rest, under a voltage that is switched on at once.
pub(crate) fn motion(
    system: &System,
    solving: Solving,
    (h, steps): (f64, usize),
    voltage: f64,
) -> DiscreteTrajectory {
    let model = Model::new(system.clone(), None, h, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let observer = |_: &_| ControlFlow::Continue(());
    let drive = |_: f64, _: f64| vec![voltage];
    let (discrete, failure) = simulate_by(solving, &model, &start, h, steps, drive, observer);
    assert_eq!(failure, None);
    discrete
}

pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    parts.fold(0.0, f64::max)
}

/// Compares a motion by an iteration with that by factors of the whole tangent.
pub(crate) fn compare(system: &System, step: (f64, usize), voltage: f64) -> DiscreteTrajectory {
    let by_factors = Solving {
        backend: Some(Backend::Faer),
        newton: Newton::Full,
        ..Solving::default()
    };
    let [direct, iterated] =
        [by_factors, MULTIGRID].map(|solving| motion(system, solving, step, voltage));
    let last = step.1;
    let moved = apart(&direct.z[last], &direct.z[0]);
    assert!(moved > 1e-4 * LENGTH, "it moves: {moved}");
    let error = apart(&direct.z[last], &iterated.z[last]);
    println!(
        "moved {moved:.2e}, apart {error:.1e}, {:?}",
        iterated.report
    );
    assert!(error < 1e-9 * LENGTH, "{error:e} mm");
    let potentials = apart(&direct.scalars[last - 1], &iterated.scalars[last - 1]);
    assert!(potentials < 1e-9 * LENGTH, "{potentials:e}");
    assert_eq!(iterated.solver, "GMRES with multigrid");
    assert_eq!(iterated.report.factorisations, 0);
    assert!(iterated.report.multigrid.iterations > 0);
    iterated
}

#[test]
fn the_motion_is_that_of_the_direct_solver() {
    for viscosity in [None, Some(1.0)] {
        compare(
            &system(vec![cubes(4, rubber(0.4, viscosity))]),
            (0.5, 4),
            3e5,
        );
    }
}

#[test]
fn thin_layers_and_odd_counts_of_elements_do_no_harm() {
    let iterated = compare(&system(vec![thin_layers()]), (0.5, 3), 3e4);
    let report = iterated.report;
    let each = report.multigrid.iterations as f64 / report.iterations as f64;
    assert!(each < 8.0, "{each} iterations for each update");
}

#[test]
fn two_blocks_with_sliding_faces_are_solved_together() {
    compare(
        &system(vec![cubes(4, rubber(0.4, None)), sliding()]),
        (0.5, 3),
        2e5,
    );
}

/// Boxes of random sizes, layers, materials and steps.
#[test]
fn random_blocks_move_as_by_the_direct_solver() {
    let mut random = Random(36);
    for case in 0..12 {
        let mut count = || 2 + (random.between(0.0, 4.99) as usize);
        let [x, y, z] = [count(), count(), 2 * count()];
        let below = random.between(5.0, 30.0);
        let size = Vector3::new(random.between(5.0, 20.0), 10.0, LENGTH);
        let layers = vec![(below, z / 2), (LENGTH - below, z / 2)];
        let axes = [vec![(size.x, x)], vec![(10.0, y)], layers];
        let grid = Grid::layers(Vector3::zeros(), size, axes).unwrap();
        let viscosity = (case % 3 > 0).then(|| random.between(0.1, 2.0));
        let material = rubber(random.between(0.1, 0.8), viscosity);
        let solid = stack(&grid, &[0.0, below, LENGTH], material);
        let voltage = 1.5e4 * below.min(LENGTH - below);
        compare(&system(vec![solid]), (random.between(0.3, 2.0), 2), voltage);
    }
}

#[test]
fn iterations_do_not_grow_with_the_mesh() {
    for viscosity in [None, Some(1.0)] {
        let counts = [3, 5, 9].map(|n| {
            let solid = cubes(n, rubber(0.4, viscosity));
            let report = motion(&system(vec![solid]), MULTIGRID, (0.5, 1), 3e5).report;
            println!("{n}: {report:?}");
            (
                report.iterations,
                report.multigrid.iterations,
                report.multigrid.levels,
            )
        });
        assert!(counts[0].2 < counts[2].2, "grids are added: {counts:?}");
        for (newton, krylov, _) in counts {
            assert!(newton <= 12 && krylov <= 40, "{counts:?}");
        }
    }
}

/// Multigrid stalls where the volume at each point is kept, and nothing but elasticity resists.
#[test]
fn a_direct_solver_takes_over_where_the_iteration_stalls() {
    let system = system(vec![cubes(3, rubber(1e4, None))]);
    let iterated = motion(&system, MULTIGRID, (20.0, 1), 1e5);
    let direct = motion(&system, Solving::default(), (20.0, 1), 1e5);
    println!("{:?}", iterated.report);
    assert_eq!(iterated.report.fallbacks, 1);
    assert_ne!(iterated.solver, "GMRES with multigrid");
    assert!(iterated.report.factorisations > 0);
    assert!(apart(&direct.z[1], &direct.z[0]) > 1e-3);
    assert!(apart(&direct.z[1], &iterated.z[1]) < 1e-6);
}

/// Steps that go on from a motion that ended, with the tangent that was kept.
#[test]
fn a_resumed_motion_has_the_same_bits() {
    let model = Model::new(
        system(vec![cubes(3, rubber(0.4, Some(1.0)))]),
        None,
        0.5,
        &[],
    )
    .unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let go = |begun: DiscreteTrajectory, steps: usize| {
        let lengths = Lengths::Equal { h: 0.5, steps };
        let drive = |_: f64, _: f64| vec![3e5];
        let observer = |_: &_| ControlFlow::Continue(());
        let (discrete, failure) = go_on(MULTIGRID, &model, begun, lengths, &drive, observer);
        assert_eq!(failure, None);
        discrete
    };
    let whole = go(DiscreteTrajectory::at(&start), 8);
    let made = whole.report.multigrid.hierarchies;
    assert!(made < 8, "tangents are kept over steps: {made}");
    let resumed = go(go(DiscreteTrajectory::at(&start), 5), 8);
    assert!(whole.z == resumed.z && whole.scalars == resumed.scalars);
    let counts = [&whole, &resumed].map(|motion| motion.report.multigrid.iterations);
    assert_eq!(counts[0], counts[1]);
}

/// Under weight and voltages, cubes and thin layers; the inertia proves stability.
#[test]
fn the_equilibrium_is_that_of_the_direct_solver() {
    let layers = vec![(6.0, 12), (34.0, 7)];
    let size = Vector3::new(10.0, 10.0, LENGTH);
    let axes = [vec![(10.0, 4)], vec![(10.0, 3)], layers];
    let grid = Grid::layers(Vector3::zeros(), size, axes).unwrap();
    let thin = stack(&grid, &[0.0, 1.5, 3.0, 4.5, 6.0], rubber(0.4, None));
    for (solid, voltage) in [(cubes(4, rubber(0.4, None)), 3e5), (thin, 4.5e4)] {
        let mut system = system(vec![solid]);
        system.gravity = Some(Vector3::new(0.0, 2e-3, -9.81e-3));
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let start = model.reference_coordinates();
        let direct = stable_equilibrium(&model, &start, &[voltage]).unwrap();
        let by = MultigridUse::Always;
        let iterated = stable_equilibrium_by(&model, &start, &[voltage], by).unwrap();
        println!(
            "{:?} {} {}",
            iterated.on_grids, iterated.iterations, direct.iterations
        );
        let moved = apart(&direct.z, &start);
        assert!(moved > 1e-3 * LENGTH, "{moved}");
        assert!(apart(&direct.z, &iterated.z) < 1e-9 * LENGTH);
        assert!(apart(&direct.scalars, &iterated.scalars) < 1e-9 * voltage);
        assert_eq!(direct.on_grids, None);
        let (report, fallbacks) = iterated.on_grids.unwrap();
        assert!(report.iterations > 0 && fallbacks == 0);
        assert_eq!(iterated.is_stable(), Some(true));
        assert_eq!(iterated.unstable, direct.unstable);
    }
}

#[test]
fn other_blocks_and_unknowns_are_named() {
    let of = |solid: Solid| {
        Model::new(system(vec![solid]), None, 0.5, &[])
            .unwrap()
            .node_grids()
    };
    let mut solid = cubes(2, rubber(0.4, None));
    let grids = of(solid.clone()).unwrap();
    assert_eq!(grids.boxes[0].planes[2].len(), 9);
    assert!(grids.meshes.is_empty());
    solid.mesh.hexahedra.swap(0, 1);
    let grids = of(solid.clone()).unwrap();
    assert!(grids.boxes.is_empty() && grids.meshes[0].places.len() == 81);
    solid.element = ElementKind::Hex8Q1P0;
    assert!(of(solid.clone()).is_ok());
    solid.materials[0].lame_lambda = Some(10.0);
    assert!(of(solid.clone()).unwrap().meshes[0].has_pressures);
    solid.mesh.hexahedra.swap(0, 1);
    assert!(of(solid.clone()).unwrap().boxes[0].has_pressures);
    solid.electrodes[1].potential = Potential::Floating;
    solid.electrodes[2].potential = DRIVEN;
    let found = of(solid);
    assert!(
        matches!(&found, Err(NoGrids::Other(name)) if name.contains("e1")),
        "{found:?}"
    );
}
