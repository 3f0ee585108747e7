//! Sensitivities of an optimum in `summary.json`, and what is to be known of them.

use serde::Serialize;

use crate::control::Solution;
use crate::math::significant;
use crate::model::System;
use crate::sensitivity::Sensitivity;
use crate::tasks::SolveResult;

/// Derivatives of an optimum by one number of its problem, in units of the International System.
#[derive(Debug, Serialize)]
pub(super) struct SensitivitySummary {
    /// Path of the number in the scene or in the problem.
    name: String,
    /// Its unit, empty for a ratio.
    unit: &'static str,
    value: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    /// Derivative of the objective.
    objective: f64,
    /// Change of the objective with the tolerance, to first order.
    #[serde(skip_serializing_if = "Option::is_none")]
    objective_change: Option<f64>,
    /// Derivative of the duration in s; absent where it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    duration: Option<f64>,
    /// Derivatives of constants that were sought.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<OfParameter>,
    inputs: Vec<OfInput>,
    /// Values of the number between which the same bounds are reached, to first order, and the bounds that end them; absent where there is no end.
    valid: Valid,
    /// Bounds that are reached or left at once: the derivatives hold to one side alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    one_sided: Vec<String>,
}

/// Derivative of a constant that was sought.
#[derive(Debug, Serialize)]
struct OfParameter {
    name: String,
    /// Unit of the constant.
    unit: &'static str,
    derivative: f64,
}

/// The greatest derivative of a voltage or load over time.
#[derive(Debug, Serialize)]
struct OfInput {
    name: String,
    unit: &'static str,
    /// The derivative of greatest size, and the middle of its interval in s.
    derivative: f64,
    time: f64,
    /// Greatest change with the tolerance, to first order.
    #[serde(skip_serializing_if = "Option::is_none")]
    change: Option<f64>,
}

/// Ends of a range.
#[derive(Debug, Serialize)]
struct Valid {
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    to: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_below: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_above: Option<String>,
}

impl SensitivitySummary {
    /// Those of a result; none where there are none.
    pub(super) fn all(system: &System, result: &SolveResult) -> Vec<Self> {
        let motion = &result.optimum.motion;
        let all = result.sensitivities.iter();
        all.map(|one| Self::new(system, motion, one)).collect()
    }

    fn new(system: &System, motion: &Solution, of: &Sensitivity) -> Self {
        let Sensitivity { varied, range, .. } = of;
        let si = varied.unit.factor;
        let tolerance = varied.tolerance.map(|size| size * si);
        let parameters = motion.parameters.iter().zip(&of.parameters);
        let end =
            |change: f64| Some((varied.value + change) * si).filter(|value| value.is_finite());
        Self {
            name: varied.name.clone(),
            unit: varied.unit.symbol,
            value: varied.value * si,
            tolerance,
            objective: of.objective / si,
            objective_change: tolerance.map(|size| (of.objective / si * size).abs()),
            duration: Some(of.duration / 1e3 / si).filter(|duration| *duration != 0.0),
            parameters: parameters
                .map(|(found, by)| OfParameter {
                    name: found.name.clone(),
                    unit: found.unit.symbol,
                    derivative: by * found.unit.factor / si,
                })
                .collect(),
            inputs: inputs(system, motion, of, tolerance),
            valid: Valid {
                from: end(range.down.change),
                to: end(range.up.change),
                bound_below: range.down.bound.clone(),
                bound_above: range.up.bound.clone(),
            },
            one_sided: of.weak.clone(),
        }
    }

    /// In words, for the table of the page.
    pub(super) fn row(&self) -> (String, String) {
        let key = format!("sensitivity to {}", self.name);
        let by = match self.unit {
            "" => String::new(),
            unit => format!(" per {unit}"),
        };
        let change = self.objective_change.map_or_else(String::new, |change| {
            format!("; ± {} with its tolerance", significant(change, 3))
        });
        let value = significant(self.objective, 5);
        (key, format!("objective {value}{by}{change}"))
    }

    /// Warnings on tolerances that reach beyond what first derivatives tell.
    pub(super) fn warning(&self) -> Option<String> {
        let Valid {
            from,
            to,
            bound_below,
            bound_above,
        } = &self.valid;
        let tolerance = self.tolerance?;
        let ends = [
            (
                self.value - tolerance < from.unwrap_or(f64::NEG_INFINITY),
                from,
                bound_below,
            ),
            (
                self.value + tolerance > to.unwrap_or(f64::INFINITY),
                to,
                bound_above,
            ),
        ];
        let (_, end, bound) = ends.into_iter().find(|(is_beyond, ..)| *is_beyond)?;
        Some(format!(
            "the tolerance of {} reaches beyond {} {}, where {}, to first order: derivatives are others behind",
            self.name,
            significant((*end)?, 5),
            self.unit,
            bound.as_deref()?
        ))
    }
}

/// The greatest derivative of each input that has one.
fn inputs(
    system: &System,
    motion: &Solution,
    of: &Sensitivity,
    tolerance: Option<f64>,
) -> Vec<OfInput> {
    let si = of.varied.unit.factor;
    let sources = system.sources().into_iter().enumerate();
    let input = sources.filter_map(|(source, named)| {
        let by = of.voltages.iter().map(|row| row[source]).enumerate();
        let (k, greatest) = by.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (unit, size) = named.kind.si();
        let derivative = greatest / size / si;
        (derivative != 0.0).then(|| OfInput {
            name: named.name.clone(),
            unit,
            derivative,
            time: 0.5e-3 * (motion.times[k] + motion.times[k + 1]),
            change: tolerance.map(|tolerance| (derivative * tolerance).abs()),
        })
    });
    input.collect()
}
