//! Terms of circuits: a charge that flows through a resistor, which with a leak is that of the equivalent source.

use crate::energy::{CoordinateDamper, DeadLoad};
use crate::functional::Element;
use crate::math::Vector;
use crate::model::components::muscle::{CHARGES, capacitance, constants};
use crate::model::components::muscle_laws::Flowing;
use crate::model::internal::{InternalKind, Internals};
use crate::model::system::Muscle;
use crate::model::terms::{Terms, mid, rate};

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
    let (Some(resistance), Some(capacitance)) = (muscle.inner_resistance(), capacitance(muscle))
    else {
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
    if let Some(voltage) = terms.input(index) {
        let drive = (muscle.voltage_at_rest(unit), voltage);
        add_voltage(SOURCES, &muscle.name, charge, drive, terms);
    }
    add_resistor(&muscle.name, charge, resistance * unit * unit, terms);
}

/// Adds the energy of a charge in its unit at a voltage, which is a scalar of the interval times a factor.
pub(super) fn add_voltage(
    term: &'static str,
    name: &str,
    charge: usize,
    (factor, voltage): (f64, usize),
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

/// Adds a resistor as the damper of a charge in its unit.
pub(super) fn add_resistor(name: &str, charge: usize, coefficient: f64, terms: &mut Terms<'_>) {
    let element = Element {
        energy: CoordinateDamper { coefficient },
        vectors: [mid(charge), rate(charge)],
        scalars: [],
    };
    terms.add::<_, 6, 2, 0>(RESISTANCE, WHY, name, element);
}
