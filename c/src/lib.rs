//! The interface for C, `include/proboscis.h`.
//!
//! Every function takes pointers that the caller vouches for, as the header says: to a controller that was created and not freed, which no other thread
//! uses, and to as many numbers as it has measured quantities and inputs. No panic leaves a function.

use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr;
use std::slice;

use proboscis::app::{FileHorizon, SiController};
use proboscis::workflow::receding::Source;

/// Answer where there are no inputs.
const WRONG: c_int = -1;

/// A controller with the horizon that it borrows.
pub struct Owned {
    /// Dropped before the horizon.
    controller: Option<SiController<'static>>,
    horizon: *mut FileHorizon,
    measured: Vec<CString>,
    inputs: Vec<CString>,
    /// Length of an interval in s.
    interval: f64,
}

impl Owned {
    fn new(horizon: FileHorizon) -> Self {
        let names = |list: Vec<(String, &'static str)>| {
            let line = |(name, unit): (String, &str)| {
                let text = format!("{name} in {unit}").replace('\0', " ");
                CString::new(text).expect("a text without its end")
            };
            list.into_iter().map(line).collect::<Vec<_>>()
        };
        let (measured, inputs) = (names(horizon.measured()), names(horizon.inputs()));
        let interval = horizon.interval();
        let horizon = Box::into_raw(Box::new(horizon));
        // SAFETY: the horizon is freed in `drop` alone, behind the controller, and is not changed before.
        let borrowed: &'static FileHorizon = unsafe { &*horizon };
        Self {
            controller: Some(SiController::new(borrowed)),
            horizon,
            measured,
            inputs,
            interval,
        }
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        self.controller = None;
        // SAFETY: it was made by `Box::into_raw`, and nothing borrows it any more.
        drop(unsafe { Box::from_raw(self.horizon) });
    }
}

/// Writes a message with its end into a place of a size.
fn tell(message: &str, to: *mut c_char, size: usize) {
    if to.is_null() || size == 0 {
        return;
    }
    let mut length = message.len().min(size - 1);
    while !message.is_char_boundary(length) {
        length -= 1;
    }
    // SAFETY: the caller gives `size` bytes, of which `length + 1` are written.
    unsafe {
        ptr::copy_nonoverlapping(message.as_ptr().cast(), to, length);
        *to.add(length) = 0;
    }
}

/// See the header.
///
/// # Safety
/// `problem` is a text that ends with a zero, or null; `message` has room for `size` bytes, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_create(
    problem: *const c_char,
    intervals: usize,
    message: *mut c_char,
    size: usize,
) -> *mut Owned {
    if problem.is_null() {
        tell(
            "found no path, expected that of a problem file",
            message,
            size,
        );
        return ptr::null_mut();
    }
    // SAFETY: the caller gives a text that ends with a zero.
    let path = unsafe { CStr::from_ptr(problem) }.to_string_lossy();
    let made =
        catch_unwind(|| FileHorizon::new(Path::new(&*path), None, intervals).map(Owned::new));
    match made {
        Ok(Ok(owned)) => {
            tell("", message, size);
            Box::into_raw(Box::new(owned))
        }
        Ok(Err(error)) => {
            tell(&error.to_string(), message, size);
            ptr::null_mut()
        }
        Err(_) => {
            tell("it broke off: see standard error", message, size);
            ptr::null_mut()
        }
    }
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_free(controller: *mut Owned) {
    if !controller.is_null() {
        // SAFETY: it was made by `proboscis_create`, and the caller frees it once.
        drop(unsafe { Box::from_raw(controller) });
    }
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_interval(controller: *const Owned) -> f64 {
    // SAFETY: as the caller vouches.
    unsafe { controller.as_ref() }.map_or(f64::NAN, |one| one.interval)
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_measured_count(controller: *const Owned) -> usize {
    // SAFETY: as the caller vouches.
    unsafe { controller.as_ref() }.map_or(0, |one| one.measured.len())
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_input_count(controller: *const Owned) -> usize {
    // SAFETY: as the caller vouches.
    unsafe { controller.as_ref() }.map_or(0, |one| one.inputs.len())
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_measured_name(
    controller: *const Owned,
    place: usize,
) -> *const c_char {
    // SAFETY: as the caller vouches.
    let name = unsafe { controller.as_ref() }.and_then(|one| one.measured.get(place));
    name.map_or(ptr::null(), |name| name.as_ptr())
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_input_name(
    controller: *const Owned,
    place: usize,
) -> *const c_char {
    // SAFETY: as the caller vouches.
    let name = unsafe { controller.as_ref() }.and_then(|one| one.inputs.get(place));
    name.map_or(ptr::null(), |name| name.as_ptr())
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null; `measured` are as many numbers as it measures, or null; `inputs` has room for as many as it
/// has, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_step(
    controller: *mut Owned,
    time: f64,
    measured: *const f64,
    inputs: *mut f64,
) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(owned) = (unsafe { controller.as_mut() }) else {
        return WRONG;
    };
    let (states, width) = (owned.measured.len(), owned.inputs.len());
    let Some(controller) = owned.controller.as_mut().filter(|_| !inputs.is_null()) else {
        return WRONG;
    };
    // SAFETY: as the caller vouches, of numbers that are there.
    let measured =
        (!measured.is_null()).then(|| unsafe { slice::from_raw_parts(measured, states) });
    // SAFETY: as the caller vouches.
    let to = unsafe { slice::from_raw_parts_mut(inputs, width) };
    let step = AssertUnwindSafe(|| {
        let (source, values) = controller.step(time, measured);
        to.copy_from_slice(values);
        source
    });
    match catch_unwind(step) {
        Ok(Source::Plan) => 0,
        Ok(Source::Late) => 1,
        Ok(Source::Unusable) => 2,
        Ok(Source::Kept) => 3,
        Ok(Source::Regulator) => 4,
        Err(_) => WRONG,
    }
}

/// See the header.
///
/// # Safety
/// The controller was created and not freed, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn proboscis_prepare(controller: *mut Owned) {
    // SAFETY: as the caller vouches.
    let owned = unsafe { controller.as_mut() };
    if let Some(controller) = owned.and_then(|owned| owned.controller.as_mut()) {
        // What broke off is prepared by the next step.
        let _ = catch_unwind(AssertUnwindSafe(|| controller.prepare()));
    }
}
