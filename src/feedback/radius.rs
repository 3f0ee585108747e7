//! The spectral radius of a matrix, `lim |Aᵐ|^(1/m)`, by repeated squares.

use nalgebra::DMatrix;

/// Squares that are taken: m = 2⁴⁰.
const SQUARES: i32 = 40;

/// The greatest modulus of the eigenvalues; NaN where the matrix is not finite.
pub fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut power = matrix.clone();
    // log |Aᵐ|^(1/m)
    let mut logarithm = 0.0;
    for square in 0..=SQUARES {
        let size = power.norm();
        if size == 0.0 || !size.is_finite() {
            return if size == 0.0 { 0.0 } else { f64::NAN };
        }
        logarithm += size.ln() * 0.5_f64.powi(square);
        power /= size;
        power = &power * &power;
    }
    logarithm.exp()
}
