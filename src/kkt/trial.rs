//! How good factors are: a system solved with them, and what the solution leaves.

/// A system with a right-hand side b as large as the largest entry of each row, with changing signs.
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    right: Vec<f64>,
    solution: Vec<f64>,
    /// Residual, and the sum of the magnitudes of its terms.
    residual: Vec<[f64; 2]>,
}

/// What a solution leaves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quality {
    /// The smallest relative change of entries with which the solution is exact (Oettli and Prager, 1964): the greatest of
    /// `|b − A x| / (|A| |x| + |b|)`.
    pub(super) backward_error: f64,
    /// The greatest of `|b − A x| / |b|`. A singular matrix leaves a part of b, however large x is.
    pub(super) left: f64,
}

impl Trial {
    pub(super) fn new(order: usize) -> Self {
        Self {
            right: vec![0.0; order],
            solution: vec![0.0; order],
            residual: vec![[0.0; 2]; order],
        }
    }

    /// The right-hand side of a matrix, to be replaced by the solution.
    pub(super) fn begin(&mut self, (rows, cols): (&[u32], &[u32]), entries: &[f64]) -> &mut [f64] {
        self.right.fill(f64::MIN_POSITIVE);
        for ((&row, &col), entry) in rows.iter().zip(cols).zip(entries) {
            for i in [row as usize, col as usize] {
                self.right[i] = self.right[i].max(entry.abs());
            }
        }
        let odd = self.right.iter_mut().skip(1).step_by(2);
        odd.for_each(|b| *b = -*b);
        self.solution.copy_from_slice(&self.right);
        &mut self.solution
    }

    /// How good the solution is.
    pub(super) fn end(&mut self, (rows, cols): (&[u32], &[u32]), entries: &[f64]) -> Quality {
        let (x, sums) = (&self.solution, &mut self.residual);
        for (sum, &b) in sums.iter_mut().zip(&self.right) {
            *sum = [b, b.abs()];
        }
        let mut add = |row: u32, term: f64| {
            let [residual, magnitude] = &mut sums[row as usize];
            *residual -= term;
            *magnitude += term.abs();
        };
        for ((&row, &col), &entry) in rows.iter().zip(cols).zip(entries) {
            add(row, entry * x[col as usize]);
            if row != col {
                add(col, entry * x[row as usize]);
            }
        }
        let mut quality = Quality::default();
        for ([residual, magnitude], b) in self.residual.iter().zip(&self.right) {
            // What is no number is no solution.
            let part = |of: f64| match residual.abs() / of {
                part if part.is_finite() => part,
                _ => f64::INFINITY,
            };
            quality.backward_error = quality.backward_error.max(part(*magnitude));
            quality.left = quality.left.max(part(b.abs()));
        }
        quality
    }
}
