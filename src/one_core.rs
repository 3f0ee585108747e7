//! Needs of the libraries while they are loaded: one core, and room for their first block of memory.
//!
//! OpenBLAS, which Ipopt and MUMPS call, starts a thread for each further core as soon as it is loaded, before `main`. These threads are of
//! no use: two are slower on these systems. They keep a core busy for a tenth of a second, and where memory is limited they ask for it for ever, so
//! that the process never ends; where no thread can be had OpenBLAS ends the process. It starts none where the process has one core.
//!
//! The OpenBLAS beside a MUMPS with MPI (0.3.29 in Debian 13) also takes a block of 128 MiB then, and asks for it for ever where the address
//! space is limited to less: the process ends with a message instead. Without MPI it ends so where the kept problems would run out of memory.

use std::sync::OnceLock;

use rustix::mm::{MapFlags, ProtFlags, mmap_anonymous, munmap};
use rustix::process::{Resource, getrlimit};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// The cores that the process was given.
static CORES: OnceLock<CpuSet> = OnceLock::new();

macro_rules! room {
    ($mebibytes:literal) => {
        /// Address space that has to be left when the libraries are mapped.
        const ROOM: usize = $mebibytes << 20;
        /// Message where there is less.
        const TOO_LITTLE: &str = concat!(
            "error: too little address space: expected ",
            $mebibytes,
            " MiB more than the libraries take (ulimit -v)\n"
        );
    };
}
// The first block of OpenBLAS, and 17 MiB that a library of MPI takes before it, for a thread and its data.
#[cfg(mpi)]
room!(160);
// The memory of the trunk (60 MiB for 40 s of motion).
#[cfg(not(mpi))]
room!(64);

/// Called by the loader before it initialises the libraries.
#[used]
#[expect(unsafe_code, reason = "a section of the program by its name")]
// SAFETY: the loader takes the section for a list of functions to be called with C's convention; what they are given they may ignore.
#[unsafe(link_section = ".preinit_array")]
static BEGIN: extern "C" fn() = begin;

extern "C" fn begin() {
    if is_limited() && !has_room(ROOM) {
        let _written = rustix::io::write(rustix::stdio::stderr(), TOO_LITTLE.as_bytes());
        exit_now();
    }
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

/// Returns true if the process may have a part of the address space only.
fn is_limited() -> bool {
    getrlimit(Resource::As).current.is_some()
}

/// Ends the process with status 1, before anything that is to be done at its end.
#[expect(unsafe_code, reason = "a function of C")]
fn exit_now() -> ! {
    // SAFETY: it takes any number and does not return.
    unsafe { libc::_exit(1) }
}

/// Makes all threads share one pool of memory where the address space is limited: glibc reserves 64 MiB for each further one, and nothing is
/// left for the first.
fn share_memory() {
    #[cfg(target_env = "gnu")]
    if is_limited() {
        #[expect(unsafe_code, reason = "a function of C")]
        // SAFETY: it takes any numbers, and there is no other thread yet.
        unsafe {
            libc::mallopt(libc::M_ARENA_MAX, 1);
        }
    }
}

/// Returns true if a block of memory of this length can be had.
#[expect(unsafe_code, reason = "memory of the process by its address")]
fn has_room(length: usize) -> bool {
    let (protection, flags) = (ProtFlags::empty(), MapFlags::PRIVATE);
    // SAFETY: the kernel chooses the place of the block, which nothing reads or writes before it is given back.
    unsafe {
        let block = mmap_anonymous(std::ptr::null_mut(), length, protection, flags);
        block.is_ok_and(|block| munmap(block, length).is_ok())
    }
}

/// Gives the process its cores back, for threads that share its memory.
pub(crate) fn end() {
    share_memory();
    if let Some(cores) = CORES.get()
        && let Err(error) = sched_setaffinity(None, cores)
    {
        tracing::warn!("this process works on one core: {error}");
    }
}
