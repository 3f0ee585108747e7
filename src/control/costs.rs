//! Costs of energies: the energy from the sources of lumped muscles, and the work of their electrical forces.

use crate::math::Signal;
use crate::model::components::capacitance;
use crate::model::system::{InputKind, Muscle};
use crate::model::{Quantity, System, What};

/// An energy of one source that is minimised (docs/theory.md, 3.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyCost {
    /// Index of the source, which is that of its lumped muscle.
    pub source: usize,
    /// Energy, summed over the motion.
    pub energy: SourceEnergy,
    /// Weight per J, positive.
    pub weight: f64,
}

/// An energy that a source and its muscle exchange with a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceEnergy {
    /// Energy from the source to the muscle; energy that flows back is negative.
    Electrical,
    /// Work of the electrical forces.
    Mechanical,
}

impl EnergyCost {
    /// Returns true if the source is that of a lumped muscle with electric constants, without a circuit, whose electrodes have its voltage, or
    /// supplies electrical energy through a resistor.
    pub fn exists(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        let is_direct = muscle.is_some_and(|muscle| muscle.circuit.is_none());
        let is_supplied = self.energy == SourceEnergy::Electrical && self.is_resisted(system);
        let has_capacitance = muscle.and_then(capacitance).is_some();
        has_capacitance && (is_direct || is_supplied) && !system.is_charged(self.source)
    }

    /// Returns true if it is the energy that a source supplies through a resistor: the integral of its power.
    pub(super) fn is_resisted(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        muscle.is_some_and(Muscle::is_behind_resistor)
    }

    /// The same as the integral of the power of its source in W, through a resistor.
    pub(super) fn integral(&self) -> QuantityCost {
        QuantityCost {
            quantity: Quantity::power(self.source),
            weight: self.weight,
            function: CostFunction::Itself,
            during: During::Motion,
        }
    }
}

/// The sources without resistors whose energies are minimised, each once.
pub(super) fn sources(costs: &[EnergyCost], system: &System) -> Vec<usize> {
    let direct = costs.iter().filter(|cost| !cost.is_resisted(system));
    let mut sources: Vec<usize> = direct.map(|cost| cost.source).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

/// The energies that flow through resistors.
pub(super) fn resisted<'a>(
    costs: &'a [EnergyCost],
    system: &'a System,
) -> impl Iterator<Item = &'a EnergyCost> {
    costs.iter().filter(|cost| cost.is_resisted(system))
}

/// Objective: a sum of costs with the voltages V in kV, the interval length h in s and N intervals (docs/theory.md, 10.2). The default
/// is no cost at all, and a weight of zero leaves no trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objective {
    /// Weight of Σ h |V_k|², not negative.
    pub effort: f64,
    /// Weight of Σ_{k=0..N} |V_k − V_{k−1}|²/h, not negative; V_{−1} and V_N are the rest voltages of start and goal, and without them the
    /// first or last summand is left out.
    pub rate: f64,
    /// Weight of the final time in s, not negative.
    pub duration: f64,
    /// Squared deviations of markers and joints, over the motion or at its end.
    pub quantities: Vec<QuantityCost>,
    /// Electrical energies from the sources and mechanical works of their muscles in J; several of one source are added.
    pub energies: Vec<EnergyCost>,
}

/// A function of a quantity that is minimised.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityCost {
    /// The quantity m.
    pub quantity: Quantity,
    /// Weight of the cost, positive.
    pub weight: f64,
    /// Function of the quantity.
    pub function: CostFunction,
    /// Times at which it counts.
    pub during: During,
}

/// Function of a quantity m in a cost.
#[derive(Clone, Debug, PartialEq)]
pub enum CostFunction {
    /// (m − r(t))², in the square of the [plain unit](Quantity::plain), with the difference of angles nearest to zero; of the rate of a joint
    /// where m is its step in an interval.
    Square {
        /// Reference of the quantity, r(t) in its unit.
        reference: Signal,
    },
    /// m itself: a quantity that is a square.
    Itself,
}

/// Times at which a cost counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum During {
    /// All the time: the integral over the time in s, by the trapezoidal rule, or in the middle of the intervals.
    Motion,
    /// At the final instant.
    End,
    /// At the instant nearest to a part of the duration: a waypoint that the motion passes near.
    At(f64),
}

impl Objective {
    /// Units of its terms in their order, each once; a single one is that of the sum. Inputs of these kinds act. Weights are
    /// plain numbers.
    pub fn units(&self, system: &System, inputs: &[InputKind]) -> Vec<String> {
        let squares = inputs.iter().map(|kind| match kind.counted().0 {
            unit if unit.contains(' ') => format!("({unit})²"),
            unit => format!("{unit}²"),
        });
        let effort = squares.clone().map(|square| format!("{square} s"));
        let rate = squares.map(|square| format!("{square}/s"));
        let effort = effort.filter(|_| self.effort != 0.0);
        let rate = rate.filter(|_| self.rate != 0.0);
        let duration = (self.duration != 0.0).then(|| "s".to_owned());
        let quantities = self.quantities.iter().map(|cost| cost.unit(system));
        let energies = self.energies.iter().map(|_| "J".to_owned());
        let mut units: Vec<String> = Vec::new();
        for unit in effort
            .chain(rate)
            .chain(duration)
            .chain(quantities)
            .chain(energies)
        {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        units
    }
}

impl QuantityCost {
    /// Unit of the cost, without the weight.
    fn unit(&self, system: &System) -> String {
        if let What::Amount { amount, .. } = self.quantity.what {
            return amount.unit().0.to_owned();
        }
        let squared = match self.quantity.plain(0.0, system).1 {
            "" => String::new(),
            unit if unit.contains('/') => format!("({unit})²"),
            unit => format!("{unit}²"),
        };
        match self.during {
            During::Motion => format!("{squared} s").trim_start().to_owned(),
            During::End | During::At(_) => squared,
        }
    }

    /// Returns true if its second derivative by the quantity is other than zero.
    pub fn is_curved(&self) -> bool {
        match self.function {
            CostFunction::Square { .. } => true,
            CostFunction::Itself => false,
        }
    }
}
