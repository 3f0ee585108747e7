//! Lowest eigenvalues on boxes against those of a dense matrix from which potentials are eliminated.

use crate::common::boxes::{entries, grid};
use nalgebra::{DMatrix, SymmetricEigen};
use proboscis::sparse::multigrid::{LowestModes, Multigrid, NodeGrid};

/// Eigenvalues of displacements, ascending, with a stiffness taken from each.
fn expected(grids: &[NodeGrid], size: usize, taken: f64) -> Vec<f64> {
    let mut all = DMatrix::<f64>::zeros(size, size);
    for ((row, col), value) in grids.iter().flat_map(entries) {
        all[(row, col)] += 0.5 * value;
        all[(col, row)] += 0.5 * value;
    }
    let nodes = grids.iter().flat_map(|grid| &grid.unknowns);
    let of = |components: std::ops::Range<usize>| -> Vec<usize> {
        let unknowns = nodes
            .clone()
            .flat_map(|node| node[components.clone()].iter());
        unknowns.flatten().map(|u| *u as usize).collect()
    };
    let [moving, electric] = [of(0..3), of(3..4)];
    let block = |rows: &[usize], cols: &[usize]| all.select_rows(rows).select_columns(cols);
    let inverse = block(&electric, &electric).try_inverse().unwrap();
    let coupling = block(&moving, &electric);
    let left = &coupling * inverse * coupling.transpose();
    let stiffness = block(&moving, &moving) - left;
    let stiffness = stiffness - taken * DMatrix::identity(moving.len(), moving.len());
    let mut values = Vec::from(SymmetricEigen::new(stiffness).eigenvalues.as_slice());
    values.sort_by(f64::total_cmp);
    values
}

fn found(grids: &[NodeGrid], size: usize, taken: f64) -> LowestModes {
    let mut solver = Multigrid::new(size, grids, &[]).unwrap();
    solver.values_mut().fill(0.0);
    let nodes = grids.iter().flat_map(|grid| &grid.unknowns);
    let moving = nodes.flat_map(|node| node[..3].iter().flatten());
    let own = moving.map(|u| ((*u as usize, *u as usize), -taken));
    // As a tangent, that is a negative multiple.
    for ((row, col), value) in grids.iter().flat_map(entries).chain(own) {
        let slot = solver.slot(row, col).unwrap();
        solver.values_mut()[slot] -= 0.25 * value;
    }
    solver.take_values().unwrap();
    solver.lowest_modes(-4.0, &|| false).unwrap().unwrap()
}

#[test]
fn eigenvalues_are_within_their_bounds() {
    let mut size = 0;
    let grids = [grid([3, 4, 8], &mut size), grid([4, 3, 6], &mut size)];
    let size = size as usize;
    let values = expected(&grids, size, 0.0);
    assert!(
        values[0] > 1e-3 && values[4] > 1.01 * values[0],
        "{:?}",
        &values[..6]
    );
    // Between the eigenvalues: none below zero, some, and more than are sought.
    let between = |i: usize| 0.5 * (values[i] + values[i + 1]);
    for taken in [0.0, between(0), between(1), between(3), between(9)] {
        let expected: Vec<f64> = values.iter().map(|value| value - taken).collect();
        let modes = found(&grids, size, taken);
        println!(
            "{taken}: {:?} {:?} {:?}",
            &expected[..4],
            modes.quotients,
            modes.bounds
        );
        println!("{:?} in {}", modes.errors, modes.iterations);
        let below = expected.iter().filter(|value| **value < 0.0).count();
        assert_eq!(modes.below_zero(), Some(below.min(4)));
        assert!(modes.bounds[0] < 0.11 * modes.quotients[0].abs());
        for (quotient, bound) in modes.quotients.iter().zip(modes.bounds) {
            let nearest = expected.iter().map(|value| (value - quotient).abs());
            assert!(nearest.fold(f64::INFINITY, f64::min) <= bound);
        }
        // A quotient is above the eigenvalue by the square of its vector's error, unless the vectors are of other ones below zero.
        let above = modes.quotients[0] - expected[0];
        let most = if below <= 4 { 0.02 } else { 0.1 };
        assert!(
            above > -1e-12 && above < most * expected[0].abs(),
            "{above}"
        );
        assert!(modes.lowest.iter().all(|value| value.abs() <= 1.0));
    }
}
