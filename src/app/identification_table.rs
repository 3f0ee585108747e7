//! `residuals.csv`: readings of an identification beside their predictions.

use crate::control::problem::Identification;
use crate::identify::Identified;

/// All readings with their predictions as rows of cells, in SI units.
pub(super) fn table(task: &Identification, found: &Identified) -> Vec<Vec<String>> {
    let header = [
        "recording",
        "quantity",
        "unit",
        "time [s]",
        "measured",
        "predicted",
        "residual",
        "standard deviation",
        "held out",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let held_out = found.held_out.iter().flat_map(|one| &one.series);
    for one in found.series.iter().chain(held_out) {
        let recording = &task.recordings[one.recording];
        let channel = &recording.channels[one.channel];
        let (symbol, factor) = channel.unit;
        for k in 0..one.times.len() {
            let (measured, predicted) = (one.measured[k], one.predicted[k]);
            let numbers = [measured, predicted, measured - predicted, one.deviations[k]];
            let mut row = vec![
                recording.name.clone(),
                channel.name.clone(),
                symbol.to_owned(),
                format!("{}", one.times[k] / 1e3),
            ];
            row.extend(numbers.map(|number| format!("{}", factor * number)));
            row.push(recording.is_held_out.to_string());
            rows.push(row);
        }
    }
    rows
}
