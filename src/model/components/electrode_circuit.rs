//! Terms of circuits of electrodes of finite elements, whose charge flows through a resistor.
//!
//! With the energy W(x, φ) of the elements, the charge Q of the electrodes, the voltage V of the source and its resistance R, the energy
//! `W + φ Q − V Q` and the damper `−R Q̇ δQ` give `Q = −∂W/∂φ` and `R Q̇ + φ = V`; a leak makes V and R those of the equivalent source.

use crate::energy::{CoordinateDamper, DeadLoad};
use crate::functional::Element;
use crate::math::Vector;
use crate::model::components::circuit::{RESISTANCE, SOURCES};
use crate::model::electrode_circuits::ElectrodeCircuit;
use crate::model::internal::{InternalKind, Internals};
use crate::model::terms::{Terms, mid, rate};

const CHARGES: &str = "electrode charges";

/// Terms of the circuits of electrodes.
pub(in crate::model) fn build(
    circuits: &[ElectrodeCircuit],
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    let why = "circuit of";
    for of in circuits {
        let Some(charge) = internals.vector(InternalKind::Charge(of.source)) else {
            continue;
        };
        let (charge, unit) = (terms.vector(charge), of.unit_of_charge);
        let (potential, volts) = of.potential;
        let held = DeadLoad {
            force: Vector::x() * -(unit * volts),
        };
        let driven = DeadLoad {
            force: Vector::x() * (unit * of.circuit.division().unwrap_or(1.0)),
        };
        let both = [(CHARGES, held, potential), (SOURCES, driven, of.input)];
        for (term, energy, scalar) in both {
            let element = Element {
                energy,
                vectors: [mid(charge)],
                scalars: [scalar],
            };
            terms.add::<_, 4, 1, 1>(term, why, &of.name, element);
        }
        let resistance = of.circuit.inner_resistance().unwrap_or(0.0);
        let element = Element {
            energy: CoordinateDamper {
                coefficient: resistance * unit * unit,
            },
            vectors: [mid(charge), rate(charge)],
            scalars: [],
        };
        terms.add::<_, 6, 2, 0>(RESISTANCE, why, &of.name, element);
    }
    terms.without(
        CHARGES,
        match terms.is_of_motion() {
            true => "no electrode of finite elements names a circuit with a resistor",
            false => "at rest no charge flows",
        },
    );
}
