//! Nearly incompressible blocks of mean dilatation by multigrid: the displacements of factors, with iterations that neither the ratio of
//! moduli nor the mesh makes grow.

use crate::common::solid::system;
use crate::common::stacks::{LENGTH, cubes, rubber};
use crate::multigrid::MULTIGRID;
use proboscis::dynamics::{
    DiscreteTrajectory, MultigridUse, Newton, Solving, Start, StepperReport, simulate_by,
    stable_equilibrium, stable_equilibrium_by,
};
use proboscis::model::Model;
use proboscis::model::system::{ElementKind, System};
use proboscis::sparse::Backend;
use std::ops::ControlFlow;

/// Voltage in V over layers of 10 mm.
const VOLTAGE: f64 = 5e4;
/// Ratios λ/μ.
const RATIOS: [f64; 4] = [10.0, 100.0, 1e3, 1e4];

/// Most iterations for each update.
const MOST: f64 = 8.0;
/// Solutions for the lowest modes of a block: four in each of four iterations.
const MODES: usize = 16;

/// A block between electrodes on its ends and middle planes, of n × n × 4n elements.
fn stiff(n: usize, ratio: f64, viscosity: Option<f64>) -> System {
    let mut solid = cubes(n, rubber(0.4, viscosity));
    solid.element = ElementKind::Hex8Q1P0;
    for material in &mut solid.materials {
        material.lame_lambda = Some(ratio * material.shear_modulus);
    }
    system(vec![solid])
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    parts.fold(0.0, f64::max)
}

/// Two steps under a voltage that is switched on at once.
fn motion(system: &System, solving: Solving) -> DiscreteTrajectory {
    let model = Model::new(system.clone(), None, 0.5, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let observer = |_: &_| ControlFlow::Continue(());
    let drive = |_: f64, _: f64| vec![VOLTAGE];
    let (discrete, failure) = simulate_by(solving, &model, &start, 0.5, 2, drive, observer);
    assert_eq!(failure, None);
    discrete
}

/// Two steps by multigrid are those of factors, with a tangent of each iteration; what multigrid took.
fn same_motion(label: &str, system: System) -> StepperReport {
    let by = |backend, multigrid| Solving {
        newton: Newton::Full,
        backend,
        multigrid,
        ..Solving::default()
    };
    let factors = by(Some(Backend::Faer), MultigridUse::WhereFaster);
    let direct = motion(&system, factors);
    let iterated = motion(&system, by(None, MultigridUse::Always));
    let moved = apart(&direct.z[2], &direct.z[0]);
    let error = apart(&direct.z[2], &iterated.z[2]);
    let report = iterated.report;
    println!("{label}: moved {moved:.1e} apart {error:.1e} {report:?}");
    assert!(moved > 1e-4 * LENGTH, "{moved}");
    assert!(error < 1e-9 * LENGTH, "{error:e}");
    assert_eq!((report.fallbacks, report.factorisations), (0, 0));
    report
}

/// The state of rest by multigrid is that of factors; the iterations that it took, for stability too, and the updates.
fn same_rest(label: &str, system: System) -> (f64, usize) {
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let start = model.reference_coordinates();
    let direct = stable_equilibrium(&model, &start, &[VOLTAGE]).unwrap();
    let iterated = stable_equilibrium_by(&model, &start, &[VOLTAGE], MultigridUse::Always).unwrap();
    let (report, fallbacks) = iterated.on_grids.unwrap();
    let error = apart(&direct.z, &iterated.z);
    println!(
        "{label}: at rest apart {error:.1e}, {} updates, {report:?}",
        iterated.iterations
    );
    assert!(apart(&direct.z, &start) > 1e-4 * LENGTH);
    assert!(error < 1e-9 * LENGTH, "{error:e}");
    assert_eq!(fallbacks, 0);
    (report.iterations as f64, iterated.iterations)
}

#[test]
fn the_motion_of_nearly_incompressible_blocks_is_that_of_factors() {
    for viscosity in [None, Some(1.0)] {
        for ratio in RATIOS {
            let label = format!("{viscosity:?} {ratio}");
            let report = same_motion(&label, stiff(3, ratio, viscosity));
            let each = report.multigrid.iterations as f64 / report.iterations as f64;
            assert!(each < MOST, "{each} iterations for each update");
        }
    }
}

#[test]
fn the_rest_of_nearly_incompressible_blocks_is_that_of_factors() {
    for ratio in RATIOS {
        let (iterations, updates) = same_rest(&ratio.to_string(), stiff(3, ratio, None));
        let each = iterations / (updates + MODES) as f64;
        assert!(each < 1.5 * MOST, "{each} iterations for each solution");
    }
}

/// The same block on a mesh that is no box: elements in another order, and nodes between its faces and electrodes elsewhere.
fn without_box(mut system: System) -> System {
    let mesh = &mut system.solids[0].mesh;
    mesh.hexahedra.reverse();
    mesh.regions.reverse();
    let is_inside = |x: &f64| (x / 10.0 - (x / 10.0).round()).abs() > 1e-9;
    let mut moved = 0;
    for (number, node) in mesh.nodes.iter_mut().enumerate() {
        if node.iter().all(is_inside) {
            moved += 1;
            for (axis, place) in node.iter_mut().enumerate() {
                *place += 0.3 * (12.9898 * number as f64 + 2.0 * axis as f64).sin();
            }
        }
    }
    assert!(moved > 20 && mesh.box_planes().is_none());
    system
}

#[test]
fn nearly_incompressible_blocks_on_meshes_are_those_of_factors() {
    for ratio in RATIOS {
        let system = without_box(stiff(3, ratio, None));
        let report = same_motion(&ratio.to_string(), system.clone());
        assert!(report.multigrid.levels > 1);
        let each = report.multigrid.iterations as f64 / report.iterations as f64;
        assert!(each < 2.0 * MOST, "{each} iterations for each update");
        let (iterations, updates) = same_rest(&ratio.to_string(), system);
        let each = iterations / (updates + MODES) as f64;
        assert!(each < 1.25 * MOST, "{each} iterations for each solution");
    }
}

/// Coarser levels correct pressures too: where the second of three does not, an update takes three times as many iterations as on two levels.
#[test]
fn iterations_on_meshes_grow_little_with_them() {
    let each = [(3, 2), (8, 3)].map(|(n, levels)| {
        let report = motion(&without_box(stiff(n, 1e4, None)), MULTIGRID).report;
        println!("{n}: {report:?}");
        assert_eq!((report.multigrid.levels, report.fallbacks), (levels, 0));
        report.multigrid.iterations as f64 / report.iterations as f64
    });
    assert!(each[0] > 1.0, "{each:?}");
    assert!(
        each[1] < 2.0 * each[0],
        "{each:?} iterations for each update"
    );
}
