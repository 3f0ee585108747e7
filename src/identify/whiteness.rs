//! Whiteness of residuals: the test of Ljung and Box.
//!
//! `Q = n (n + 2) Σ_{k=1..L} ρ_k²/(n − k)` of the autocorrelations ρ of n residuals has the χ² distribution of L degrees of freedom where they
//! are independent.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Most lags L; of short series a fifth of their length.
const MOST: usize = 10;
/// Fewest residuals that tell anything.
const FEWEST: usize = 10;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whiteness {
    /// Q.
    pub statistic: f64,
    /// Lags L.
    pub lags: usize,
    /// Probability of so large a Q where residuals are independent.
    pub p: f64,
    /// Autocorrelation of neighbours.
    pub neighbours: f64,
}

/// The test of a series of residuals about zero in the order of time; none of too short a series.
pub fn ljung_box(residuals: &[f64]) -> Option<Whiteness> {
    let n = residuals.len();
    let lags = MOST.min(n / 5);
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    if n < FEWEST || square <= 0.0 {
        return None;
    }
    let correlation = |k: usize| {
        let products = residuals[k..].iter().zip(residuals);
        products.map(|(a, b)| a * b).sum::<f64>() / square
    };
    let size = n as f64;
    let part = |k: usize| correlation(k).powi(2) / (size - k as f64);
    let statistic = size * (size + 2.0) * (1..=lags).map(part).sum::<f64>();
    let distribution = ChiSquared::new(lags as f64).ok()?;
    Some(Whiteness {
        statistic,
        lags,
        p: distribution.sf(statistic),
        neighbours: correlation(1),
    })
}
