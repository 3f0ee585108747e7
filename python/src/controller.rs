//! A controller that plans anew over a receding horizon: a thread keeps it, answers, and prepares the next step.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::{self, Sender};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use proboscis::app::{FileHorizon, SiController};
use proboscis::stop::{self, StopRequest};
use proboscis::workflow::parallel_map;
use pyo3::prelude::*;

use crate::program::{heard, taken};
use crate::{broke_off, error};

/// A step: its time in s, what was measured, and a place for the origin of the inputs with these.
type Step = (f64, Option<Vec<f64>>, Sender<(&'static str, Vec<f64>)>);
/// Names with units.
type Names = Vec<(String, &'static str)>;

/// A controller in SI units.
#[pyclass(frozen)]
pub(crate) struct Controller {
    ask: Mutex<Sender<Step>>,
    names: [Names; 2],
    interval: f64,
}

#[pymethods]
impl Controller {
    #[new]
    fn new(py: Python<'_>, input: PathBuf, text: String, intervals: usize) -> PyResult<Self> {
        let (ask, steps) = mpsc::channel::<Step>();
        let (tell, told) = mpsc::channel();
        let stop = StopRequest::default();
        let request = stop.clone();
        let work = move || {
            stop::listen(&request);
            let horizon = match FileHorizon::new(&input, Some(&text), intervals) {
                Ok(horizon) => horizon,
                Err(mistake) => {
                    tell.send(Err(mistake)).ok();
                    return;
                }
            };
            let mut controller = SiController::new(&horizon);
            let names = [horizon.measured(), horizon.inputs()];
            tell.send(Ok((names, horizon.interval()))).ok();
            for (time, measured, answer) in steps {
                let (source, inputs) = controller.step(time, measured.as_deref());
                answer.send((source.word(), inputs.to_vec())).ok();
                controller.prepare();
            }
        };
        parallel_map::begin(work).map_err(|cause| broke_off(py, &cause.to_string()))?;
        let made = heard(py, told).inspect_err(|_| stop.make())?;
        let (names, interval) = made.map_err(|mistake| error(py, &mistake))?;
        Ok(Self {
            ask: Mutex::new(ask),
            names,
            interval,
        })
    }

    /// Names of what is measured and of the inputs, with their units.
    fn names(&self) -> [Names; 2] {
        self.names.clone()
    }

    /// Length of the intervals in s.
    fn interval(&self) -> f64 {
        self.interval
    }

    /// Origin and values of the inputs.
    fn step<'py>(
        &self,
        py: Python<'py>,
        time: f64,
        measured: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<(&'static str, Bound<'py, PyArray1<f64>>)> {
        let states = self.names[0].len();
        let measured = measured.map(|array| taken(&array, states, "measured"));
        let measured = measured.transpose()?;
        let (tell, told) = mpsc::channel();
        let step = (time, measured, tell);
        let asked = py.detach(|| self.ask.lock().ok()?.send(step).ok());
        asked.ok_or_else(|| broke_off(py, "see standard error"))?;
        let (source, inputs) = heard(py, told)?;
        Ok((source, inputs.into_pyarray(py)))
    }
}
