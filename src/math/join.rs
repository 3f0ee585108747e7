//! Join of two pieces of work in parallel.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::OnceCell;
use std::error::Error;
use std::fs;
use std::sync::LazyLock;
use std::thread::available_parallelism;

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

/// Bytes that the machine, the group of this process and its limit of address space leave; `None` where that is not known.
pub(crate) fn available() -> Option<f64> {
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.as_deref().and_then(of_machine);
    let of_group = |name: &str| -> Option<f64> {
        let text = fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?;
        text.trim().parse().ok()
    };
    let group = of_group("memory.max").zip(of_group("memory.current"));
    // What is cached is given back when it is needed.
    let group = group.map(|(limit, used)| (limit - used).max(0.5 * limit));
    let limits = fs::read_to_string("/proc/self/limits").ok();
    let used = fs::read_to_string("/proc/self/status").ok();
    let limit = limits.as_deref().and_then(of_limits);
    let used = used.as_deref().and_then(of_process);
    let space = limit.zip(used).map(|(limit, used)| (limit - used).max(0.0));
    let all = [machine, group, space].into_iter();
    all.flatten().reduce(f64::min)
}

/// Returns the limit of address space that `/proc/self/limits` states, in bytes.
fn of_limits(text: &str) -> Option<f64> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Returns the address space in use that `/proc/self/status` states, in bytes.
fn of_process(text: &str) -> Option<f64> {
    kilobytes(text, "VmSize:")
}

/// Returns the available memory that `/proc/meminfo` states, in bytes.
fn of_machine(text: &str) -> Option<f64> {
    kilobytes(text, "MemAvailable:")
}

/// Returns the number of kilobytes under a name, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// A number of bytes for people.
pub(crate) fn readable(bytes: f64) -> String {
    match bytes < 1e8 {
        true => format!("{:.1} MB", bytes / 1e6),
        false => format!("{:.1} GB", bytes / 1e9),
    }
}
