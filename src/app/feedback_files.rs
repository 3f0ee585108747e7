//! The files of a regulator along an optimum: `feedback.json`, `feedback.csv`, `feedback.c` and `feedback.npz`.

use std::io;

use nalgebra::DMatrix;

use crate::app::summary::Summary;
use crate::control::problem::{Control, Regulator};
use crate::files::feedback::{law_c, law_csv, law_json};
use crate::files::npz::NpzWriter;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::tasks::SolveResult;
use crate::workflow::regulator::{Along, Regulated, RegulatedStep, regulator};

const JSON: &str = "feedback.json";
const TABLE: &str = "feedback.csv";
const ARRAYS: &str = "feedback.npz";
const CODE: &str = "feedback.c";

/// Finds the regulator that is asked for and adds its files and remarks; one of an earlier result goes.
///
/// # Errors
/// A file cannot be written.
pub(super) fn add(
    control: &Control,
    task: Option<&Regulator>,
    result: &SolveResult,
    summary: &mut Summary,
    files: &mut FileSet,
    origin: &Origin,
) -> Result<(), WriteError> {
    let found = task.map(|task| {
        let optimum = &result.optimum;
        if !result.verdict.is_solved {
            return Err("the motion is no optimum".to_owned());
        }
        let along = Along::new(optimum, &result.discrete, control);
        regulator(along, task).map_err(|reason| reason.to_string())
    });
    match found {
        None => {}
        Some(Err(reason)) => {
            let text = format!("no gains of \"feedback\" were written: {reason}");
            summary.notes.warn("feedback", [text]);
        }
        Some(Ok(found)) => {
            let system = &result.optimum.model.system;
            summary.notes.note("feedback", found.notes());
            summary.notes.warn("feedback", found.warnings());
            summary.feedback = Some(found.report());
            files.add(JSON, law_json(&found.law, system).as_bytes())?;
            let origin = origin.line();
            files.add(TABLE, law_csv(&found.law, system, &origin).as_bytes())?;
            files.add(CODE, law_c(&found.law, system, &origin).as_bytes())?;
            let arrays = arrays(&found).map_err(WriteError::at(files.folder().join(ARRAYS)))?;
            return files.add(ARRAYS, &arrays);
        }
    }
    for name in [JSON, TABLE, CODE, ARRAYS] {
        files.remove(name);
    }
    Ok(())
}

/// Matrices of all steps in rad, mm, ms, g, V: of the state of coordinates, momenta and integrals.
fn arrays(found: &Regulated) -> io::Result<Vec<u8>> {
    let mut arrays = NpzWriter::default();
    type Matrix = fn(&RegulatedStep) -> DMatrix<f64>;
    let mut of: Vec<(&str, Matrix)> = vec![
        ("A", |step| step.by_state.clone()),
        ("B", |step| step.by_inputs.clone()),
        ("Q", |step| step.whole_costs().costs.state),
        ("R", |step| step.whole_costs().costs.inputs),
        ("K", |step| step.gain.clone()),
    ];
    if found.steps[0].has_rates() {
        of.push(("N", |step| step.whole_costs().cross.transpose()));
    }
    for (name, matrix) in of {
        let first = matrix(&found.steps[0]);
        let shape = [found.steps.len(), first.nrows(), first.ncols()];
        let all = found
            .steps
            .iter()
            .flat_map(|step| rows(&matrix(step)).collect::<Vec<_>>());
        arrays.array(name, &shape, all);
        if let Some((step, _)) = &found.held {
            let matrix = matrix(step);
            let shape = [matrix.nrows(), matrix.ncols()];
            arrays.array(&format!("{name}_held"), &shape, rows(&matrix));
        }
    }
    let end = &found.end_cost;
    arrays.array("S_end", &[end.nrows(), end.ncols()], rows(end));
    if let Some((_, held)) = &found.held {
        let cost = &held.cost;
        arrays.array("S_held", &[cost.nrows(), cost.ncols()], rows(cost));
    }
    Ok(arrays.finish()?.0)
}

fn rows(matrix: &DMatrix<f64>) -> impl Iterator<Item = f64> + '_ {
    let entries = (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| (i, j)));
    entries.map(|at| matrix[at])
}
