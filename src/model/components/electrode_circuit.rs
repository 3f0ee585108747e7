//! Terms of circuits of electrodes of finite elements, whose charge flows through a resistor.
//!
//! With the energy W(x, φ) of the elements, the charge Q of the electrodes, the voltage V of the source and its resistance R, the energy
//! `W + φ Q − V Q` and the damper `−R Q̇ δQ` give `Q = −∂W/∂φ` and `R Q̇ + φ = V`; a leak makes V and R those of the equivalent source.

use crate::model::components::circuit::{Wires, add_circuit, add_voltage};
use crate::model::electrode_circuits::ElectrodeCircuit;
use crate::model::internal::{InternalKind, Internals};
use crate::model::terms::Terms;

const CHARGES: &str = "electrode charges";

/// Terms of the circuits of electrodes.
pub(in crate::model) fn build(
    circuits: &[ElectrodeCircuit],
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    for of in circuits {
        let Some(charge) = internals.vector(InternalKind::Charge(of.source)) else {
            continue;
        };
        let (charge, unit) = (terms.vector(charge), of.unit_of_charge);
        let (potential, volts) = of.potential;
        add_voltage(CHARGES, &of.name, charge, -(unit * volts), potential, terms);
        let series = of.circuit.resistance.unwrap_or(0.0);
        let wires = Wires {
            source: of.source,
            series,
            leakage: of.circuit.leakage,
            unit,
        };
        add_circuit(&of.name, charge, Some(of.input), &wires, terms);
    }
    terms.without(
        CHARGES,
        match terms.is_of_motion() {
            true => "no electrode of finite elements names a circuit with a resistor",
            false => "at rest no charge flows",
        },
    );
}
