//! The C interface of Ipopt: problems, and the callbacks over one guard against panics.

#![expect(unsafe_code, reason = "C interface of Ipopt")]

use std::any::Any;
use std::ffi::{CString, c_int, c_void};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr::{self, NonNull};
use std::slice;

use crate::ipopt::bindings::{
    AddIpoptIntOption, AddIpoptNumOption, AddIpoptStrOption, Bool, CreateIpoptProblem,
    FreeIpoptProblem, IpoptProblemInfo, IpoptSolve, SetIntermediateCallback,
};
use crate::ipopt::evaluation::Evaluator;
use crate::ipopt::solution::{Iteration, OptionValue};
use crate::nlp::{Bounds, Entries, Multipliers};
use crate::sparse::mumps::{self, Exclusive};

/// A problem known to Ipopt, for any number of solves; while one exists that uses MUMPS, no other thread has such a one or calls MUMPS.
pub(super) struct Problem {
    handle: NonNull<IpoptProblemInfo>,
    variables: usize,
    constraints: usize,
    _lock: Option<Exclusive>,
}

/// Returns the address of a function of the Ipopt that is called.
pub(super) fn address() -> *const c_void {
    FreeIpoptProblem as *const c_void
}

/// An evaluator, and the panic that ended its work, if any.
struct Session<'e, 'a> {
    evaluator: &'e mut Evaluator<'a>,
    panic: Option<Box<dyn Any + Send>>,
}

impl Problem {
    /// Creates a problem; `None` if Ipopt refuses it. One that is to be alone with MUMPS waits for the others.
    pub(super) fn new(
        variables: &Bounds,
        constraints: &Bounds,
        jacobian: usize,
        hessian: usize,
        is_alone: bool,
    ) -> Option<Self> {
        let lock = is_alone.then(mumps::exclusive);
        let count = |number: usize| c_int::try_from(number).ok();
        let (n, m) = (variables.count(), constraints.count());
        assert!(
            variables.upper.len() == n && constraints.upper.len() == m,
            "as many upper as lower bounds"
        );
        // SAFETY: the bounds are arrays of `n` and `m` numbers, which Ipopt copies; the callbacks have the types that the
        // header declares.
        let handle = unsafe {
            CreateIpoptProblem(
                count(n)?,
                variables.lower.as_ptr().cast_mut(),
                variables.upper.as_ptr().cast_mut(),
                count(m)?,
                constraints.lower.as_ptr().cast_mut(),
                constraints.upper.as_ptr().cast_mut(),
                count(jacobian)?,
                count(hessian)?,
                0,
                Some(objective),
                Some(constraint),
                Some(gradient),
                Some(self::jacobian),
                Some(self::hessian),
            )
        };
        let problem = Self {
            handle: NonNull::new(handle)?,
            variables: n,
            constraints: m,
            _lock: lock,
        };
        // SAFETY: the handle is valid; the callback has the type that the header declares.
        unsafe { SetIntermediateCallback(handle, Some(iteration)) };
        Some(problem)
    }

    /// Sets an option and returns true if Ipopt takes it.
    pub(super) fn set(&mut self, name: &str, value: &OptionValue) -> bool {
        let Ok(name) = CString::new(name) else {
            return false;
        };
        let name = name.as_ptr().cast_mut();
        let handle = self.handle.as_ptr();
        let taken = match value {
            // SAFETY: the handle is valid, and Ipopt copies the name, which ends in NUL.
            OptionValue::Integer(value) => unsafe { AddIpoptIntOption(handle, name, *value) },
            // SAFETY: as above.
            OptionValue::Number(value) => unsafe { AddIpoptNumOption(handle, name, *value) },
            OptionValue::Text(value) => {
                let Ok(value) = CString::new(value.as_str()) else {
                    return false;
                };
                // SAFETY: as above; the value is copied too and ends in NUL.
                unsafe { AddIpoptStrOption(handle, name, value.as_ptr().cast_mut()) }
            }
        };
        taken != Bool::from(false)
    }

    /// Solves from `x` and `costates`, leaves the final values there, and returns Ipopt's code for the outcome.
    ///
    /// A panic in the evaluator ends the solve and goes on from here.
    pub(super) fn solve(
        &mut self,
        evaluator: &mut Evaluator<'_>,
        x: &mut [f64],
        costates: &mut Multipliers,
    ) -> i32 {
        let Multipliers {
            constraints,
            lower,
            upper,
        } = costates;
        let lengths = [x.len(), lower.len(), upper.len(), constraints.len()];
        let (n, m) = (self.variables, self.constraints);
        let expected = "a value and two multipliers per variable, and one per constraint";
        assert_eq!(lengths, [n, n, n, m], "{expected}");
        let mut session = Session {
            evaluator,
            panic: None,
        };
        // SAFETY: the handle is valid and the arrays have the lengths it was created with. The session outlives the call and
        // is reached through the pointer alone meanwhile; Ipopt calls back from this thread only, one call at a time.
        let code = unsafe {
            IpoptSolve(
                self.handle.as_ptr(),
                x.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                constraints.as_mut_ptr(),
                lower.as_mut_ptr(),
                upper.as_mut_ptr(),
                (&raw mut session).cast(),
            )
        };
        match session.panic {
            Some(panic) => resume_unwind(panic),
            None => code,
        }
    }
}

impl Drop for Problem {
    fn drop(&mut self) {
        // SAFETY: the handle came from `CreateIpoptProblem` and is freed once, here; the lock is released afterwards.
        unsafe { FreeIpoptProblem(self.handle.as_ptr()) };
    }
}

/// Runs `evaluate` and returns its success to Ipopt.
///
/// A panic must not pass through C++: it is kept for the end, and every further question is answered by "failed".
///
/// # Safety
///
/// `session` is the pointer that [`Problem::solve`] gave to Ipopt, within that call.
unsafe fn guard(session: *mut c_void, evaluate: impl FnOnce(&mut Evaluator<'_>) -> bool) -> Bool {
    // SAFETY: the caller vouches that the session exists and is not borrowed elsewhere.
    let session = unsafe { &mut *session.cast::<Session<'_, '_>>() };
    let succeeded = session.panic.is_none()
        && catch_unwind(AssertUnwindSafe(|| evaluate(session.evaluator))).unwrap_or_else(|panic| {
            session.panic = Some(panic);
            false
        });
    Bool::from(succeeded)
}

/// `length` numbers at `start`, which may be null if there are none.
///
/// # Safety
///
/// Unless `length` is zero, `start` points to that many numbers which nobody writes to during the life of the slice.
unsafe fn read<'s>(start: *const f64, length: c_int) -> &'s [f64] {
    match usize::try_from(length) {
        // SAFETY: the caller vouches for it.
        Ok(length) if length > 0 => unsafe { slice::from_raw_parts(start, length) },
        _ => &[],
    }
}

/// `length` places to fill at `start`, which may be null if there are none.
///
/// # Safety
///
/// Unless `length` is zero, `start` points to that many initialised values which nobody else uses during the life of the slice.
unsafe fn write<'s, T>(start: *mut T, length: c_int) -> &'s mut [T] {
    match usize::try_from(length) {
        // SAFETY: the caller vouches for it.
        Ok(length) if length > 0 => unsafe { slice::from_raw_parts_mut(start, length) },
        _ => &mut [],
    }
}

/// Copies the places of a sparse matrix, which fit into `c_int` since the numbers of rows and columns do.
fn copy_entries(entries: &Entries, rows: &mut [c_int], cols: &mut [c_int]) -> bool {
    let put = |from: u32, to: &mut c_int| c_int::try_from(from).map(|index| *to = index).is_ok();
    let copy = |from: &[u32], to: &mut [c_int]| {
        from.len() == to.len() && from.iter().zip(to).all(|(&from, to)| put(from, to))
    };
    copy(&entries.rows, rows) && copy(&entries.cols, cols)
}

unsafe extern "C" fn objective(
    n: c_int,
    x: *mut f64,
    _new_x: Bool,
    value: *mut f64,
    session: *mut c_void,
) -> Bool {
    // SAFETY: Ipopt passes the session, `n` variables and a place for the value.
    unsafe {
        guard(session, |evaluator| match evaluator.objective(read(x, n)) {
            Some(f) => {
                *value = f;
                true
            }
            None => false,
        })
    }
}

unsafe extern "C" fn gradient(
    n: c_int,
    x: *mut f64,
    _new_x: Bool,
    grad: *mut f64,
    session: *mut c_void,
) -> Bool {
    // SAFETY: Ipopt passes the session, `n` variables and `n` places for the gradient.
    unsafe {
        guard(session, |evaluator| {
            evaluator.gradient(read(x, n), write(grad, n))
        })
    }
}

unsafe extern "C" fn constraint(
    n: c_int,
    x: *mut f64,
    _new_x: Bool,
    m: c_int,
    g: *mut f64,
    session: *mut c_void,
) -> Bool {
    // SAFETY: Ipopt passes the session, `n` variables and `m` places for the constraints.
    unsafe {
        guard(session, |evaluator| {
            evaluator.constraints(read(x, n), write(g, m))
        })
    }
}

unsafe extern "C" fn jacobian(
    n: c_int,
    x: *mut f64,
    _new_x: Bool,
    _m: c_int,
    entries: c_int,
    rows: *mut c_int,
    cols: *mut c_int,
    values: *mut f64,
    session: *mut c_void,
) -> Bool {
    // SAFETY: Ipopt passes the session and either `entries` places for rows and columns, or `n` variables and `entries`
    // places for the values.
    unsafe {
        guard(session, |evaluator| match values.is_null() {
            true => copy_entries(
                evaluator.jacobian_structure(),
                write(rows, entries),
                write(cols, entries),
            ),
            false => evaluator.jacobian(read(x, n), write(values, entries)),
        })
    }
}

unsafe extern "C" fn hessian(
    n: c_int,
    x: *mut f64,
    _new_x: Bool,
    sigma: f64,
    m: c_int,
    costates: *mut f64,
    _new_costates: Bool,
    entries: c_int,
    rows: *mut c_int,
    cols: *mut c_int,
    values: *mut f64,
    session: *mut c_void,
) -> Bool {
    // SAFETY: Ipopt passes the session and either `entries` places for rows and columns, or `n` variables, `m` multipliers
    // and `entries` places for the values.
    unsafe {
        guard(session, |evaluator| match values.is_null() {
            true => copy_entries(
                evaluator.hessian_structure(),
                write(rows, entries),
                write(cols, entries),
            ),
            false => {
                evaluator.hessian(read(x, n), sigma, read(costates, m), write(values, entries))
            }
        })
    }
}

unsafe extern "C" fn iteration(
    mode: c_int,
    number: c_int,
    objective: f64,
    primal_infeasibility: f64,
    dual_infeasibility: f64,
    mu: f64,
    step_norm: f64,
    regularization: f64,
    alpha_dual: f64,
    alpha_primal: f64,
    line_search_trials: c_int,
    session: *mut c_void,
) -> Bool {
    let told = Iteration {
        iteration: usize::try_from(number).unwrap_or_default(),
        objective,
        primal_infeasibility,
        dual_infeasibility,
        mu,
        step_norm,
        regularization,
        alpha_dual,
        alpha_primal,
        line_search_trials: usize::try_from(line_search_trials).unwrap_or_default(),
        restoration: mode != 0,
    };
    // SAFETY: Ipopt passes the session.
    unsafe {
        guard(session, |evaluator| {
            evaluator.iteration(&told) == ControlFlow::Continue(())
        })
    }
}
