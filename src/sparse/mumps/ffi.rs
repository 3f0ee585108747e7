//! The C interface of MUMPS: bindings, and one instance per matrix.
//!
//! Words of the manual: an instance goes through jobs (initialisation −1, analysis 1, factorisation 2, solution 3, end −2);
//! `ICNTL` and `CNTL` are its controls, `INFOG` its answers; all three are counted from one.

#![expect(unsafe_code, reason = "C interface of MUMPS")]

use std::ffi::c_int;
use std::fmt;
use std::mem::MaybeUninit;
use std::ptr;
use std::slice;

use crate::sparse::Symmetry;
use crate::sparse::mumps::lock::exclusive;

/// What `bindgen` makes of `dmumps_c.h`.
#[allow(
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    dead_code,
    clippy::all,
    reason = "generated from a C header that differs between versions"
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/mumps.rs"));
}

/// The communicator of the library without MPI.
const COMM_WORLD: c_int = -987_654;

/// What an instance is asked to do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Job {
    Analyse = 1,
    Factor = 2,
    Solve = 3,
}

/// A matrix known to MUMPS, with its symbolic and numeric factors.
pub(super) struct Instance {
    /// Its arrays `irn` and `jcn` are those below; `a` and `rhs` are null between two calls.
    data: Box<bindings::DMUMPS_STRUC_C>,
    rows: Vec<c_int>,
    cols: Vec<c_int>,
}

// SAFETY: nothing in an instance belongs to a thread, and every call to MUMPS takes the lock of the process.
unsafe impl Send for Instance {}

impl Instance {
    /// An instance for matrices of `size` rows with these entries, counted from one.
    pub(super) fn new(size: usize, symmetry: Symmetry, rows: Vec<c_int>, cols: Vec<c_int>) -> Self {
        assert_eq!(rows.len(), cols.len(), "as many rows as columns");
        // SAFETY: the structure is made of numbers and pointers, for which zero is a value.
        let data = unsafe { Box::<MaybeUninit<_>>::new(MaybeUninit::zeroed()).assume_init() };
        let mut instance = Self { data, rows, cols };
        instance.data.par = 1;
        instance.data.sym = match symmetry {
            Symmetry::Unsymmetric => 0,
            Symmetry::Symmetric => 2,
        };
        instance.data.comm_fortran = COMM_WORLD;
        instance.call(-1);
        instance.data.n = c_int::try_from(size).expect("a size that MUMPS can count");
        instance.data.nnz = i64::try_from(instance.rows.len()).expect("a countable matrix");
        instance.data.irn = instance.rows.as_mut_ptr();
        instance.data.jcn = instance.cols.as_mut_ptr();
        instance
    }

    /// Sets ICNTL(`number`).
    pub(super) fn control(&mut self, number: usize, value: c_int) {
        self.data.icntl[number - 1] = value;
    }

    /// Sets CNTL(`number`).
    pub(super) fn threshold(&mut self, number: usize, value: f64) {
        self.data.cntl[number - 1] = value;
    }

    /// INFOG(`number`).
    pub(super) fn information(&self, number: usize) -> c_int {
        self.data.infog[number - 1]
    }

    /// The place of each row in the order of elimination, counted from one; empty before the analysis.
    pub(super) fn places(&self) -> &[c_int] {
        let (start, size) = (self.data.sym_perm, usize::try_from(self.data.n));
        match size {
            // SAFETY: after the analysis the pointer leads to `n` numbers, which stay unchanged until the next call.
            Ok(size) if !start.is_null() => unsafe { slice::from_raw_parts(start, size) },
            _ => &[],
        }
    }

    /// Does `job` with the values of the matrix or the right-hand side, and returns INFOG(1): negative where it failed.
    pub(super) fn run(&mut self, job: Job, numbers: &mut [f64]) -> c_int {
        match job {
            Job::Analyse => self.call(job as c_int),
            Job::Factor => {
                assert_eq!(numbers.len(), self.rows.len(), "one value per entry");
                self.data.a = numbers.as_mut_ptr();
                let code = self.call(job as c_int);
                self.data.a = ptr::null_mut();
                code
            }
            Job::Solve => {
                let size = usize::try_from(self.data.n).unwrap_or_default();
                assert_eq!(numbers.len(), size, "one number per row");
                self.data.rhs = numbers.as_mut_ptr();
                let code = self.call(job as c_int);
                self.data.rhs = ptr::null_mut();
                code
            }
        }
    }

    fn call(&mut self, job: c_int) -> c_int {
        let _lock = exclusive();
        self.data.job = job;
        // SAFETY: the instance was initialised (that is job −1); its arrays have the lengths that `n` and `nnz` tell and live
        // during the call; the lock keeps all other users of MUMPS out.
        unsafe { bindings::dmumps_c(&raw mut *self.data) };
        self.data.infog[0]
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.call(-2);
    }
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance")
            .field("n", &self.data.n)
            .field("nnz", &self.data.nnz)
            .finish_non_exhaustive()
    }
}
