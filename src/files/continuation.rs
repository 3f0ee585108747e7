//! `continuation.npz`: a simulated motion with all data from which another run resumes it to the bit.
//!
//! Times are in ms; coordinates, momenta, voltages and potentials are as the program has them (g, mm, ms, N, V). `state/…` is the state of
//! the method at the end, `tangent/…` the matrix whose factors are used again, `problem.json` the problem.

use std::io;
use std::path::Path;

use crate::dynamics::{DiscreteTrajectory, Inputs, StepState, StepperReport, TangentState, Work};

use crate::files::npz::{self, Array, Npz, NpzError, NpzWriter};
use crate::sparse::MethodState;

/// Name of the text of the problem.
const PROBLEM: &str = "problem.json";
/// The text that names the method of factorisation.
const METHOD: &str = "tangent/method.txt";
/// Name of the text that identifies the equations of a state.
const OF: &str = "state/of.txt";
/// Begins the names of lists of the state.
const STATE: &str = "state/";

/// A motion, and its problem.
#[derive(Clone, Debug)]
pub struct Continuation {
    /// The motion.
    pub discrete: DiscreteTrajectory,
    /// The JSON text of the problem.
    pub problem: String,
}

/// Reason why a file is no continuation.
#[derive(Debug, thiserror::Error)]
pub enum ContinuationError {
    /// It is no file of arrays.
    #[error(transparent)]
    Npz(#[from] NpzError),
    /// Something is missing, or has another shape.
    #[error("{0} is missing, or not as a simulation writes it")]
    Missing(&'static str),
}

/// The content of a file, or why it is no continuation.
type Result<T, E = ContinuationError> = std::result::Result<T, E>;

/// The bytes of a file.
///
/// # Errors
/// A motion with names too long for the format; no method has them.
pub fn bytes(discrete: &DiscreteTrajectory, problem: &str) -> io::Result<Vec<u8>> {
    let mut arrays = NpzWriter::default();
    arrays.text(PROBLEM, problem);
    arrays.list("times", &discrete.times);
    arrays.rows("z", &discrete.z);
    arrays.rows("momenta", &discrete.momenta);
    arrays.rows("scalars", &discrete.scalars);
    let ends = |part: fn(&Inputs) -> &Vec<f64>| -> Vec<Vec<f64>> {
        let ends = discrete.ends.iter().flatten();
        ends.map(part).cloned().collect()
    };
    if !discrete.ends.is_empty() {
        arrays.rows("input_ends", &ends(|inputs| &inputs.values));
        arrays.rows("input_rates", &ends(|inputs| &inputs.rates));
    }
    let works = |part: fn(&Work) -> f64| discrete.works.iter().map(part).collect::<Vec<_>>();
    arrays.list("works", &works(|work| work.dissipation));
    arrays.list("applied_works", &works(|work| work.applied));
    if let Some(rates) = &discrete.rates {
        arrays.list("rates", rates);
    }
    let StepState {
        of,
        lists,
        tangent,
        report,
        wanted,
        tolerance,
    } = &discrete.end;
    arrays.text(OF, of);
    for (i, (name, list)) in lists.iter().enumerate() {
        arrays.list(&format!("{STATE}{i:04} {name}"), list);
    }
    if let Some(tangent) = tangent {
        arrays.text(METHOD, &tangent.method.method);
        let is_approximate = f64::from(u8::from(tangent.is_approximate));
        arrays.list(
            "tangent/learnt",
            &[is_approximate, tangent.method.doubled as f64],
        );
        arrays.list("tangent/step", tangent.step.as_slice());
        arrays.list("tangent/matrix", &tangent.matrix);
    }
    add_report(&mut arrays, report);
    arrays.list("wanted", wanted.as_slice());
    arrays.list("tolerance", tolerance.as_slice());
    Ok(arrays.finish()?.0)
}

/// Reads a file.
///
/// # Errors
/// It is none.
pub fn read(path: &Path) -> Result<Continuation> {
    let mut file = npz::read(path, |_| true)?;
    let problem = file.texts.remove(PROBLEM);
    let problem = problem.ok_or(ContinuationError::Missing(PROBLEM))?;
    let end = state(&mut file)?;
    let works = list(&mut file, "works")?.into_iter();
    let works = works.zip(list(&mut file, "applied_works")?);
    let discrete = DiscreteTrajectory {
        times: list(&mut file, "times")?,
        z: rows(&mut file, "z")?,
        momenta: rows(&mut file, "momenta")?,
        scalars: rows(&mut file, "scalars")?,
        ends: ends(&mut file)?,
        works: works
            .map(|(dissipation, applied)| Work {
                applied,
                dissipation,
            })
            .collect(),
        rates: file.arrays.remove("rates").map(|rates| rates.values),
        report: end.report,
        end,
        ..DiscreteTrajectory::default()
    };
    let is_whole = discrete.times.len() > 1 && discrete.z.len() == discrete.times.len();
    if !is_whole || discrete.momenta.len() != discrete.times.len() {
        return Err(ContinuationError::Missing("a motion of one step or more"));
    }
    Ok(Continuation { discrete, problem })
}

/// Inputs at the ends of intervals; none where they are constant.
fn ends(file: &mut Npz) -> Result<Vec<[Inputs; 2]>> {
    if !file.arrays.contains_key("input_ends") {
        return Ok(Vec::new());
    }
    let values = rows(file, "input_ends")?.into_iter();
    let rates = rows(file, "input_rates")?.into_iter();
    let mut all = values.zip(rates);
    let mut next = || {
        let (values, rates) = all.next()?;
        Some(Inputs { values, rates })
    };
    Ok(std::iter::from_fn(|| Some([next()?, next()?])).collect())
}

fn state(file: &mut Npz) -> Result<StepState> {
    let (of_state, others) = std::mem::take(&mut file.arrays)
        .into_iter()
        .partition(|(name, _)| name.starts_with(STATE));
    file.arrays = others;
    // Their numbers put them in order.
    let of_state: std::collections::BTreeMap<String, Array> = of_state;
    let lists = of_state.into_iter().map(|(name, array)| {
        let (_, name) = name.split_once(' ').unwrap_or_default();
        (name.to_owned(), array.values)
    });
    let tangent = match file.texts.remove(METHOD) {
        None => None,
        Some(method) => {
            let [is_approximate, doubled] = numbers(file, "tangent/learnt")?;
            Some(TangentState {
                step: list(file, "tangent/step")?.first().copied(),
                is_approximate: is_approximate != 0.0,
                method: MethodState {
                    method,
                    doubled: doubled as usize,
                },
                matrix: list(file, "tangent/matrix")?,
            })
        }
    };
    Ok(StepState {
        of: file.texts.remove(OF).unwrap_or_default(),
        lists: lists.collect(),
        tangent,
        report: report(file)?,
        wanted: list(file, "wanted")?.first().copied(),
        tolerance: list(file, "tolerance")?.first().copied(),
    })
}

/// Declares the numbers of a report: names of arrays, and the fields that they hold.
macro_rules! report {
    ($($name:literal: $($($field:ident).+),+;)*) => {
        fn add_report(arrays: &mut NpzWriter, of: &StepperReport) {
            $(arrays.list($name, &[$(of.$($field).+ as f64),+]);)*
        }

        fn report(file: &mut Npz) -> Result<StepperReport> {
            let mut of = StepperReport::default();
            $(
                let values = list(file, $name)?;
                let mut next = values.iter();
                $(of.$($field).+ = *next.next().ok_or(ContinuationError::Missing($name))? as _;)+
                if next.next().is_some() {
                    return Err(ContinuationError::Missing($name));
                }
            )*
            Ok(of)
        }
    };
}

report! {
    "report/counts": steps, iterations, halved, factorisations;
    "report/seconds": assembly, factorisation, solution;
    "report/energies": made, exchanged;
    "report/multigrid": fallbacks, multigrid.iterations, multigrid.hierarchies, multigrid.levels, multigrid.bytes;
}

fn taken(file: &mut Npz, name: &'static str) -> Result<Array> {
    let array = file.arrays.remove(name);
    array.ok_or(ContinuationError::Missing(name))
}

fn list(file: &mut Npz, name: &'static str) -> Result<Vec<f64>> {
    Ok(taken(file, name)?.values)
}

fn numbers<const N: usize>(file: &mut Npz, name: &'static str) -> Result<[f64; N]> {
    let list = list(file, name)?;
    list.try_into()
        .map_err(|_| ContinuationError::Missing(name))
}

fn rows(file: &mut Npz, name: &'static str) -> Result<Vec<Vec<f64>>> {
    let Array { shape, values } = taken(file, name)?;
    let [count, length] = shape[..] else {
        return Err(ContinuationError::Missing(name));
    };
    let row = |k: usize| values[k * length..(k + 1) * length].to_vec();
    Ok((0..count).map(row).collect())
}
