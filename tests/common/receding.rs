//! Receding horizons of kept problems.

use proboscis::control::problem::{Control, Regulator, Task};
use proboscis::files::read_problem;
use proboscis::model::System;
use proboscis::tasks::{SolveRequest, solve};
use proboscis::workflow::Iterate;
use proboscis::workflow::receding::Horizon;
use proboscis::workflow::regulator::Along;
use std::ops::ControlFlow;
use std::path::Path;

/// A kept problem of control.
pub fn problem(name: &str, changes: &[&str]) -> (System, Control) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("problems")
        .join(name);
    let changes: Vec<String> = changes.iter().map(|one| (*one).to_owned()).collect();
    let loaded = read_problem(&path, &changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    (loaded.system, *control)
}

/// The horizon of a number of intervals along the optimum of a problem.
pub fn horizon((system, control): &(System, Control), task: &Regulator, n: usize) -> Horizon {
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve(system, control, SolveRequest::default(), go_on).unwrap();
    assert!(found.verdict.is_solved);
    let along = Along::new(&found.optimum, &found.discrete, control);
    Horizon::new(system, along, task, n).unwrap()
}
