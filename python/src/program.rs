//! The nonlinear program of a control problem: a thread keeps it and answers.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::{self, Sender};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use proboscis::Nlp;
use proboscis::app::with_program;
use proboscis::nlp::{Bounds, Entries};
use proboscis::workflow::at_once;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::error;

type Question = Box<dyn FnOnce(&mut dyn Nlp) + Send>;
type Array<'py> = Bound<'py, PyArray1<f64>>;
type Indices<'py> = Bound<'py, PyArray1<u32>>;

/// What does not change of a program.
struct Sizes {
    start: Vec<f64>,
    bounds: [Bounds; 2],
    structures: [Entries; 2],
    names: [Vec<String>; 2],
}

/// A nonlinear program; values are in the order of the structures.
#[pyclass(frozen)]
pub(crate) struct Program {
    ask: Mutex<Sender<Question>>,
    sizes: Sizes,
}

impl Program {
    /// The answer of the thread that keeps the program.
    fn answer<R: Send + 'static>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&mut dyn Nlp) -> R + Send + 'static,
    ) -> PyResult<R> {
        let (tell, mut told) = mpsc::channel();
        let question: Question = Box::new(move |program| {
            tell.send(question(program)).ok();
        });
        let told = &mut told;
        let answer = py.detach(move || {
            self.ask.lock().ok()?.send(question).ok()?;
            told.recv().ok()
        });
        answer.ok_or_else(|| PyRuntimeError::new_err("the program broke off; see standard error"))
    }

    fn variables(&self) -> usize {
        self.sizes.start.len()
    }

    fn constraints(&self) -> usize {
        self.sizes.bounds[1].lower.len()
    }
}

/// The numbers of an array of this length.
fn taken(array: &PyReadonlyArray1<'_, f64>, length: usize, of: &str) -> PyResult<Vec<f64>> {
    let values = array.as_array().to_vec();
    match values.len() == length {
        true => Ok(values),
        false => Err(PyValueError::new_err(format!(
            "{of}: found {} numbers, expected {length}",
            values.len()
        ))),
    }
}

#[pymethods]
impl Program {
    #[new]
    fn new(py: Python<'_>, input: PathBuf, text: String) -> PyResult<Self> {
        let (ask, questions) = mpsc::channel::<Question>();
        let (tell, mut told) = mpsc::channel();
        let work = move || {
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
                for question in questions {
                    question(program);
                }
            });
            if let Err(mistake) = ended {
                failed.send(Err(mistake)).ok();
            }
        };
        at_once::begin(work)?;
        let waiting = &mut told;
        let sizes = py.detach(move || waiting.recv());
        let sizes = sizes
            .map_err(|_| PyRuntimeError::new_err("the program broke off; see standard error"))?
            .map_err(|mistake| error(py, &mistake))?;
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
