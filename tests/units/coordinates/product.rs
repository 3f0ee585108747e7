//! Dense products of groups on every vector unit.

use crate::coordinates::pull_back::product::{Pair, Product};
use pulp::{Arch, Scalar, Simd, WithSimd};

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        self.run(unit);
    }
}

/// Numbers without a pattern.
fn numbers(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|i| (seed + 1.7 * i as f64).sin()).collect()
}

#[test]
fn products_are_sums_over_pairs_on_every_unit() {
    for (stride, rows) in [
        ([4, 4], 1),
        ([4, 8], 3),
        ([8, 4], 6),
        ([8, 12], 7),
        ([12, 16], 12),
    ] {
        let [m, n] = stride;
        let pairs = [3 * m as u32, 0, 6 * m as u32].map(|first| Pair {
            slot: 0,
            transposed: 0,
            first: [first, 0],
        });
        let sides = [0.3, 0.8].map(|seed| [numbers(9 * m, seed), numbers(9 * n, 2.0 * seed)]);
        let panels = sides
            .each_ref()
            .map(|side| side.each_ref().map(Vec::as_slice));
        let mut naive = vec![0.0; m * n];
        for [columns, images] in panels {
            for (p, pair) in pairs.iter().enumerate() {
                for (i, j) in (0..rows).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    for k in 0..3 {
                        let a = columns[pair.first[0] as usize + k * m + i];
                        naive[i * n + j] += a * images[(3 * p + k) * n + j];
                    }
                }
            }
        }
        let largest = naive.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(largest > 1.0);
        for is_scalar in [false, true] {
            let mut out = vec![0.0; m * n];
            let product = Product {
                pairs: &pairs,
                panels: &panels,
                stride,
                rows,
                out: &mut out,
            };
            match is_scalar {
                true => product.run(Scalar::new()),
                false => Arch::new().dispatch(product),
            }
            for (value, expected) in out.iter().zip(&naive) {
                assert!((value - expected).abs() < 1e-14 * largest);
            }
        }
    }
}
