//! The bounds that Ipopt knows.
//!
//! An equation g = b is passed to it as g − b = 0, so that b may move while Ipopt keeps what it knows. Given b, Ipopt would subtract it itself,
//! with the same bits.

use crate::nlp::Bounds;

/// Bounds as Ipopt knows them.
#[derive(Debug, Default)]
pub(super) struct KnownBounds {
    pub(super) variables: Bounds,
    /// Of the constraints less their right-hand sides.
    pub(super) constraints: Bounds,
    /// b of an equation, 0 of an inequality.
    pub(super) right: Vec<f64>,
}

impl KnownBounds {
    /// Takes the bounds of a program, and returns true if Ipopt needs others than before.
    pub(super) fn take(&mut self, variables: &Bounds, constraints: &Bounds) -> bool {
        let Bounds { lower, upper } = constraints;
        let is_equation = |low: f64, high: f64| low == high && low.is_finite();
        let rights = lower
            .iter()
            .zip(upper)
            .map(|(&low, &high)| match is_equation(low, high) {
                true => low,
                false => 0.0,
            });
        self.right.clear();
        self.right.extend(rights);
        let known = &mut self.constraints;
        let are_known = self.variables == *variables
            && known
                .lower
                .iter()
                .copied()
                .eq(differences(lower, &self.right))
            && known
                .upper
                .iter()
                .copied()
                .eq(differences(upper, &self.right));
        if !are_known {
            self.variables.clone_from(variables);
            for (known, bounds) in [(&mut known.lower, lower), (&mut known.upper, upper)] {
                known.clear();
                known.extend(differences(bounds, &self.right));
            }
        }
        !are_known
    }

    /// Returns true if there are as many equations as free variables.
    pub(super) fn is_square(&self) -> bool {
        let equal = |bounds: &Bounds| {
            let pairs = bounds.lower.iter().zip(&bounds.upper);
            pairs.filter(|(lower, upper)| lower == upper).count()
        };
        self.variables.lower.len() - equal(&self.variables) == equal(&self.constraints)
    }
}

/// Bounds less the right-hand sides.
fn differences<'a>(bounds: &'a [f64], right: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    bounds.iter().zip(right).map(|(bound, right)| bound - right)
}
