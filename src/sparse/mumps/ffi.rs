//! The C interface of MUMPS, one instance per matrix.
//!
//! Words of the manual: an instance goes through jobs (initialisation −1, analysis 1, factorisation 2, solution 3, end −2);
//! `ICNTL` and `CNTL` are its controls, `INFOG` its answers; all three are counted from one. `instance.c` knows where they stand in the structure,
//! which differs between versions.

#![expect(unsafe_code, reason = "C interface of MUMPS")]

use crate::sparse::Symmetry;
use crate::sparse::mumps::libraries::use_one_thread;
use parking_lot::{ReentrantMutex, ReentrantMutexGuard};
use std::ffi::{CStr, c_char, c_int};
use std::ptr::NonNull;
use std::{fmt, ptr, slice};

/// `DMUMPS_STRUC_C`, which `instance.c` looks into.
#[repr(C)]
struct Structure {
    _inside: [u8; 0],
}

unsafe extern "C" {
    fn proboscis_mumps_begin(symmetry: c_int) -> *mut Structure;
    fn proboscis_mumps_end(instance: *mut Structure);
    fn proboscis_mumps_header() -> *const c_char;
    fn proboscis_mumps_library(instance: *const Structure, most: *mut usize) -> *const c_char;
    fn proboscis_mumps_matrix(
        instance: *mut Structure,
        n: c_int,
        entries: i64,
        rows: *mut c_int,
        cols: *mut c_int,
    );
    fn proboscis_mumps_icntl(instance: *mut Structure) -> *mut c_int;
    fn proboscis_mumps_cntl(instance: *mut Structure) -> *mut f64;
    fn proboscis_mumps_infog(instance: *const Structure) -> *const c_int;
    fn proboscis_mumps_places(instance: *const Structure) -> *const c_int;
    fn proboscis_mumps_call(
        instance: *mut Structure,
        job: c_int,
        entries: *mut f64,
        right: *mut f64,
    ) -> c_int;
}

/// Lengths of `ICNTL`, `CNTL` and `INFOG`.
const ICNTL: usize = 60;
const CNTL: usize = 15;
const INFOG: usize = 80;

/// Job of an instance, with its number.
#[derive(Clone, Copy, Debug)]
pub(super) enum Job {
    Analyse = 1,
    Factor = 2,
    Solve = 3,
}

/// A matrix known to MUMPS, with its symbolic and numeric factors.
pub(super) struct Instance {
    /// Its arrays `irn` and `jcn` are those below; `a` and `rhs` are null between two calls.
    structure: NonNull<Structure>,
    size: usize,
    rows: Vec<c_int>,
    cols: Vec<c_int>,
    is_analysed: bool,
}

// SAFETY: nothing in an instance belongs to a thread, and every call to MUMPS takes the lock of the process.
unsafe impl Send for Instance {}

impl Instance {
    /// An instance for matrices of `size` rows with these entries, counted from one.
    pub(super) fn new(size: usize, symmetry: Symmetry, rows: Vec<c_int>, cols: Vec<c_int>) -> Self {
        assert_eq!(rows.len(), cols.len(), "as many rows as columns");
        let n = c_int::try_from(size).expect("a size that MUMPS can count");
        let entries = i64::try_from(rows.len()).expect("a countable matrix");
        let symmetry = match symmetry {
            Symmetry::Unsymmetric => 0,
            Symmetry::Symmetric => 2,
        };
        let structure = {
            let _lock = exclusive();
            // SAFETY: the lock keeps all other users of MUMPS out.
            NonNull::new(unsafe { proboscis_mumps_begin(symmetry) })
                .expect("memory for an instance")
        };
        check_version(structure);
        let mut instance = Self {
            structure,
            size,
            rows,
            cols,
            is_analysed: false,
        };
        let (rows, cols) = (instance.rows.as_mut_ptr(), instance.cols.as_mut_ptr());
        // SAFETY: the structure is valid; the arrays have `entries` numbers and live as long as it.
        unsafe { proboscis_mumps_matrix(structure.as_ptr(), n, entries, rows, cols) };
        instance
    }

    /// Sets ICNTL(`number`).
    pub(super) fn control(&mut self, number: usize, value: c_int) {
        // SAFETY: the structure is valid and has `ICNTL` controls.
        let controls = unsafe {
            slice::from_raw_parts_mut(proboscis_mumps_icntl(self.structure.as_ptr()), ICNTL)
        };
        controls[number - 1] = value;
    }

    /// Sets CNTL(`number`).
    pub(super) fn threshold(&mut self, number: usize, value: f64) {
        // SAFETY: as above.
        let controls = unsafe {
            slice::from_raw_parts_mut(proboscis_mumps_cntl(self.structure.as_ptr()), CNTL)
        };
        controls[number - 1] = value;
    }

    /// INFOG(`number`).
    pub(super) fn information(&self, number: usize) -> c_int {
        // SAFETY: as above.
        let told =
            unsafe { slice::from_raw_parts(proboscis_mumps_infog(self.structure.as_ptr()), INFOG) };
        told[number - 1]
    }

    /// The place of each row in the order of elimination, counted from one; empty before the analysis.
    pub(super) fn places(&self) -> &[c_int] {
        // SAFETY: the structure is valid.
        let start = unsafe { proboscis_mumps_places(self.structure.as_ptr()) };
        match self.is_analysed && !start.is_null() {
            // SAFETY: after the analysis the pointer leads to `n` numbers, which stay unchanged until the next call.
            true => unsafe { slice::from_raw_parts(start, self.size) },
            false => &[],
        }
    }

    /// Does `job` with the values of the matrix or the right-hand side, and returns INFOG(1): negative where it failed.
    pub(super) fn run(&mut self, job: Job, numbers: &mut [f64]) -> c_int {
        let none = ptr::null_mut();
        let (entries, right) = match job {
            Job::Analyse => (none, none),
            Job::Factor => {
                assert_eq!(numbers.len(), self.rows.len(), "one value per entry");
                (numbers.as_mut_ptr(), none)
            }
            Job::Solve => {
                assert_eq!(numbers.len(), self.size, "one number per row");
                (none, numbers.as_mut_ptr())
            }
        };
        let _lock = exclusive();
        let structure = self.structure.as_ptr();
        // SAFETY: the structure is valid; its arrays have the lengths that it was told and live during the call; the lock
        // keeps all other users of MUMPS out.
        let code = unsafe { proboscis_mumps_call(structure, job as c_int, entries, right) };
        self.is_analysed |= code >= 0;
        code
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        let _lock = exclusive();
        // SAFETY: the structure is valid and ended once, here; the lock keeps all other users of MUMPS out.
        unsafe { proboscis_mumps_end(self.structure.as_ptr()) };
    }
}

/// A structure of another version than the header's has its parts elsewhere; the first two numbers of a version identify it.
fn check_version(structure: NonNull<Structure>) {
    let mut most = 0;
    // SAFETY: the structure is valid, the first text ends in NUL, and the second one has `most` places in the structure.
    let (header, library) = unsafe {
        let start = proboscis_mumps_library(structure.as_ptr(), &raw mut most);
        let library = slice::from_raw_parts(start.cast::<u8>(), most);
        (CStr::from_ptr(proboscis_mumps_header()), library)
    };
    let library = CStr::from_bytes_until_nul(library).unwrap_or_default();
    let [header, library] = [header, library].map(CStr::to_string_lossy);
    let series = |version: &str| {
        version
            .trim()
            .split('.')
            .take(2)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert!(
        series(&header) == series(&library),
        "the program was built with dmumps_c.h of MUMPS {header}, and MUMPS {library} is loaded"
    );
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance")
            .field("n", &self.size)
            .field("nnz", &self.rows.len())
            .finish_non_exhaustive()
    }
}

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
