//! Adapter in the place of MA57, called as Ipopt calls it: it answers a solve that runs in this thread, and no one else.

#![expect(unsafe_code, reason = "C interface of MA57")]

use crate::common::programs::{HS071_START, hs071};
use crate::ipopt::run;
use proboscis::ipopt::{LinearSolver, Options, functions_of_ma57};
use proboscis::nlp::Status;
use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::{Arc, Mutex};
use std::{mem, thread};

type Integers = *mut c_int;
type Numbers = *mut f64;
type Analyse = unsafe extern "C" fn(
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Numbers,
);
type Factor = unsafe extern "C" fn(
    Integers,
    Integers,
    Numbers,
    Numbers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Integers,
    Numbers,
    Integers,
    Numbers,
);
type Solve = unsafe extern "C" fn(
    Integers,
    Integers,
    Numbers,
    Integers,
    Integers,
    Integers,
    Integers,
    Numbers,
    Integers,
    Numbers,
    Integers,
    Integers,
    Integers,
    Integers,
);

/// Functions in the place of `MA57AD`, `MA57BD` and `MA57CD`.
fn functions() -> (Analyse, Factor, Solve) {
    assert!(Options::default().run_at_once(), "an Ipopt that takes them");
    let [analyse, factor, solve, ..] = functions_of_ma57();
    // SAFETY: pointers to functions of these types, as MA57 declares its own.
    unsafe {
        (
            mem::transmute::<*const c_void, Analyse>(analyse),
            mem::transmute::<*const c_void, Factor>(factor),
            mem::transmute::<*const c_void, Solve>(solve),
        )
    }
}

/// `info` after the analysis of a matrix of so many unknowns with a full diagonal.
fn analyse(order: usize) -> [c_int; 40] {
    let mut info = [17; 40];
    let mut places: Vec<c_int> = (1..=order as c_int).collect();
    let mut count = order as c_int;
    // SAFETY: as MA57 takes its arguments; null where what stands in its place reads nothing.
    unsafe {
        functions().0(
            &raw mut count,
            &raw mut count,
            places.as_mut_ptr(),
            places.as_mut_ptr(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            info.as_mut_ptr(),
            null_mut(),
        );
    }
    info
}

/// `info` after the factorisation of a matrix with these entries.
fn factor(entries: &[f64]) -> [c_int; 40] {
    let mut info = [17; 40];
    let mut entries = entries.to_vec();
    let mut count = entries.len() as c_int;
    let mut tolerance = 1e-8;
    // SAFETY: as above.
    unsafe {
        functions().1(
            &raw mut count,
            &raw mut count,
            entries.as_mut_ptr(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            &raw mut tolerance,
            info.as_mut_ptr(),
            null_mut(),
        );
    }
    info
}

/// `info` after a solution with this right-hand side, which it replaces.
fn solve(right: &mut [f64]) -> [c_int; 40] {
    let mut info = [17; 40];
    let (mut order, mut columns) = (right.len() as c_int, 1);
    // SAFETY: as above.
    unsafe {
        functions().2(
            null_mut(),
            &raw mut order,
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            &raw mut columns,
            right.as_mut_ptr(),
            &raw mut order,
            null_mut(),
            null_mut(),
            null_mut(),
            null_mut(),
            info.as_mut_ptr(),
        );
    }
    info
}

const FAILED: c_int = -1;

#[test]
fn without_a_solve_nothing_is_answered() {
    let ask = || {
        let mut right = [1.0, 2.0];
        let all = [analyse(2), factor(&[1.0, 1.0]), solve(&mut right)];
        assert_eq!(right, [1.0, 2.0]);
        all.map(|info| info[0])
    };
    assert_eq!(ask(), [FAILED; 3]);
    // Nor while another thread solves.
    let mut program = hs071();
    let mut objective = mem::replace(&mut program.f, Box::new(|_| 0.0));
    program.f = Box::new(move |x| {
        assert_eq!(thread::spawn(ask).join().unwrap(), [FAILED; 3]);
        objective(x)
    });
    let solution = run(&mut program, &HS071_START, &stages());
    assert_eq!(solution.status, Status::Solved);
    assert_eq!(ask(), [FAILED; 3]);
}

fn stages() -> Options {
    Options {
        linear_solver: LinearSolver::Stages,
        ..Options::default()
    }
}

/// Solves with questions asked at the k-th call of the gradient; what was answered, and the panic that the solve ended with.
fn asked_within(
    call: usize,
    ask: impl Fn() -> Vec<c_int> + Send + 'static,
) -> (Vec<c_int>, Option<String>) {
    let answers = Arc::new(Mutex::new(Vec::new()));
    let mut program = hs071();
    let mut gradient = mem::replace(&mut program.grad, Box::new(|_, _| ()));
    let (mut calls, heard) = (0, answers.clone());
    program.grad = Box::new(move |x, to| {
        calls += 1;
        if calls == call {
            *heard.lock().unwrap() = ask();
        }
        gradient(x, to);
    });
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        run(&mut program, &HS071_START, &stages())
    }));
    let panic = outcome.err().map(|panic| match panic.downcast::<String>() {
        Ok(text) => *text,
        Err(panic) => (*panic.downcast::<&str>().unwrap()).to_owned(),
    });
    // The next solve is as good as ever.
    let solution = run(&mut hs071(), &HS071_START, &stages());
    assert_eq!(solution.status, Status::Solved);
    let answers = answers.lock().unwrap().clone();
    (answers, panic)
}

/// A system of another size takes the place of that of the solve; with other numbers of entries or unknowns it fails.
#[test]
fn wrong_sizes_end_the_solve_with_a_panic() {
    let few = || {
        let first = [analyse(3)[0], factor(&[1.0, -2.0, 4.0])[0]];
        let mut right = [1.0, 2.0, 4.0];
        let third = solve(&mut right)[0];
        assert_eq!(right, [1.0, -1.0, 1.0]);
        let wrong = factor(&[1.0, 1.0])[0];
        // After a failure nothing is answered any more.
        let after = [factor(&[1.0, -2.0, 4.0])[0], solve(&mut right)[0]];
        assert_eq!(right, [1.0, -1.0, 1.0]);
        [first.as_slice(), &[third, wrong], &after].concat()
    };
    let (answers, panic) = asked_within(2, few);
    assert_eq!(answers, [0, 0, 0, FAILED, FAILED, FAILED]);
    let panic = panic.expect("it goes on after the solve");
    assert!(panic.contains("the entries of the pattern"), "{panic}");

    let short = || {
        let known = [analyse(3)[0], factor(&[1.0, -2.0, 4.0])[0]];
        [known.as_slice(), &[solve(&mut [1.0, 2.0])[0]]].concat()
    };
    let (answers, panic) = asked_within(2, short);
    assert_eq!(answers, [0, 0, FAILED]);
    assert!(panic.is_some());
}

#[test]
fn what_was_not_analysed_ends_the_solve_with_a_panic() {
    let (answers, panic) = asked_within(1, || vec![factor(&[1.0])[0]]);
    assert_eq!(answers, [FAILED]);
    assert!(panic.is_some_and(|panic| panic.contains("analysed first")));
}

/// The adapter reports signs of eigenvalues, rank, and singularity of a matrix as MA57 does.
#[test]
fn answers_tell_inertia_and_rank() {
    let ask = || {
        analyse(3);
        let [regular, singular] =
            [[1.0, -2.0, -4.0], [1.0, -2.0, 0.0]].map(|entries| factor(&entries));
        // The system of the solve itself is gone with this.
        [regular, singular]
            .iter()
            .flat_map(|info| [info[0], info[23], info[24]])
            .collect()
    };
    let (answers, _) = asked_within(2, ask);
    assert_eq!(answers, [0, 2, 3, 4, 1, 2]);
}
