//! Terms of circuits: a charge that flows through a resistor, which with a leak is that of the equivalent source.

use crate::energy::{CoordinateDamper, DeadLoad, FlowingCharge};
use crate::functional::Element;
use crate::math::Vector;
use crate::model::components::muscle::{CHARGES, capacitance};
use crate::model::internal::{InternalKind, Internals};
use crate::model::system::Muscle;
use crate::model::terms::{Terms, mid, rate};

pub(in crate::model) const SOURCES: &str = "circuit sources";
pub(in crate::model) const RESISTANCE: &str = "circuit resistance";

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
    let why = "circuit of";
    let element = Element {
        energy: FlowingCharge { capacitance, unit },
        vectors: [mid(span), mid(charge)],
        scalars: [],
    };
    terms.add::<_, 6, 2, 0>(CHARGES, why, &muscle.name, element);
    if let Some(voltage) = terms.input(index) {
        let element = Element {
            energy: DeadLoad {
                force: Vector::x() * muscle.voltage_at_rest(unit),
            },
            vectors: [mid(charge)],
            scalars: [voltage],
        };
        terms.add::<_, 4, 1, 1>(SOURCES, why, &muscle.name, element);
    }
    let element = Element {
        energy: CoordinateDamper {
            coefficient: resistance * unit * unit,
        },
        vectors: [mid(charge), rate(charge)],
        scalars: [],
    };
    terms.add::<_, 6, 2, 0>(RESISTANCE, why, &muscle.name, element);
}
