//! Bytes as an earlier `solution.json` from which a problem starts.
#![no_main]

use libfuzzer_sys::fuzz_target;
use proboscis::app::CommandError;
use proboscis::control::problem::Task;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::files::solution;
use proboscis_fuzz::{PROBLEM, check, with};
use std::fs;

fuzz_target!(|bytes: &[u8]| {
    with("solution.json", bytes, |folder, path| {
        let problem = folder.join("problem.json");
        if !problem.exists() {
            fs::write(&problem, PROBLEM).expect("a problem");
        }
        let loaded = read_problem(&problem, &[]).expect("a kept problem");
        let Task::Control(control) = loaded.task else {
            unreachable!("the kept problem is one of control");
        };
        let (model, boundary) =
            BoundaryConditions::resolve(&loaded.system, &control, 10.0).expect("a kept problem");
        match solution::read(&path, &model) {
            Ok(earlier) => {
                let initial = guess(&model, &boundary, &control, 10.0, Some(&earlier));
                let program = Transcription::new(&model, &boundary, &control, &initial);
                let point = program.expect("a kept problem").start(&initial);
                assert!(!point.x.is_empty());
            }
            Err(error) => check("solution.json", CommandError::Earlier(error.into())),
        }
    });
});
