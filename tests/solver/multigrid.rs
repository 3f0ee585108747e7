//! The iteration with multigrid on a matrix of springs between the nodes of boxes.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::boxes::{entries, fill, grid, solver};
use proboscis::math::Stopped;
use proboscis::sparse::Direct;
use proboscis::sparse::multigrid::NoSolution;

fn rhs(size: usize) -> Vec<f64> {
    (0..size).map(|i| (0.7 * i as f64).sin()).collect()
}

#[test]
fn the_solution_is_that_of_a_factorisation() {
    let mut size = 0;
    // Two boxes, one of which has an axis of two planes and an even number of them along another.
    let grids = [grid([9, 7, 12], &mut size), grid([2, 8, 17], &mut size)];
    let size = size as usize;
    let all: Vec<_> = grids.iter().flat_map(entries).collect();
    let pattern: Vec<_> = all.iter().map(|(entry, _)| *entry).collect();
    let values: Vec<f64> = all.iter().map(|(_, value)| *value).collect();
    let mut direct = Direct::new(size, &pattern);
    direct.factor(&values).unwrap();
    let mut expected = rhs(size);
    direct.solve(&mut expected);
    let mut solver = solver(size, &grids);
    for tolerance in [1e-2, 1e-6, 1e-11] {
        let mut found = rhs(size);
        let solved = solver.solve(&mut found, tolerance, &|| false).unwrap();
        assert_eq!(solved, Ok(()));
        let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|v| v * v).sum::<f64>().sqrt();
        let error = norm(&mut found.iter().zip(&expected).map(|(a, b)| a - b));
        let whole = norm(&mut expected.iter().copied());
        assert!(
            whole > 1.0 && error < 30.0 * tolerance * whole,
            "{error:e} of {whole}"
        );
    }
    let report = solver.counted();
    assert!(report.levels > 1 && report.iterations < 70, "{report:?}");
    assert_eq!(solver.slot(0, size - 1), None, "boxes are not coupled");
}

#[test]
fn it_is_asked_within_the_iteration_whether_to_stop() {
    let mut size = 0;
    let grids = [grid([5, 5, 20], &mut size)];
    let mut solver = solver(size as usize, &grids);
    let questions = AtomicUsize::new(0);
    let third = || questions.fetch_add(1, Ordering::Relaxed) == 2;
    let mut values = rhs(size as usize);
    assert_eq!(solver.solve(&mut values, 1e-10, &third), Err(Stopped));
    assert_eq!(values, rhs(size as usize), "the right-hand side stays");
    assert_eq!(solver.solve(&mut values, 1e-10, &|| false), Ok(Ok(())));
}

#[test]
fn numbers_that_are_none_have_no_solution() {
    let mut size = 0;
    let grids = [grid([4, 4, 8], &mut size)];
    let mut solver = solver(size as usize, &grids);
    let mut values = rhs(size as usize);
    values[7] = f64::NAN;
    assert_eq!(
        solver.solve(&mut values, 1e-4, &|| false),
        Ok(Err(NoSolution))
    );
    // Later ones are not lost with it.
    fill(&mut solver, &grids);
    solver.take_values().unwrap();
    let mut values = rhs(size as usize);
    assert_eq!(solver.solve(&mut values, 1e-4, &|| false), Ok(Ok(())));
    assert!(values.iter().all(|value| value.is_finite()));
}

/// A grid of enough planes is swept in four slabs, two at once.
#[test]
fn tall_grids_are_solved_with_the_same_bits_in_any_number_of_threads() {
    let mut size = 0;
    // Slabs of nine and of ten planes.
    let grids = [grid([12, 11, 38], &mut size)];
    let size = size as usize;
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut solver = solver(size, &grids);
            let mut found = rhs(size);
            let solved = solver.solve(&mut found, 1e-10, &|| false);
            assert_eq!(solved, Ok(Ok(())));
            (found, solver.counted())
        })
    };
    let (found, report) = solve(1);
    assert!(report.levels > 2 && report.iterations < 30, "{report:?}");
    let mut left = rhs(size);
    for ((row, col), value) in entries(&grids[0]) {
        left[row] -= value * found[col];
    }
    let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    assert!(norm(&found) > 1.0 && norm(&left) < 1e-8 * norm(&rhs(size)));
    assert_eq!(solve(2), (found, report));
}
