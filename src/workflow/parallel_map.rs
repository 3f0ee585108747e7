//! Parallel map: pieces of work in several threads, each on its share of the cores.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};

use rayon::ThreadPoolBuilder;

pub use crate::math::cores;
use crate::stop;

/// Bytes of the stack of a thread: those that a main thread has.
const STACK: usize = 8 << 20;

/// An answer, or the message of the panic that came in its place.
pub type Answered<A> = Result<A, String>;

/// The answers to all items, in their order, found in at most `threads` threads.
///
/// A thread has its share of the cores for what is parallel within an answer: with as many threads as cores no half of a horizon competes
/// with another answer, and stops where the one that calls is asked to. A panic is the end of one answer alone. `told` is called in this thread with each answer, as soon as there is one.
pub fn parallel_map<T: Sync, A: Send>(
    items: &[T],
    threads: usize,
    answer: impl Fn(&T) -> A + Sync,
    mut told: impl FnMut(usize, &Answered<A>),
) -> Vec<Answered<A>> {
    let threads = threads.clamp(1, items.len().max(1));
    let share = (cores() / threads).max(1);
    let next = AtomicUsize::new(0);
    let request = stop::request();
    let take = || {
        let index = next.fetch_add(1, Ordering::Relaxed);
        let item = items.get(index)?;
        let answered = catch_unwind(AssertUnwindSafe(|| answer(item)));
        Some((index, answered.map_err(|panic| message(&*panic))))
    };
    let mut answers: Vec<Option<Answered<A>>> = items.iter().map(|_| None).collect();
    let mut keep = |index: usize, answered: Answered<A>| {
        told(index, &answered);
        answers[index] = Some(answered);
    };
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..threads {
            let sender = sender.clone();
            let request = &request;
            let work = move || {
                let all = || {
                    stop::listen(request);
                    std::iter::from_fn(take).for_each(|one| sender.send(one).unwrap_or(()));
                };
                on_cores(share, all);
            };
            let thread = thread::Builder::new().stack_size(STACK);
            if thread.spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        drop(sender);
        let found = receiver.into_iter();
        found.for_each(|(index, answered)| keep(index, answered));
    });
    // Where no thread could be had.
    std::iter::from_fn(take).for_each(|(index, answered)| keep(index, answered));
    let answers = answers.into_iter();
    answers.map(|one| one.expect("all are taken")).collect()
}

/// Begins work in a thread of its own that has all cores for what is parallel within it, and leaves no memory behind.
///
/// # Errors
///
/// That of the system, where it has no more threads.
pub fn begin<A: Send + 'static>(
    work: impl FnOnce() -> A + Send + 'static,
) -> io::Result<JoinHandle<A>> {
    let thread = thread::Builder::new().stack_size(STACK);
    thread.spawn(|| on_cores(cores(), work))
}

/// Does work in a pool of this number of threads, which ends with it: one of which this thread were a part would never be freed.
fn on_cores<A: Send>(count: usize, work: impl FnOnce() -> A + Send) -> A {
    let pool = ThreadPoolBuilder::new()
        .num_threads(count)
        .stack_size(STACK);
    match pool.build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("a panic: {}", text.unwrap_or("without a message"))
}
