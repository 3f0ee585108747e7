//! The bound of eigenvalues.

use super::largest_eigenvalue_bound;
use crate::math::Matrix;
use nalgebra::SymmetricEigen;

#[test]
fn no_eigenvalue_is_beyond_the_bound() {
    let mut tight = 0;
    for case in 0..200 {
        let f = Matrix::from_fn(|i, j| (1.7 * (9 * case + 3 * i + j) as f64).sin());
        let c = f.transpose() * f;
        let largest = SymmetricEigen::new(c).eigenvalues.max();
        let bound = largest_eigenvalue_bound(&c);
        assert!(largest > 0.1 && bound >= largest * (1.0 - 1e-14), "{c}");
        tight += usize::from(bound < 1.1 * largest);
    }
    assert!(tight > 20, "{tight}");
    let two_equal = Matrix::from_diagonal(&[0.3, 2.5, 0.3].into());
    assert!((largest_eigenvalue_bound(&two_equal) - 2.5).abs() < 1e-15);
}
