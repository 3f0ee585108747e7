//! The libraries that MUMPS calls: threads of OpenBLAS, threads and random numbers of SCOTCH.

#![expect(
    unsafe_code,
    reason = "C interfaces of OpenBLAS and SCOTCH, and the environment"
)]

use std::ffi::{CStr, c_int, c_void};
use std::ptr::NonNull;
use std::sync::{LazyLock, Once};
use std::{env, hint, mem};

/// Environment variable that SCOTCH reads.
const SCOTCH_THREADS: &str = "SCOTCH_PTHREAD_NUMBER";

/// Makes both work in one thread. The lock of this crate keeps their other users in it out.
pub(super) fn use_one_thread() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        use_one_blas_thread();
        use_one_ordering_thread();
    });
}

/// Makes OpenBLAS, if it is loaded, work in one thread: two are slower on these systems and change the results.
///
/// OpenBLAS reads its environment variables while it is loaded, before `main`, so that setting them here would come too late.
fn use_one_blas_thread() {
    if let Some(symbol) = loaded(c"openblas_set_num_threads") {
        // SAFETY: OpenBLAS declares `void openblas_set_num_threads(int)`, and the lock keeps its other users of this crate out.
        let set_num_threads =
            unsafe { mem::transmute::<NonNull<c_void>, unsafe extern "C" fn(c_int)>(symbol) };
        // SAFETY: as above.
        unsafe { set_num_threads(1) };
    }
}

/// Makes SCOTCH order in one thread, unless the environment says otherwise: from several threads, as many as there are cores, the order
/// differs from run to run, and with it the last digits of every solution.
///
/// MUMPS calls SCOTCH, which takes the number from the environment alone.
fn use_one_ordering_thread() {
    if env::var_os(SCOTCH_THREADS).is_none() {
        // SAFETY: the standard library keeps its own readers out; MUMPS and SCOTCH, which are called under the lock of
        // this crate, do not run yet; the other libraries of this crate do not read the environment after they are loaded.
        unsafe { env::set_var(SCOTCH_THREADS, "1") };
    }
}

/// Lets the random numbers of SCOTCH, if it is loaded, begin anew: an order does not depend on those before it.
pub(super) fn restart_random_numbers() {
    if let Some(symbol) = loaded(c"SCOTCH_randomReset") {
        // SAFETY: SCOTCH declares `void SCOTCH_randomReset(void)`, and the lock keeps other calls of this crate out.
        let reset = unsafe { mem::transmute::<NonNull<c_void>, unsafe extern "C" fn()>(symbol) };
        // SAFETY: as above.
        unsafe { reset() };
    }
}

/// Returns true unless OpenBLAS is loaded and lacks the memory that it takes at its first call. It would then ask again and
/// again and never returns.
pub(crate) fn has_room() -> bool {
    /// Memory that OpenBLAS takes, and a little more; with MPI also that which MPI takes before.
    const ROOM: usize = if cfg!(mpi) { 280 << 20 } else { 136 << 20 };
    static HAS_ROOM: LazyLock<bool> = LazyLock::new(|| {
        let is_needed = loaded(c"openblas_set_num_threads").is_some();
        let mut room = Vec::<u8>::new();
        let taken = room.try_reserve_exact(ROOM);
        // What nobody looks at may not be taken at all.
        hint::black_box(&mut room);
        !is_needed || taken.is_ok()
    });
    *HAS_ROOM
}

/// A function of a library that is loaded, if there is one of this name.
pub(super) fn loaded(name: &CStr) -> Option<NonNull<c_void>> {
    // SAFETY: the name ends in NUL; `dlsym` looks it up among the libraries already loaded and returns null if there is none.
    NonNull::new(unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) })
}
