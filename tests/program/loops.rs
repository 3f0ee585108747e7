//! Closed loops whose constraints repeat each other, in files: what `inspect` and `solve` say of them.

use crate::refusals::refused_run;
use crate::runs::{problem, read, run, workshop};

#[test]
fn a_loop_that_repeats_constraints_is_solved_and_inspected() {
    let folder = workshop();
    let path = folder.path();
    let (status, out, err) = run(path, &["inspect", &problem("four_bar")]);
    assert_eq!(status, 0, "{err}");
    let lines: Vec<&str> = out.lines().map(str::trim).collect();
    let first = lines
        .iter()
        .position(|line| line.starts_with("left out of loops"));
    let first = first.unwrap_or_else(|| panic!("{out}")) + 1;
    let names = ["hinge4 axis 1", "hinge4 axis 2", "hinge4 point 3", ""];
    assert_eq!(lines[first..first + 4], names);
    assert!(
        out.contains("degrees of freedom with loops closed  1"),
        "{out}"
    );
    let short = ["--set", "simulate.duration=\"50 ms\"", "--output", "out"];
    let arguments = [&["solve", "problems/four_bar.json"][..], &short].concat();
    let (status, out, err) = run(path, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    assert_eq!(read(path.join("out/summary.json"))["status"], "simulated");
}

#[test]
fn a_loop_that_closes_in_the_reference_only_is_refused() {
    let folder = workshop();
    let tilted = "scene.joints[2].revolute.axis=[0, 0.0001, 1]";
    refused_run(
        folder.path(),
        &["solve", "problems/four_bar.json", "--set", tilted],
        &["scene.joints", "\"hinge4\"", "a gap of 8", "expected none"],
    );
}

#[test]
fn bars_in_line_are_a_warning() {
    let folder = workshop();
    let path = folder.path();
    // A parallelogram laid flat.
    let at = |joint: usize, x: &str| format!("scene.joints[{joint}].at=[\"{x}\", 0, 0]");
    let places = [at(1, "50 mm"), at(2, "150 mm")];
    let flat = [
        "scene.muscles=[]",
        "simulate.voltages={}",
        "simulate.duration=\"10 ms\"",
        &places[0],
        &places[1],
    ];
    let sets = flat.iter().flat_map(|set| ["--set", set]);
    let arguments: Vec<&str> = ["inspect", "problems/four_bar.json"]
        .into_iter()
        .chain(sets)
        .collect();
    let (status, out, err) = run(path, &arguments);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("warning: the reference is a singular configuration of the loops"),
        "{out}"
    );
}
