//! Signals that ask for a stop: Ctrl-C, the end of a session, the end that a system asks for.
//!
//! They are recorded without a thread, since there may be none; callers of [`interrupt`](super::interrupt) see them.

use std::ffi::c_int;
use std::fs;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Once, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

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

/// Makes signals end the solves of this process with [`Status::Interrupted`](super::Status::Interrupted): Ctrl-C (SIGINT), SIGTERM and SIGHUP, each of
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
pub(super) fn have_asked() -> bool {
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
