//! SCOTCH, which MUMPS asks for an order of elimination, so that it gives the same one every time.

#![expect(unsafe_code, reason = "C interface and environment of SCOTCH")]

use std::env;
use std::ffi::c_void;
use std::mem;
use std::sync::Once;

/// What SCOTCH asks the environment for.
const THREADS: &str = "SCOTCH_PTHREAD_NUMBER";

/// Makes SCOTCH order in one thread, unless the environment says otherwise: from several threads, as many as there are cores, the order
/// differs from run to run, and with it the last digits of every solution.
///
/// MUMPS calls SCOTCH, which takes the number from the environment alone.
pub(super) fn use_one_ordering_thread() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        if env::var_os(THREADS).is_none() {
            // SAFETY: the standard library keeps its own readers out; MUMPS and SCOTCH, which are called under the lock of
            // this crate, do not run yet; the other libraries of this crate do not read the environment after they are loaded.
            unsafe { env::set_var(THREADS, "1") };
        }
    });
}

/// Lets the random numbers of SCOTCH, if it is loaded, begin anew: an order does not depend on those before it.
pub(super) fn restart_random_numbers() {
    // SAFETY: the name ends in NUL; `dlsym` looks it up among the libraries already loaded and returns null if there is none.
    let symbol = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"SCOTCH_randomReset".as_ptr()) };
    if !symbol.is_null() {
        // SAFETY: SCOTCH declares `void SCOTCH_randomReset(void)`, and the lock keeps other calls of this crate out.
        let reset = unsafe { mem::transmute::<*mut c_void, unsafe extern "C" fn()>(symbol) };
        // SAFETY: as above.
        unsafe { reset() };
    }
}
