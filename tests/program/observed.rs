//! Problems from a text in memory, observed while they run and stopped by request.

use crate::runs::{problem, read};
use proboscis::app::{
    CommandInput, CommandOutput, PageWanted, ProgressDisplay, Reached, check_text, run_observed,
    with_program,
};
use proboscis::ipopt::interrupt::{self, StopRequest};
use proboscis::report::Figures;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

/// A file that does not exist, beside the kept problems.
fn nowhere() -> PathBuf {
    Path::new(&problem("pair")).with_file_name("nowhere.json")
}

fn text(name: &str) -> String {
    fs::read_to_string(problem(name)).unwrap()
}

fn solve(
    name: &str,
    text: Option<&str>,
    output: &Path,
    observer: &mut dyn FnMut(Reached<'_>),
) -> CommandOutput {
    let request = CommandInput {
        command: "proboscis".to_owned(),
        input: match text {
            Some(_) => nowhere(),
            None => problem(name).into(),
        },
        set: Vec::new(),
        output: Some(output.to_owned()),
        max_seconds: None,
        max_iterations: None,
        from: None,
        wanted: None,
        figures: Figures::default(),
        progress: ProgressDisplay::Never,
        page: PageWanted::Written,
    };
    run_observed(&request, text, observer).unwrap()
}

#[test]
fn a_text_is_solved_as_the_file_and_every_iterate_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let [of_file, of_text] = ["file", "text"].map(|name| folder.path().join(name));
    assert!(!nowhere().exists());
    let mut heard = Vec::new();
    let mut hear = |reached: Reached<'_>| match reached {
        Reached::Iteration(20, report) => heard.push(report.iteration),
        other => panic!("{other:?}"),
    };
    assert!(solve("pair", Some(&text("pair")), &of_text, &mut hear).is_solved);
    assert!(solve("pair", None, &of_file, &mut |_| {}).is_solved);
    let [one, other] = [&of_file, &of_text].map(|f| fs::read(f.join("solution.json")).unwrap());
    assert!(one == other);
    let iterations = read(of_text.join("summary.json"))["iterations"].as_u64();
    assert!(heard.len() > 5 && heard.iter().copied().eq(0..heard.len()));
    assert_eq!(iterations, Some(heard.len() as u64 - 1));
}

#[test]
fn a_request_stops_the_thread_that_listens_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let request = StopRequest::default();
    let listening = thread::scope(|scope| {
        let stopped = scope.spawn(|| {
            interrupt::listen(&request);
            let mut stop = |reached: Reached<'_>| match reached {
                Reached::Iteration(_, report) if report.iteration == 3 => request.make(),
                _ => {}
            };
            let told = solve("pair", None, &folder.path().join("stopped"), &mut stop);
            (told, interrupt::requested())
        });
        stopped.join().unwrap()
    });
    assert!(!listening.0.is_solved && listening.1);
    let summary = read(folder.path().join("stopped/summary.json"));
    assert_eq!(summary["status"], "interrupted");
    assert_eq!(summary["iterations"], 3);
    assert!(!interrupt::requested());
    let again = solve("pair", None, &folder.path().join("again"), &mut |_| {});
    assert!(again.is_solved);
}

#[test]
fn a_request_stops_a_motion_after_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let request = StopRequest::default();
    let mut times = Vec::new();
    thread::scope(|scope| {
        scope.spawn(|| {
            interrupt::listen(&request);
            let mut stop = |reached: Reached<'_>| match reached {
                Reached::Step(step, time) => {
                    times.push(time);
                    if step == 4 {
                        request.make();
                    }
                }
                other => panic!("{other:?}"),
            };
            solve("pair_constant", None, folder.path(), &mut stop)
        });
    });
    let summary = read(folder.path().join("summary.json"));
    assert_eq!(summary["status"], "interrupted");
    assert_eq!((summary["steps"].as_u64(), times.len()), (Some(4), 4));
    assert_eq!(summary["duration"].as_f64(), Some(times[3] / 1e3));
}

#[test]
fn a_text_is_checked_and_its_program_handed_out() {
    let path = nowhere();
    assert_eq!(check_text(&path, &text("pair"), &[]).unwrap(), "control");
    let other = check_text(&path, &text("pair_constant"), &[]).unwrap();
    assert_eq!(other, "simulate");
    let wrong = text("pair").replace("\"intervals\": 20", "\"intervals\": -3");
    let error = check_text(&path, &wrong, &[]).unwrap_err();
    assert_eq!(error.place(), "control.intervals");
    assert!(error.to_string().contains("nowhere.json"), "{error}");
    let error = with_program(&path, &text("pair_constant"), |_, _| ()).unwrap_err();
    assert_eq!(error.place(), "simulate");
    let [n, m, start] = with_program(&path, &text("pair"), |program, start| {
        [
            program.variables().lower.len(),
            program.constraints().lower.len(),
            start.len(),
        ]
    })
    .unwrap();
    assert!(n > m && m > 20 && n == start);
}
