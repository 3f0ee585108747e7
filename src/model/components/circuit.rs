//! Terms of circuits: a charge that flows through a resistor, which with a leak is that of the equivalent source.

use crate::energy::{Coefficient, CoordinateDamper, DeadLoad};
use crate::functional::Element;
use crate::math::Vector;
use crate::model::components::muscle::{CHARGES, constants};
use crate::model::components::muscle_constants::capacitance;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::Read;
use crate::model::construction::Construction;
use crate::model::layout::internal::{InternalKind, Internals};
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::terms::{Terms, mid, rate};
use nalgebra::Vector3;

pub(super) const SOURCES: &str = "circuit sources";
const RESISTANCE: &str = "circuit resistance";
const ELECTRODE_CHARGES: &str = "electrode charges";
/// Reason of the terms, before the names of their parts.
const WHY: &str = "circuit of";

/// Terms of the circuits of the muscles of a scene, and of electrodes.
pub(in crate::model) fn build(of: &Construction<'_>, terms: &mut Terms<'_>) {
    for m in 0..of.system.muscles.len() {
        circuit(of, m, terms);
    }
    build_electrodes(&of.blocks.circuits, of.internals, terms);
    if !terms.is_of_motion() {
        let flowing = [SOURCES, RESISTANCE, ELECTRODE_CHARGES];
        terms.without_each(flowing, "at rest no charge flows");
    }
}

/// The electric energy of a charge, which is an internal coordinate, the source, and the resistor as its damper.
pub(in crate::model) fn circuit(of: &Construction<'_>, index: usize, terms: &mut Terms<'_>) {
    let (muscle, span) = (&of.system.muscles[index], of.spans[index]);
    let charge = of.internals.vector(InternalKind::Charge(index));
    let (Some(circuit), Some(capacitance), Some(charge)) =
        (muscle.circuit, capacitance(muscle), charge)
    else {
        return;
    };
    let (Some(series), charge) = (circuit.resistance, terms.vector(charge)) else {
        return;
    };
    let mut constants = constants(muscle, index, terms);
    if let Some(law) = constants.flowing_charge() {
        let element = constants.element(law, [mid(span), mid(charge)], []);
        terms.add_law(CHARGES, WHY, &muscle.name, element);
    }
    let wires = Wires {
        source: index,
        series,
        leakage: circuit.leakage,
        unit: capacitance.unit_of_charge(),
    };
    add_circuit(&muscle.name, charge, terms.input(index), &wires, terms);
}

/// A resistor in series with electrodes, and a leak parallel to them, whose resistances may be free.
pub(super) struct Wires {
    pub(super) source: usize,
    /// Resistance in series in Ω.
    pub(super) series: f64,
    /// Resistance of the leak in Ω.
    pub(super) leakage: Option<f64>,
    /// Unit of the charge in mC.
    pub(super) unit: f64,
}

impl Wires {
    /// Resistance in series, and the part of the voltage that the leak leaves at rest.
    fn read(&self, read: &mut Read) -> [Coefficient; 2] {
        let series = read.constant(Constant::Resistance(self.source), self.series);
        let part = match self.leakage {
            None => 1.0.into(),
            Some(leakage) => {
                let leakage = read.constant(Constant::Leakage(self.source), leakage);
                &leakage / &(&series + &leakage)
            }
        };
        [series, part]
    }
}

/// Adds source and resistor of a charge in its unit, from the scalar of the voltage of the source: those of the source that stands for source,
/// resistor and leak.
pub(super) fn add_circuit(
    name: &str,
    charge: usize,
    voltage: Option<usize>,
    wires: &Wires,
    terms: &mut Terms<'_>,
) {
    let unit = wires.unit;
    if let Some(voltage) = voltage {
        let mut read = terms.sought().read();
        let [_, part] = wires.read(&mut read);
        let none = Coefficient::from(0.0);
        let force = Vector3::new(part.scaled(unit), none.clone(), none);
        let element = read.element(DeadLoad { force }, [mid(charge)], [voltage]);
        terms.add_law(SOURCES, WHY, name, element);
    }
    let mut read = terms.sought().read();
    let [series, part] = wires.read(&mut read);
    let law = CoordinateDamper {
        coefficient: (&part * &series).scaled(unit).scaled(unit),
    };
    let element = read.element(law, [mid(charge), rate(charge)], []);
    terms.add_law(RESISTANCE, WHY, name, element);
}

fn build_electrodes(circuits: &[ElectrodeCircuit], internals: &Internals, terms: &mut Terms<'_>) {
    for of in circuits {
        let Some(charge) = internals.vector(InternalKind::Charge(of.source)) else {
            continue;
        };
        let (charge, unit) = (terms.vector(charge), of.unit_of_charge);
        let (potential, volts) = of.potential;
        // The energy of a charge in its unit at the potential, a scalar of the interval in its own unit.
        let force = Vector::x() * -(unit * volts);
        let element = Element {
            energy: DeadLoad { force },
            vectors: [mid(charge)],
            scalars: [potential],
        };
        terms.add(ELECTRODE_CHARGES, WHY, &of.name, element);
        let series = of.circuit.resistance.unwrap_or(0.0);
        let wires = Wires {
            source: of.source,
            series,
            leakage: of.circuit.leakage,
            unit,
        };
        add_circuit(&of.name, charge, Some(of.input), &wires, terms);
    }
}
