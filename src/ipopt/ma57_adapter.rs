//! The linear solver along the horizon in the place of MA57 of the HSL.
//!
//! Ipopt can be given the functions of a linear solver that it was not built with: up to 3.13 by `LSL_setMA57` of its header `HSLLoader.h`, from
//! 3.14 on by the static function `Ipopt::Ma57TSolverInterface::SetFunctions` of C++, whose mangled name holds the types of its arguments. Both take
//! the same five functions, for all problems of the process. Meaning of the arguments: specification of MA57 (HSL, 2016) and
//! `IpMa57TSolverInterface.cpp`; the arrays `keep`, `fact` and `ifact`, in which MA57 stores what it knows, stay unused.
//!
//! A process may hold another Ipopt too, as Python does with packages that bring their own: names are looked up in the library that the linked
//! functions stand in, and among all libraries only where that one cannot be identified, as in a program that contains Ipopt.

#![expect(unsafe_code, reason = "C interface of Ipopt")]

use std::ffi::{CStr, c_int, c_uint, c_void};
use std::mem::MaybeUninit;
use std::ptr::NonNull;
use std::sync::OnceLock;
use std::{mem, slice};

use crate::ipopt::ffi;
use crate::ipopt::session::with_current;
use crate::ipopt::solution::NoStages;

/// Numbers in `info`, in `icntl` and in `cntl`.
const INFO: usize = 40;
const ICNTL: usize = 20;
const CNTL: usize = 5;
/// `info(1)` of a system that is singular, and of a failure that ends the solve.
const SINGULAR: c_int = 4;
const FAILED: c_int = -1;
/// Length of the arrays that nothing is stored in.
const UNUSED: c_int = 10;

/// Takes the functions of analysis, factorisation, solution, of more room, and of defaults, whose arguments MA57 gives.
type SetMa57 =
    unsafe extern "C" fn(*const c_void, *const c_void, *const c_void, *const c_void, *const c_void);

type LinearSolvers = unsafe extern "C" fn(c_int) -> c_uint;

/// Symbols that take the functions: of 3.13 and before, and of 3.14, as `c++filt` shows.
const SETTERS: [&CStr; 2] = [
    c"LSL_setMA57",
    c"_ZN5Ipopt20Ma57TSolverInterface12SetFunctionsEPFvPiS1_PKiS3_S1_S1_S1_S1_S1_PdEPFvS1_S1_S4_S4_S1_S1_S1_S1_S1_S1_S1_S4_S1_S4_EPFvS1_S1_S4_S1_S1_S1_S1_S4_S1_S4_S1_S1_S1_S1_EPFvS1_S1_S1_S4_S1_S4_S1_S1_S1_S1_S1_S1_EPFvS4_S1_E",
];
/// Tells the linear solvers that may be asked for, since 3.14, where a build may leave MA57 out.
const LINEAR_SOLVERS: &CStr = c"IpoptGetAvailableLinearSolvers";
/// `IPOPTLINEARSOLVER_MA57` of `IpLinearSolvers.h`.
const MA57: c_uint = 2;

/// Gives Ipopt the functions, once in a process.
pub(super) fn install() -> Result<(), NoStages> {
    static TAKEN: OnceLock<Result<(), NoStages>> = OnceLock::new();
    *TAKEN.get_or_init(|| {
        let ipopt = Loaded::with(ffi::address());
        if let Some(symbol) = ipopt.function(LINEAR_SOLVERS) {
            // SAFETY: `IpLinearSolvers.h` declares the function with these types.
            let known = unsafe {
                let ask = mem::transmute::<NonNull<c_void>, LinearSolvers>(symbol);
                // Linked or loaded.
                ask(0)
            };
            if known & MA57 == 0 {
                return Err(NoStages::WithoutMa57);
            }
        }
        let symbol = SETTERS.into_iter().find_map(|name| ipopt.function(name));
        let symbol = symbol.ok_or(NoStages::WithoutSetter)?;
        // SAFETY: `HSLLoader.h` declares the first function with five pointers to functions, the second one's name tells them, and a static
        // function of C++ is called as one of C; a pointer to a function is passed as any other.
        let set = unsafe { mem::transmute::<NonNull<c_void>, SetMa57>(symbol) };
        let [analyse, factor, solve, enlarge, initialise] = functions_of_ma57();
        // SAFETY: the functions have the arguments of MA57 and live as long as the process, and the cell keeps other threads out.
        unsafe { set(analyse, factor, solve, enlarge, initialise) };
        Ok(())
    })
}

/// Functions that Ipopt calls in the place of MA57, in the order of its setter.
#[doc(hidden)]
#[must_use]
pub fn functions_of_ma57() -> [*const c_void; 5] {
    [
        analyse as *const c_void,
        factor as *const c_void,
        solve as *const c_void,
        enlarge as *const c_void,
        initialise as *const c_void,
    ]
}

/// `length` numbers at `start`.
///
/// # Safety
///
/// Unless `length` is zero, `start` points to that many numbers which nobody writes to during the life of the slice.
unsafe fn read<'s, T>(start: *const T, length: usize) -> &'s [T] {
    match length {
        0 => &[],
        // SAFETY: the caller vouches for it.
        _ => unsafe { slice::from_raw_parts(start, length) },
    }
}

/// The number at `place`, none of which is negative.
///
/// # Safety
///
/// `place` points to a number.
unsafe fn count(place: *const c_int) -> usize {
    // SAFETY: the caller vouches for it.
    usize::try_from(unsafe { *place }).unwrap_or(0)
}

/// Answers with `info(1)` and further entries, counted from one; all others are zero.
///
/// # Safety
///
/// `info` points to [`INFO`] numbers.
unsafe fn answer(info: *mut c_int, first: c_int, others: &[(usize, usize)]) {
    // SAFETY: the caller vouches for it.
    let info = unsafe { slice::from_raw_parts_mut(info, INFO) };
    info.fill(0);
    info[0] = first;
    for &(place, number) in others {
        info[place - 1] = c_int::try_from(number).unwrap_or(c_int::MAX);
    }
}

unsafe extern "C" fn initialise(cntl: *mut f64, icntl: *mut c_int) {
    // SAFETY: Ipopt passes arrays of these lengths.
    unsafe {
        slice::from_raw_parts_mut(cntl, CNTL).fill(0.0);
        slice::from_raw_parts_mut(icntl, ICNTL).fill(0);
    }
}

unsafe extern "C" fn analyse(
    n: *mut c_int,
    entries: *mut c_int,
    rows: *const c_int,
    cols: *const c_int,
    _lkeep: *mut c_int,
    _keep: *mut c_int,
    _iwork: *mut c_int,
    _icntl: *mut c_int,
    info: *mut c_int,
    _rinfo: *mut f64,
) {
    // SAFETY: Ipopt passes the order, the number of entries, their rows and columns, and `INFO` places for the answer.
    unsafe {
        let (order, entries) = (count(n), count(entries));
        let (rows, cols) = (read(rows, entries), read(cols, entries));
        let done = with_current(|session| session.analyse(order, rows, cols));
        let first = done.flatten().map_or(FAILED, |()| 0);
        let unused = UNUSED.unsigned_abs() as usize;
        answer(info, first, &[(9, unused), (10, unused)]);
    }
}

unsafe extern "C" fn factor(
    n: *mut c_int,
    entries: *mut c_int,
    values: *mut f64,
    _fact: *mut f64,
    _lfact: *mut c_int,
    _ifact: *mut c_int,
    _lifact: *mut c_int,
    _lkeep: *mut c_int,
    _keep: *mut c_int,
    _iwork: *mut c_int,
    _icntl: *mut c_int,
    cntl: *mut f64,
    info: *mut c_int,
    _rinfo: *mut f64,
) {
    // SAFETY: Ipopt passes as many values as it passed entries, the pivot tolerance in `cntl(1)`, and `INFO` places for the answer.
    unsafe {
        let (order, values, tolerance) = (count(n), read(values, count(entries)), *cntl);
        match with_current(|session| session.factor(values, tolerance)) {
            Some(Some(inertia)) => {
                let first = if inertia.zero > 0 { SINGULAR } else { 0 };
                let rank = order - inertia.zero;
                answer(info, first, &[(24, inertia.negative), (25, rank)]);
            }
            Some(None) | None => answer(info, FAILED, &[]),
        }
    }
}

unsafe extern "C" fn solve(
    _job: *mut c_int,
    n: *mut c_int,
    _fact: *mut f64,
    _lfact: *mut c_int,
    _ifact: *mut c_int,
    _lifact: *mut c_int,
    columns: *mut c_int,
    right: *mut f64,
    stride: *mut c_int,
    _work: *mut f64,
    _lwork: *mut c_int,
    _iwork: *mut c_int,
    _icntl: *mut c_int,
    info: *mut c_int,
) {
    // SAFETY: Ipopt passes right-hand sides of `n` numbers, `stride` apart, that nobody else uses meanwhile, and `INFO` places for
    // the answer.
    unsafe {
        let (order, columns, stride) = (count(n), count(columns), count(stride));
        let length = match columns {
            0 => 0,
            _ => (columns - 1) * stride + order,
        };
        let right = match length {
            0 => &mut [],
            _ => slice::from_raw_parts_mut(right, length),
        };
        let done = with_current(|session| session.solve(right, stride.max(1)));
        answer(info, done.map_or(FAILED, |()| 0), &[]);
    }
}

/// Never called: there is always room for the factors.
unsafe extern "C" fn enlarge(
    _n: *mut c_int,
    _ic: *mut c_int,
    _keep: *mut c_int,
    _fact: *mut f64,
    _lfact: *mut c_int,
    _newfac: *mut f64,
    _lnew: *mut c_int,
    _ifact: *mut c_int,
    _lifact: *mut c_int,
    _newifc: *mut c_int,
    _linew: *mut c_int,
    info: *mut c_int,
) {
    // SAFETY: Ipopt passes `INFO` places for the answer.
    unsafe { answer(info, FAILED, &[]) };
}

/// The library that a function stands in.
struct Loaded {
    /// Of `dlopen`, which is never closed, or that of all libraries.
    handle: *mut c_void,
}

impl Loaded {
    /// The library of this function.
    fn with(function: *const c_void) -> Self {
        let mut info = MaybeUninit::<libc::Dl_info>::zeroed();
        // SAFETY: `dladdr` writes the structure where it knows the address, and returns zero elsewhere; zeros are null pointers.
        let name = unsafe {
            libc::dladdr(function, info.as_mut_ptr());
            info.assume_init().dli_fname
        };
        let handle = match name.is_null() {
            true => None,
            // SAFETY: the loader's name of a library, which ends in NUL; nothing is loaded that is not there.
            false => {
                NonNull::new(unsafe { libc::dlopen(name, libc::RTLD_LAZY | libc::RTLD_NOLOAD) })
            }
        };
        Self {
            handle: handle.map_or(libc::RTLD_DEFAULT, NonNull::as_ptr),
        }
    }

    /// A function of the library or of those that it needs, if there is one of this name.
    fn function(&self, name: &CStr) -> Option<NonNull<c_void>> {
        // SAFETY: the name ends in NUL, and the handle is one of `dlopen` that was never closed, or that of all libraries.
        NonNull::new(unsafe { libc::dlsym(self.handle, name.as_ptr()) })
    }
}
