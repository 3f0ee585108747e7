//! When to stop: at Ctrl-C, when somebody else asks for it, or when the time that was given is over.
//!
//! What takes long asks [`stop`] between its parts: Newton iterations, factorisations, intervals, the questions of Ipopt. It is
//! answered while a [`Watch`] lasts, so that what is known can be written afterwards.

use std::cell::RefCell;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Once};
use std::time::{Duration, Instant};

use crate::ipopt::status::Status;

/// Exit status of a program ended by Ctrl-C: 128 plus the number of SIGINT.
const EXIT_STATUS: i32 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);

thread_local! {
    static LIMIT: RefCell<Option<TimeLimit>> = const { RefCell::new(None) };
    static REQUEST: RefCell<StopRequest> = RefCell::default();
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

/// Whether Ctrl-C was pressed since [`install`], or this thread was asked to stop.
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst) || REQUEST.with_borrow(StopRequest::is_made)
}

/// A request to one thread, made by another: it stops as at Ctrl-C.
#[derive(Clone, Debug, Default)]
pub struct StopRequest(Arc<AtomicBool>);

impl StopRequest {
    /// Asks for it.
    pub fn make(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    fn is_made(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// What this thread does from now on stops at this request.
pub fn listen(request: &StopRequest) {
    REQUEST.set(request.clone());
}

/// The request that this thread listens to, for threads that work for it.
#[must_use]
pub fn request() -> StopRequest {
    REQUEST.with_borrow(StopRequest::clone)
}

/// Until when work may go on.
#[derive(Clone, Debug)]
pub struct TimeLimit {
    end: Option<Instant>,
    request: StopRequest,
}

impl TimeLimit {
    /// So many seconds from now; a time that no clock reaches is no limit.
    #[must_use]
    pub fn after(seconds: Option<f64>) -> Self {
        let length = seconds.and_then(|s| Duration::try_from_secs_f64(s.max(0.0)).ok());
        let end = length.and_then(|length| Instant::now().checked_add(length));
        let request = REQUEST.with_borrow(StopRequest::clone);
        Self { end, request }
    }

    /// Why to stop now, if so: [`Status::Interrupted`] or [`Status::TimeLimit`].
    #[must_use]
    pub fn reached(&self) -> Option<Status> {
        if REQUESTED.load(Ordering::SeqCst) || self.request.is_made() {
            return Some(Status::Interrupted);
        }
        let is_over = self.end.is_some_and(|end| Instant::now() >= end);
        is_over.then_some(Status::TimeLimit)
    }
}

/// The limit of this thread, while somebody watches over it.
#[must_use]
pub fn limit() -> Option<TimeLimit> {
    LIMIT.with_borrow(Clone::clone)
}

/// Why this thread is to stop now, if so; never without a [`Watch`].
#[must_use]
pub fn stop() -> Option<Status> {
    LIMIT.with_borrow(|limit| limit.as_ref()?.reached())
}

/// Watches over Ctrl-C and the time of this thread until it is dropped.
#[derive(Debug)]
#[must_use = "it ends where it is dropped"]
pub struct Watch {
    before: Option<TimeLimit>,
}

/// Begins to watch: this thread is to stop at Ctrl-C, after so many seconds, or when a watch around this one says so.
pub fn watch(seconds: Option<f64>) -> Watch {
    let before = limit();
    let around = before.as_ref().and_then(|limit| limit.end);
    let mut own = TimeLimit::after(seconds);
    own.end = [own.end, around].into_iter().flatten().min();
    LIMIT.set(Some(own));
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
        LIMIT.set(self.before.take());
    }
}
