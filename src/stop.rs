//! Requests to stop: Ctrl-C, a request of another thread, or a time limit.
//!
//! Long work calls [`reason`] between its parts: Newton iterations, factorisations, intervals, the evaluations of Ipopt. A request is
//! answered while a [`Watch`] lasts, so that what is known can be written afterwards.
//!
//! Signals that ask for a stop: Ctrl-C, the end of a session, the end that a system asks for.
//!
//! They are recorded without a thread, since there may be none; callers of [`reason`] see them.

use crate::math::{self, IsOver};
use crate::nlp::Status;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::cell::RefCell;
use std::ffi::c_int;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Once, OnceLock};
use std::time::{Duration, Instant};
use std::{fs, io};
use thiserror::Error;

thread_local! {
    static LIMIT: RefCell<Option<TimeLimit>> = const { RefCell::new(None) };
    static REQUEST: RefCell<StopRequest> = RefCell::default();
}

/// Returns true if a signal asked for a stop since [`install`], or this thread was asked to stop.
#[must_use]
pub fn requested() -> bool {
    have_asked() || REQUEST.with_borrow(StopRequest::is_made)
}

/// Goes on unless a stop was [`requested`].
pub fn go_on() -> ControlFlow<()> {
    match requested() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
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

/// Makes all later work of this thread stop at this request.
pub fn listen(request: &StopRequest) {
    REQUEST.set(request.clone());
}

/// The request that this thread listens to, for threads that work for it.
#[must_use]
pub fn request() -> StopRequest {
    REQUEST.with_borrow(StopRequest::clone)
}

/// A limit that counts calls: it is over after a number of questions, and counts how many there were. Tests use it in place of
/// the clock, so that they stop at the same question every time.
#[derive(Clone, Debug)]
pub struct Questions(Arc<[AtomicU64; 3]>);

impl Questions {
    /// Makes a limit of this number of questions.
    #[must_use]
    pub fn allowed(count: u64) -> Self {
        Self(Arc::new([count, 0, u64::MAX].map(AtomicU64::new)))
    }

    /// Sets the number of questions that stand for the second after a limit in which results are written; without it there is no end to these.
    pub fn grant(&self, count: u64) {
        self.0[2].store(count, Ordering::SeqCst);
    }

    /// Returns the number of questions so far.
    #[must_use]
    pub fn asked(&self) -> u64 {
        self.0[1].load(Ordering::SeqCst)
    }

    /// Ends the time after this number of further questions.
    pub fn end_after(&self, count: u64) {
        self.0[0].store(self.asked().saturating_add(count), Ordering::SeqCst);
    }

    /// Counts a question; returns true if the time is over, and the grace where there is one.
    fn ask(&self, has_grace: bool) -> bool {
        let [allowed, asked, grace] = &*self.0;
        let before = asked.fetch_add(1, Ordering::SeqCst);
        let more = match has_grace {
            true => grace.load(Ordering::SeqCst),
            false => 0,
        };
        before >= allowed.load(Ordering::SeqCst).saturating_add(more)
    }
}

/// Seconds that what remains to be done after a stop may take.
const GRACE: f64 = 1.0;

/// Until when work may go on.
#[derive(Clone, Debug)]
pub struct TimeLimit {
    end: Option<Instant>,
    questions: Option<Questions>,
    request: StopRequest,
    heeds_requests: bool,
    has_grace: bool,
}

impl TimeLimit {
    /// The limit `seconds` from now; a time that no clock reaches is no limit.
    #[must_use]
    pub fn after(seconds: Option<f64>) -> Self {
        let length = seconds.and_then(|s| Duration::try_from_secs_f64(s.max(0.0)).ok());
        let end = length.and_then(|length| Instant::now().checked_add(length));
        let request = REQUEST.with_borrow(StopRequest::clone);
        Self {
            end,
            questions: None,
            request,
            heeds_requests: true,
            has_grace: false,
        }
    }

    /// The limit of the work that remains when long work has ended, `seconds` from now and a second more: where a request has ended the
    /// long work, a second from now, whatever was requested.
    #[must_use]
    pub fn with_grace(seconds: Option<f64>) -> Self {
        let heeds_requests = !requested();
        let seconds = match heeds_requests {
            true => seconds,
            false => Some(0.0),
        };
        Self {
            questions: limit().and_then(|limit| limit.questions),
            heeds_requests,
            has_grace: true,
            ..Self::after(seconds.map(|s| s.max(0.0) + GRACE))
        }
    }

    /// Returns the reason to stop now, if there is one: [`Status::Interrupted`] or [`Status::TimeLimit`].
    #[must_use]
    pub fn reached(&self) -> Option<Status> {
        if self.heeds_requests && (have_asked() || self.request.is_made()) {
            return Some(Status::Interrupted);
        }
        let is_late = self.end.is_some_and(|end| Instant::now() >= end);
        let questions = self.questions.as_ref();
        let is_over = questions.is_some_and(|questions| questions.ask(self.has_grace));
        (is_late || is_over).then_some(Status::TimeLimit)
    }
}

/// The limit of this thread, while somebody watches over it.
#[must_use]
pub fn limit() -> Option<TimeLimit> {
    LIMIT.with_borrow(Clone::clone)
}

/// Returns the reason for which this thread is to stop now, if there is one; never without a [`Watch`].
#[must_use]
pub fn reason() -> Option<Status> {
    LIMIT.with_borrow(|limit| limit.as_ref()?.reached())
}

/// There is no result, because it was time to stop: [`Status::Interrupted`] or [`Status::TimeLimit`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("{}", .0.word().replace('_', " "))]
pub struct Stopped(pub Status);

/// Goes on, unless this thread is to stop.
///
/// # Errors
/// It is to stop.
pub fn check() -> Result<(), Stopped> {
    reason().map_or(Ok(()), |status| Err(Stopped(status)))
}

/// The stop, where this thread is to stop, and else the error: what is cut short may seem wrong.
pub fn unless_stopped<E: From<Stopped>>(error: E) -> E {
    check().map_or_else(E::from, |()| error)
}

/// Calls what asks on any thread whether this one is to stop.
///
/// # Errors
/// It stopped.
pub fn heed<T>(work: impl FnOnce(IsOver<'_>) -> Result<T, math::Stopped>) -> Result<T, Stopped> {
    let limit = limit();
    let reached = || limit.as_ref().and_then(TimeLimit::reached);
    let done = work(&|| reached().is_some());
    done.map_err(|_| Stopped(reached().unwrap_or(Status::Interrupted)))
}

/// Watches over Ctrl-C and the time of this thread until it is dropped.
#[derive(Debug)]
#[must_use = "it ends where it is dropped"]
pub struct Watch {
    before: Option<TimeLimit>,
}

/// Begins to watch: this thread is to stop at Ctrl-C, after this number of seconds, or when a watch around this one stops it.
pub fn watch(seconds: Option<f64>) -> Watch {
    watch_until(TimeLimit::after(seconds))
}

/// Begins to watch with a time that passes by questions.
pub fn watch_questions(questions: &Questions) -> Watch {
    watch_until(TimeLimit {
        questions: Some(questions.clone()),
        ..TimeLimit::after(None)
    })
}

/// Begins to watch as a limit does, that of another thread or of [the work that remains](TimeLimit::with_grace), and no watch around this
/// one.
pub fn watch_by(limit: TimeLimit) -> Watch {
    Watch {
        before: LIMIT.replace(Some(limit)),
    }
}

fn watch_until(mut own: TimeLimit) -> Watch {
    let before = limit();
    if let Some(around) = &before {
        own.end = [own.end, around.end].into_iter().flatten().min();
        own.questions = own.questions.or_else(|| around.questions.clone());
    }
    LIMIT.set(Some(own));
    Watch { before }
}

/// Shields this thread from stops until the watch is dropped: for the work that remains after a stop.
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

/// Exit status of a program ended by a signal: this plus its number.
const EXIT_STATUS: c_int = 128;

/// Message at the first signal.
const WORDS: &str =
    "\nstopping; the results so far will be written; Ctrl-C again ends the program at once";

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
static TOLD: AtomicBool = AtomicBool::new(false);
static TELL: OnceLock<fn(&str)> = OnceLock::new();

/// Signals that ask for a stop; the second one of a kind ends the process.
#[cfg(unix)]
const ASKING: [c_int; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const ASKING: [c_int; 2] = [SIGINT, SIGTERM];

/// Makes signals end the solves of this process with [`Status::Interrupted`]: Ctrl-C (SIGINT), SIGTERM and SIGHUP, each of
/// which ends the process when it comes again, with exit status 128 plus its number, and SIGXCPU, which comes when a limit of computing time
/// is near. `tell` writes a message for the user. Signals that the process was started to ignore, as by `nohup`, it ignores.
///
/// Only the first call has an effect.
pub fn install(tell: fn(&str)) {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        TELL.set(tell).ok();
        let ignored = ignored();
        for signal in ASKING.into_iter().filter(|signal| !ignored(*signal)) {
            if let Err(error) = stop_at(signal) {
                tracing::warn!("signal {signal} will not stop a solve in good order: {error}");
            }
        }
        #[cfg(unix)]
        if let Err(error) = flag::register(signal_hook::consts::SIGXCPU, REQUESTED.clone()) {
            tracing::warn!(
                "a limit of computing time will not stop a solve in good order: {error}"
            );
        }
    });
}

/// Makes a file that would grow beyond the limit of the process (SIGXFSZ) an error of its writing, as where the disk is full.
///
/// # Errors
/// That of the system.
pub fn outlive_file_limit() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
    Ok(())
}

fn stop_at(signal: c_int) -> io::Result<()> {
    let came = Arc::<AtomicBool>::default();
    // In this order: the first one finds that none came before.
    flag::register_conditional_shutdown(signal, EXIT_STATUS + signal, came.clone())?;
    flag::register(signal, came)?;
    flag::register(signal, REQUESTED.clone())?;
    Ok(())
}

/// Returns true if a signal has asked for a stop, and writes the message once.
fn have_asked() -> bool {
    let have = REQUESTED.load(Ordering::Relaxed);
    if have
        && !TOLD.swap(true, Ordering::Relaxed)
        && let Some(tell) = TELL.get()
    {
        tell(WORDS);
    }
    have
}

/// Returns a test for the signals that the process was started to ignore, where the system reports them.
fn ignored() -> impl Fn(c_int) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let mask = lines.find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    move |signal| mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
