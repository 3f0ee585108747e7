//! A run in a thread of its own, while the thread of Python waits for news and for Ctrl-C.

use std::path::PathBuf;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use proboscis::app::{
    CommandInput, CommandOutput, PageWanted, ProgressDisplay, Reached, run_observed,
};
use proboscis::ipopt::interrupt::{self, StopRequest};
use proboscis::report::Figures;
use proboscis::workflow::accuracy::AccuracyTarget;
use proboscis::workflow::at_once;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error;

/// How often Python is asked for signals.
const PERIOD: Duration = Duration::from_millis(50);

/// News of a run: intervals, number, objective, infeasibility and optimality of an iterate; number and time in ms of a step.
enum News {
    Iteration(usize, usize, f64, f64, f64),
    Step(usize, f64),
}

impl News {
    fn of(reached: Reached<'_>) -> Self {
        match reached {
            Reached::Iteration(intervals, at) => Self::Iteration(
                intervals,
                at.iteration,
                at.objective,
                at.primal_infeasibility,
                at.dual_infeasibility,
            ),
            Reached::Step(step, time) => Self::Step(step, time),
        }
    }

    fn tell(&self, observer: &Bound<'_, PyAny>) -> PyResult<()> {
        match *self {
            Self::Iteration(n, i, f, g, d) => observer.call1((n, i, f, g, d)),
            Self::Step(step, time) => observer.call1((step, time)),
        }?;
        Ok(())
    }
}

/// Whether the question has an answer, the answer, notes.
type Told = (bool, String, Vec<String>);

/// Does what a problem asks and writes the folder. Returns what is told of it, if there is anything, and the exception that ended it
/// early, if there was one.
#[pyfunction]
#[pyo3(signature = (input, text, changes, folder, command, *, max_seconds, max_iterations, accuracy, estimate_error, observer))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn run(
    py: Python<'_>,
    input: PathBuf,
    text: String,
    changes: Vec<String>,
    folder: PathBuf,
    command: String,
    max_seconds: Option<f64>,
    max_iterations: Option<usize>,
    accuracy: Option<f64>,
    estimate_error: bool,
    observer: Option<Bound<'_, PyAny>>,
) -> PyResult<(Option<Told>, Option<PyErr>)> {
    let request = CommandInput {
        command,
        input,
        set: changes,
        output: Some(folder),
        max_seconds,
        max_iterations,
        from: None,
        wanted: match (accuracy, estimate_error) {
            (Some(error), _) => Some(AccuracyTarget::Below(error)),
            (None, true) => Some(AccuracyTarget::Estimate),
            (None, false) => None,
        },
        figures: Figures::default(),
        progress: ProgressDisplay::Never,
        page: PageWanted::Written,
    };
    let stop = StopRequest::default();
    let (tell, mut told) = mpsc::channel();
    let (go_on, wait) = mpsc::channel::<()>();
    let (request_to_stop, is_observed) = (stop.clone(), observer.is_some());
    let work = move || {
        interrupt::listen(&request_to_stop);
        // `tell` ends with this thread, and with it the waiting of the other one.
        let ended = tell;
        run_observed(&request, Some(&text), &mut |reached| {
            if is_observed && ended.send(News::of(reached)).is_ok() {
                wait.recv().ok();
            }
        })
    };
    let thread = at_once::begin(work)?;
    let mut failure = None;
    loop {
        let waiting = &mut told;
        let news = py.detach(move || waiting.recv_timeout(PERIOD));
        let mut answer = py.check_signals();
        match (&news, &observer, &failure) {
            (Err(RecvTimeoutError::Disconnected), ..) => {}
            (Ok(news), Some(observer), None) if answer.is_ok() => answer = news.tell(observer),
            _ => {}
        }
        if let Err(raised) = answer {
            stop.make();
            failure.get_or_insert(raised);
        }
        match news {
            Ok(_) => go_on.send(()).unwrap_or(()),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let ended = py.detach(|| thread.join());
    let ended =
        ended.map_err(|_| PyRuntimeError::new_err("the run broke off; see standard error"))?;
    match (ended, failure) {
        (Ok(output), failure) => {
            let CommandOutput {
                is_solved,
                result,
                notes,
            } = output;
            Ok((Some((is_solved, result, notes)), failure))
        }
        (Err(_), Some(failure)) => Ok((None, Some(failure))),
        (Err(mistake), None) => Err(error(py, &mistake)),
    }
}
