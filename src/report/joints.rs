//! Joint coordinates, charges and energies over time.

use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::model::system::System;
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::{sources, style};

/// Joint coordinates as curves over time in s: angles in degrees, displacements in mm.
pub fn curves(system: &System, trajectory: &Trajectory) -> Vec<Series> {
    let coordinates = trajectory.coordinates(system).into_iter().enumerate();
    coordinates
        .map(|(i, coordinate)| {
            let factor = if coordinate.unit == "rad" {
                1_f64.to_degrees()
            } else {
                1.0
            };
            let instants = trajectory.times.iter().zip(&trajectory.joints);
            let points = instants.map(|(t, u)| [t / 1e3, factor * u[i]]).collect();
            Series::curve(coordinate.name, points, style::hue(i))
        })
        .collect()
}

/// The same by their units, each with the label of its axis.
pub(super) fn by_unit(
    system: &System,
    trajectory: &Trajectory,
) -> Vec<(&'static str, Vec<Series>)> {
    let coordinates = trajectory.coordinates(system);
    let curves = curves(system, trajectory);
    let labels = [
        ("rad", "joint angle [°]"),
        ("mm", "joint displacement [mm]"),
    ];
    let each = labels.map(|(unit, label)| {
        let of = coordinates.iter().zip(&curves);
        let of = of.filter(|(coordinate, _)| coordinate.unit == unit);
        (label, of.map(|(_, curve)| curve.clone()).collect())
    });
    each.to_vec()
}

/// Label of the vertical axis of [`curves`].
pub fn label(system: &System, trajectory: &Trajectory) -> &'static str {
    let coordinates = trajectory.coordinates(system);
    let has = |unit| coordinates.iter().any(|c| c.unit == unit);
    match (has("rad"), has("mm")) {
        (_, false) => "joint angle [°]",
        (false, true) => "joint displacement [mm]",
        (true, true) => "joint coordinate [°, mm]",
    }
}

/// `joint_angles.svg`: joint coordinates over time in s.
pub fn svg(system: &System, trajectory: &Trajectory, origin: &Origin) -> String {
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear(label(system, trajectory), Extent::Padded),
        curves(system, trajectory),
    )
    .svg(origin)
}

/// The observed charges of electrodes and muscles over time in s, in mC.
pub fn charges(
    system: &System,
    trajectory: &Trajectory,
    observations: &Observations,
) -> Vec<Series> {
    let columns = observations.columns.iter();
    let named = columns.filter_map(|column| {
        let name = column.name.strip_suffix("_charge")?;
        let instants = trajectory.times.iter().zip(&column.values);
        Some((name, instants.map(|(t, q)| [t / 1e3, *q]).collect()))
    });
    sources::curves(system, named)
}

/// The charges in the unit that suits the largest, and the label of their axis.
pub(super) fn scaled_charges(mut charges: Vec<Series>) -> (&'static str, Vec<Series>) {
    let values = charges.iter().flat_map(|series| &series.points);
    let largest = values.map(|p| p[1].abs()).filter(|q| q.is_finite());
    let (label, factor) = match largest.fold(0.0, f64::max) {
        q if q >= 1.0 => ("charge [mC]", 1.0),
        q if q >= 1e-3 => ("charge [µC]", 1e3),
        q if q >= 1e-6 => ("charge [nC]", 1e6),
        _ => ("charge [pC]", 1e9),
    };
    let points = charges.iter_mut().flat_map(|series| &mut series.points);
    points.for_each(|p| p[1] *= factor);
    (label, charges)
}

/// `charge.svg`: the charges over time in s.
pub fn charge_svg(charges: Vec<Series>, origin: &Origin) -> String {
    let (label, charges) = scaled_charges(charges);
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear(label, Extent::Padded),
        charges,
    )
    .svg(origin)
}

/// The observed columns that are energies of the system, over time in s; in N mm, which is mJ.
pub fn energies(trajectory: &Trajectory, observations: &Observations) -> Vec<Series> {
    let columns = observations.columns.iter();
    columns
        .filter(|column| is_energy(&column.name))
        .enumerate()
        .map(|(i, column)| {
            let instants = trajectory.times.iter().zip(&column.values);
            let points = instants.map(|(t, e)| [t / 1e3, *e]).collect();
            Series::curve(column.name.replace('_', " "), points, style::hue(i))
        })
        .collect()
}

/// Returns true if a column is an energy of the system, not of one of many sources.
pub(super) fn is_energy(name: &str) -> bool {
    let is_of_one = ["_electrical_energy", "_mechanical_work"].map(|end| name.ends_with(end));
    (name.contains("energy") && is_of_one == [false; 2]) || name == "mechanical_work"
}

/// `energy.svg`: the energies over time in s.
pub fn energy_svg(energies: Vec<Series>, origin: &Origin) -> String {
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear("energy [mJ]", Extent::Padded),
        energies,
    )
    .svg(origin)
}
