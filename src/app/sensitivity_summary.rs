//! Sensitivities of an optimum in `summary.json`, and what is to be known of them, in units of the International System.

use crate::control::Solution;
use crate::files::Entries;
use crate::math::significant;
use crate::model::System;
use crate::sensitivity::Sensitivity;

/// Tolerance of the number.
fn tolerance(of: &Sensitivity) -> Option<f64> {
    of.varied.tolerance.map(|size| size * of.varied.unit.factor)
}

/// Derivative of the objective.
fn objective(of: &Sensitivity) -> f64 {
    of.objective / of.varied.unit.factor
}

/// Change of the objective with the tolerance, to first order.
fn objective_change(of: &Sensitivity) -> Option<f64> {
    tolerance(of).map(|size| (objective(of) * size).abs())
}

/// Values of the number between which the same bounds are reached, to first order, where there is an end.
fn ends(of: &Sensitivity) -> [Option<f64>; 2] {
    let end = |change: f64| (of.varied.value + change) * of.varied.unit.factor;
    [&of.range.down, &of.range.up].map(|one| Some(end(one.change)).filter(|end| end.is_finite()))
}

/// Derivatives of an optimum by one number of its problem.
pub(super) fn entries(system: &System, motion: &Solution, of: &Sensitivity) -> Entries {
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
        .with("objective", objective(of))
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
pub(super) fn row(of: &Sensitivity) -> (String, String) {
    let by = match of.varied.unit.symbol {
        "" => String::new(),
        unit => format!(" per {unit}"),
    };
    let change = objective_change(of).map_or_else(String::new, |change| {
        format!("; ± {} with its tolerance", significant(change, 3))
    });
    let value = significant(objective(of), 5);
    let key = format!("sensitivity to {}", of.varied.name);
    (key, format!("objective {value}{by}{change}"))
}

/// Warning of a tolerance that reaches beyond what first derivatives tell.
pub(super) fn warning(of: &Sensitivity) -> Option<String> {
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
