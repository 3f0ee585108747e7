//! LDLᵀ by fronts against dense matrices, on one core and on several.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{DMatrix, DVector};
use rayon::ThreadPoolBuilder;

use crate::math::Stopped;
use crate::sparse::fronts::Fronts;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Symmetry};

/// A symmetric matrix, whose every third diagonal entry is negative, and places of its unknowns.
struct System {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    places: Vec<Option<[f64; 3]>>,
}

impl System {
    /// Two boxes of nodes that do not touch, with two unknowns a node, and `loose` unknowns without a place that are coupled
    /// to all.
    fn boxes(nodes: [usize; 3], loose: usize) -> Self {
        let [nx, ny, nz] = nodes;
        let mut places = vec![None; loose];
        for shift in [0.0, 100.0] {
            for i in 0..nx * ny * nz {
                let at = [i % nx, i / nx % ny, i / nx / ny].map(|at| at as f64);
                places.extend([Some([at[0] + shift, at[1], at[2]]); 2]);
            }
        }
        let mut entries = Vec::new();
        for (j, q) in places.iter().enumerate() {
            for (i, p) in places.iter().enumerate().skip(j) {
                let is_near = match (p, q) {
                    (Some(p), Some(q)) => (0..3).all(|k| (p[k] - q[k]).abs() < 1.5),
                    _ => true,
                };
                if is_near {
                    entries.push((i, j));
                }
            }
        }
        let value = |&(i, j): &(usize, usize)| match (i == j, i % 3) {
            (true, 0) => -60.0 - (i % 7) as f64,
            (true, _) => 60.0 + (i % 5) as f64,
            (false, _) => ((31 * i + 17 * j) % 13) as f64 / 13.0 - 0.5,
        };
        let pattern = Pattern::new(places.len(), entries.iter().copied(), Symmetry::Symmetric);
        let all: Vec<f64> = entries.iter().map(value).collect();
        let mut values = vec![0.0; pattern.rows.len()];
        pattern.gather(&all, &mut values);
        Self {
            pattern: Arc::new(pattern),
            values,
            places,
        }
    }

    fn fronts(&self) -> Fronts<f32> {
        Fronts::new(&self.pattern, &self.places)
    }

    fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.pattern.size, self.pattern.size);
        let fill = |i, j, value| dense[(i, j)] = value;
        self.pattern.visit(&self.values, fill);
        dense
    }
}

#[test]
fn solutions_and_inertia_are_those_of_the_dense_matrix() {
    for (nodes, loose) in [
        ([3, 4, 7], 0),
        ([4, 3, 6], 5),
        ([1, 1, 90], 1),
        ([2, 2, 1], 2),
    ] {
        let system = System::boxes(nodes, loose);
        let dense = system.dense();
        let rhs = DVector::from_fn(system.pattern.size, |i, _| 1.0 + (i as f64).sin());
        let expected = dense.clone().lu().solve(&rhs).unwrap();
        assert!(expected.amax() > 1e-2);
        let negative = dense.symmetric_eigenvalues();
        let negative = negative.iter().filter(|value| **value < 0.0).count();
        assert!(negative > 0);
        let single = system.fronts();
        let double = single.more_robust().unwrap();
        let methods: [(Box<dyn Factorisation>, f64); 2] =
            [(Box::new(single), 1e-5), (double, 1e-13)];
        for (mut fronts, lost) in methods {
            // Numbers of the matrix before do not stay.
            for scale in [3.0, 1.0] {
                let values: Vec<f64> = system.values.iter().map(|v| v * scale).collect();
                fronts.factor(&values).unwrap();
            }
            assert_eq!(fronts.negative_pivots(), Some(negative));
            let mut found = rhs.as_slice().to_vec();
            fronts.solve(&mut found);
            let error = (DVector::from_vec(found) - &expected).amax();
            assert!(error < lost * expected.amax(), "{nodes:?} {error:e}");
        }
    }
}

#[test]
fn one_core_gives_the_bits_of_several() {
    let system = System::boxes([10, 10, 16], 1);
    let mut fronts = system.fronts();
    let sides = fronts.tree.fronts.iter().filter_map(|front| front.sides);
    assert!(sides.clone().any(|sides| sides.at_once));
    assert!(sides.clone().any(|sides| !sides.at_once));
    let mut solve = || {
        let mut x: Vec<f64> = (0..system.pattern.size).map(|i| (i as f64).cos()).collect();
        fronts.factor(&system.values).unwrap();
        fronts.solve(&mut x);
        (fronts.panels.clone(), x)
    };
    let several = solve();
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert!(pool.install(solve) == several);
    assert!(several.1.iter().all(|value| *value != 0.0));
}

#[test]
fn a_factorisation_that_was_stopped_can_be_made() {
    let system = System::boxes([10, 10, 16], 1);
    let mut fronts = system.fronts();
    let asked = AtomicUsize::new(0);
    let ask = || asked.fetch_add(1, Ordering::Relaxed);
    let never = || ask() == usize::MAX;
    assert_eq!(fronts.factor_unless(&system.values, &never), Ok(Ok(())));
    let (questions, panels) = (asked.load(Ordering::Relaxed), fronts.panels.clone());
    assert!(questions > 50);
    for first in [0, questions / 2, questions - 1] {
        asked.store(0, Ordering::Relaxed);
        let is_over = || ask() >= first;
        let done = fronts.factor_unless(&system.values, &is_over);
        assert_eq!(done, Err(Stopped));
        assert!(asked.load(Ordering::Relaxed) < first + questions / 4);
    }
    fronts.factor(&system.values).unwrap();
    assert!(fronts.panels == panels);
}

#[test]
fn a_row_without_entries_has_no_pivot() {
    let mut system = System::boxes([3, 3, 3], 0);
    let lost = 17;
    for col in 0..system.pattern.size {
        for slot in system.pattern.slots(col) {
            if col == lost || system.pattern.rows[slot] == lost {
                system.values[slot] = 0.0;
            }
        }
    }
    assert!(system.fronts().factor(&system.values).is_err());
}
