//! Elimination of dense fronts: factors are multiplied out again.

use super::{Count, Dense, Eliminate, Rules, Workspace};
use crate::kkt::dense::padded;
use crate::kkt::graph::Progress;
use crate::math::Random;
use nalgebra::DMatrix;
use pulp::Arch;

/// A front after the elimination.
struct Eliminated {
    count: Count,
    unknowns: Vec<u32>,
    /// L and the remainder, by columns.
    values: DMatrix<f64>,
    pivots: Vec<[f64; 2]>,
}

fn eliminate(a: &DMatrix<f64>, candidates: usize, is_root: bool, arch: Arch) -> Eliminated {
    let order = a.nrows();
    let stride = padded(order);
    let mut values = vec![0.0; stride * order];
    for (j, column) in a.column_iter().enumerate() {
        for (to, value) in values[j * stride..].iter_mut().zip(&column).skip(j) {
            *to = *value;
        }
    }
    let mut unknowns: Vec<u32> = (0..order as u32).collect();
    let mut pivots = vec![[0.0; 2]; candidates];
    let count = arch.dispatch(Eliminate {
        front: Dense {
            values: &mut values,
            order,
            stride,
            candidates,
            unknowns: &mut unknowns,
            pivots: &mut pivots,
        },
        rules: Rules {
            threshold: 0.1,
            zero: 1e-14,
        },
        is_root,
        workspace: &mut Workspace::default(),
        progress: &mut Progress::new(&|| false),
    });
    pivots.truncate(count.unwrap().eliminated);
    Eliminated {
        count: count.unwrap(),
        unknowns,
        values: DMatrix::from_fn(order, order, |i, j| values[i + j * stride]),
        pivots,
    }
}

/// L, D of the eliminated columns and the remainder, multiplied out.
fn product(found: &Eliminated) -> DMatrix<f64> {
    let (n, k) = (found.values.nrows(), found.count.eliminated);
    let mut l = DMatrix::identity(n, n);
    let mut d = DMatrix::zeros(n, n);
    let mut second = false;
    for j in 0..n {
        let [diagonal, beside] = match j < k {
            true => found.pivots[j],
            false => [0.0; 2],
        };
        for i in j..n {
            match j < k {
                true if i > j => l[(i, j)] = found.values[(i, j)],
                true => {}
                false => {
                    d[(i, j)] = found.values[(i, j)];
                    d[(j, i)] = d[(i, j)];
                }
            }
        }
        if second || j >= k {
            second = false;
            continue;
        }
        if beside == 0.0 {
            d[(j, j)] = if diagonal == 0.0 {
                0.0
            } else {
                diagonal.recip()
            };
            continue;
        }
        let other = found.pivots[j + 1][0];
        let determinant = diagonal * other - beside * beside;
        d[(j, j)] = other / determinant;
        d[(j + 1, j + 1)] = diagonal / determinant;
        d[(j + 1, j)] = -beside / determinant;
        d[(j, j + 1)] = d[(j + 1, j)];
        second = true;
    }
    &l * d * l.transpose()
}

/// A front whose first `hidden` columns have small entries among the candidates and large ones below, so that they are no pivots.
fn front(order: usize, candidates: usize, hidden: usize, random: &mut Random) -> DMatrix<f64> {
    let mut a = DMatrix::zeros(order, order);
    for i in 0..order {
        for j in 0..=i {
            let is_hidden = j < hidden && i < candidates;
            let scale = if is_hidden { 1e-3 } else { 1.0 };
            let is_none = i == j && i % 3 == 0;
            a[(i, j)] = if is_none {
                0.0
            } else {
                scale * random.between(-1.0, 1.0)
            };
            a[(j, i)] = a[(i, j)];
        }
    }
    a
}

#[test]
fn factors_of_a_front_multiplied_out_are_the_front() {
    let mut random = Random::new(3);
    let (mut delayed, mut pairs) = (0, 0);
    for (order, candidates, hidden) in [
        (1, 1, 0),
        (9, 4, 2),
        (24, 24, 0),
        (40, 17, 5),
        (75, 70, 9),
        (100, 66, 40),
        (131, 131, 30),
    ] {
        for _ in 0..4 {
            let a = front(order, candidates, hidden, &mut random);
            assert!(order == 1 || a.amax() > 0.5);
            let found = eliminate(&a, candidates, order == candidates, Arch::new());
            delayed += candidates - found.count.eliminated;
            pairs += found.pivots.iter().filter(|pivot| pivot[1] != 0.0).count();
            let place = |i: usize| found.unknowns[i] as usize;
            let permuted = DMatrix::from_fn(order, order, |i, j| a[(place(i), place(j))]);
            let error = (product(&found) - permuted).amax();
            assert!(error < 1e-12, "{order} {candidates} {hidden}: {error:e}");
            let l = found.values.columns(0, found.count.eliminated);
            let below = |j: usize| (j + 1..order).map(move |i| (i, j));
            let entries = (0..found.count.eliminated).flat_map(below);
            let growth = entries.fold(0.0, |most: f64, at| most.max(l[at].abs()));
            // A root takes what pivots there are.
            assert!(
                order == candidates || growth <= 1.0 / 0.1 + 1e-9,
                "{growth}"
            );
        }
    }
    assert!(delayed > 50 && pairs > 50, "{delayed} {pairs}");
}

#[test]
fn every_vector_unit_finds_the_same_factors() {
    let mut random = Random::new(4);
    for (order, candidates, hidden) in [(11, 6, 2), (64, 40, 8), (93, 70, 12)] {
        let a = front(order, candidates, hidden, &mut random);
        let [one, other] =
            [Arch::Scalar, Arch::new()].map(|arch| eliminate(&a, candidates, false, arch));
        assert!(one.count.eliminated > 0 && one.count.negative > 0);
        assert_eq!(one.count, other.count);
        assert_eq!(one.unknowns, other.unknowns);
        let scale = product(&one).amax();
        let error = (product(&one) - product(&other)).amax();
        assert!(error < 1e-14 * scale * order as f64, "{error:e}");
    }
}
