//! Voltages that colour muscles in pictures: those of their electrodes.
//!
//! They are those of the sources but for muscles with a charge, whose voltage is an observation at the instants.

use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::model::System;
use std::borrow::Cow;

/// The motion with the voltages of the electrodes at the end of each interval.
pub fn coloured<'t>(
    system: &System,
    trajectory: &'t Trajectory,
    observations: &Observations,
) -> Cow<'t, Trajectory> {
    let mut out = Cow::Borrowed(trajectory);
    let charged = (0..system.muscles.len()).filter(|&m| !system.has_source_voltage(m));
    for muscle in charged {
        let name = format!("{}_voltage", system.muscles[muscle].name);
        let is_own = |column: &&Column| column.name == name;
        let Some(column) = observations.columns.iter().find(is_own) else {
            continue;
        };
        let rows = out.to_mut().voltages.iter_mut();
        for (row, voltage) in rows.zip(column.values.iter().skip(1)) {
            row[muscle] = *voltage;
        }
    }
    out
}
