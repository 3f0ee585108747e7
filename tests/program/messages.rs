//! Messages to the user: a run was stopped, derivatives are wrong, a command does not know an option.

use crate::common::programs::{HS071_START, Program, hs071, one_variable};
use crate::common::signals::Listening as _;
use crate::runs::{problem, read, run};
use proboscis::control::problem::Task;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::dynamics::{Start, simulate};
use proboscis::files::read_problem;
use proboscis::ipopt::{Options, StartingPoint, solve};
use proboscis::model::Model;
use proboscis::nlp::differences::{TOLERANCE, check_with_sizes};
use proboscis::nlp::{Nlp, Status};
use proboscis::stop;
use proboscis::stop::Questions;
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

/// A column of few elements.
const SMALL: [&str; 4] = [
    "--set",
    "scene.solids[0].box.elements=[1,1,4]",
    "--set",
    "scene.markers=[]",
];

#[test]
fn a_step_is_stopped_between_its_iterations() {
    let changes = [SMALL[1], SMALL[3]].map(str::to_owned);
    let loaded = read_problem(problem("clamped_stack_step").as_ref(), &changes).unwrap();
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation");
    };
    let analysis = task.analysis(&loaded.system, 0.5);
    let model = Model::for_analysis(loaded.system.clone(), analysis).unwrap();
    let z = model.coordinates_at(&vec![0.0; model.joint_readings.len()]);
    let start = Start::at_rest(&model, z);
    let voltages = |_: f64, _: f64| model.scalars(&[3e5]);
    let three = |_: &_| ControlFlow::Continue(());
    let steps = || simulate(&model, &start, 0.5, 3, voltages, three);

    let (discrete, failure) = steps();
    assert!(failure.is_none() && discrete.intervals() == 3);
    let watch = stop::watch(Some(0.0));
    let (discrete, failure) = steps();
    assert!(failure.is_none(), "{failure:?}");
    assert_eq!((discrete.intervals(), discrete.report.iterations), (0, 0));
    // Whoever watches inside for longer is stopped all the same.
    let inner = stop::watch(Some(1e9));
    assert_eq!(stop::reason(), Some(Status::TimeLimit));
    drop(inner);
    drop(watch);
    assert_eq!(stop::reason(), None);
    let _watch = stop::watch(Some(1e300));
    assert_eq!(steps().0.intervals(), 3);
}

/// After the time is over Ipopt gets no answer any more.
#[test]
fn a_solve_is_stopped_at_the_next_question() {
    let questions = Questions::allowed(u64::MAX);
    let over = questions.clone();
    let mut program: Program = hs071();
    let mut hessian = hs071().hess;
    program.hess = Box::new(move |x, sigma, y, values| {
        over.end_after(0);
        hessian(x, sigma, y, values);
    });
    let start = StartingPoint {
        x: HS071_START.to_vec(),
        costates: None,
    };
    let options = Options::default();
    let mut go_on = |_: &_, _: &proboscis::ipopt::Reached<'_>| ControlFlow::Continue(());
    let _watch = stop::watch_questions(&questions);
    let solution = solve(&mut program, &start, &options, &mut go_on).unwrap();
    assert_eq!(solution.status, Status::TimeLimit);
    assert_eq!(solution.evaluations.hessian, 1);
    assert_eq!(solution.evaluations.gradient, 1);
    assert!(solution.x.iter().all(|x| x.is_finite()));
}

/// A stop leaves no half-done work that is taken for done.
#[test]
fn a_program_that_was_stopped_is_evaluated_anew() {
    let loaded = read_problem(problem("pair").as_ref(), &[]).unwrap();
    let Task::Control(control) = &loaded.task else {
        panic!("a control problem");
    };
    let h = control.duration.first() / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&loaded.system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let program = || Transcription::new(&model, &boundary, control, &initial).unwrap();
    let (mut fresh, mut stopped) = (program(), program());
    let start = fresh.start(&initial);
    let x: Vec<f64> = start.x.iter().map(|x| x + 0.01).collect();
    let values = |program: &mut Transcription<'_>| {
        let mut g = vec![0.0; program.constraints().lower.len()];
        program.constraint(&x, &mut g);
        let mut jacobian = vec![0.0; program.jacobian_structure().rows.len()];
        program.jacobian(&x, &mut jacobian);
        [g, jacobian].concat()
    };
    let expected = values(&mut fresh);
    assert!(expected.iter().all(|v| v.is_finite()) && expected.iter().any(|v| *v != 0.0));
    let watch = stop::watch(Some(0.0));
    assert_ne!(values(&mut stopped), expected);
    drop(watch);
    assert_eq!(values(&mut stopped), expected);

    // No time at all, watched from outside too: the start comes back with what it violates.
    let _watch = stop::watch(Some(0.0));
    let options = Options {
        max_seconds: Some(0.0),
        ..Options::default()
    };
    let mut go_on = |_: &_, _: &proboscis::ipopt::Reached<'_>| ControlFlow::Continue(());
    let solution = solve(&mut stopped, &start, &options, &mut go_on).unwrap();
    assert_eq!(solution.status, Status::TimeLimit);
    assert!(solution.constraints.iter().all(|g| g.is_finite()));
    let evaluations = &solution.evaluations;
    assert_eq!((evaluations.gradient, evaluations.jacobian), (0, 0));
}

#[test]
fn ctrl_c_stops_a_motion_of_elements_within_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .current_dir(folder.path())
        .args(["simulate", &problem("clamped_stack_step"), "-o", "out"])
        .args([
            "--set",
            "simulate.step=0.05 ms",
            "--set",
            "simulate.duration=1 s",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn_listening()
        .unwrap();
    // The folder is made after the first step.
    while !folder.path().join("out").exists() && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(20));
    }
    crate::common::signals::interrupt(&child);
    let status = child.wait().unwrap();
    let mut told = String::new();
    std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut told).unwrap();
    assert_eq!(status.code(), Some(1), "{told}");
    assert!(told.contains("stopping"), "{told}");
    let summary = read(folder.path().join("out/summary.json"));
    assert_eq!(summary["status"], "interrupted");
    assert!(folder.path().join("out/continuation.npz").exists());
}

#[test]
fn no_time_is_told_by_every_task() {
    let folder = tempfile::tempdir().unwrap();
    for (command, name) in [
        ("equilibrium", "clamped_stack"),
        ("simulate", "clamped_stack_step"),
        ("simulate", "pair_constant"),
        ("equilibrium", "pull_in"),
    ] {
        let path = problem(name);
        let arguments = [command, &path, "--max-seconds", "1e-6", "-o", "out"];
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 1, "{name}: {out}{err}");
        assert!(
            format!("{out}{err}").contains("time limit"),
            "{name}: {out}{err}"
        );
    }
}

#[test]
fn derivatives_are_checked_for_every_task() {
    let folder = tempfile::tempdir().unwrap();
    let fine = [
        "--set",
        "scene.solids[0].box.elements=[6,1,4]",
        "--set",
        "control.intervals=3",
    ];
    let cases: [(&str, &[&str]); 4] = [
        ("clamped_stack", &SMALL),
        ("clamped_stack_step", &SMALL),
        ("free_flight", &SMALL),
        ("fe_bending_control", &fine),
    ];
    for (name, more) in cases {
        let path = problem(name);
        let arguments = [&["check", &path], more].concat();
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 0, "{name}: {out}{err}");
        assert!(
            out.contains("derivatives agree with differences"),
            "{name}: {out}{err}"
        );
    }
}

/// A curvature that a difference over a long step does not resolve is no mistake; one that it does not have is.
#[test]
fn two_differences_have_to_agree_before_an_entry_is_wrong() {
    // x + sin(a x)/a: its slope changes over a length of 1/a.
    let wave = |a: f64, wrong: f64| -> Program {
        let mut program = one_variable((-1.0, 1.0), |x| x, |_| 1.0, |_| 0.0);
        program.f = Box::new(move |x| x[0] + (a * x[0]).sin() / a);
        program.grad = Box::new(move |x, grad| grad[0] = 1.0 + (a * x[0]).cos() + wrong);
        program.hess = Box::new(move |x, sigma, _, values| {
            values[0] = -sigma * a * (a * x[0]).sin();
        });
        program
    };
    let check = |a: f64, wrong: f64, size: f64| {
        check_with_sizes(&mut wave(a, wrong), &[0.3008], &[size], 3, || false)
    };
    let report = check(2e3, 0.0, 1.0);
    assert!(
        report.is_consistent() && report.hessian <= TOLERANCE,
        "{report}"
    );
    let report = check(2e3, 1e-2, 1.0);
    assert!(!report.wrong.is_empty(), "{report}");
    // A step of the size of the wave needs no second one.
    let report = check(2e3, 0.0, 1e-2);
    assert!(
        report.is_consistent() && report.hessian < 0.1 * TOLERANCE,
        "{report}"
    );
    let stopped = check_with_sizes(&mut wave(1.0, 0.0), &[0.3008], &[1.0], 3, || true);
    assert!(!stopped.is_consistent() && stopped.left == 1 && stopped.checked == 0);
}

#[test]
fn options_without_a_use_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 7] = [
        (
            &["simulate", "pair_constant", "--max-iterations", "3"],
            "--max-iterations",
        ),
        (
            &["solve", "pair_constant", "--max-iterations", "3"],
            "--max-iterations",
        ),
        (
            &["solve", "pull_in", "--max-iterations", "3"],
            "--max-iterations",
        ),
        (
            &["equilibrium", "pull_in", "--accuracy", "1e-3"],
            "--accuracy",
        ),
        (&["solve", "pull_in", "--accuracy", "1e-3"], "--accuracy"),
        (&["inspect", "pair", "--max-seconds", "3"], "--max-seconds"),
        (&["check", "pair", "-o", "out"], "-o"),
    ];
    for (words, option) in cases {
        let path = problem(words[1]);
        let arguments = [&[words[0], path.as_str()], &words[2..]].concat();
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 2, "{words:?}: {out}{err}");
        assert!(err.contains(option), "{words:?}: {err}");
        assert!(
            fs::read_dir(folder.path()).unwrap().next().is_none(),
            "{words:?}"
        );
    }
}

#[test]
fn the_extent_of_a_robot_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = problem("clamped_stack");
    let (status, out, err) = run(folder.path(), &["inspect", &path]);
    assert_eq!(status, 0, "{err}");
    let extent = "10 × 10 × 40 mm from (0, 0, 0) mm";
    assert!(
        out.contains(&format!("extent of the robot: {extent}")),
        "{out}"
    );
    assert!(out.contains(&format!("extent of block: {extent}")), "{out}");
    assert!(!out.contains("are the units right?"), "{out}");
    // The same column a thousand times as long.
    let sized = "scene.solids[0].box.size=[10,10,40]";
    let arguments = ["inspect", &path, "--set", sized, "--set", SMALL[3]];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("the robot is 40 m long; are the units right?"),
        "{out}"
    );
    // A trunk of six segments of 50 mm, 20 mm of its muscles below the ground, 20 mm around its axis.
    let (_, out, _) = run(folder.path(), &["inspect", &problem("elephant_trunk")]);
    assert!(
        out.contains("extent of the robot: 40 × 320 × 40 mm from (-20, -20, -20) mm"),
        "{out}"
    );
}

#[test]
fn a_block_that_the_memory_cannot_hold_is_refused_with_its_numbers() {
    let machine = fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = machine
        .lines()
        .find(|line| line.starts_with("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    let folder = tempfile::tempdir().unwrap();
    // Three coordinates and a potential of 65 × 65 × 65 or 100 × 100 × 101 nodes.
    let [small, large] = [
        ("[64,64,64]", "262144 elements with about 1098500 unknowns"),
        ("[99,99,100]", "980100 elements with about 4040000 unknowns"),
    ];
    let step = ["simulate", "clamped_stack_step"];
    let rest = ["equilibrium", "clamped_stack"];
    // A machine may hold it, or not tell: by factors, the smallest that it does not hold, and by an iteration.
    let cases = [
        (3.15e10, step, Some("faer"), small, "31.5 GB"),
        (1.176e11, step, Some("faer"), large, "117.6 GB"),
        (9.8e9, step, None, large, "9.8 GB"),
        (9.8e9, rest, None, large, "9.8 GB"),
    ];
    let mut is_refused_by_factors = false;
    for (bytes, [command, name], solver, (elements, size), told) in cases {
        let is_done = solver.is_some() && is_refused_by_factors;
        if is_done || kilobytes.is_none_or(|kb| 1024.0 * kb > bytes) {
            continue;
        }
        is_refused_by_factors |= solver.is_some();
        let large = format!("scene.solids[0].box.elements={elements}");
        let solver = solver.map(|name| format!("simulate.linear_solver=\"{name}\""));
        let path = problem(name);
        let mut arguments = vec![command, path.as_str(), "--set", large.as_str()];
        arguments.extend(solver.iter().flat_map(|solver| ["--set", solver]));
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 2, "{out}{err}");
        let told = format!("{size} needs {told} of memory or more");
        assert!(err.contains(&told), "{err}");
        assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
    }
    if kilobytes.is_none_or(|kb| kb > 3e7) {
        return;
    }
    let large = "scene.solids[0].box.elements=[30,30,40]";
    let creeping = problem("creeping_block");
    let (status, out, err) = run(folder.path(), &["simulate", &creeping, "--set", large]);
    assert_eq!(status, 2, "{out}{err}");
    // Three coordinates of 31 × 31 × 41 nodes, and five numbers at eight points of each element and branch.
    let told = "36000 elements with 72000 Maxwell branches and about 2998203 unknowns needs 33.1 GB of memory or more";
    assert!(err.contains(told), "{err}");
}
