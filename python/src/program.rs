//! The nonlinear program of a control problem: a thread keeps it and answers.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use proboscis::Nlp;
use proboscis::app::with_program;
use proboscis::nlp::{Bounds, Entries};
use proboscis::stop::{self, StopRequest};
use proboscis::workflow::parallel_map;
use pyo3::prelude::*;

use crate::background::PERIOD;
use crate::{broke_off, error, mistake};

type Call = Box<dyn FnOnce(&mut dyn Nlp) + Send>;
type Array<'py> = Bound<'py, PyArray1<f64>>;
type Indices<'py> = Bound<'py, PyArray1<u32>>;

/// Constant data of a program.
struct Sizes {
    start: Vec<f64>,
    bounds: [Bounds; 2],
    structures: [Entries; 2],
    names: [Vec<String>; 2],
}

/// A nonlinear program; values are in the order of the structures.
#[pyclass(frozen)]
pub(crate) struct Program {
    ask: Mutex<Sender<Call>>,
    sizes: Sizes,
}

impl Program {
    /// The answer of the thread that keeps the program.
    fn answer<R: Send + 'static>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut dyn Nlp) -> R + Send + 'static,
    ) -> PyResult<R> {
        let (tell, told) = mpsc::channel();
        let call: Call = Box::new(move |program| {
            tell.send(call(program)).ok();
        });
        let asked = py.detach(|| self.ask.lock().ok()?.send(call).ok());
        asked.ok_or_else(|| broke_off(py, "see standard error"))?;
        heard(py, told)
    }

    fn variables(&self) -> usize {
        self.sizes.start.len()
    }

    fn constraints(&self) -> usize {
        self.sizes.bounds[1].lower.len()
    }
}

/// Waits for a message of another thread; Ctrl-C ends the waiting.
pub(crate) fn heard<T: Send>(py: Python<'_>, mut told: Receiver<T>) -> PyResult<T> {
    loop {
        let waiting = &mut told;
        let heard = py.detach(move || waiting.recv_timeout(PERIOD));
        match heard {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(broke_off(py, "see standard error"));
            }
        }
    }
}

/// The numbers of an array of this length.
pub(crate) fn taken(
    array: &PyReadonlyArray1<'_, f64>,
    length: usize,
    of: &str,
) -> PyResult<Vec<f64>> {
    let values = array.as_array().to_vec();
    match values.len() == length {
        true => Ok(values),
        false => {
            let found = format!("{of}: found {} numbers, expected {length}", values.len());
            Err(mistake(array.py(), found, of))
        }
    }
}

#[pymethods]
impl Program {
    #[new]
    fn new(py: Python<'_>, input: PathBuf, text: String) -> PyResult<Self> {
        let (ask, calls) = mpsc::channel::<Call>();
        let (tell, told) = mpsc::channel();
        let stop = StopRequest::default();
        let request = stop.clone();
        let work = move || {
            stop::listen(&request);
            let failed = tell.clone();
            let ended = with_program(&input, &text, move |program, start| {
                let (n, m) = (start.len(), program.constraints().lower.len());
                let sizes = Sizes {
                    start: start.to_vec(),
                    bounds: [program.variables().clone(), program.constraints().clone()],
                    structures: [program.jacobian_structure(), program.hessian_structure()],
                    names: [
                        (0..n).map(|i| program.variable_name(i)).collect(),
                        (0..m).map(|i| program.constraint_name(i)).collect(),
                    ],
                };
                tell.send(Ok(sizes)).ok();
                drop(tell);
                for call in calls {
                    call(program);
                }
            });
            if let Err(mistake) = ended {
                failed.send(Err(mistake)).ok();
            }
        };
        parallel_map::begin(work).map_err(|cause| broke_off(py, &cause.to_string()))?;
        let sizes = heard(py, told).inspect_err(|_| stop.make())?;
        let sizes = sizes.map_err(|mistake| error(py, &mistake))?;
        let ask = Mutex::new(ask);
        Ok(Self { ask, sizes })
    }

    fn start<'py>(&self, py: Python<'py>) -> Array<'py> {
        self.sizes.start.clone().into_pyarray(py)
    }

    /// Lower and upper bounds of variables, then of constraints.
    fn bounds<'py>(&self, py: Python<'py>) -> [Array<'py>; 4] {
        let [x, g] = &self.sizes.bounds;
        [&x.lower, &x.upper, &g.lower, &g.upper].map(|v| v.clone().into_pyarray(py))
    }

    /// Rows and columns of the Jacobian, then of the lower triangle of the Hessian.
    fn structures<'py>(&self, py: Python<'py>) -> [Indices<'py>; 4] {
        let [j, h] = &self.sizes.structures;
        [&j.rows, &j.cols, &h.rows, &h.cols].map(|v| v.clone().into_pyarray(py))
    }

    /// Names of variables, then of constraints.
    fn names(&self) -> [Vec<String>; 2] {
        self.sizes.names.clone()
    }

    fn objective(&self, py: Python<'_>, x: PyReadonlyArray1<'_, f64>) -> PyResult<f64> {
        let x = taken(&x, self.variables(), "x")?;
        self.answer(py, move |program| program.objective(&x))
    }

    fn gradient<'py>(&self, py: Python<'py>, x: PyReadonlyArray1<'_, f64>) -> PyResult<Array<'py>> {
        let x = taken(&x, self.variables(), "x")?;
        let values = self.answer(py, move |program| {
            let mut gradient = vec![0.0; x.len()];
            program.gradient(&x, &mut gradient);
            gradient
        })?;
        Ok(values.into_pyarray(py))
    }

    fn constraint<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Array<'py>> {
        let (x, m) = (taken(&x, self.variables(), "x")?, self.constraints());
        let values = self.answer(py, move |program| {
            let mut values = vec![0.0; m];
            program.constraint(&x, &mut values);
            values
        })?;
        Ok(values.into_pyarray(py))
    }

    fn jacobian<'py>(&self, py: Python<'py>, x: PyReadonlyArray1<'_, f64>) -> PyResult<Array<'py>> {
        let x = taken(&x, self.variables(), "x")?;
        let entries = self.sizes.structures[0].rows.len();
        let values = self.answer(py, move |program| {
            let mut values = vec![0.0; entries];
            program.jacobian(&x, &mut values);
            values
        })?;
        Ok(values.into_pyarray(py))
    }

    fn hessian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'_, f64>,
        factor: f64,
        multipliers: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Array<'py>> {
        let x = taken(&x, self.variables(), "x")?;
        let y = taken(&multipliers, self.constraints(), "multipliers")?;
        let entries = self.sizes.structures[1].rows.len();
        let values = self.answer(py, move |program| {
            let mut values = vec![0.0; entries];
            program.hessian(&x, factor, &y, &mut values);
            values
        })?;
        Ok(values.into_pyarray(py))
    }
}
