//! Voltages and loads over time: one step function per source, of voltages agonists solid, antagonists dashed.

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::{InputKind, System};
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style;

/// Steps (time in s; kV, N or N m) of one source: each value from the start of its interval to the end.
fn steps(trajectory: &Trajectory, source: usize, kind: InputKind) -> Vec<[f64; 2]> {
    let (_, unit) = kind.counted();
    let ends = trajectory.times.windows(2);
    ends.zip(&trajectory.voltages)
        .flat_map(|(ends, row)| [[ends[0], row[source]], [ends[1], row[source]]])
        .map(|[time, value]| [time / 1e3, value / unit])
        .collect()
}

/// The curves of all sources of a kind, each with its number.
pub fn curves(system: &System, trajectory: &Trajectory, kind: InputKind) -> Vec<(usize, Series)> {
    let sources = system.sources().into_iter().enumerate();
    // A muscle whose charge is given takes no voltage.
    let curve = sources.filter(|(i, source)| source.kind == kind && !system.is_charged(*i));
    let curve = curve.map(|(i, source)| {
        let (colour, dash) = style::muscle(i);
        let steps = steps(trajectory, i, kind);
        (i, Series::curve(&source.name, steps, colour).dashed(dash))
    });
    curve.collect()
}

/// Label of the axis of a kind.
pub fn label(kind: InputKind) -> String {
    format!("{} [{}]", kind.name(), kind.counted().0)
}

/// `voltages.svg`, `forces.svg`, `body_forces.svg` …: the inputs of a kind over time in s, where there are any.
pub fn svg(
    system: &System,
    trajectory: &Trajectory,
    kind: InputKind,
    origin: &Origin,
) -> Option<(&'static str, String)> {
    let curves = curves(system, trajectory, kind);
    let (name, extent) = match kind {
        InputKind::Voltage => ("voltages.svg", Extent::FromZero),
        InputKind::Force => ("forces.svg", Extent::Padded),
        InputKind::Torque => ("torques.svg", Extent::Padded),
        InputKind::Traction => ("tractions.svg", Extent::Padded),
        InputKind::BodyForce => ("body_forces.svg", Extent::Padded),
        InputKind::SurfaceCharge => ("surface_charges.svg", Extent::Padded),
        InputKind::Charge => ("charges.svg", Extent::Padded),
    };
    let plot = LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear(label(kind), extent),
        curves.into_iter().map(|(_, curve)| curve).collect(),
    );
    (!plot.series.is_empty()).then(|| (name, plot.svg(origin)))
}
