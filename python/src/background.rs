//! Work in a thread of its own, while the thread of Python waits for news, for its end and for Ctrl-C.

use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use proboscis::app::{CommandError, CommandOutput, Reached};
use proboscis::stop::{self, StopRequest};
use proboscis::workflow::parallel_map;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::{broke_off, error};

/// Time between checks for signals of Python.
pub(crate) const PERIOD: Duration = Duration::from_millis(20);
/// Time that work has to end in good order after Ctrl-C, before it is left to do so behind the back of the caller.
const GRACE: Duration = Duration::from_millis(100);

/// Answer of work: true if the task has an answer, the answer, notes.
pub(crate) type Answer = (bool, String, Vec<String>);
/// End of work.
pub(crate) type Ended = Result<CommandOutput, CommandError>;
/// Answer of work, if there is one; the exception that ended it early, if there was one; work that still ends.
pub(crate) type Outcome = (Option<Answer>, Option<PyErr>, Option<Ending>);

/// A text as an answer.
pub(crate) const fn answer(result: String) -> CommandOutput {
    CommandOutput {
        is_solved: true,
        result,
        notes: Vec::new(),
    }
}

fn answer_of(output: CommandOutput) -> Answer {
    (output.is_solved, output.result, output.notes)
}

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

/// Work that was asked to stop and is not waited for.
#[pyclass(frozen)]
pub(crate) struct Ending {
    thread: Mutex<Option<JoinHandle<Ended>>>,
}

#[pymethods]
impl Ending {
    /// Returns true if it has ended.
    fn is_over(&self) -> bool {
        let thread = self.thread.lock();
        thread.is_ok_and(|thread| thread.as_ref().is_none_or(JoinHandle::is_finished))
    }

    /// Waits for its end; returns once what is told of it, if there is anything.
    fn wait(&self, py: Python<'_>) -> PyResult<Option<Answer>> {
        while !self.is_over() {
            py.detach(|| thread::sleep(PERIOD));
            py.check_signals()?;
        }
        let thread = self.thread.lock().ok().and_then(|mut kept| kept.take());
        let ended = thread.and_then(|thread| thread.join().ok());
        Ok(ended.and_then(Result::ok).map(answer_of))
    }
}

/// Does work that hands its news to whom it is given.
///
/// After Ctrl-C it has a tenth of a second to end; then it is left to end alone. Another exception, from the observer or a handler of
/// signals, is kept until it has ended.
pub(crate) fn supervised(
    py: Python<'_>,
    observer: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(Reached<'_>)) -> Ended + Send + 'static,
) -> PyResult<Outcome> {
    let stop = StopRequest::default();
    let (tell, mut heard) = mpsc::channel();
    let (go_on, wait) = mpsc::channel::<()>();
    let (request_to_stop, is_observed) = (stop.clone(), observer.is_some());
    let work = move || {
        stop::listen(&request_to_stop);
        // `tell` ends with this thread, and with it the waiting of the other one.
        let ended = tell;
        work(&mut |reached| {
            if is_observed && ended.send(News::of(reached)).is_ok() {
                wait.recv().ok();
            }
        })
    };
    let thread = parallel_map::begin(work).map_err(|cause| broke_off(py, &cause.to_string()))?;
    let mut failure: Option<PyErr> = None;
    let mut interrupted: Option<Instant> = None;
    loop {
        let waiting = &mut heard;
        let news = py.detach(move || waiting.recv_timeout(PERIOD));
        let mut answer = py.check_signals();
        match (&news, observer, &failure) {
            (Err(RecvTimeoutError::Disconnected), ..) => {}
            (Ok(news), Some(observer), None) if answer.is_ok() => answer = news.tell(observer),
            _ => {}
        }
        if let Err(raised) = answer {
            stop.make();
            if raised.is_instance_of::<PyKeyboardInterrupt>(py) {
                interrupted.get_or_insert_with(Instant::now);
            }
            failure.get_or_insert(raised);
        }
        match news {
            Ok(_) => go_on.send(()).unwrap_or(()),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if interrupted.is_some_and(|at| at.elapsed() > GRACE) {
            let thread = Mutex::new(Some(thread));
            return Ok((None, failure, Some(Ending { thread })));
        }
    }
    let ended = py.detach(|| thread.join());
    match (
        ended.map_err(|_| broke_off(py, "see standard error"))?,
        failure,
    ) {
        (Ok(output), failure) => Ok((Some(answer_of(output)), failure, None)),
        (Err(_), Some(failure)) => Ok((None, Some(failure), None)),
        (Err(mistake), None) => Err(error(py, &mistake)),
    }
}
