//! Curves over time of a motion, which look the same in figures and charts: inputs, joint coordinates, deviations, charges and energies.

use crate::dynamics::trajectory::{Column, Trajectory};
use crate::model::system::InputKind;
use crate::report::Run;
use crate::report::axes::Extent;
use crate::report::lines::{LinePlot, Series, over_time};
use crate::report::style;
use crate::report::table::{TableColumn, csv};
use crate::workflow::Tracked;

/// Steps over time in s: each value, of an interval and its inputs, from the start of the interval to the end.
pub(super) fn steps(
    trajectory: &Trajectory,
    value: impl Fn(usize, &[f64]) -> f64,
) -> Vec<[f64; 2]> {
    let intervals = trajectory.times.windows(2).zip(&trajectory.voltages);
    let steps = intervals.enumerate().flat_map(|(k, (ends, row))| {
        let value = value(k, row);
        [ends[0], ends[1]].map(|time| [time / 1e3, value])
    });
    steps.collect()
}

/// The curves of all sources of a kind, each with its number: of voltages agonists solid, antagonists dashed.
pub(super) fn inputs(run: &Run<'_>, kind: InputKind) -> Vec<(usize, Series)> {
    let (system, (_, unit)) = (run.system, kind.counted());
    let sources = system.sources().into_iter().enumerate();
    // A muscle whose charge is given takes no voltage.
    let curve = sources.filter(|(i, source)| source.kind == kind && !system.is_charged(*i));
    let curve = curve.map(|(i, source)| {
        let (colour, dash) = style::muscle(i);
        let steps = steps(run.trajectory, |_, row| row[i] / unit);
        (i, Series::curve(&source.name, steps, colour).dashed(dash))
    });
    curve.collect()
}

/// Label of the axis of a kind.
pub(super) fn input_label(kind: InputKind) -> String {
    format!("{} [{}]", kind.name(), kind.counted().0)
}

/// Name of the figure of a kind, and title of its chart.
pub fn input_names(kind: InputKind) -> (&'static str, &'static str) {
    match kind {
        InputKind::Voltage => ("voltages.svg", "Voltages"),
        InputKind::Force => ("forces.svg", "Forces"),
        InputKind::Torque => ("torques.svg", "Torques"),
        InputKind::Traction => ("tractions.svg", "Tractions and pressures"),
        InputKind::BodyForce => ("body_forces.svg", "Body forces"),
        InputKind::SurfaceCharge => ("surface_charges.svg", "Surface charges"),
        InputKind::Charge => ("charges.svg", "Charges"),
    }
}

/// `voltages.svg`, `forces.svg`, `body_forces.svg` …: the inputs of a kind over time in s, where there are any.
pub fn input_svg(run: &Run<'_>, kind: InputKind) -> Option<String> {
    let curves = inputs(run, kind).into_iter();
    let mut plot = plot(input_label(kind), curves.map(|(_, curve)| curve).collect())?;
    if kind == InputKind::Voltage {
        plot.y.extent = Extent::FromZero;
    }
    Some(plot.svg(run.origin))
}

/// A plot over time in s; none without curves.
pub(super) fn plot(label: impl Into<String>, curves: Vec<Series>) -> Option<LinePlot> {
    (!curves.is_empty()).then(|| LinePlot::over_time(label, curves))
}

/// Curves of two units.
pub(super) struct OfUnits {
    /// The curves with their units.
    curves: Vec<(&'static str, Series)>,
    /// The units with the labels of their axes.
    labels: [(&'static str, &'static str); 2],
    /// Label of an axis of both.
    of_both: &'static str,
}

impl OfUnits {
    /// Curves by their units, each with the label of its axis.
    pub(super) fn panels(self) -> Vec<(&'static str, Vec<Series>)> {
        let of = |unit| self.curves.iter().filter(move |(other, _)| *other == unit);
        let panel = |(unit, label)| (label, of(unit).map(|(_, curve)| curve.clone()).collect());
        self.labels.map(panel).to_vec()
    }

    /// All curves over one axis.
    pub(super) fn plot(self) -> Option<LinePlot> {
        let has = |unit| self.curves.iter().any(|(other, _)| *other == unit);
        let [(first, of_first), (second, of_second)] = self.labels;
        let label = match (has(first), has(second)) {
            (_, false) => of_first,
            (false, true) => of_second,
            (true, true) => self.of_both,
        };
        let curves = self.curves.into_iter().map(|(_, curve)| curve);
        plot(label, curves.collect())
    }
}

/// Factor from rad or mm to degrees or mm.
fn shown(unit: &str) -> f64 {
    match unit {
        "rad" => 1_f64.to_degrees(),
        _ => 1.0,
    }
}

/// Joint coordinates over time in s: angles in degrees and displacements in mm.
pub(super) fn joints(run: &Run<'_>) -> OfUnits {
    let Run {
        system, trajectory, ..
    } = *run;
    let coordinates = trajectory.coordinates(system).into_iter().enumerate();
    let curve = coordinates.map(|(i, coordinate)| {
        let unit = coordinate.unit;
        let values = trajectory.joints.iter().map(|u| shown(unit) * u[i]);
        let points = over_time(&trajectory.times, values);
        (unit, Series::curve(coordinate.name, points, style::hue(i)))
    });
    OfUnits {
        curves: curve.collect(),
        labels: [
            ("rad", "joint angle [°]"),
            ("mm", "joint displacement [mm]"),
        ],
        of_both: "joint coordinate [°, mm]",
    }
}

/// Deviations of markers and joints from their references over time in s: distances in mm and angles in degrees.
pub(super) fn deviations(run: &Run<'_>) -> OfUnits {
    let curves = run.tracked.iter().enumerate().map(|(i, one)| {
        let values = one.deviation.iter().map(|e| shown(one.unit) * e);
        let points = over_time(&run.trajectory.times, values);
        (one.unit, Series::curve(&one.name, points, style::hue(i)))
    });
    OfUnits {
        curves: curves.collect(),
        labels: [("m", "deviation [mm]"), ("rad", "deviation [°]")],
        of_both: "deviation [°, mm]",
    }
}

/// `tracking.csv`: one row per instant with each coordinate, its reference, and the deviation; none where nothing is followed.
pub(super) fn tracking_csv(run: &Run<'_>) -> Option<String> {
    let (times, tracked) = (&run.trajectory.times, run.tracked);
    let mut columns = vec![TableColumn::new("time [ms]", times)];
    for one in tracked {
        let unit = match one.unit {
            "m" => "mm",
            unit => unit,
        };
        let mut add = |name: String, values| {
            columns.push(TableColumn::new(format!("{name} [{unit}]"), values));
        };
        for path in &one.paths {
            add(path.name.clone(), &path.value);
            add(format!("{}_reference", path.name), &path.reference);
        }
        add(format!("{}_deviation", one.name), &one.deviation);
    }
    (!tracked.is_empty()).then(|| csv(&run.origin.line(), &columns))
}

/// The path that a marker follows in a plane, where it follows one in both directions.
pub(super) fn reference(
    tracked: &[Tracked],
    marker: &str,
    plane: [usize; 2],
) -> Option<Vec<[f64; 2]>> {
    let of = |one: &&Tracked| one.kind == "marker" && one.name == marker;
    let one = tracked.iter().find(of)?;
    let along = |axis: usize| one.paths.iter().find(|path| path.axis == Some(axis));
    let [a, b] = plane.map(along);
    let points = a?.reference.iter().zip(&b?.reference);
    Some(points.map(|(&a, &b)| [a, b]).collect())
}

/// Curves by the names of their sources in columns with an ending; each has the name and the look of the voltage of its source. What no voltage
/// drives, such as a grounded electrode, has a look of its own.
pub(super) fn of_sources(run: &Run<'_>, end: &str) -> Vec<Series> {
    let sources = run.system.sources();
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
    let columns = run.observations.columns.iter();
    let columns = columns.filter(|column| column.name != "mechanical_work");
    let named = columns
        .filter_map(|column| Some(look(column.name.strip_suffix(end)?, points(run, column))));
    named.collect()
}

/// The observed charges of electrodes and muscles over time in s, in the unit that suits the largest, and the label of their axis.
pub(super) fn charges(run: &Run<'_>) -> (&'static str, Vec<Series>) {
    let mut charges = of_sources(run, "_charge");
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

/// The observed columns that are energies of the system, over time in s; in N mm, which is mJ.
pub(super) fn energies(run: &Run<'_>) -> Vec<Series> {
    let name = |column: &Column| is_energy(&column.name).then(|| column.name.replace('_', " "));
    named(run, &name)
}

/// The observed columns that have a name, each in a colour of its own.
pub(super) fn named(run: &Run<'_>, name: &dyn Fn(&Column) -> Option<String>) -> Vec<Series> {
    let columns = run.observations.columns.iter();
    let named = columns.filter_map(|column| Some((name(column)?, points(run, column))));
    let named = named.enumerate();
    let curve = named.map(|(i, (name, points))| Series::curve(name, points, style::hue(i)));
    curve.collect()
}

/// An observed column over time in s.
fn points(run: &Run<'_>, column: &Column) -> Vec<[f64; 2]> {
    over_time(&run.trajectory.times, column.values.iter().copied())
}

/// Returns true if a column is an energy of the system, not of one of many sources.
fn is_energy(name: &str) -> bool {
    let is_of_one = ["_electrical_energy", "_mechanical_work"].map(|end| name.ends_with(end));
    (name.contains("energy") && is_of_one == [false; 2]) || name == "mechanical_work"
}
