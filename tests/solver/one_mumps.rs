//! The one MUMPS of the process, whatever its library is called: `libdmumps_seq`, `libdmumps`, `libcoinmumps`, or Ipopt itself.
#![cfg(target_os = "linux")]
#![expect(unsafe_code, reason = "C interface of the loader")]

use crate::sparse::ipopt_calls_mumps;
use std::collections::BTreeSet;
use std::ffi::{CStr, CString, c_void};
use std::fs;
use std::mem::MaybeUninit;
use std::path::PathBuf;

/// Files that are mapped into the process.
fn mapped() -> BTreeSet<String> {
    let maps = fs::read_to_string("/proc/self/maps").unwrap();
    let path = |line: &str| line.find('/').map(|start| line[start..].to_owned());
    maps.lines().filter_map(path).collect()
}

/// The file of a library, or of one that it needs, that defines a function; nothing if `file` is no library.
fn definer(file: &str, function: &CStr) -> Option<PathBuf> {
    let file = CString::new(file).unwrap();
    let mut info = MaybeUninit::<libc::Dl_info>::zeroed();
    // SAFETY: the names end in NUL, nothing is loaded that is not there, and `dladdr` writes the structure or leaves its zeros, which are null.
    let name = unsafe {
        let library = libc::dlopen(file.as_ptr(), libc::RTLD_LAZY | libc::RTLD_NOLOAD);
        if library.is_null() {
            return None;
        }
        let symbol: *mut c_void = libc::dlsym(library, function.as_ptr());
        libc::dladdr(symbol, info.as_mut_ptr());
        info.assume_init().dli_fname
    };
    // SAFETY: the loader's name of a library ends in NUL.
    let name = (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) })?;
    fs::canonicalize(name.to_str().unwrap()).ok()
}

#[test]
fn one_mumps_is_in_the_process() {
    ipopt_calls_mumps();
    let files = mapped();
    let definers: BTreeSet<PathBuf> = files
        .iter()
        .filter_map(|file| definer(file, c"dmumps_c"))
        .collect();
    assert_eq!(definers.len(), 1, "{definers:?}");
}
