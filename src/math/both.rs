//! Two pieces of work at once.

use std::cell::OnceCell;
use std::sync::LazyLock;
use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Asked once: the answer takes reading files.
static CORES: LazyLock<usize> = LazyLock::new(|| available_parallelism().map_or(1, usize::from));

thread_local! {
    /// This thread and one more for each other core; none where the thread belongs to a pool already.
    static POOL: OnceCell<Option<ThreadPool>> = const { OnceCell::new() };
}

/// Runs both, at once where there is a second core for this thread.
pub(crate) fn both<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if *CORES == 1 {
        return (a(), b());
    }
    POOL.with(|pool| {
        let pool = pool.get_or_init(|| {
            let builder = ThreadPoolBuilder::new().num_threads(*CORES);
            builder.use_current_thread().build().ok()
        });
        match pool {
            Some(pool) => pool.join(a, b),
            None => rayon::join(a, b),
        }
    })
}
