//! Polynomials through Lobatto points, and the quadrature with these points.

/// Points on [0, 1] with both ends, their weights, and the derivatives of the Lagrange polynomials there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lobatto {
    /// Points c₀ = 0 < c₁ < … < c_s = 1.
    pub(super) points: Vec<f64>,
    /// Weights b of the quadrature, exact for polynomials of degree 2s − 1.
    pub(super) weights: Vec<f64>,
    /// Row i holds l′_ν(c_i).
    pub(super) derivatives: Vec<Vec<f64>>,
}

impl Lobatto {
    /// The s + 1 points of polynomials of degree s ≥ 1.
    ///
    /// On [−1, 1] they are ±1 and the zeros of P′_s, the weights 2/(s (s + 1) P_s²) (Abramowitz & Stegun 25.4.32).
    pub(super) fn new(degree: usize) -> Self {
        let s = degree as f64;
        let point = |i: usize| {
            // Chebyshev's points are near; Newton on (1 − x²) P′_s = s (P_{s−1} − x P_s).
            let mut x = -(std::f64::consts::PI * i as f64 / s).cos();
            for _ in 0..50 {
                let [before, last] = legendre(degree, x);
                let step = (before - x * last) / ((s + 1.0) * last);
                x += step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            x
        };
        let on_both: Vec<f64> = (0..=degree).map(point).collect();
        let weight = |&x: &f64| 1.0 / (s * (s + 1.0) * legendre(degree, x)[1].powi(2));
        let weights = on_both.iter().map(weight).collect();
        let points: Vec<f64> = on_both.iter().map(|x| 0.5 * (1.0 + x)).collect();
        let derivatives = (0..=degree).map(|i| derivatives(&points, i)).collect();
        Self {
            points,
            weights,
            derivatives,
        }
    }
}

/// P_{s−1} and P_s at x by their recurrence.
fn legendre(degree: usize, x: f64) -> [f64; 2] {
    let (mut before, mut last) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, last) = (last, ((2.0 * k - 1.0) * x * last - (k - 1.0) * before) / k);
    }
    [before, last]
}

/// Derivatives of all Lagrange polynomials through the points at point i.
fn derivatives(points: &[f64], i: usize) -> Vec<f64> {
    let product = |x: f64, without: [usize; 2]| {
        let others = points.iter().enumerate();
        let kept = others.filter(|(k, _)| !without.contains(k));
        kept.map(|(_, p)| x - p).product::<f64>()
    };
    let derivative = |v: usize| {
        if v == i {
            let others = points.iter().enumerate().filter(|(k, _)| *k != i);
            return others.map(|(_, p)| 1.0 / (points[i] - p)).sum();
        }
        product(points[i], [v, i]) / product(points[v], [v, v])
    };
    (0..points.len()).map(derivative).collect()
}

/// Values at x of the Lagrange polynomials through some points.
pub(super) fn lagrange(points: &[f64], x: f64) -> Vec<f64> {
    let value = |v: usize| {
        let others = points.iter().enumerate().filter(|(k, _)| *k != v);
        let factors = others.map(|(_, p)| (x - p) / (points[v] - p));
        factors.product::<f64>()
    };
    (0..points.len()).map(value).collect()
}

#[cfg(test)]
#[path = "../../../tests/units/dynamics/lobatto.rs"]
mod tests;
