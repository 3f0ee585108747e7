//! Stability by the lowest mode, against the inertia of factors.

use crate::common::random::Random;
use crate::common::solid::system;
use crate::common::stacks::{LENGTH, cubes, rubber, scattered, stack};
use nalgebra::Vector3;
use proboscis::dynamics::{continuation, equilibrium, lowest_mode};
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{ElementKind, Solid, System};

/// Distance by which nodes inside are moved, as a part of that of their neighbours.
const PART: f64 = 0.15;
/// Vectors of the search.
const SOUGHT: usize = 4;

/// Numbers of states: stable, unstable, and not decided by the lowest mode.
#[derive(Debug, Default)]
struct Tally([usize; 3]);

impl Tally {
    /// Compares along a path of equilibria up to a voltage, where that is reached, and past it.
    fn compare(&mut self, system: System, voltage: f64, steps: usize) {
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let start = model.reference_coordinates();
        let path = continuation(&model, &start, &[voltage], steps).unwrap();
        for stop in path.iter().filter(|stop| stop.lost.is_none()) {
            let (point, fraction) = (&stop.rest, stop.fraction);
            let expected = point.unstable.expect("factors give the inertia");
            let Some(mode) = lowest_mode(&model, &point.z, &point.scalars) else {
                println!("{fraction:.4}: inertia {expected}, not found");
                assert!(expected > 0, "what is stable is found");
                self.0[2] += 1;
                continue;
            };
            println!(
                "{:.4}: inertia {expected}, {:?}, {:.3e} ± {:.1e} N/mm, {} iterations",
                fraction, mode.unstable, mode.stiffness, mode.bound, mode.iterations
            );
            match mode.unstable {
                Some(found) => {
                    assert_eq!(found > 0, expected > 0);
                    assert!(found <= expected, "{found} of {expected}");
                    if mode.iterations < 30 {
                        assert_eq!(found, expected.min(SOUGHT));
                    }
                    self.0[usize::from(found > 0)] += 1;
                }
                None => {
                    assert!(expected > 0, "what is stable is decided");
                    self.0[2] += 1;
                }
            }
        }
    }
}

fn layered(random: &mut Random) -> Solid {
    let mut count = || 1 + (random.between(0.0, 1.99) as usize);
    let [x, y, z] = [count(), 2, 2 * count()];
    let below = random.between(5.0, 30.0);
    let size = Vector3::new(random.between(5.0, 20.0), 10.0, LENGTH);
    let layers = vec![(below, z / 2), (LENGTH - below, z / 2)];
    let axes = [vec![(size.x, x)], vec![(10.0, y)], layers];
    let grid = Grid::layers(Vector3::zeros(), size, axes).unwrap();
    let material = rubber(random.between(0.1, 0.8), None);
    stack(&grid, &[0.0, below, LENGTH], material)
}

/// Paths of growing voltages to pull-in and past it.
#[test]
fn the_lowest_mode_tells_what_the_inertia_tells() {
    let mut tally = Tally::default();
    tally.compare(system(vec![cubes(2, rubber(0.4, None))]), 2e6, 14);
    let mut random = Random(11);
    for _ in 0..4 {
        let solid = layered(&mut random);
        tally.compare(system(vec![solid]), 3e6, 14);
    }
    println!("{tally:?}");
    let Tally([stable, unstable, undecided]) = tally;
    assert!(stable > 30 && unstable > 8, "{stable} {unstable}");
    assert!(undecided < unstable, "{undecided}");
}

/// The same on meshes without a grid.
#[test]
fn the_lowest_mode_of_a_mesh_tells_what_the_inertia_tells() {
    let mut tally = Tally::default();
    let cubes = scattered(cubes(3, rubber(0.4, None)), PART);
    assert_eq!(cubes.mesh.box_planes(), None);
    tally.compare(system(vec![cubes.clone()]), 2e6, 14);
    let mut random = Random(11);
    for _ in 0..1 {
        let layers = scattered(layered(&mut random), PART);
        tally.compare(system(vec![layers]), 3e6, 14);
    }
    // Beside a box.
    let mut beside = layered(&mut random);
    beside.mesh = (beside.mesh).transformed(|x| x + Vector3::new(30.0, 0.0, 0.0));
    tally.compare(system(vec![cubes, beside]), 3e6, 14);
    println!("{tally:?}");
    let Tally([stable, unstable, undecided]) = tally;
    assert!(stable > 20 && unstable > 6, "{stable} {unstable}");
    assert!(undecided < unstable, "{undecided}");
}

/// Unstable directions of a column under its weight, those of the lowest modes being those of the inertia.
fn unstable(column: Solid, weight: f64, voltage: f64) -> usize {
    let mut system = system(vec![column]);
    system.gravity = Some(Vector3::new(0.0, 0.0, -weight));
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.reference_coordinates(), &[voltage]).unwrap();
    let mode = lowest_mode(&model, &found.z, &found.scalars).unwrap();
    println!(
        "{weight}: {:?} {:?} {:.3e} ± {:.1e} N/mm, {} iterations",
        found.unstable, mode.unstable, mode.stiffness, mode.bound, mode.iterations
    );
    assert_eq!(mode.unstable, found.unstable.map(|count| count.min(SOUGHT)));
    mode.unstable.unwrap()
}

/// A column under a growing weight stays straight by symmetry, and buckles to both sides.
#[test]
fn a_column_that_buckles_is_unstable_by_its_lowest_mode() {
    let column = || cubes(2, rubber(0.4, None));
    let counts = [0.1, 0.3, 0.5, 1.0].map(|weight| unstable(column(), weight, 0.0));
    assert_eq!(counts[0], 0);
    assert!(counts.contains(&2), "{counts:?}");
}

/// A column on a mesh without a grid under a weight that the straight state does not carry.
#[test]
fn a_column_on_a_mesh_is_unstable_by_its_lowest_mode() {
    let column = || scattered(cubes(3, rubber(0.4, None)), PART);
    let counts = [0.1, 0.5].map(|weight| unstable(column(), weight, 1e5));
    assert_eq!(counts[0], 0);
    assert!(counts[1] > 0, "{counts:?}");
}

/// Columns of mean dilatation with ratios λ/μ, stable under a small weight, and buckled under a great one; on meshes without a grid too.
#[test]
fn the_lowest_mode_of_nearly_incompressible_columns_tells_what_the_inertia_tells() {
    let mut on_meshes = 0;
    for ratio in [10.0, 1e4] {
        let mut solid = cubes(3, rubber(0.4, None));
        solid.element = ElementKind::Hex8Q1P0;
        for material in &mut solid.materials {
            material.lame_lambda = Some(ratio * material.shear_modulus);
        }
        let counts = [0.1, 0.4].map(|weight| unstable(solid.clone(), weight, 1e5));
        assert_eq!(counts, [0, 2], "{ratio}");
        // Without symmetry the state that is found may be a bent one, which is stable.
        let mesh = scattered(solid, PART);
        let counts = [0.1, 0.4].map(|weight| unstable(mesh.clone(), weight, 1e5));
        assert_eq!(counts[0], 0, "{ratio}");
        on_meshes += counts[1];
    }
    assert!(on_meshes > 0);
}
