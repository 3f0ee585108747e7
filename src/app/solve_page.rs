//! Texts of the page of a control problem: rows of its table, the convergence of the solver, the goal.

use crate::app::blocks::EnergySummary;
use crate::app::sensitivity_summary::SensitivitySummary;
use crate::app::summary::{Program, Summary};
use crate::control::BoundaryConditions;
use crate::control::problem::{BoundaryState, Control, CostFunction, During, Place, instant_at};
use crate::dynamics::trajectory::Trajectory;
use crate::ipopt::Iteration;
use crate::kinematics::Pose;
use crate::math::significant;
use crate::model::{Model, What};
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::style;
use crate::tasks::solve_messages;
use crate::workflow::optimum::Violation;
use crate::workflow::tracking::Tracked;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Rows of the table of the page.
pub(super) fn rows(summary: &Summary) -> Vec<(String, String)> {
    let mut rows = vec![("status".to_owned(), summary.status.clone())];
    let mut row = |key: &str, value: String| rows.push((key.to_owned(), value));
    if let Some(program) = &summary.program {
        row("objective", objective(program));
        row("iterations", program.iterations.to_string());
        row("duration", format!("{:.6} s", program.duration));
        row("intervals", program.intervals.to_string());
        for parameter in &program.parameters {
            row(&parameter.name, parameter.text());
        }
        row(
            "coordinates",
            summary.coordinates.unwrap_or_default().to_owned(),
        );
        row("variables", program.variables.to_string());
        row("constraints", program.constraints.to_string());
        row("computing time", format!("{:.3} s", summary.seconds.total));
        for (key, value) in summary.energies.iter().flat_map(EnergySummary::rows) {
            row(&key, value);
        }
        for (name, error) in summary.accuracy.iter().flat_map(|a| &a.estimate) {
            row(&format!("estimated error, {name}"), format!("{error:.1e}"));
        }
        if let Some(r) = &program.resimulation {
            let of = |d: &crate::workflow::motion::Distance| {
                format!("{:.1e} rad, {:.1e} m", d.angle, d.length)
            };
            row("deviation when simulated forward", of(&r.deviation));
            if let (Some(drift), Some(held)) = (&r.drift, r.held) {
                row(&format!("drift when held for {held} s"), of(drift));
            }
        }
        for (key, value) in summary.tracking.iter().map(tracking_row) {
            row(&key, value);
        }
        for (key, value) in summary.sensitivities.iter().map(SensitivitySummary::row) {
            row(&key, value);
        }
        for violation in &program.violations {
            row("violated", describe(violation));
        }
    }
    rows
}

/// The objective with its unit, or those of its terms where they differ.
fn objective(program: &Program) -> String {
    let value = program.objective;
    match program.objective_units.as_slice() {
        [] => format!("{value:.9}"),
        [unit] => format!("{value:.9} {unit}").trim_end().to_owned(),
        [units @ .., last] => format!(
            "{value:.9} (weighted sum of terms in {} and {last})",
            units.join(", ")
        ),
    }
}

/// A violated row in words.
pub(super) fn describe(violation: &Violation) -> String {
    match (violation.violation, violation.scaled) {
        (Some(distance), Some(scaled)) => {
            let unit = match violation.unit {
                "" => String::new(),
                unit => format!(" {unit}"),
            };
            format!(
                "{}: violated by {}{unit} (scaled violation {scaled:.1e})",
                violation.row,
                significant(distance, 4)
            )
        }
        _ => format!("{}: has no value there", violation.row),
    }
}

/// Title and plot of the iterations of the solver.
pub(super) fn convergence(iterations: &[Iteration]) -> (String, LinePlot) {
    let curve = |i: usize, name: &str, value: &dyn Fn(&Iteration) -> f64| {
        let points = iterations.iter().enumerate();
        let points = points.map(|(k, iteration)| [k as f64, value(iteration)]);
        Series::curve(name, points.collect(), style::hue(i))
    };
    let series = vec![
        curve(0, "violation of equations and limits", &|one| {
            one.primal_infeasibility
        }),
        curve(1, "gradient of the Lagrangian", &|one| {
            one.dual_infeasibility
        }),
        curve(2, "barrier parameter", &|one| one.mu),
        curve(3, "greatest step", &|one| one.step_norm),
    ];
    let plot = LinePlot::new(
        Axis::linear("iteration", Extent::Tight),
        Axis::log("scaled value"),
        series,
    );
    ("Convergence".to_owned(), plot)
}

/// Places in mm where markers were to end, by goal or objective, with their indices; as they ended in directions that are free.
pub(super) fn targets(control: &Control, motion: &Trajectory) -> Vec<(usize, Vector3<f64>)> {
    let mut places = match &control.goal {
        BoundaryState::Markers { places, .. } => places.clone(),
        _ => BTreeMap::new(),
    };
    let last = motion.times.len() - 1;
    for cost in &control.objective.quantities {
        let CostFunction::Square { reference } = &cost.function else {
            continue;
        };
        if let (&What::Place { marker, axis }, During::End) = (&cost.quantity.what, cost.during) {
            let place = &mut places.entry(marker).or_default().0[axis];
            place.get_or_insert_with(|| reference.at(motion.times[last]));
        }
    }
    let whole = |(marker, place): (usize, Place)| {
        let mut at = motion.marks[last][marker];
        place.given().for_each(|(axis, value)| at[axis] = value);
        (marker, at)
    };
    places.into_iter().map(whole).collect()
}

/// Places in mm that markers are to pass, exactly or near, with their indices; as they pass in directions that are free.
pub(super) fn waypoints(control: &Control, motion: &Trajectory) -> Vec<(usize, Vector3<f64>)> {
    let mut places: BTreeMap<(usize, usize), Place> = BTreeMap::new();
    let instant = |part: f64| instant_at(part, motion.intervals());
    for waypoint in &control.waypoints {
        let all = waypoint.places.iter();
        places.extend(all.map(|(&marker, place)| ((instant(waypoint.part), marker), *place)));
    }
    for cost in &control.objective.quantities {
        let CostFunction::Square { reference } = &cost.function else {
            continue;
        };
        if let (&What::Place { marker, axis }, During::At(part)) =
            (&cost.quantity.what, cost.during)
        {
            let k = instant(part);
            let place = &mut places.entry((k, marker)).or_default().0[axis];
            place.get_or_insert_with(|| reference.at(motion.times[k]));
        }
    }
    let whole = |((k, marker), place): ((usize, usize), Place)| {
        let mut at = motion.marks[k][marker];
        place.given().for_each(|(axis, value)| at[axis] = value);
        (marker, at)
    };
    places.into_iter().map(whole).collect()
}

/// Poses of the bodies at the end that is asked for, where it is given as a whole.
pub(super) fn goal(model: &Model, boundary: &BoundaryConditions) -> Option<Vec<Pose>> {
    let goal = &boundary.goal;
    let z = match &goal.rest {
        Some(rest) => rest.z.clone(),
        None => goal
            .coordinates
            .iter()
            .copied()
            .collect::<Option<Vec<f64>>>()?,
    };
    let mut instant = model.action.map.instant();
    (z.len() == instant.z.len()).then(|| {
        instant.z.copy_from_slice(&z);
        model.action.map.place(&mut instant);
        model.poses(&instant)
    })
}

/// A row of a table: what follows, and its deviations.
fn tracking_row(of: &Tracked) -> (String, String) {
    let Tracked { kind, name, .. } = of;
    let key = format!("deviation of {kind} {name} from its path");
    (key, solve_messages::deviation_words(of))
}
