//! Costs of quantities on a horizon before they are summed: values and derivatives of a summand.
//!
//! At instant k, t = k h, or in interval k, t = (k + ½) h, a cost with the deviation e = m − r(t) is the summand
//!
//! ```text
//! f_k = w φ e²,     φ = ω_k τ of an integral (trapezoidal rule: ω = ½ at both ends, else 1; τ = h in s),  φ = 1 at the end and at a waypoint.
//! ```
//!
//! Of the rate of a quantity whose step in an interval is m it is e = g m/h − r(t) with the factor g of the unit. A cost of m itself, as the
//! energy from a source of the power m, is w φ m.

use crate::control::costs::{CostFunction, During, EnergyCost, QuantityCost, resisted};
use crate::control::goal::instant_at;
use crate::control::transcription::limit_rows::Site;
use crate::coordinates::Reduced;
use crate::functional::{Outer, Sample};
use crate::math::Signal;
use crate::model::{Model, Quantity};
use std::ops::Range;

/// s in a ms.
pub(super) const MILLISECOND: f64 = 1e-3;

/// A cost of a quantity before it is summed.
#[derive(Clone, Debug)]
pub(super) struct CostRow {
    weight: f64,
    function: Function,
    during: During,
    /// Index among the measures of its site.
    pub(super) measure: usize,
    pub(super) site: Site,
    /// Instants or intervals at which it is paid.
    pub(super) at: Range<usize>,
    /// Vectors that it reads.
    pub(super) vectors: Vec<usize>,
    /// Scalars that it reads.
    pub(super) scalars: Vec<usize>,
    /// After which values repeat themselves: angles.
    period: Option<f64>,
    /// Factor g of a rate over a step, where the cost is that of a rate.
    rate_factor: Option<f64>,
    /// True if the length of the interval is part of the quantity.
    pub(super) reads_rates: bool,
    intervals: usize,
}

/// Function of a quantity that is summed.
#[derive(Clone, Debug)]
enum Function {
    /// The square of the deviation from a reference.
    Square(Signal),
    /// The quantity.
    Itself,
}

/// A summand of the objective with its derivatives by the value m of its quantity and by the interval length h in ms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summand {
    pub(super) value: f64,
    /// By m, and by m twice.
    pub(super) outer: Outer,
    pub(super) by_h: f64,
    pub(super) by_value_and_h: f64,
    pub(super) by_h_twice: f64,
}

/// The costs of the quantities that the model can change, then the energies that flow through resistors; their measures follow those of
/// `limits` limits and goals.
pub(super) fn cost_rows(
    model: &Model,
    costs: &[QuantityCost],
    energies: &[EnergyCost],
    limits: usize,
    intervals: usize,
) -> Vec<CostRow> {
    let squares = costs.iter().map(|cost| {
        let function = match &cost.function {
            CostFunction::Square { reference } => Function::Square(reference.clone()),
            CostFunction::Itself => Function::Itself,
        };
        (cost.quantity.clone(), cost.weight, function, cost.during)
    });
    let powers = resisted(energies, &model.system)
        .map(|cost| (cost.power(), cost.weight, Function::Itself, During::Motion));
    let row = |((quantity, weight, function, during), measure): (_, &Option<usize>)| {
        let quantity: Quantity = quantity;
        let measure = (*measure)?;
        let site = Site::from_quantity(&quantity);
        let reads = site.measure(model, measure);
        let mut vectors = reads.vectors();
        vectors.sort_unstable();
        vectors.dedup();
        let count = intervals + 2 - site.sides();
        let at = match during {
            During::Motion => 0..count,
            During::End => count - 1..count,
            During::At(part) => {
                let k = instant_at(part, intervals) + 1 - site.sides();
                k..k + 1
            }
        };
        Some(CostRow {
            weight,
            function,
            during,
            measure,
            site,
            at,
            vectors,
            scalars: reads.scalars(),
            period: quantity.period(&model.system),
            rate_factor: quantity.rate_factor(&model.system),
            reads_rates: reads.reads_rates(),
            intervals,
        })
    };
    let measured = &model.measured[limits..];
    squares
        .chain(powers)
        .zip(measured)
        .filter_map(row)
        .collect()
}

impl CostRow {
    /// Its summand at instant or interval k, where the quantity is m.
    pub(super) fn summand(&self, m: f64, k: usize, h: f64) -> Summand {
        let weight = self.weight;
        // φ and ∂φ/∂h.
        let [factor, by_h] = match self.during {
            During::Motion => {
                let is_end = self.site == Site::Instants && (k == 0 || k == self.intervals);
                let part = if is_end { 0.5 } else { 1.0 } * MILLISECOND;
                [part * h, part]
            }
            During::End | During::At(_) => [1.0, 0.0],
        };
        match &self.function {
            Function::Itself => Summand {
                value: weight * factor * m,
                outer: Outer::linear(weight * factor),
                by_h: weight * by_h * m,
                by_value_and_h: weight * by_h,
                by_h_twice: 0.0,
            },
            Function::Square(reference) => {
                let steps = match self.site {
                    Site::Instants => k as f64,
                    Site::Intervals => k as f64 + 0.5,
                };
                let [at, rate, second] = reference.derivatives(steps * h);
                // e = s m − r with ∂s/∂h and ∂²s/∂h².
                let [s, s_h, s_hh] = match self.rate_factor {
                    None => [1.0, 0.0, 0.0],
                    Some(g) => [g / h, -g / (h * h), 2.0 * g / (h * h * h)],
                };
                let e = self.nearest(s * m - at);
                // ∂e/∂h and ∂²e/∂h².
                let e_h = s_h * m - steps * rate;
                let e_hh = s_hh * m - steps * steps * second;
                Summand {
                    value: weight * factor * e * e,
                    outer: Outer {
                        slope: 2.0 * weight * factor * e * s,
                        curvature: 2.0 * weight * factor * s * s,
                    },
                    by_h: weight * (by_h * e * e + 2.0 * factor * e * e_h),
                    by_value_and_h: 2.0 * weight * (by_h * e * s + factor * (e_h * s + e * s_h)),
                    by_h_twice: 2.0
                        * weight
                        * (2.0 * by_h * e * e_h + factor * (e_h * e_h + e * e_hh)),
                }
            }
        }
    }

    /// A deviation, of an angle without its full turns.
    fn nearest(&self, deviation: f64) -> f64 {
        match self.period {
            Some(period) => deviation - period * (deviation / period).round(),
            None => deviation,
        }
    }
}

/// Functions of the measures of one site at instant or interval k: costs times σ.
pub(super) fn fill_costs(
    outer: &mut [Outer],
    costs: &[CostRow],
    (site, k): (Site, usize),
    sigma: f64,
    (action, sample): (&Reduced, &Sample<'_>),
) {
    for cost in costs
        .iter()
        .filter(|cost| cost.site == site && cost.at.contains(&k))
    {
        let value = site.sum(action).measures[cost.measure].value(sample);
        let Outer { slope, curvature } = cost.summand(value, k, sample.h).outer;
        outer[cost.measure] = Outer {
            slope: sigma * slope,
            curvature: sigma * curvature,
        };
    }
}
