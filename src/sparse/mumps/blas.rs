//! The number of threads of OpenBLAS.

#![expect(unsafe_code, reason = "C interface of OpenBLAS")]

use std::ffi::{c_int, c_void};
use std::mem;
use std::sync::Once;

/// Makes OpenBLAS, if it is loaded, work in one thread: two are slower on these systems and change the results.
///
/// OpenBLAS reads its environment variables while it is loaded, before `main`, so that setting them here would come too late.
pub(super) fn use_one_blas_thread() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // SAFETY: the name ends in NUL; `dlsym` looks it up among the libraries already loaded and returns null if there is none.
        let symbol =
            unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"openblas_set_num_threads".as_ptr()) };
        if !symbol.is_null() {
            // SAFETY: OpenBLAS declares `void openblas_set_num_threads(int)`, and the lock keeps its other users of this
            // crate out.
            let set_num_threads =
                unsafe { mem::transmute::<*mut c_void, unsafe extern "C" fn(c_int)>(symbol) };
            // SAFETY: as above.
            unsafe { set_num_threads(1) };
        }
    });
}
