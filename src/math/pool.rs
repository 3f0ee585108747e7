//! Thread pool of this thread, or none where no thread can be had.

use std::error::Error;
use std::sync::LazyLock;

use rayon::ThreadPoolBuilder;

/// Returns true if this thread belongs to a pool, or there is one for all threads.
pub(crate) fn has_pool() -> bool {
    static GLOBAL: LazyLock<bool> =
        LazyLock::new(|| match ThreadPoolBuilder::new().build_global() {
            Ok(()) => true,
            // Without a source it stands already; with one no thread could be had.
            Err(error) => error.source().is_none(),
        });
    rayon::current_thread_index().is_some() || *GLOBAL
}

/// Runs both at once, or one after the other where there is no pool.
pub(crate) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    match has_pool() {
        true => rayon::join(a, b),
        false => (a(), b()),
    }
}
