//! When to stop: at Ctrl-C, or when the time that was given is over.
//!
//! What takes long asks [`stop`] between its parts: Newton iterations, factorisations, intervals, the questions of Ipopt. It is
//! answered while a [`Watch`] lasts, so that what is known can be written afterwards.

use std::cell::Cell;
use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::ipopt::status::Status;

/// Exit status of a program ended by Ctrl-C: 128 plus the number of SIGINT.
const EXIT_STATUS: i32 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);

thread_local! {
    static LIMIT: Cell<Option<TimeLimit>> = const { Cell::new(None) };
}

/// Makes Ctrl-C end the solves of this process with [`Status::Interrupted`], and says so
/// on standard error; the second Ctrl-C ends the process with exit status 130.
///
/// Only the first call has an effect.
pub fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let installed = ctrlc::set_handler(|| {
            if REQUESTED.swap(true, Ordering::SeqCst) {
                process::exit(EXIT_STATUS);
            }
            eprintln!("\nstopping; the results so far will be written; Ctrl-C again ends the program at once");
        });
        if let Err(error) = installed {
            tracing::warn!("Ctrl-C will not stop a solve in good order: {error}");
        }
    });
}

/// Whether Ctrl-C was pressed since [`install`].
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// Until when work may go on.
#[derive(Clone, Copy, Debug)]
pub struct TimeLimit {
    end: Option<Instant>,
}

impl TimeLimit {
    /// So many seconds from now; a time that no clock reaches is no limit.
    #[must_use]
    pub fn after(seconds: Option<f64>) -> Self {
        let length = seconds.and_then(|s| Duration::try_from_secs_f64(s.max(0.0)).ok());
        let end = length.and_then(|length| Instant::now().checked_add(length));
        Self { end }
    }

    /// Why to stop now, if so: [`Status::Interrupted`] or [`Status::TimeLimit`].
    #[must_use]
    pub fn reached(self) -> Option<Status> {
        if requested() {
            return Some(Status::Interrupted);
        }
        let is_over = self.end.is_some_and(|end| Instant::now() >= end);
        is_over.then_some(Status::TimeLimit)
    }
}

/// The limit of this thread, while somebody watches over it.
#[must_use]
pub fn limit() -> Option<TimeLimit> {
    LIMIT.get()
}

/// Why this thread is to stop now, if so; never without a [`Watch`].
#[must_use]
pub fn stop() -> Option<Status> {
    limit().and_then(TimeLimit::reached)
}

/// Watches over Ctrl-C and the time of this thread until it is dropped.
#[derive(Debug)]
#[must_use = "it ends where it is dropped"]
pub struct Watch {
    before: Option<TimeLimit>,
}

/// Begins to watch: this thread is to stop at Ctrl-C, after so many seconds, or when a watch around this one says so.
pub fn watch(seconds: Option<f64>) -> Watch {
    let before = LIMIT.get();
    let around = before.and_then(|limit| limit.end);
    let own = TimeLimit::after(seconds).end;
    let end = [own, around].into_iter().flatten().min();
    LIMIT.set(Some(TimeLimit { end }));
    Watch { before }
}

/// Nothing on this thread is to stop until the watch is dropped: for what is left to do after a stop.
pub fn unwatched() -> Watch {
    Watch {
        before: LIMIT.take(),
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        LIMIT.set(self.before);
    }
}
