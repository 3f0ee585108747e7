//! The start of MPI, which a parallel MUMPS needs: when MUMPS is first called, not when the program is loaded.
//!
//! An Ipopt that is linked with MPI starts it while the loader initialises libraries, unless `MPI_Initialized` says that it runs, and ends it with
//! the process, unless `MPI_Finalized` says that it has ended. That would cost every command a sixth of a second, two threads and sockets, where
//! the linear solver along the horizon calls no MUMPS. So the program answers both questions itself, as tools for profiling do (MPI has each function a
//! second time, under a name that begins with `PMPI_`, for this): until all libraries are there MPI counts as running, and as ended where it never ran.
//! Tests that compile this file again have the answers of the library.

#![expect(unsafe_code, reason = "C interface of MPI")]

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::{NonNull, null_mut};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::{mem, thread};

use crate::sparse::mumps::libraries::loaded;

/// `MPI_SUCCESS`.
const SUCCESS: c_int = 0;
/// `MPI_THREAD_SERIALIZED` of Open MPI and MPICH: any thread calls it, one at a time.
const SERIALIZED: c_int = 2;

type Ask = unsafe extern "C" fn(*mut c_int) -> c_int;
type Start = unsafe extern "C" fn(*mut c_int, *mut *mut *mut c_char, c_int, *mut c_int) -> c_int;

/// True once the libraries that the program needs have been initialised.
static ARE_INITIALISED: AtomicBool = AtomicBool::new(false);

/// The loader calls it when all libraries that the program needs have been initialised.
#[used]
#[unsafe(link_section = ".init_array")]
static LAST: extern "C" fn() = {
    extern "C" fn note() {
        ARE_INITIALISED.store(true, Ordering::Relaxed);
    }
    note
};

/// Returns true if MPI runs or can be started: it starts threads, and ends the process where it gets none.
pub(crate) fn has_threads() -> bool {
    let is_needed = answer(c"PMPI_Initialized") == Some(false);
    let made = || thread::Builder::new().spawn(|| ());
    !is_needed || made().is_ok_and(|thread| thread.join().is_ok())
}

/// Starts MPI unless it runs. The lock of MUMPS keeps others out.
pub(super) fn start() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        if answer(c"PMPI_Initialized") == Some(false)
            && let Some(symbol) = loaded(c"PMPI_Init_thread")
        {
            let mut provided = 0;
            // SAFETY: MPI declares the function with these types, and takes null for the arguments of the program.
            unsafe {
                let start = mem::transmute::<NonNull<c_void>, Start>(symbol);
                start(null_mut(), null_mut(), SERIALIZED, &raw mut provided);
            }
            tracing::debug!(provided, "MPI runs, for MUMPS");
        }
    });
}

/// Answer of an MPI function; nothing without MPI.
fn answer(name: &CStr) -> Option<bool> {
    let symbol = loaded(name)?;
    let mut flag = 0;
    // SAFETY: MPI declares both functions that are asked with these types; they may be called at any time.
    unsafe { mem::transmute::<NonNull<c_void>, Ask>(symbol)(&raw mut flag) };
    Some(flag != 0)
}

/// Reports that MPI runs if it does, or if nobody is to start it yet.
///
/// # Safety
///
/// `flag` points to a number.
#[cfg(not(test))]
#[unsafe(no_mangle)]
unsafe extern "C" fn MPI_Initialized(flag: *mut c_int) -> c_int {
    let is_to_wait = !ARE_INITIALISED.load(Ordering::Relaxed);
    let runs = is_to_wait || answer(c"PMPI_Initialized").unwrap_or(false);
    // SAFETY: the caller vouches for it.
    unsafe { *flag = c_int::from(runs) };
    SUCCESS
}

/// Reports that MPI has ended if it has, or never ran.
///
/// # Safety
///
/// `flag` points to a number.
#[cfg(not(test))]
#[unsafe(no_mangle)]
unsafe extern "C" fn MPI_Finalized(flag: *mut c_int) -> c_int {
    let has_run = answer(c"PMPI_Initialized").unwrap_or(false);
    let has_ended = !has_run || answer(c"PMPI_Finalized").unwrap_or(true);
    // SAFETY: the caller vouches for it.
    unsafe { *flag = c_int::from(has_ended) };
    SUCCESS
}
