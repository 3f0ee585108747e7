//! Functions of the Ipopt that is called, found by their names.
//!
//! A process may hold another Ipopt too, as Python does with packages that bring their own: names are looked up in the library that the linked
//! functions stand in, and among all libraries only where that one cannot be identified, as in a program that contains Ipopt.

#![expect(unsafe_code, reason = "C interface of the loader")]

use std::ffi::{CStr, c_void};
use std::mem::MaybeUninit;
use std::ptr::NonNull;

/// The library that a function stands in.
pub(super) struct Loaded {
    /// Of `dlopen`, which is never closed, or that of all libraries.
    handle: *mut c_void,
}

impl Loaded {
    /// The library of this function.
    pub(super) fn with(function: *const c_void) -> Self {
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
    pub(super) fn function(&self, name: &CStr) -> Option<NonNull<c_void>> {
        // SAFETY: the name ends in NUL, and the handle is one of `dlopen` that was never closed, or that of all libraries.
        NonNull::new(unsafe { libc::dlsym(self.handle, name.as_ptr()) })
    }
}
