//! A control problem in `summary.json`, on its page and in the answer of its command: program, notes, times, rows, convergence, goal.
//!
//! Sensitivities of an optimum in `summary.json`, and what is to be known of them, in units of the International System.

use crate::app::linear_systems::{evaluations, linear_systems, microseconds};
use crate::app::request::{CommandOutput, counted};
use crate::app::summary::{STOPPED, Seconds, Summary};
use crate::control::problem::{BoundaryState, Control, CostFunction, During, Place, instant_at};
use crate::control::{BoundaryConditions, Solution};
use crate::dynamics::trajectory::Trajectory;
use crate::files::Entries;
use crate::ipopt::Iteration;
use crate::kinematics::Pose;
use crate::math::significant;
use crate::model::{FoundParameter, Model, System, What};
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::style;
use crate::sensitivity::Sensitivity;
use crate::tasks::{SolveResult, Verdict, solve_messages};
use crate::workflow::motion::Distance;
use crate::workflow::optimum::{Optimum, Violation};
use crate::workflow::tracking::Tracked;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// The program of an optimum in numbers.
pub(super) fn program(system: &System, control: &Control, result: &SolveResult) -> Entries {
    let optimum = &result.optimum;
    let Optimum {
        solution,
        motion,
        program: size,
        ..
    } = optimum;
    let intervals = motion.intervals();
    let infeasibility = Some(optimum.infeasibility).filter(|value| value.is_finite());
    Entries::default()
        .with("objective", solution.objective)
        .with("objective_units", control.objective_units(system))
        .with("iterations", result.iterations)
        .with("intervals", intervals)
        .with("duration", motion.times[intervals] / 1e3)
        .with("variables", solution.x.len())
        .with("constraints", size.constraints)
        .with("jacobian_nonzeros", size.jacobian_nonzeros)
        .with("hessian_nonzeros", size.hessian_nonzeros)
        .with("linear_solver", linear_systems(&solution.linear))
        .with("evaluations", evaluations(solution))
        .with("interval_microseconds", microseconds(solution, intervals))
        // The greatest scaled violation of an equation or limit; absent where one has no value.
        .with_some("infeasibility", infeasibility)
        // The worst rows that do not hold; none of a solution.
        .with("violations", &optimum.violated)
        .with_some("resimulation", optimum.resimulation.as_ref())
        .with_any("parameters", motion.parameters.iter().map(parameter))
        .with_some("gap", gap(size.gap, &result.verdict))
        // Motion after a goal that no known voltages hold.
        .with_some("afterwards", optimum.afterwards.as_ref())
        // A periodic motion under the same inputs again.
        .with_some("repeated", optimum.repeated.as_ref())
}

/// Bound of the objective above its least value; absent without a solution.
pub(super) fn gap(gap: f64, verdict: &Verdict) -> Option<f64> {
    (verdict.is_solved && gap.is_finite()).then_some(gap)
}

/// A constant that was sought, in its unit of the International System.
pub(super) fn parameter(found: &FoundParameter) -> Entries {
    Entries::default()
        .with("name", &found.name)
        .with("value", found.value * found.unit.factor)
        .with("unit", found.unit.symbol)
        .with("at_bound", found.is_at_bound)
}

/// The same in words.
fn parameter_text(found: &FoundParameter) -> String {
    let value = significant(found.value * found.unit.factor, 8);
    let value = format!("{value} {}", found.unit.symbol);
    match found.is_at_bound {
        true => format!("{}, at its bound", value.trim_end()),
        false => value.trim_end().to_owned(),
    }
}

/// A note on a constant that was sought.
pub(super) fn parameter_note(found: &FoundParameter) -> String {
    format!("{}: {}", found.name, parameter_text(found))
}

/// Times of a solve whose files were read in `read` seconds.
pub(super) fn seconds(optimum: &Optimum, read: f64, began: Instant) -> Seconds {
    let seconds = &optimum.solution.seconds;
    Seconds {
        solver: seconds.solver,
        objective: seconds.objective,
        gradient: seconds.gradient,
        constraints: seconds.constraints,
        jacobian: seconds.jacobian,
        hessian: seconds.hessian,
        ..Seconds::since(began, read + optimum.setup)
    }
}

/// The outcome of a solve with its status, where that says more.
pub(super) fn outcome_word(is_solved: bool, status: &str) -> String {
    let solved = if is_solved { "solved" } else { "not solved" };
    match status {
        "solved" => solved.to_owned(),
        word => format!("{solved} ({})", word.replace('_', " ")),
    }
}

/// The answer of the command.
pub(super) fn command_output(
    summary: &Summary,
    control: &Control,
    result: &SolveResult,
    folder: &Path,
) -> CommandOutput {
    let optimum = &result.optimum;
    let mut is_solved = summary.message.is_none();
    let mut word = outcome_word(is_solved, &summary.status);
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    notes.extend(optimum.violated.iter().map(describe));
    notes.extend(summary.notes.lines());
    notes.extend(optimum.motion.parameters.iter().map(parameter_note));
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    // An optimum of which not all is written.
    is_solved &= !STOPPED.contains(&&*summary.status);
    let intervals = optimum.motion.intervals();
    let grid = match control.is_refined || summary.accuracy.is_some() {
        true => format!(", {}", counted(intervals, "interval")),
        false => String::new(),
    };
    let objective = significant(optimum.solution.objective, 8);
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective}{grid}, {}, {:.2} s, {}",
            counted(result.iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}

/// Rows of the table of the page.
pub(super) fn rows(
    summary: &Summary,
    system: &System,
    control: &Control,
    result: &SolveResult,
) -> Vec<(String, String)> {
    let optimum = &result.optimum;
    let (motion, intervals) = (&optimum.motion, optimum.motion.intervals());
    let objective = objective(optimum.solution.objective, &control.objective_units(system));
    let mut rows = Vec::new();
    let mut row = |key: &str, value: String| rows.push((key.to_owned(), value));
    row("objective", objective);
    row("iterations", result.iterations.to_string());
    row(
        "duration",
        format!("{:.6} s", motion.times[intervals] / 1e3),
    );
    row("intervals", intervals.to_string());
    for found in &motion.parameters {
        row(&found.name, parameter_text(found));
    }
    row("coordinates", optimum.model.coordinates.name().to_owned());
    row("variables", optimum.solution.x.len().to_string());
    row("constraints", optimum.program.constraints.to_string());
    rows.extend(summary.rows());
    if let Some(r) = &optimum.resimulation {
        let of = |d: &Distance| format!("{:.1e} rad, {:.1e} m", d.angle, d.length);
        let key = "deviation when simulated forward";
        rows.push((key.to_owned(), of(&r.deviation)));
        if let (Some(drift), Some(held)) = (&r.drift, r.held) {
            rows.push((format!("drift when held for {held} s"), of(drift)));
        }
    }
    rows.extend(summary.tracking.iter().map(tracking_row));
    rows.extend(result.sensitivities.iter().map(sensitivity_row));
    let violated = optimum.violated.iter().map(describe);
    rows.extend(violated.map(|words| ("violated".to_owned(), words)));
    rows
}

/// The objective with its unit, or those of its terms where they differ.
fn objective(value: f64, units: &[String]) -> String {
    match units {
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

/// Places in mm where markers were to end, by goal or objective, or those that they are to pass before, exactly or near, with their indices; as
/// the motion has them in directions that are free.
pub(super) fn asked_places(
    control: &Control,
    motion: &Trajectory,
    are_at_end: bool,
) -> Vec<(usize, Vector3<f64>)> {
    let last = motion.intervals();
    let instant = |part: f64| instant_at(part, last);
    let given: Vec<_> = match &control.goal {
        BoundaryState::Markers { places, .. } if are_at_end => vec![(last, places)],
        _ if are_at_end => Vec::new(),
        _ => {
            let waypoints = control.waypoints.iter();
            waypoints
                .map(|one| (instant(one.part), &one.places))
                .collect()
        }
    };
    let given = given.into_iter().flat_map(|(k, places)| {
        let each = places.iter();
        each.map(move |(&marker, place)| ((k, marker), *place))
    });
    let mut places: BTreeMap<(usize, usize), Place> = given.collect();
    for cost in &control.objective.quantities {
        let k = match cost.during {
            During::End if are_at_end => last,
            During::At(part) if !are_at_end => instant(part),
            _ => continue,
        };
        if let (&What::Place { marker, axis }, CostFunction::Square { reference }) =
            (&cost.quantity.what, &cost.function)
        {
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
    let instant = model.action.map.placed(&z);
    (z.len() == instant.z.len()).then(|| model.poses(&instant))
}

/// A row of a table: what follows, and its deviations.
fn tracking_row(of: &Tracked) -> (String, String) {
    let Tracked { kind, name, .. } = of;
    let key = format!("deviation of {kind} {name} from its path");
    (key, solve_messages::deviation_words(of))
}

/// Tolerance of the number.
fn tolerance(of: &Sensitivity) -> Option<f64> {
    of.varied.tolerance.map(|size| size * of.varied.unit.factor)
}

/// Derivative of the objective.
fn objective_slope(of: &Sensitivity) -> f64 {
    of.objective / of.varied.unit.factor
}

/// Change of the objective with the tolerance, to first order.
fn objective_change(of: &Sensitivity) -> Option<f64> {
    tolerance(of).map(|size| (objective_slope(of) * size).abs())
}

/// Values of the number between which the same bounds are reached, to first order, where there is an end.
fn ends(of: &Sensitivity) -> [Option<f64>; 2] {
    let end = |change: f64| (of.varied.value + change) * of.varied.unit.factor;
    [&of.range.down, &of.range.up].map(|one| Some(end(one.change)).filter(|end| end.is_finite()))
}

/// Derivatives of an optimum by one number of its problem.
pub(super) fn sensitivity_entries(system: &System, motion: &Solution, of: &Sensitivity) -> Entries {
    let Sensitivity { varied, range, .. } = of;
    let si = varied.unit.factor;
    let parameters = motion.parameters.iter().zip(&of.parameters);
    let parameters = parameters.map(|(found, by)| {
        Entries::default()
            .with("name", &found.name)
            .with("unit", found.unit.symbol)
            .with("derivative", by * found.unit.factor / si)
    });
    let duration = Some(of.duration / 1e3 / si).filter(|duration| *duration != 0.0);
    let [from, to] = ends(of);
    let valid = Entries::default()
        .with_some("from", from)
        .with_some("to", to)
        .with_some("bound_below", range.down.bound.as_ref())
        .with_some("bound_above", range.up.bound.as_ref());
    Entries::default()
        // Path of the number in the scene or in the problem.
        .with("name", &varied.name)
        .with("unit", varied.unit.symbol)
        .with("value", varied.value * si)
        .with_some("tolerance", tolerance(of))
        .with("objective", objective_slope(of))
        .with_some("objective_change", objective_change(of))
        // Absent where it is given.
        .with_some("duration", duration)
        // Constants that were sought.
        .with_any("parameters", parameters)
        .with("inputs", inputs(system, motion, of))
        .with("valid", valid)
        // Bounds that are reached or left at once: the derivatives hold to one side alone.
        .with_any("one_sided", &of.weak)
}

/// The greatest derivative over time of each voltage or load that has one, and the middle of its interval.
fn inputs(system: &System, motion: &Solution, of: &Sensitivity) -> Vec<Entries> {
    let sources = system.sources().into_iter().enumerate();
    let input = sources.filter_map(|(source, named)| {
        let by = of.voltages.iter().map(|row| row[source]).enumerate();
        let (k, greatest) = by.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (unit, size) = named.kind.si();
        let derivative = greatest / size / of.varied.unit.factor;
        let change = tolerance(of).map(|tolerance| (derivative * tolerance).abs());
        (derivative != 0.0).then(|| {
            Entries::default()
                .with("name", &named.name)
                .with("unit", unit)
                .with("derivative", derivative)
                .with("time", 0.5e-3 * (motion.times[k] + motion.times[k + 1]))
                // Greatest change with the tolerance, to first order.
                .with_some("change", change)
        })
    });
    input.collect()
}

/// In words, for the table of the page.
fn sensitivity_row(of: &Sensitivity) -> (String, String) {
    let by = match of.varied.unit.symbol {
        "" => String::new(),
        unit => format!(" per {unit}"),
    };
    let change = objective_change(of).map_or_else(String::new, |change| {
        format!("; ± {} with its tolerance", significant(change, 3))
    });
    let value = significant(objective_slope(of), 5);
    let key = format!("sensitivity to {}", of.varied.name);
    (key, format!("objective {value}{by}{change}"))
}

/// Warning of a tolerance that reaches beyond what first derivatives tell.
pub(super) fn tolerance_warning(of: &Sensitivity) -> Option<String> {
    let (varied, range) = (&of.varied, &of.range);
    let (value, tolerance) = (varied.value * varied.unit.factor, tolerance(of)?);
    let [from, to] = ends(of);
    let (end, bound) = if value - tolerance < from.unwrap_or(f64::NEG_INFINITY) {
        (from, &range.down.bound)
    } else if value + tolerance > to.unwrap_or(f64::INFINITY) {
        (to, &range.up.bound)
    } else {
        return None;
    };
    Some(format!(
        "the tolerance of {} reaches beyond {} {}, where {}, to first order: derivatives are others behind",
        varied.name,
        significant(end?, 5),
        varied.unit.symbol,
        bound.as_deref()?
    ))
}
