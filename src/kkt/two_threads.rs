//! Work in two halves, on two threads where it is long.
//!
//! The halves depend on the system alone, so that factors are the same for any number of threads.

use crate::math::join_if;

/// Multiplications below which a second core is not worth being woken: some milliseconds.
const MUCH: usize = 1 << 23;

/// Does both halves of this number of multiplications.
pub(super) fn halves<A: Send, B: Send>(
    multiplications: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    join_if(multiplications >= MUCH, a, b)
}

/// Returns the number of items of the first half, of items with these costs.
pub(super) fn middle(costs: impl Iterator<Item = f64> + Clone) -> usize {
    let half = 0.5 * costs.clone().sum::<f64>();
    let sums = costs.scan(0.0, |sum, cost| {
        *sum += cost;
        Some(*sum)
    });
    sums.take_while(|sum| *sum <= half).count()
}
