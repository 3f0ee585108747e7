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
//!
//! Energies of sources without resistors on a horizon, instant by instant; those through resistors are integrals of powers, as costs of quantities.
//!
//! The sums over the intervals of docs/theory.md, 3.5 are, by summation by parts, sums over the instants in which the shape occurs in the
//! capacitance `C_k = C(x_k)` alone. With the voltages a before and b after an instant and the weights e of the electrical energy and w of the
//! mechanical work,
//!
//! ```text
//! f = Σ_{k=0..N} C_k p_k,     p_k = (e + w/2) a² − w/2 b² − e a b     at 0 < k < N,
//!                             p_0 = −w/2 b² − e a b,     p_N = (e + w/2) a² − e a b + e b²,
//! ```
//!
//! where the voltages b that hold the goal are none, b = 0, if they are not known.
//!
//! The objective on a horizon: costs of inputs, of quantities and of energies, with its scale.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::costs::{
    CostFunction, During, EnergyCost, QuantityCost, SourceEnergy, resisted, sources,
};
use crate::control::goal::instant_at;
use crate::control::objective::Cost;
use crate::control::problem::Control;
use crate::control::transcription::layout::Layout;
use crate::control::transcription::limit_rows::Site;
use crate::coordinates::{Reduced, StepPattern};
use crate::functional::{Outer, Sample};
use crate::model::{Model, Time};
use std::ops::Range;

/// s in a ms.
pub(super) const MILLISECOND: f64 = 1e-3;

/// A cost of a quantity before it is summed.
#[derive(Clone, Debug)]
pub(super) struct CostRow {
    cost: QuantityCost,
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
    let powers = resisted(energies, &model.system).map(EnergyCost::integral);
    let row = |(cost, measure): (QuantityCost, &Option<usize>)| {
        let measure = (*measure)?;
        let site = Site::from_quantity(&cost.quantity);
        let reads = site.measure(model, measure);
        let mut vectors = reads.vectors();
        vectors.sort_unstable();
        vectors.dedup();
        let count = intervals + 2 - site.sides();
        let at = match cost.during {
            During::Motion => 0..count,
            During::End => count - 1..count,
            During::At(part) => {
                let k = instant_at(part, intervals) + 1 - site.sides();
                k..k + 1
            }
        };
        Some(CostRow {
            measure,
            site,
            at,
            vectors,
            scalars: reads.scalars(),
            period: cost.quantity.period(&model.system),
            rate_factor: cost.quantity.rate_factor(&model.system),
            reads_rates: reads.reads_rates(),
            intervals,
            cost,
        })
    };
    let paid = costs.iter().cloned().chain(powers);
    let measured = paid.zip(&model.measured[limits..]);
    measured.filter_map(row).collect()
}

impl CostRow {
    /// Its summand at instant or interval k, where the quantity is m.
    pub(super) fn summand(&self, m: f64, k: usize, h: f64) -> Summand {
        let weight = self.cost.weight;
        // φ and ∂φ/∂h.
        let [factor, by_h] = match self.cost.during {
            During::Motion => {
                let is_end = self.site == Site::Instants && (k == 0 || k == self.intervals);
                let part = if is_end { 0.5 } else { 1.0 } * MILLISECOND;
                [part * h, part]
            }
            During::End | During::At(_) => [1.0, 0.0],
        };
        match &self.cost.function {
            CostFunction::Itself => Summand {
                value: weight * factor * m,
                outer: Outer::linear(weight * factor),
                by_h: weight * by_h * m,
                by_value_and_h: weight * by_h,
                by_h_twice: 0.0,
            },
            CostFunction::Square { reference } => {
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
    site: Site,
    k: usize,
    sigma: f64,
    action: &Reduced,
    sample: &Sample<'_>,
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

/// J in a mJ.
const MILLIJOULE: f64 = 1e-3;

/// Energies of one source before they are summed.
#[derive(Clone, Debug)]
pub(super) struct EnergyRow {
    /// Index of the capacitance among the measures of instants.
    pub(super) measure: usize,
    /// Vectors that it reads.
    pub(super) vectors: Vec<usize>,
    /// Scalar of its voltage.
    pub(super) scalar: usize,
    /// Slot of the second derivative by the voltage.
    pub(super) square: usize,
    /// Coordinates of an instant on which the capacitance depends, with the slots of the second derivatives by them and the voltage.
    pub(super) mixed: Vec<(usize, usize)>,
    /// Weights per mJ of the electrical energy and of the mechanical work.
    weights: [f64; 2],
    /// Voltages in V before the start and after the end.
    ends: [f64; 2],
    intervals: usize,
}

/// The factor p of the capacitance at one instant, with its derivatives by the voltages before and after.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor {
    pub(super) value: f64,
    pub(super) slopes: [f64; 2],
    /// By each voltage twice.
    pub(super) squares: [f64; 2],
    /// By both.
    pub(super) product: f64,
}

/// Neighbouring inputs that meet in the objective: those of interval k and of the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump {
    pub(super) k: usize,
    /// Its place among the inputs of an interval.
    pub(super) input: usize,
    /// Index of the energies of the source, where they couple the two.
    pub(super) energy: Option<usize>,
}

/// The energies of each source that drives something; their measures are the last ones of the model. `rest` are the voltages at rest before
/// and after, where they are known.
pub(super) fn energy_rows(
    model: &Model,
    costs: &[EnergyCost],
    rest: &[Option<Vec<f64>>; 2],
    intervals: usize,
) -> Vec<EnergyRow> {
    let sources = sources(costs, &model.system);
    let first = model.measured.len() - sources.len();
    let layout = model.action.layout();
    let voltages = rest.each_ref().map(Option::as_ref);
    let measured = sources.iter().zip(&model.measured[first..]);
    let rows = measured.filter_map(|(&source, measure)| {
        let (measure, scalar) = (*measure, model.variables.input(source));
        let (measure, scalar) = measure.zip(scalar)?;
        let vectors = model.action.instants.measures[measure].vectors();
        let weight = |energy: SourceEnergy| {
            let own = |cost: &&EnergyCost| cost.source == source && cost.energy == energy;
            let weights = costs.iter().filter(own).map(|cost| cost.weight);
            MILLIJOULE * weights.sum::<f64>()
        };
        Some(EnergyRow {
            measure,
            mixed: mixed(model, &vectors, scalar, layout),
            vectors,
            scalar,
            square: layout
                .scalars
                .find(scalar, scalar)
                .expect("a voltage has a curvature of its own"),
            weights: [SourceEnergy::Electrical, SourceEnergy::Mechanical].map(weight),
            // A voltage that is not known is none.
            ends: voltages.map(|row| row.map_or(0.0, |row| row[source])),
            intervals,
        })
    });
    rows.collect()
}

/// The coordinates that vectors depend on, with the slots of their couplings with a voltage: those of the energy of the muscle.
fn mixed(
    model: &Model,
    vectors: &[usize],
    scalar: usize,
    layout: &StepPattern,
) -> Vec<(usize, usize)> {
    let map = &model.action.map;
    let mut coordinates: Vec<usize> = vectors.iter().flat_map(|&v| map.support(v)).collect();
    coordinates.sort_unstable();
    coordinates.dedup();
    let slot = |i: usize| {
        let slot = layout.mixed.find(i, scalar);
        (i, slot.expect("a muscle couples its ends and its voltage"))
    };
    coordinates.into_iter().map(slot).collect()
}

impl EnergyRow {
    /// Returns true if voltages of neighbouring intervals couple: in the electrical energy.
    pub(super) fn couples_intervals(&self) -> bool {
        self.weights[0] != 0.0
    }

    /// Its factor at instant k; `scalars` are those of all intervals, `count` of each.
    pub(super) fn factor(&self, k: usize, scalars: &[f64], count: usize) -> Factor {
        let [electrical, mechanical] = self.weights;
        let half = 0.5 * mechanical;
        let of = |k: usize| scalars[k * count + self.scalar];
        let (a, first) = match k {
            0 => (self.ends[0], 0.0),
            _ => (of(k - 1), electrical + half),
        };
        let (b, second) = match k == self.intervals {
            true => (self.ends[1], electrical),
            false => (of(k), -half),
        };
        let product = -electrical;
        Factor {
            value: first * a * a + second * b * b + product * a * b,
            slopes: [
                2.0 * first * a + product * b,
                2.0 * second * b + product * a,
            ],
            squares: [2.0 * first, 2.0 * second],
            product,
        }
    }
}

/// Functions of the measures of instant k: energies times σ.
pub(super) fn fill_energies(
    outer: &mut [Outer],
    rows: &[EnergyRow],
    k: usize,
    sigma: f64,
    scalars: &[f64],
    count: usize,
) {
    for row in rows {
        outer[row.measure] = Outer::linear(sigma * row.factor(k, scalars, count).value);
    }
}

/// The objective of a control problem on its grid.
#[derive(Clone, Debug)]
pub(super) struct Objective {
    pub(super) cost: Cost,
    /// Costs of quantities.
    pub(super) quantities: Vec<CostRow>,
    /// Costs of energies.
    pub(super) energies: Vec<EnergyRow>,
    /// Voltages and loads of an interval.
    pub(super) inputs: Vec<CostInput>,
    /// Factor that brings the objective near 1, which follows from its value at the guess.
    pub(super) scale: f64,
}

/// A voltage or load in the objective.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostInput {
    /// Its place among the scalars.
    pub(super) scalar: usize,
    /// Slot of its second derivative with itself.
    pub(super) slot: usize,
    /// Size of one kV, N or N m in the unit inside; infinite of a given one, which costs nothing.
    pub(super) unit: f64,
    /// Scale of its variable in kV, N or N m.
    pub(super) scale: f64,
    /// Scale of its variable in the unit inside.
    pub(super) size: f64,
}

impl CostInput {
    /// The voltages and loads of an interval of a model.
    fn of_model(model: &Model, control: &Control) -> Vec<Self> {
        let slots = &model.action.layout().scalars;
        let variables = &model.variables.of(Time::Interval)[model.variables.sources_range()];
        let inputs = variables.iter().enumerate().map(|(s, variable)| {
            let source = variable.source.expect("an input of a source");
            let unit = unit_of(model, control, source);
            let size = control.size(variable, model);
            Self {
                scalar: s,
                slot: slots
                    .find(s, s)
                    .expect("an input has a curvature of its own"),
                unit,
                scale: size / unit,
                size,
            }
        });
        inputs.collect()
    }
}

impl Objective {
    /// The objective of a problem on a layout.
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        control: &Control,
        layout: &Layout,
    ) -> Self {
        let objective = &control.objective;
        let (paid, energies) = (&objective.quantities, &objective.energies);
        let inputs = CostInput::of_model(model, control);
        let ends = boundary.rest.each_ref();
        let ends = ends.map(|row| row.as_ref().map(|row| counted(model, &inputs, row)));
        Self {
            cost: Cost::new(objective, inputs.len(), layout.span, ends),
            quantities: cost_rows(
                model,
                paid,
                energies,
                boundary.limits.quantities().len(),
                layout.span.end,
            ),
            energies: energy_rows(model, energies, &boundary.rest, layout.span.all),
            inputs,
            scale: 1.0,
        }
    }
}

/// Size of one kV, N or N m of an input in the unit inside; infinite of a given one, which costs nothing.
pub(super) fn unit_of(model: &Model, control: &Control, source: usize) -> f64 {
    match control.is_given(source) {
        true => f64::INFINITY,
        false => model.input_kind(source).counted().1,
    }
}

/// Inputs of an interval in kV, N and N m, from those of all sources.
pub(super) fn counted(model: &Model, inputs: &[CostInput], row: &[f64]) -> Vec<f64> {
    let values = model.variables.sources().map(|source| row[source]);
    let values = values.zip(inputs);
    values.map(|(value, input)| value / input.unit).collect()
}
