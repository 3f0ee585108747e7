//! Problems that no start solves: what is said of their duration, and stops on the way.

use crate::verdicts::{control, kept, output_of, read};
use proboscis::control::problem::{MotionTask, Task};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::files::read_problem;
use proboscis::nlp::Status;
use proboscis::stop::{self, Questions};
use proboscis::tasks::{
    SimulationRequest, SimulationResult, SolveRequest, SolveResult, simulate, solve,
};
use proboscis::workflow::accuracy::AccuracyTarget;
use proboscis::workflow::{
    Iterate, Optimum, Shortest, SolveLimits, WorkflowError, listen_to_phases, optimise,
    optimise_together,
};
use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;
use tempfile::tempdir;

const TRUNK: &str = "elephant_trunk_effort";
/// A fifth of the duration of the trunk, in too few iterations.
const SHORT: [&str; 2] = [
    "control.duration=0.12 s",
    "control.solver.max_iterations=55",
];

#[test]
fn a_limit_of_iterations_is_explained_by_a_duration_that_can_be_solved() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("short");
    let ended = output_of(&kept(TRUNK), &SHORT, &out);
    assert!(!ended.is_solved);
    assert_eq!(read(&out.join("summary.json"))["status"], "iteration_limit");
    let seconds = |before: &str| -> f64 {
        let said = ended.notes.iter().find_map(|note| {
            let (_, after) = note.split_once(before)?;
            after.split(' ').next()
        });
        said.unwrap_or_else(|| panic!("{:?}", ended.notes))
            .parse()
            .unwrap()
    };
    let found = seconds("with the duration free the shortest motion found takes ");
    let slowest = seconds("half a period of the slowest mode takes ");
    // As a clamped beam of 300 mm 0.35 s, π (L/1.875)² √(m/EI); the voltages of the goal soften it.
    assert!((0.35..0.7).contains(&slowest), "{slowest} s");
    assert!((0.12..0.7).contains(&found), "{found} s");
    for duration in [found, slowest] {
        let change = format!("control.duration={duration} s");
        let ended = output_of(&kept(TRUNK), &[&change], &folder.path().join("longer"));
        assert!(ended.is_solved, "{duration} s: {ended:?}");
    }
}

/// The same on half of the intervals.
const SHORT_AND_COARSE: [&str; 3] = [SHORT[0], SHORT[1], "control.intervals=20"];

/// Phases of the starts after the first one, each with a problem that comes to it: the shortest motion of the trunk is longer, and nothing is displaced.
const LATER: [(&str, &str, &[&str]); 4] = [
    ("looking for the shortest motion", TRUNK, &SHORT_AND_COARSE),
    (
        "a second, displaced initial guess",
        "tendon_finger_control",
        &KINKED,
    ),
    ("looking for the slowest mode", TRUNK, &SHORT_AND_COARSE),
    (
        "looking for a slow motion",
        "tendon_finger_control",
        &KINKED,
    ),
];
/// Changes with which the tendon of the finger grows taut at a kink.
const KINKED: [&str; 3] = [
    "scene.tendons[0].smoothing=null",
    "control.intervals=60",
    "control.solver.max_iterations=55",
];

/// Solves until some questions after the beginning of a phase; returns the result and the questions after the end of the time.
fn stopped_in(phase: &'static str, (name, changes): (&str, &[&str]), after: u64) -> (Optimum, u64) {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let (system, control) = control(name, &changes);
    let questions = Questions::allowed(u64::MAX);
    let over = Rc::new(Cell::new(0));
    let (asked, end) = (questions.clone(), over.clone());
    listen_to_phases(move |begun| {
        if begun == phase {
            asked.end_after(after);
            end.set(asked.asked() + after);
        }
    });
    let watch = stop::watch_questions(&questions);
    let found = optimise(&system, &control, None, SolveLimits::default(), &mut |_| {
        ControlFlow::Continue(())
    });
    drop(watch);
    listen_to_phases(|_| ());
    assert!(over.get() > 0, "{phase} was not begun");
    (found.unwrap(), questions.asked() - over.get())
}

#[test]
fn other_starts_stop_at_the_next_question_and_leave_the_first_one() {
    for (phase, name, changes) in LATER {
        // The later starts of the finger are short.
        let afters: &[u64] = if name == TRUNK { &[0, 2] } else { &[0] };
        for &after in afters {
            let (found, late) = stopped_in(phase, (name, changes), after);
            println!("{phase}, {after}: {late} questions after the end");
            assert_eq!(found.word(), "time_limit", "{phase}");
            assert_eq!(found.solution.status, Status::IterationLimit);
            assert!(found.motion.intervals() >= 20 && !found.violated.is_empty());
            assert!(!matches!(found.shortest, Shortest::NotUpTo(_)));
            // One for each piece of work that is not begun any more.
            assert!(late < 30, "{phase}: {late} questions after the end");
        }
    }
}

/// A stop while a finer grid is built keeps the optimum of the grid before.
#[test]
fn a_stop_between_grids_keeps_the_result_so_far() {
    let (system, control) = control(TRUNK, &["control.intervals=auto".to_owned()]);
    let questions = Questions::allowed(u64::MAX);
    let (asked, built) = (questions.clone(), Cell::new(0));
    listen_to_phases(move |begun| {
        built.set(built.get() + i32::from(begun.starts_with("building the model")));
        if built.get() == 2 {
            asked.end_after(0);
        }
    });
    let watch = stop::watch_questions(&questions);
    // No grid is fine enough for this.
    let request = SolveRequest {
        wanted: Some(AccuracyTarget::Below(1e-9)),
        ..SolveRequest::default()
    };
    let task = MotionTask::alone(&system, &control).into();
    let found = optimise_together(&task, request, &mut |_, _| ControlFlow::Continue(()));
    drop(watch);
    listen_to_phases(|_| ());
    let found = found.expect("the result of the first grid");
    let optimum = &found.optima[0];
    assert!(optimum.solution.status.is_solved());
    assert_eq!(optimum.motion.intervals(), control.intervals);
    let note = optimum.refined.as_ref();
    let note = note.expect("the accuracy is not reached");
    assert!(note.ends_with("it was stopped"), "{note}");
}

/// A stop that leaves a point of a weaker tolerance is told, so that the point does not count as the end of the matter.
#[test]
fn an_optimum_to_a_weaker_tolerance_tells_of_the_stop() {
    let (system, control) = control("pair", &[]);
    let run = |allowed: u64| {
        let questions = Questions::allowed(allowed);
        let asked = questions.clone();
        // What the solver found is verified without a stop.
        listen_to_phases(move |begun| {
            if begun == "simulating under the optimal inputs" {
                asked.end_after(u64::MAX >> 1);
            }
        });
        let _watch = stop::watch_questions(&questions);
        let mut last = 0;
        let found = solve(&system, &control, SolveRequest::default(), &mut |_, _| {
            last = questions.asked();
            ControlFlow::Continue(())
        });
        listen_to_phases(|_| ());
        (found.unwrap(), last)
    };
    let codes = |found: &SolveResult| -> Vec<String> {
        let each = found.remarks.0.iter();
        each.map(|remark| remark.code.to_string()).collect()
    };
    let (whole, last) = run(u64::MAX >> 1);
    assert_eq!(whole.verdict.word, "solved");
    assert!(!codes(&whole).contains(&"stopped_early".to_owned()));
    let mut stopped = (0..last).rev().take(80).map(|allowed| run(allowed).0);
    let early = stopped
        .find(|found| found.verdict.word == "acceptable")
        .expect("a stop at an acceptable point");
    assert!(codes(&early).contains(&"stopped_early".to_owned()));
    assert!(early.verdict.is_solved);
    let [early, whole] = [early, whole].map(|found| found.optimum.solution.objective);
    assert!(
        early != whole && (early / whole - 1.0).abs() < 1e-3,
        "{early} {whole}"
    );
}

/// A motion by a tolerance whose confirmation is stopped is whole, and says that its error is not known.
#[test]
fn a_motion_whose_error_is_not_confirmed_tells_of_the_stop() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_constant.json");
    let loaded = read_problem(&path, &["simulate.step=auto".to_owned()]).unwrap();
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation");
    };
    let run = |allowed: u64| {
        let questions = Questions::allowed(allowed);
        let _watch = stop::watch_questions(&questions);
        let go_on = &mut |_: usize, _: &_, _: &_| ControlFlow::Continue(());
        let found = simulate(&loaded.system, task, SimulationRequest::default(), go_on);
        (found.unwrap(), questions.asked())
    };
    let early = |found: &SimulationResult| {
        let simulated = &found.simulated;
        let trajectory = Trajectory::from_discrete(&simulated.model, &simulated.discrete);
        let assessed = found.assess(&loaded.system, task, &trajectory);
        let mut each = assessed.remarks.0.iter();
        each.any(|remark| remark.code == "stopped_early")
    };
    let (whole, asked) = run(u64::MAX >> 1);
    assert!(
        whole
            .simulated
            .error
            .is_some_and(|error| error.is_confirmed)
    );
    assert!(!early(&whole));
    let (stopped, _) = run(asked - asked / 8);
    assert_eq!(stopped.word(), "simulated");
    assert_eq!(stopped.reached(), whole.reached());
    assert!(stopped.simulated.error.is_none() && early(&stopped));
}

/// Whenever it is time to stop, a motion, a state of rest and a motion over a horizon end as stopped: no other error, and no panic.
#[test]
fn stops_are_no_errors() {
    let kept = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        read_problem(&path, &[]).unwrap()
    };
    let mut stopped = 0;
    for (name, counts) in [("pair_receding", 400), ("tendon_finger_control", 150)] {
        let loaded = kept(name);
        for count in (0..counts).step_by(7) {
            let questions = Questions::allowed(count);
            let watch = stop::watch_questions(&questions);
            let found = match &loaded.task {
                Task::Simulate(task) => {
                    let request = SimulationRequest::default();
                    let go_on = &mut |_: usize, _: &_, _: &_| match stop::reason() {
                        Some(_) => ControlFlow::Break(()),
                        None => ControlFlow::Continue(()),
                    };
                    let found = simulate(&loaded.system, task, request, go_on);
                    found.map(|found| found.word() != "simulated")
                }
                Task::Control(control) => {
                    let limits = SolveLimits::default();
                    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
                    let found = optimise(&loaded.system, control, None, limits, go_on);
                    found.map(|found| !found.is_solved())
                }
                _ => unreachable!("of two kinds"),
            };
            drop(watch);
            let is_stopped = match found {
                Err(WorkflowError::Stopped(_)) => true,
                Err(error) => panic!("{name} {count}: {error}"),
                Ok(is_stopped) => is_stopped,
            };
            stopped += usize::from(is_stopped);
        }
    }
    assert!(stopped > 50, "{stopped}");
}
