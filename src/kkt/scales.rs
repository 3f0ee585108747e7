//! Equilibration: factors of rows and columns that bring the largest entry of each near one (Ruiz, 2001).
//!
//! They are powers of two, so that scaling does not round.

/// Sweeps; one is not enough for stiff systems, more hardly change anything.
const SWEEPS: usize = 3;

/// Factors of the unknowns.
#[derive(Clone, Debug, Default)]
pub(super) struct Scales {
    factors: Vec<f64>,
    largest: Vec<f64>,
}

impl Scales {
    /// Finds the factors of a matrix.
    pub(super) fn find(&mut self, order: usize, (rows, cols): (&[u32], &[u32]), entries: &[f64]) {
        self.factors.clear();
        self.factors.resize(order, 1.0);
        self.largest.resize(order, 0.0);
        for _ in 0..SWEEPS {
            self.largest.fill(0.0);
            for ((&row, &col), entry) in rows.iter().zip(cols).zip(entries) {
                let (row, col) = (row as usize, col as usize);
                let entry = (entry * self.factors[row] * self.factors[col]).abs();
                self.largest[row] = self.largest[row].max(entry);
                self.largest[col] = self.largest[col].max(entry);
            }
            for (factor, &largest) in self.factors.iter_mut().zip(&self.largest) {
                if largest > 0.0 {
                    *factor *= inverse_root(largest);
                }
            }
        }
    }

    /// The scaled entries.
    pub(super) fn scale(&self, (rows, cols): (&[u32], &[u32]), entries: &[f64], to: &mut Vec<f64>) {
        to.clear();
        let places = rows.iter().zip(cols).zip(entries);
        to.extend(places.map(|((&row, &col), entry)| {
            entry * self.factors[row as usize] * self.factors[col as usize]
        }));
    }

    /// Multiplies a right-hand side or a solution.
    pub(super) fn apply(&self, x: &mut [f64]) {
        for (x, factor) in x.iter_mut().zip(&self.factors) {
            *x *= factor;
        }
    }
}

/// The power of two next to `1/√x`, for x > 0.
fn inverse_root(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    let half = (exponent + (exponent & 1)) / 2;
    f64::from_bits(((1023 - half) as u64) << 52)
}
