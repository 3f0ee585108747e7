//! The lock of MUMPS, which keeps state for the whole process.

use std::fmt;

use parking_lot::{ReentrantMutex, ReentrantMutexGuard};

use crate::sparse::mumps::libraries::use_one_thread;

static LOCK: ReentrantMutex<()> = ReentrantMutex::new(());

/// While it exists, no other thread calls MUMPS or Ipopt.
pub(crate) struct Exclusive {
    _guard: ReentrantMutexGuard<'static, ()>,
}

impl fmt::Debug for Exclusive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Exclusive")
    }
}

/// Waits until no other thread is in MUMPS or Ipopt.
///
/// One thread may ask twice: what Ipopt calls back may use MUMPS, since Ipopt itself is not in MUMPS then. But such a callback
/// must not wait for another thread that does.
pub(crate) fn exclusive() -> Exclusive {
    let guard = LOCK.lock();
    use_one_thread();
    #[cfg(mpi)]
    crate::sparse::mumps::mpi::start();
    Exclusive { _guard: guard }
}
