//! Declarations of the C interface of Ipopt.
//!
//! The header differs between versions: up to 3.13 `Bool` is `int`, `Number` is `double` and `Index` is `int`; since
//! 3.14 `Bool` is `bool`, and the other two are old names of `ipnumber` and `ipindex`, which are `double` and `int`
//! unless Ipopt was built for single precision or long indices (then the build ends). So truth values are written with
//! `Bool::from` and read by comparison with it, and nothing else depends on the version. `header.c` holds the declarations
//! below against the header.

#![expect(unsafe_code, reason = "C interface of Ipopt")]

use std::ffi::{c_char, c_int, c_void};

/// Truth values of this Ipopt.
#[cfg(ipopt_bool)]
pub(super) type Bool = bool;
/// Truth values of this Ipopt.
#[cfg(not(ipopt_bool))]
pub(super) type Bool = c_int;

/// `struct IpoptProblemInfo`, which only Ipopt looks into.
#[repr(C)]
pub(super) struct IpoptProblemInfo {
    _inside: [u8; 0],
}

type Objective = unsafe extern "C" fn(c_int, *mut f64, Bool, *mut f64, *mut c_void) -> Bool;
type Gradient = unsafe extern "C" fn(c_int, *mut f64, Bool, *mut f64, *mut c_void) -> Bool;
type Constraint = unsafe extern "C" fn(c_int, *mut f64, Bool, c_int, *mut f64, *mut c_void) -> Bool;
type Jacobian = unsafe extern "C" fn(
    c_int,
    *mut f64,
    Bool,
    c_int,
    c_int,
    *mut c_int,
    *mut c_int,
    *mut f64,
    *mut c_void,
) -> Bool;
type Hessian = unsafe extern "C" fn(
    c_int,
    *mut f64,
    Bool,
    f64,
    c_int,
    *mut f64,
    Bool,
    c_int,
    *mut c_int,
    *mut c_int,
    *mut f64,
    *mut c_void,
) -> Bool;
type Intermediate = unsafe extern "C" fn(
    c_int,
    c_int,
    f64,
    f64,
    f64,
    f64,
    f64,
    f64,
    f64,
    f64,
    c_int,
    *mut c_void,
) -> Bool;

unsafe extern "C" {
    pub(super) fn CreateIpoptProblem(
        n: c_int,
        x_lower: *mut f64,
        x_upper: *mut f64,
        m: c_int,
        g_lower: *mut f64,
        g_upper: *mut f64,
        jacobian_entries: c_int,
        hessian_entries: c_int,
        first_index: c_int,
        objective: Objective,
        constraint: Constraint,
        gradient: Gradient,
        jacobian: Jacobian,
        hessian: Hessian,
    ) -> *mut IpoptProblemInfo;
    pub(super) fn FreeIpoptProblem(problem: *mut IpoptProblemInfo);
    pub(super) fn AddIpoptStrOption(
        problem: *mut IpoptProblemInfo,
        name: *mut c_char,
        value: *mut c_char,
    ) -> Bool;
    pub(super) fn AddIpoptNumOption(
        problem: *mut IpoptProblemInfo,
        name: *mut c_char,
        value: f64,
    ) -> Bool;
    pub(super) fn AddIpoptIntOption(
        problem: *mut IpoptProblemInfo,
        name: *mut c_char,
        value: c_int,
    ) -> Bool;
    pub(super) fn SetIntermediateCallback(
        problem: *mut IpoptProblemInfo,
        iteration: Intermediate,
    ) -> Bool;
    pub(super) fn IpoptSolve(
        problem: *mut IpoptProblemInfo,
        x: *mut f64,
        g: *mut f64,
        objective: *mut f64,
        of_constraints: *mut f64,
        of_lower: *mut f64,
        of_upper: *mut f64,
        session: *mut c_void,
    ) -> c_int;
}
