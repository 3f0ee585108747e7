//! The number of threads of SCOTCH.

#![expect(unsafe_code, reason = "environment of SCOTCH, a C library")]

use std::env;
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
