//! Terms of circuits: a charge that flows through a resistor, which with a leak is that of the equivalent source.

use crate::energy::{CoordinateDamper, DeadLoad, Polynomial};
use crate::functional::{Element, Law};
use crate::math::{Number, Vector};
use crate::model::components::muscle::{CHARGES, capacitance, constants};
use crate::model::components::muscle_laws::Flowing;
use crate::model::constant::Constant;
use crate::model::free_parameters::Read;
use crate::model::internal::{InternalKind, Internals};
use crate::model::system::Muscle;
use crate::model::terms::{Terms, mid, rate};
use nalgebra::Vector3;

pub(super) const SOURCES: &str = "circuit sources";
const RESISTANCE: &str = "circuit resistance";
/// Reason of the terms, before the names of their parts.
const WHY: &str = "circuit of";

/// Terms of the circuits of the muscles of a scene; `spans` are the vectors of their spans.
pub(in crate::model) fn build(
    muscles: &[Muscle],
    spans: &[usize],
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    for (m, (muscle, &span)) in muscles.iter().zip(spans).enumerate() {
        circuit(muscle, m, span, internals, terms);
    }
    let none = match terms.is_of_motion() {
        true => "no muscle or electrode names a circuit with a resistor",
        false => "at rest no charge flows",
    };
    for term in [SOURCES, RESISTANCE] {
        terms.without(term, none);
    }
}

/// The electric energy of a charge, which is an internal coordinate, the source, and the resistor as its damper.
fn circuit(
    muscle: &Muscle,
    index: usize,
    span: usize,
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    let series = muscle.circuit.and_then(|circuit| circuit.resistance);
    let Some(capacitance) = capacitance(muscle).filter(|_| series.is_some()) else {
        return;
    };
    let Some(charge) = internals.vector(InternalKind::Charge(index)) else {
        return;
    };
    let (charge, unit) = (terms.vector(charge), capacitance.unit_of_charge());
    let mut constants = constants((muscle, index), terms);
    if let Some(capacitance) = constants.capacitance() {
        let law = Flowing { capacitance, unit };
        let element = constants.element(law, [mid(span), mid(charge)], []);
        terms.add_law((CHARGES, WHY), &muscle.name, element);
    }
    if let (Some(circuit), Some(series)) = (&muscle.circuit, series) {
        let wires = Wires::new((index, series), circuit.leakage, unit);
        add_circuit(&muscle.name, charge, terms.input(index), wires, terms);
    }
}

/// A resistor in series with electrodes, and a leak parallel to them, whose resistances may be free.
#[derive(Clone)]
pub(super) struct Wires {
    source: usize,
    series: f64,
    leakage: Option<f64>,
    /// Unit of the charge in mC.
    unit: f64,
}

impl Wires {
    /// Those of the circuit of a source with a resistance in series in Ω.
    pub(super) fn new((source, series): (usize, f64), leakage: Option<f64>, unit: f64) -> Self {
        Self {
            source,
            series,
            leakage,
            unit,
        }
    }

    fn read(&self, read: &mut Read) -> Resistances {
        let leakage = self.leakage;
        Resistances {
            series: read.constant(Constant::Resistance(self.source), self.series),
            leakage: leakage.map(|r| read.constant(Constant::Leakage(self.source), r)),
            unit: self.unit,
        }
    }
}

/// The resistances in Ω.
#[derive(Clone)]
struct Resistances {
    series: Polynomial,
    leakage: Option<Polynomial>,
    unit: f64,
}

impl Resistances {
    /// Resistance in series, and the part of the voltage that the leak leaves at rest.
    fn at<T: Number>(&self, parameters: &[T]) -> [T; 2] {
        let series = self.series.at(parameters);
        let leakage = self.leakage.as_ref().map(|leak| leak.at(parameters));
        [
            series,
            leakage.map_or(T::one(), |leak| leak.over(series + leak)),
        ]
    }
}

/// Energy of a charge in its unit at the voltage of the source that stands for source, resistor and leak.
#[derive(Clone)]
struct Supply(Resistances);

impl Law<4> for Supply {
    type Formula<T: Number> = DeadLoad<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> DeadLoad<T> {
        let [_, part] = self.0.at(parameters);
        let none = T::zero();
        DeadLoad {
            force: Vector3::new(part.scaled(self.0.unit), none, none),
        }
    }
}

/// Resistor of that source, as the damper of a charge in its unit.
#[derive(Clone)]
struct Resistor(Resistances);

impl Law<6> for Resistor {
    type Formula<T: Number> = CoordinateDamper<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> CoordinateDamper<T> {
        let ([series, part], unit) = (self.0.at(parameters), self.0.unit);
        CoordinateDamper {
            coefficient: (part * series).scaled(unit).scaled(unit),
        }
    }
}

/// Adds source and resistor of a charge in its unit, from the scalar of the voltage of the source.
pub(super) fn add_circuit(
    name: &str,
    charge: usize,
    voltage: Option<usize>,
    wires: Wires,
    terms: &mut Terms<'_>,
) {
    if let Some(voltage) = voltage {
        let mut read = terms.sought().read();
        let law = Supply(wires.read(&mut read));
        let element = read.element(law, [mid(charge)], [voltage]);
        terms.add_law((SOURCES, WHY), name, element);
    }
    let mut read = terms.sought().read();
    let law = Resistor(wires.read(&mut read));
    let element = read.element(law, [mid(charge), rate(charge)], []);
    terms.add_law((RESISTANCE, WHY), name, element);
}

/// Adds the energy of a charge in its unit at a voltage, which is a scalar of the interval times a factor.
pub(super) fn add_voltage(
    term: &'static str,
    name: &str,
    charge: usize,
    factor: f64,
    voltage: usize,
    terms: &mut Terms<'_>,
) {
    let element = Element {
        energy: DeadLoad {
            force: Vector::x() * factor,
        },
        vectors: [mid(charge)],
        scalars: [voltage],
    };
    terms.add::<_, 4, 1, 1>(term, WHY, name, element);
}
