//! Curves of muscles and electrodes, which look the same in all charts.

use crate::model::system::System;
use crate::report::lines::Series;
use crate::report::style;

/// Curves by the names of their sources in columns; each has the name and the look of the voltage of its source. What no voltage
/// drives, such as a grounded electrode, has a look of its own.
pub(super) fn curves<'a>(
    system: &System,
    columns: impl Iterator<Item = (&'a str, Vec<[f64; 2]>)>,
) -> Vec<Series> {
    let sources = system.sources();
    let mut others = sources.len().div_ceil(2)..;
    let mut look = |name: &str, points| {
        let is = |source: &str| source.replace('.', "_") == name.replace('.', "_");
        match sources.iter().position(|source| is(&source.name)) {
            Some(i) => {
                let (colour, dash) = style::muscle(i);
                Series::curve(&sources[i].name, points, colour).dashed(dash)
            }
            None => {
                let hue = style::hue(others.next().unwrap_or(0));
                Series::curve(name.replace('_', " "), points, hue)
            }
        }
    };
    columns.map(|(name, points)| look(name, points)).collect()
}
