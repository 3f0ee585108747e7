//! A simulation on its page: rows of numbers, and the voltages that are held.

use crate::app::energy_summary::EnergySummary;
use crate::app::summary::Summary;
use crate::control::problem::{Afterwards, Simulation, Voltages};
use crate::dynamics::{DiscreteTrajectory, LocalError};
use crate::model::Model;
use crate::workflow::steps;

/// Rows of the page; `neglected` is the sum of the local errors of the steps.
pub(super) fn rows(
    summary: &Summary,
    task: &Simulation,
    (model, discrete): (&Model, &DiscreteTrajectory),
    neglected: Option<LocalError>,
) -> Vec<(String, String)> {
    let reached = discrete.times[discrete.intervals()];
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = vec![
        row("status", summary.status.replace('_', " ")),
        row("steps", steps::counted(discrete, task)),
        row("duration", format!("{} s", reached / 1e3)),
        row("method", method(task)),
        row("coordinates", model.coordinates.name().to_owned()),
        row("computing time", format!("{:.3} s", summary.seconds.total)),
    ];
    rows.extend(summary.energies.iter().flat_map(EnergySummary::rows));
    rows.extend(summary.accuracy.iter().flat_map(|a| {
        let told = |(name, error): (&&str, &f64)| {
            (format!("estimated error, {name}"), format!("{error:.1e}"))
        };
        a.estimate.iter().map(told)
    }));
    rows.extend(neglected.map(|error| {
        let words = format!(
            "{:.2e} m, {:.2} % of the path",
            error.error / 1e3,
            100.0 * error.relative()
        );
        row("sum of the local errors of the steps", words)
    }));
    rows
}

/// The method of a simulation in words.
fn method(task: &Simulation) -> String {
    let name = task.solving.integrator.name();
    match task.tolerance {
        Some(tolerance) => format!(
            "{name}, steps by a tolerance of {tolerance:e} (unequal steps keep momentum maps, not the energy over long times)"
        ),
        None => name,
    }
}

/// Voltages in V that the solution or table says to hold from the end of the motion on, which it reached.
pub(super) fn held(task: &Simulation, reached: f64) -> Option<&[f64]> {
    match &task.voltages {
        Voltages::Sampled {
            ends,
            rows,
            afterwards: Afterwards::Held,
            ..
        } if reached >= ends[ends.len() - 1] * (1.0 - 1e-9) => rows.last().map(Vec::as_slice),
        _ => None,
    }
}
