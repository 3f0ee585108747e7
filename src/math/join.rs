//! Join of two pieces of work in parallel.

use std::cell::OnceCell;
use std::sync::LazyLock;
use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::math::pool::join;

/// Cores of this machine; asked once, because the answer takes reading files.
pub fn cores() -> usize {
    static CORES: LazyLock<usize> =
        LazyLock::new(|| available_parallelism().map_or(1, usize::from));
    *CORES
}

thread_local! {
    /// This thread and one more for each other core; none where the thread belongs to a pool already, or no thread can be had.
    static POOL: OnceCell<Option<ThreadPool>> = const { OnceCell::new() };
}

/// Runs both; those that are much at once, where there is a second core for this thread.
pub(crate) fn join_if<A: Send, B: Send>(
    are_much: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if !are_much || cores() == 1 {
        return (a(), b());
    }
    POOL.with(|pool| {
        let pool = pool.get_or_init(|| {
            let builder = ThreadPoolBuilder::new().num_threads(cores());
            builder.use_current_thread().build().ok()
        });
        match pool {
            Some(pool) => pool.join(a, b),
            None => join(a, b),
        }
    })
}
