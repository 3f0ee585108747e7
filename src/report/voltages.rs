//! Voltages over time: one step function per muscle, agonists solid, antagonists dashed.

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::System;
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style;

/// Steps (time in s, voltage in kV) of one muscle: each voltage from the start of its interval to the end.
pub fn steps(trajectory: &Trajectory, muscle: usize) -> Vec<[f64; 2]> {
    let ends = trajectory.times.windows(2);
    ends.zip(&trajectory.voltages)
        .flat_map(|(ends, voltages)| [[ends[0], voltages[muscle]], [ends[1], voltages[muscle]]])
        .map(|[time, voltage]| [time / 1e3, voltage / 1e3])
        .collect()
}

/// `voltages.svg`: the voltage of each muscle in kV over time in s.
pub fn svg(system: &System, trajectory: &Trajectory, origin: &Origin) -> String {
    let series = system.muscles.iter().enumerate().map(|(i, muscle)| {
        let (colour, dash) = style::muscle(i);
        Series::curve(&muscle.name, steps(trajectory, i), colour).dashed(dash)
    });
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear("voltage [kV]", Extent::FromZero),
        series.collect(),
    )
    .svg(origin)
}
