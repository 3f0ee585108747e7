//! Scales of rows and columns: equations and unknowns in different units meet one criterion of singularity.

use crate::sparse::Symmetry;
use crate::sparse::backend::Backend;
use crate::sparse::direct::Direct;

/// Scaling of rows and columns ends when their largest entries are between this and its inverse, or after this number of
/// rounds.
const BALANCED: (f64, usize) = (4.0, 12);

impl Direct {
    /// Finds the largest entry of each row and column.
    pub(super) fn measure(&mut self) {
        let [rows, cols] = &mut self.largest;
        rows.fill(0.0);
        cols.fill(0.0);
        // Unlike `f64::max`, this keeps NaN.
        let grow = |peak: &mut f64, value: f64| {
            if value.abs() > *peak || value.is_nan() {
                *peak = value.abs();
            }
        };
        self.pattern.visit(&self.values, |row, col, value| {
            grow(&mut rows[row], value);
            grow(&mut cols[col], value);
        });
    }

    /// Multiplies rows and columns by functions of their largest entries.
    fn scale(&mut self, functions: [fn(f64) -> f64; 2]) {
        let Self {
            pattern,
            values,
            scales,
            largest,
            rhs,
            residual,
            ..
        } = self;
        for (i, factors) in [&mut *residual, &mut *rhs].into_iter().enumerate() {
            let lists = factors.iter_mut().zip(&largest[i]).zip(&mut scales[i]);
            for ((factor, &peak), scale) in lists {
                *factor = if peak > 0.0 { functions[i](peak) } else { 1.0 };
                *scale *= *factor;
            }
        }
        pattern.scale(values, residual, rhs);
        self.measure();
    }

    /// Brings the largest entries near 1.
    pub(super) fn equilibrate(&mut self) {
        self.scales.iter_mut().for_each(|scale| scale.fill(1.0));
        if self.pattern.symmetry == Symmetry::Unsymmetric && self.backend != Backend::Mumps {
            // Exchanges of rows see the scales of rows alone; a power of two rounds nothing.
            self.scale([f64::recip, |_| 1.0]);
            self.scale([|_| 1.0, |peak| peak.log2().round().exp2().recip()]);
            return;
        }
        // Each round halves the orders of magnitude that are left.
        let (enough, rounds) = BALANCED;
        let far = |peak: &f64| *peak > enough || *peak < 1.0 / enough;
        for _ in 0..rounds {
            if !self.largest.iter().flatten().any(far) {
                break;
            }
            // Powers of two round nothing.
            self.scale([|peak| (0.5 * peak.log2()).round().exp2().recip(); 2]);
        }
    }
}
