//! One core for the process while its libraries are loaded.
//!
//! OpenBLAS, which Ipopt and MUMPS call, starts a thread for each further core as soon as it is loaded, before `main`. These threads are of
//! no use: two are slower on these systems. They keep a core busy for a tenth of a second, and where memory is limited they ask for it for ever, so
//! that the process never ends; where no thread can be had OpenBLAS ends the process. It starts none where the process has one core.

use std::sync::OnceLock;

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// The cores that the process was given.
static CORES: OnceLock<CpuSet> = OnceLock::new();

/// Called by the loader before it initialises the libraries.
#[used]
#[expect(unsafe_code, reason = "a section of the program by its name")]
// SAFETY: the loader takes the section for a list of functions to be called with C's convention; what they are given they may ignore.
#[unsafe(link_section = ".preinit_array")]
static BEGIN: extern "C" fn() = begin;

extern "C" fn begin() {
    let Ok(cores) = sched_getaffinity(None) else {
        return;
    };
    let Some(first) = (0..CpuSet::MAX_CPU).find(|&core| cores.is_set(core)) else {
        return;
    };
    let mut one = CpuSet::new();
    one.set(first);
    if cores.count() > 1 && sched_setaffinity(None, &one).is_ok() {
        CORES.set(cores).ok();
    }
}

/// Gives the process its cores back.
pub(crate) fn end() {
    if let Some(cores) = CORES.get()
        && let Err(error) = sched_setaffinity(None, cores)
    {
        tracing::warn!("this process works on one core: {error}");
    }
}
