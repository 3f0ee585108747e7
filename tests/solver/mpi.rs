//! A parallel MUMPS brings MPI, which starts with the first use of MUMPS and not before.

#![expect(unsafe_code, reason = "C interface of MPI")]

use crate::common::programs::{HS071_START, hs071};
use crate::ipopt::run;
use proboscis::ipopt::{LinearSolver, Options};
use proboscis::nlp::Status;
use std::ffi::{c_int, c_void};
use std::process::Command;
use std::{env, mem};

const CHILD: &str = "PROBOSCIS_START_OF_MPI";

/// Returns true if MPI runs, as it says itself; nothing where there is none in the process.
fn runs() -> Option<bool> {
    type Ask = unsafe extern "C" fn(*mut c_int) -> c_int;
    // SAFETY: the name ends in NUL, and the library is loaded.
    let symbol = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"PMPI_Initialized".as_ptr()) };
    let mut flag = 0;
    (!symbol.is_null()).then(|| {
        // SAFETY: MPI declares the function with this type.
        unsafe { mem::transmute::<*mut c_void, Ask>(symbol)(&raw mut flag) };
        flag != 0
    })
}

fn solve(linear_solver: LinearSolver) {
    let options = Options {
        linear_solver,
        ..Options::default()
    };
    let solution = run(&mut hs071(), &HS071_START, &options);
    assert_eq!(solution.status, Status::Solved);
}

/// In a process of its own, in which nothing else calls MUMPS.
#[test]
fn it_starts_with_mumps_and_ends_with_the_process() {
    if env::var_os(CHILD).is_none() {
        let name = "mpi::it_starts_with_mumps_and_ends_with_the_process";
        let mut this = Command::new(env::current_exe().unwrap());
        let status = this.args(["--exact", name]).env(CHILD, "1").status();
        assert!(status.unwrap().success());
        return;
    }
    let before = runs();
    assert_ne!(before, Some(true), "nothing has called MUMPS yet");
    solve(LinearSolver::Stages);
    assert_eq!(runs(), before, "no MUMPS, no MPI");
    solve(LinearSolver::Mumps);
    assert_eq!(runs(), before.map(|_| true));
}
