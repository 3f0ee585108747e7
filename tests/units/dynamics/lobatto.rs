//! Lobatto points and their weights.

use crate::dynamics::galerkin::lobatto::{Lobatto, lagrange};

#[test]
fn points_and_weights_integrate_powers_exactly_and_no_further() {
    for degree in 1..=6 {
        let Lobatto {
            points, weights, ..
        } = Lobatto::new(degree);
        assert_eq!((points[0], points[degree]), (0.0, 1.0));
        let error = |power: i32| {
            let sum: f64 = points
                .iter()
                .zip(&weights)
                .map(|(c, b)| b * c.powi(power))
                .sum();
            (sum - 1.0 / f64::from(power + 1)).abs()
        };
        let exact = 2 * degree as i32 - 1;
        for power in 0..=exact {
            assert!(error(power) < 4e-15, "{degree} {power}");
        }
        assert!(error(exact + 1) > 1e-9);
    }
}

#[test]
fn polynomials_of_the_degree_are_met_with_their_derivatives() {
    for degree in 1..=6 {
        let rule = Lobatto::new(degree);
        let p = |x: f64| 0.3 - x + 2.0 * x.powi(degree as i32);
        let dp = |x: f64| -1.0 + 2.0 * degree as f64 * x.powi(degree as i32 - 1);
        for (i, &c) in rule.points.iter().enumerate() {
            let slopes = rule.derivatives[i].iter().zip(&rule.points);
            let slope: f64 = slopes.map(|(l, &x)| l * p(x)).sum();
            assert!((slope - dp(c)).abs() < 1e-13 * (1.0 + dp(c).abs()));
        }
        let values = lagrange(&rule.points, 1.7);
        let sum: f64 = values
            .iter()
            .zip(&rule.points)
            .map(|(l, &x)| l * p(x))
            .sum();
        assert!((sum - p(1.7)).abs() < 1e-11 * p(1.7).abs());
    }
}
