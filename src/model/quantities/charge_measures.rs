//! Measures of charges and sources: behind resistors the charge, its voltage and field, current and power; otherwise charge and energy under the
//! voltage.

use crate::energy::{
    Capacitance, Coefficient, FlowingCharge, FlowingChargeField, MeanCharge, Multiple,
    PositionComponent, PotentialDrop, SourceCurrent, SourcePower, StoredEnergy, VoltageAcross,
};
use crate::functional::{Sample, Stencil, Term, TermKind};
use crate::math::Vector;
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::{MuscleConstants, charge_field};
use crate::model::constants::constant::Constant;
use crate::model::layout::internal::InternalKind;
use crate::model::model::Model;
use crate::model::quantities::measures::{Made, Reading};
use crate::model::quantities::what::What;
use crate::model::system::InputKind;
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::terms::loads::LOADS;

/// A muscle behind a resistor: its constants, the electric energy of its charge, and the vectors of its span and of its charge.
struct Charged<'a> {
    of: MuscleConstants<'a>,
    energy: FlowingCharge<Coefficient>,
    read: [usize; 2],
}

/// A muscle under the voltage of its source: its constants and capacitance, the vector of its span, and the scalar of the voltage.
struct Direct<'a> {
    of: MuscleConstants<'a>,
    capacitance: Capacitance<Coefficient>,
    span: usize,
    voltage: usize,
}

impl<'k> Reading<'k, '_> {
    /// Squared field of a muscle behind a resistor over the one of the unit.
    pub(super) fn charged_field(&mut self, muscle: usize) -> Made {
        let Charged { of, energy, read } = self.charged(muscle)?;
        let field = FlowingChargeField {
            field: charge_field(energy.capacitance, self.quantity.unit),
            unit: energy.unit,
        };
        self.law(of.element(field, read.map(|vector| self.at(vector)), []))
    }

    /// Mean charge of a muscle under the voltage of its source in mC.
    pub(super) fn mean_charge(&mut self, muscle: usize) -> Made {
        let own = self.direct(muscle)?;
        let ends = [Stencil::Here, Stencil::Next].map(|at| at.of(own.span));
        let law = MeanCharge(own.capacitance);
        self.law(own.of.element(law, ends, [own.voltage]))
    }

    /// Energy of a muscle under the voltage of its source in mJ.
    pub(super) fn stored_energy(&mut self, muscle: usize) -> Made {
        let own = self.direct(muscle)?;
        let law = StoredEnergy(own.capacitance);
        self.law(own.of.element(law, [self.at(own.span)], [own.voltage]))
    }

    /// The electrodes behind a resistor that a source charges.
    fn electrodes(&self, source: usize) -> Option<&'k ElectrodeCircuit> {
        let mut circuits = self.known.blocks.circuits.iter();
        circuits.find(|of| of.source == source)
    }

    /// Charge behind the resistor of a source in mC.
    pub(super) fn charge(&mut self, source: usize) -> Made {
        let charge = InternalKind::Charge(source);
        let charge = self.known.internals.vector(charge)?;
        let unit = match self.electrodes(source) {
            Some(of) => of.unit_of_charge,
            None => capacitance(&self.known.system.muscles[source])?.unit_of_charge(),
        };
        let (origin, normal) = (Vector::zeros(), Vector::x() * unit);
        let charge = self.vectors.index(charge);
        self.instant(PositionComponent { origin, normal }, [charge])
    }

    /// Voltage of the electrodes behind the resistor of a source.
    pub(super) fn across(&mut self, source: usize) -> Made {
        if let Some(of) = self.electrodes(source) {
            let (potential, volts) = of.potential;
            let multiple = Multiple { unit: 1.0 / volts };
            return self.formula::<_, 1, 0, 1>(multiple, [], [potential]);
        }
        let Charged { of, energy, read } = self.charged(source)?;
        let FlowingCharge { capacitance, unit } = energy;
        let law = VoltageAcross { capacitance, unit };
        let vectors = read.map(|vector| Stencil::Mid.of(vector));
        self.law::<_, 6, 2, 0>(of.element(law, vectors, []))
    }

    /// Current of the source of electrodes behind a resistor; current or power of the source of a muscle behind one.
    pub(super) fn flow(&mut self, source: usize) -> Made {
        let is_current = matches!(self.quantity.what, What::Current(_));
        let unit = self.quantity.unit;
        if let Some(of) = self.electrodes(source).filter(|_| is_current) {
            let mut read = self.known.sought.read();
            let (potential, volts) = of.potential;
            let series = of.circuit.resistance?;
            let resistance = read.constant(Constant::Resistance(of.source), series);
            let law = PotentialDrop {
                unit: volts.into(),
                resistance: resistance.scaled(unit),
            };
            return self.law::<_, 2, 0, 2>(read.element(law, [], [of.input, potential]));
        }
        let voltage = [self.known.variables.input(source)?];
        let Charged {
            mut of,
            energy,
            read,
        } = self.charged(source)?;
        let current = SourceCurrent {
            capacitance: energy.capacitance,
            unit_of_charge: energy.unit,
            resistance: of.resistance()?,
            unit: unit.into(),
        };
        let vectors = read.map(|vector| Stencil::Mid.of(vector));
        match is_current {
            true => self.law(of.element(current, vectors, voltage)),
            false => self.law(of.element(SourcePower(current), vectors, voltage)),
        }
    }

    fn direct(&mut self, muscle: usize) -> Option<Direct<'k>> {
        let voltage = self.known.variables.input(muscle)?;
        let mut of = self.muscle(muscle);
        Some(Direct {
            capacitance: of.capacitance()?,
            of,
            span: self.span(muscle),
            voltage,
        })
    }

    fn charged(&mut self, muscle: usize) -> Option<Charged<'k>> {
        let charge = InternalKind::Charge(muscle);
        let charge = self.known.internals.vector(charge)?;
        let mut of = self.muscle(muscle);
        Some(Charged {
            energy: of.flowing_charge()?,
            of,
            read: [self.span(muscle), self.vectors.index(charge)],
        })
    }
}

impl Model {
    /// Sources that are loads of a force or torque that acts on what moves, each with its scalar of the intervals.
    pub fn working_loads(&self) -> Vec<(usize, usize)> {
        let sources = self.sources.iter().enumerate();
        let forces = sources.filter(|(_, source)| match source.kind {
            InputKind::Force | InputKind::Torque | InputKind::Traction | InputKind::BodyForce => {
                true
            }
            InputKind::Voltage | InputKind::SurfaceCharge | InputKind::Charge => false,
        });
        forces
            .filter_map(|(source, _)| Some((source, self.variables.input(source)?)))
            .collect()
    }

    /// Power in W of the load with a scalar, at places x of the vectors with their rates.
    pub fn load_power(&self, scalar: usize, [x, rates]: [&[Vector]; 2], scalars: &[f64]) -> f64 {
        let mut alone = vec![0.0; scalars.len()];
        alone[scalar] = scalars[scalar];
        // An interval of 1 ms with these places in its middle and these rates.
        let at =
            |part: f64| -> Vec<Vector> { x.iter().zip(rates).map(|(x, v)| x + v * part).collect() };
        let (a, b) = (at(-0.5), at(0.5));
        let sample = |vectors| Sample {
            vectors,
            ..Sample::of_instant(&a, &alone)
        };
        let power = |term: &dyn Term| match term.kind() {
            TermKind::AppliedWork => term.energy(&sample([&a, &b])),
            // The potential is linear in places.
            TermKind::Potential if term.name() == LOADS => {
                term.energy(&sample([&a, &a])) - term.energy(&sample([&b, &b]))
            }
            _ => 0.0,
        };
        let terms = self.action.intervals.terms.iter();
        terms.map(|term| power(term.as_ref())).sum()
    }
}
