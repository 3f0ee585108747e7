//! Solves that end early: panics, observers, times, warm starts.

use crate::common::programs::{HS071_OPTIMUM, HS071_START, Program, bounds, hs071, rosenbrock};
use crate::ipopt::{from, run};
use proboscis::ipopt::{Iteration, Options, Reached, solve};
use proboscis::nlp::{Multipliers, Status};
use proboscis::stop::{self, Questions};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::Command;
use std::{fs, thread};

/// hs071 whose named function panics at its `k`-th call.
fn panicking(function: &'static str, k: usize) -> Program {
    let mut calls = 0;
    let mut call = move || {
        calls += 1;
        assert!(calls < k, "{function} fails");
    };
    let mut program = hs071();
    let Program {
        mut f,
        mut grad,
        mut g,
        mut jac,
        mut hess,
        ..
    } = hs071();
    match function {
        "f" => {
            program.f = Box::new(move |x| {
                call();
                f(x)
            });
        }
        "grad" => {
            program.grad = Box::new(move |x, to| {
                call();
                grad(x, to);
            });
        }
        "g" => {
            program.g = Box::new(move |x, to| {
                call();
                g(x, to);
            });
        }
        "jac" => {
            program.jac = Box::new(move |x, to| {
                call();
                jac(x, to);
            });
        }
        "hess" => {
            program.hess = Box::new(move |x, sigma, y, to| {
                call();
                hess(x, sigma, y, to);
            });
        }
        _ => unreachable!("{function}"),
    }
    program
}

fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .expect("a panic with a message")
}

#[test]
fn a_panic_in_any_function_comes_through_and_harms_nothing() {
    for function in ["f", "grad", "g", "jac", "hess"] {
        for k in 1..=4 {
            let mut program = panicking(function, k);
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                run(&mut program, &HS071_START, &Options::default())
            }));
            let panic = outcome.expect_err("the panic comes through");
            assert_eq!(message(&*panic), format!("{function} fails"));
            let solution = run(&mut hs071(), &HS071_START, &Options::default());
            assert_eq!(solution.status, Status::Solved);
        }
    }
}

#[test]
fn a_panic_of_the_observer_comes_through() {
    let mut observer = |iteration: &Iteration, _: &Reached<'_>| {
        assert!(iteration.iteration < 3, "enough at {}", iteration.iteration);
        ControlFlow::Continue(())
    };
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        solve(
            &mut hs071(),
            &from(&HS071_START),
            &Options::default(),
            &mut observer,
        )
    }));
    assert_eq!(
        message(&*outcome.expect_err("the panic comes through")),
        "enough at 3"
    );
    assert_eq!(
        run(&mut hs071(), &HS071_START, &Options::default()).status,
        Status::Solved
    );
}

#[test]
fn the_observer_can_stop_and_the_iterate_is_returned() {
    let mut observer = |iteration: &Iteration, _: &Reached<'_>| match iteration.iteration {
        4 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let stopped = solve(
        &mut hs071(),
        &from(&HS071_START),
        &Options::default(),
        &mut observer,
    )
    .expect("can be called");
    assert_eq!(
        (stopped.status, stopped.iterations.len()),
        (Status::Interrupted, 5)
    );
    // The point belongs to the iteration told last; the slack of the inequality adds to the infeasibility told.
    let last = stopped.iterations[4];
    let violation = (25.0 - stopped.constraints[0])
        .max(0.0)
        .max((stopped.constraints[1] - 40.0).abs());
    assert!((stopped.objective - last.objective).abs() < 1e-6 * last.objective);
    let told = last.primal_infeasibility;
    assert!(
        violation > 0.0 && violation < told + 1e-6,
        "{violation} {told}"
    );
}

#[test]
fn a_stop_within_the_restoration_phase_returns_its_iterate() {
    // x² + 1 = y with y ≤ 0: restoration creeps towards x = 0.
    let mut program = Program {
        variables: bounds(&[(-100.0, 100.0), (-1.0, 0.0)]),
        constraints: bounds(&[(0.0, 0.0)]),
        jacobian_places: vec![(0, 0), (0, 1)],
        hessian_places: vec![(0, 0)],
        f: Box::new(|x| x[0]),
        grad: Box::new(|_, grad| grad.copy_from_slice(&[1.0, 0.0])),
        g: Box::new(|x, g| g[0] = x[0] * x[0] + 1.0 - x[1]),
        jac: Box::new(|x, values| values.copy_from_slice(&[2.0 * x[0], -1.0])),
        hess: Box::new(|_, _, y, values| values[0] = 2.0 * y[0]),
    };
    let mut restored = 0;
    let mut observer = |iteration: &Iteration, _: &Reached<'_>| {
        restored += usize::from(iteration.restoration);
        if restored == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let solution = solve(
        &mut program,
        &from(&[5.0, 0.0]),
        &Options::default(),
        &mut observer,
    )
    .expect("can be called");
    assert_eq!(solution.status, Status::Interrupted);
    let last = solution.iterations.last().expect("some iterations");
    assert!(last.restoration);
    assert!(
        (solution.constraints[0].abs() - last.primal_infeasibility).abs() < 1e-6,
        "{solution:?}"
    );
}

#[test]
fn the_better_of_the_last_two_points_is_returned() {
    // Along the tangent of the circle x² + y² = 1 from (1, 0), the first step leads away from it to where the Jacobian
    // turns out not to exist.
    let mut jacobians = 0;
    let mut program = Program {
        variables: bounds(&[(f64::NEG_INFINITY, f64::INFINITY); 2]),
        constraints: bounds(&[(1.0, 1.0)]),
        jacobian_places: vec![(0, 0), (0, 1)],
        hessian_places: vec![(0, 0), (1, 1)],
        f: Box::new(|x| x[0] + x[1]),
        grad: Box::new(|_, grad| grad.fill(1.0)),
        g: Box::new(|x, g| g[0] = x[0] * x[0] + x[1] * x[1]),
        jac: Box::new(move |x, values| {
            jacobians += 1;
            let exists = jacobians == 1;
            values.copy_from_slice(&if exists {
                [2.0 * x[0], 2.0 * x[1]]
            } else {
                [f64::NAN; 2]
            });
        }),
        hess: Box::new(|_, _, y, values| values.fill(2.0 * y[0])),
    };
    let solution = run(&mut program, &[1.0, 0.0], &Options::default());
    assert_eq!(solution.status, Status::InvalidNumber);
    assert_eq!(
        (solution.x, solution.constraints),
        (vec![1.0, 0.0], vec![1.0])
    );
}

#[test]
fn time_is_limited_at_any_question() {
    let solved = |allowed| {
        let questions = Questions::allowed(allowed);
        let watch = stop::watch_questions(&questions);
        let solution = run(&mut rosenbrock(), &[-1.2, 1.0], &Options::default());
        drop(watch);
        (solution, questions.asked())
    };
    let (whole, asked) = solved(u64::MAX);
    assert!(whole.status.is_solved() && asked > 50, "{asked}");
    for allowed in [0, 1, 7, asked / 3, asked / 2] {
        let (stopped, asked) = solved(allowed);
        assert_eq!(
            stopped.status,
            Status::TimeLimit,
            "after {allowed} questions"
        );
        // Ipopt gets no answer any more and gives up.
        assert!(asked < allowed + 20, "{asked} questions of {allowed}");
    }
    let options = Options {
        max_seconds: Some(0.0),
        ..Options::default()
    };
    let solution = run(&mut rosenbrock(), &[-1.2, 1.0], &options);
    assert_eq!(solution.status, Status::TimeLimit);
}

/// Ipopt asks for ever for the factors of a matrix that overflows, unless these fail.
#[test]
fn a_matrix_that_overflows_ends_the_solve() {
    let mut program = Program {
        variables: bounds(&[(f64::NEG_INFINITY, f64::INFINITY); 2]),
        constraints: bounds(&[(1e200, 1e200), (0.0, 0.0)]),
        jacobian_places: vec![(0, 0), (1, 0), (1, 1)],
        hessian_places: vec![(0, 0), (1, 1)],
        f: Box::new(|x| x[0] * x[0] + x[1] * x[1]),
        grad: Box::new(|x, grad| grad.copy_from_slice(&[2.0 * x[0], 2.0 * x[1]])),
        g: Box::new(|x, g| g.copy_from_slice(&[x[0].sin(), x[0] - x[1]])),
        jac: Box::new(|x, values| values.copy_from_slice(&[x[0].cos(), 1.0, -1.0])),
        hess: Box::new(|x, sigma, y, values| {
            values.copy_from_slice(&[2.0 * sigma - y[0] * x[0].sin(), 2.0 * sigma]);
        }),
    };
    let options = Options {
        max_iterations: 50,
        ..Options::default()
    };
    let solution = run(&mut program, &[0.5, 0.2], &options);
    assert!(!solution.status.is_solved(), "{:?}", solution.status);
}

#[test]
fn threads_take_turns() {
    thread::scope(|scope| {
        let solves: Vec<_> = (0..4)
            .map(|_| {
                scope.spawn(|| {
                    (0..10)
                        .map(|_| run(&mut hs071(), &HS071_START, &Options::default()))
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        for solution in solves
            .into_iter()
            .flat_map(|solve| solve.join().expect("no panic"))
        {
            assert!((solution.objective - HS071_OPTIMUM).abs() < 1e-7);
        }
    });
}

/// Run in a process of its own by the next test.
#[test]
#[ignore = "part of another test"]
fn solves_and_fails() {
    assert_eq!(
        run(&mut hs071(), &HS071_START, &Options::default()).status,
        Status::Solved
    );
    let options = Options {
        max_iterations: 3,
        ..Options::default()
    };
    assert_eq!(
        run(&mut hs071(), &HS071_START, &options).status,
        Status::IterationLimit
    );
}

#[test]
fn ipopt_is_silent_and_reads_no_file_of_the_working_directory() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(
        folder.path().join("ipopt.opt"),
        "max_iter 1\nprint_level 5\n",
    )
    .expect("can be written");
    let output = Command::new(std::env::current_exe().expect("the path of this test"))
        .args([
            "--ignored",
            "--exact",
            "--nocapture",
            "--test-threads=1",
            "ipopt_stops::solves_and_fails",
        ])
        .current_dir(folder.path())
        .output()
        .expect("it can be run again");
    let printed = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{printed}");
    let lines: Vec<_> = printed.lines().filter(|line| !line.is_empty()).collect();
    assert_eq!(
        lines.len(),
        3,
        "only the lines of the test harness: {printed}"
    );
}

/// The iterate before, as an observer sees it, is what Ipopt returns where it is stopped there; multipliers of bounds are near.
#[test]
fn the_iterate_before_has_the_multipliers_that_ipopt_returns() {
    let stopped_at = |last: usize| {
        let mut observer = |iteration: &Iteration, _: &Reached<'_>| match iteration.iteration < last
        {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        };
        let start = from(&HS071_START);
        solve(&mut hs071(), &start, &Options::default(), &mut observer).unwrap()
    };
    let mut told = Vec::new();
    let mut observer = |_: &Iteration, reached: &Reached<'_>| {
        let before = reached.before.as_ref();
        told.push(before.map(|before| {
            (
                *before.report,
                before.x.to_vec(),
                before.multipliers.clone(),
            )
        }));
        ControlFlow::Continue(())
    };
    let start = from(&HS071_START);
    let whole = solve(&mut hs071(), &start, &Options::default(), &mut observer).unwrap();
    assert!(whole.iterations.len() > 6);
    assert_eq!(told[0], None);
    for (k, told) in told.into_iter().enumerate().skip(2) {
        let (report, x, multipliers) = told.expect("no restoration phase");
        let expected = stopped_at(k - 1);
        assert_eq!(expected.status, Status::Interrupted);
        assert_eq!((report, &x), (whole.iterations[k - 1], &expected.x));
        let of = |all: &Multipliers| [&all.constraints, &all.lower, &all.upper].map(Vec::clone);
        let [rows, lower, upper] = of(&multipliers);
        let [expected_rows, expected_lower, expected_upper] = of(&expected.costates);
        assert!(expected_rows.iter().all(|y| y.abs() > 1e-3));
        for (y, expected) in rows.iter().zip(&expected_rows) {
            assert!(
                (y - expected).abs() < 1e-12 * expected.abs(),
                "{k}: {y} {expected}"
            );
        }
        let bounds = lower.iter().chain(&upper);
        for (z, expected) in bounds.zip(expected_lower.iter().chain(&expected_upper)) {
            assert!(
                *z > 0.0 && (0.01..100.0).contains(&(z / expected)),
                "{k}: {z} {expected}"
            );
        }
    }
}
