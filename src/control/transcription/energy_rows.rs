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

use crate::control::costs::{EnergyCost, SourceEnergy, sources};
use crate::coordinates::StepPattern;
use crate::functional::Outer;
use crate::model::Model;

/// J in a mJ.
const MILLIJOULE: f64 = 1e-3;

/// Energies of one source before they are summed.
#[derive(Clone, Debug)]
pub(super) struct EnergyRow {
    /// Index of the capacitance among the measures of instants.
    pub(super) measure: usize,
    /// Vectors that it reads.
    pub(super) vectors: Vec<usize>,
    /// Its number, and the scalar of its voltage.
    source: usize,
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
    let row = |(&source, measure): (&usize, &Option<usize>)| {
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
            source,
            scalar,
            square: layout
                .scalars
                .find(scalar, scalar)
                .expect("a voltage has a curvature of its own"),
            weights: [SourceEnergy::Electrical, SourceEnergy::Mechanical].map(weight),
            ends: ends(rest, source),
            intervals,
        })
    };
    let measured = &model.measured[first..];
    sources.iter().zip(measured).filter_map(row).collect()
}

/// Voltages of a source before the start and after the end; 0 where they are not known.
fn ends(rest: &[Option<Vec<f64>>; 2], source: usize) -> [f64; 2] {
    let voltages = rest.each_ref().map(Option::as_ref);
    voltages.map(|row| row.map_or(0.0, |row| row[source]))
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
    /// Takes other voltages at rest before and after.
    pub(super) fn move_ends(&mut self, rest: &[Option<Vec<f64>>; 2]) {
        self.ends = ends(rest, self.source);
    }

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
    (k, sigma): (usize, f64),
    scalars: &[f64],
    count: usize,
) {
    for row in rows {
        outer[row.measure] = Outer::linear(sigma * row.factor(k, scalars, count).value);
    }
}
