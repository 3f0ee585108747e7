//! Voltages over time: one step function per source, agonists solid, antagonists dashed.

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::System;
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style;

/// Steps (time in s, voltage in kV) of one source: each voltage from the start of its interval to the end.
pub fn steps(trajectory: &Trajectory, source: usize) -> Vec<[f64; 2]> {
    let ends = trajectory.times.windows(2);
    ends.zip(&trajectory.voltages)
        .flat_map(|(ends, voltages)| [[ends[0], voltages[source]], [ends[1], voltages[source]]])
        .map(|[time, voltage]| [time / 1e3, voltage / 1e3])
        .collect()
}

/// The curve of each source.
pub fn curves(system: &System, trajectory: &Trajectory) -> Vec<Series> {
    let sources = system.sources().into_iter().enumerate();
    let curve = sources.map(|(i, source)| {
        let (colour, dash) = style::muscle(i);
        Series::curve(&source.name, steps(trajectory, i), colour).dashed(dash)
    });
    curve.collect()
}

/// `voltages.svg`: the voltage of each source in kV over time in s.
pub fn svg(system: &System, trajectory: &Trajectory, origin: &Origin) -> String {
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear("voltage [kV]", Extent::FromZero),
        curves(system, trajectory),
    )
    .svg(origin)
}
