//! Sensitivities of an optimum: table and figures.

use crate::dynamics::trajectory::Trajectory;
use crate::model::System;
use crate::report::origin::Origin;
use crate::report::table::csv;
use crate::sensitivity::Sensitivity;

/// `sensitivities.csv`: one row per instant with the derivatives of inputs, in the interval that begins there, of joint coordinates and of places of
/// markers, each by each number in its unit of the International System.
pub fn table(
    system: &System,
    trajectory: &Trajectory,
    list: &[Sensitivity],
    origin: &Origin,
) -> String {
    let mut header = vec!["time [ms]".to_owned()];
    let mut columns: Vec<Vec<f64>> = vec![trajectory.times.clone()];
    let sources = system.sources();
    let joints = trajectory.coordinates(system);
    for one in list {
        let unit = one.varied.unit;
        let mut add = |name: &str, of: &str, values: Vec<f64>| {
            let by = match unit.symbol {
                "" => of.to_owned(),
                symbol => format!("{of}/({symbol})"),
            };
            header.push(format!("d {name} / d {} [{by}]", one.varied.name));
            columns.push(values.iter().map(|value| value / unit.factor).collect());
        };
        for (source, named) in sources
            .iter()
            .enumerate()
            .filter(|(_, source)| source.acts())
        {
            let by = one.voltages.iter().map(|row| row[source]);
            add(&named.name, named.kind.unit(), by.collect());
        }
        for (j, joint) in joints.iter().enumerate().filter(|_| !one.joints.is_empty()) {
            let by = one.joints.iter().map(|row| row[j]);
            add(&joint.name, joint.unit, by.collect());
        }
        for (m, marker) in system
            .markers
            .iter()
            .enumerate()
            .filter(|_| !one.markers.is_empty())
        {
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let by = one.markers.iter().map(|row| row[m][axis]);
                add(&format!("{}_{letter}", marker.name), "mm", by.collect());
            }
        }
    }
    let cell = |column: &Vec<f64>, k: usize| column.get(k).copied().unwrap_or(f64::NAN);
    let rows =
        (0..trajectory.times.len()).map(|k| columns.iter().map(move |column| cell(column, k)));
    let line = format!(
        "{}; derivatives of an optimum, of inputs in the interval that begins at the time",
        origin.line()
    );
    csv(&line, header.into_iter(), rows)
}
