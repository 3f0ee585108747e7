//! Measures of charges and sources: behind resistors the charge, its voltage and field, current and power; otherwise charge and energy under the
//! voltage.

use crate::energy::{
    Capacitance, Coefficient, FlowingCharge, FlowingChargeField, Law, MeanCharge, Multiple,
    PositionComponent, PotentialDrop, SourceCurrent, SourcePower, StoredEnergy, VoltageAcross,
};
use crate::functional::{Measure, Sample, Stencil, Term, TermKind, VectorArg};
use crate::kinematics::Vectors;
use crate::math::Vector;
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::{MuscleConstants, charge_field};
use crate::model::constants::constant::Constant;
use crate::model::layout::internal::InternalKind;
use crate::model::model::Model;
use crate::model::quantities::measures::{Known, Shape, instant, interval};
use crate::model::quantities::quantity::Quantity;
use crate::model::quantities::what::{At, What};
use crate::model::system::InputKind;
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::terms::loads::LOADS;

/// A muscle behind a resistor: its constants, the electric energy of its charge, and the vectors of its span and of its charge.
struct Charged<'a> {
    of: MuscleConstants<'a>,
    energy: FlowingCharge<Coefficient>,
    read: [usize; 2],
}

impl Known<'_> {
    /// The measure of a quantity of a muscle and its source.
    pub(crate) fn of_charge(
        &self,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let (unit, at) = (quantity.unit, quantity.at.stencil());
        Some(match quantity.what {
            What::ChargedField(muscle) => {
                let Charged {
                    of,
                    energy,
                    read: [span, charge],
                } = self.charged(muscle, vectors)?;
                let field = FlowingChargeField {
                    field: charge_field(energy.capacitance, unit),
                    unit: energy.unit,
                };
                match quantity.at {
                    At::Instant => instant(shape, field.formula(&[]), [span, charge]),
                    _ => shape.law(of.element(field, [at.of(span), at.of(charge)], [])),
                }
            }
            What::Charge(source) => return self.charge(source, shape, vectors),
            What::ElectrodeVoltage(source) => return self.across(source, shape, vectors),
            What::Current(source) => {
                if let Some(of) = self.electrodes(source) {
                    return self.electrode_current(of, unit, shape);
                }
                let (of, current, read, voltage) = self.source_current(source, unit, vectors)?;
                shape.law(of.element(current, read, [voltage]))
            }
            What::Power(muscle) => {
                let (of, current, read, voltage) = self.source_current(muscle, unit, vectors)?;
                shape.law(of.element(SourcePower(current), read, [voltage]))
            }
            What::MeanCharge(muscle) => {
                let (of, capacitance, span, voltage) = self.direct(muscle, vectors)?;
                let ends = [Stencil::Here, Stencil::Next].map(|at| at.of(span));
                shape.law(of.element(MeanCharge(capacitance), ends, [voltage]))
            }
            What::Energy(muscle) => {
                let (of, capacitance, span, voltage) = self.direct(muscle, vectors)?;
                shape.law(of.element(StoredEnergy(capacitance), [at.of(span)], [voltage]))
            }
            _ => return None,
        })
    }

    /// The electrodes behind a resistor that a source charges.
    fn electrodes(&self, source: usize) -> Option<&ElectrodeCircuit> {
        self.circuits.iter().find(|of| of.source == source)
    }

    /// Charge behind the resistor of a source in mC.
    fn charge(
        &self,
        source: usize,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let charge = self.internals.vector(InternalKind::Charge(source))?;
        let unit = match self.electrodes(source) {
            Some(of) => of.unit_of_charge,
            None => capacitance(&self.system.muscles[source])?.unit_of_charge(),
        };
        let (origin, normal) = (Vector::zeros(), Vector::x() * unit);
        let component = PositionComponent { origin, normal };
        Some(instant(shape, component, [vectors.index(charge)]))
    }

    /// Voltage of the electrodes behind the resistor of a source.
    fn across(
        &self,
        source: usize,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        if let Some(of) = self.electrodes(source) {
            let (potential, volts) = of.potential;
            let multiple = Multiple { unit: 1.0 / volts };
            return Some(interval::<_, 1, 0, 1>(shape, multiple, [], [potential]));
        }
        let Charged {
            of,
            energy,
            read: vectors,
            ..
        } = self.charged(source, vectors)?;
        let FlowingCharge { capacitance, unit } = energy;
        let law = VoltageAcross { capacitance, unit };
        let vectors = vectors.map(|vector| Stencil::Mid.of(vector));
        Some(shape.law::<_, 6, 2, 0>(of.element(law, vectors, [])))
    }

    /// Current of the source of electrodes behind a resistor in a unit.
    fn electrode_current(
        &self,
        of: &ElectrodeCircuit,
        unit: f64,
        shape: Shape,
    ) -> Option<Box<dyn Measure>> {
        let mut read = self.sought.read();
        let (potential, volts) = of.potential;
        let series = of.circuit.resistance?;
        let resistance = read.constant(Constant::Resistance(of.source), series);
        let law = PotentialDrop {
            unit: volts.into(),
            resistance: resistance.scaled(unit),
        };
        Some(shape.law::<_, 2, 0, 2>(read.element(law, [], [of.input, potential])))
    }

    /// A muscle without a resistor: its constants and capacitance, the vector of its span, and the scalar of its voltage.
    fn direct(
        &self,
        muscle: usize,
        vectors: &mut Vectors,
    ) -> Option<(MuscleConstants<'_>, Capacitance<Coefficient>, usize, usize)> {
        let voltage = self.variables.input(muscle)?;
        let mut of = self.muscle(muscle, vectors);
        let capacitance = of.capacitance()?;
        Some((of, capacitance, self.span(muscle, vectors), voltage))
    }

    /// A muscle behind a resistor.
    fn charged(&self, muscle: usize, vectors: &mut Vectors) -> Option<Charged<'_>> {
        let charge = self.internals.vector(InternalKind::Charge(muscle))?;
        let mut of = self.muscle(muscle, vectors);
        let energy = of.flowing_charge()?;
        Some(Charged {
            of,
            energy,
            read: [self.span(muscle, vectors), vectors.index(charge)],
        })
    }

    /// The current of the source of a muscle behind a resistor in a unit, its vectors and the scalar of its voltage.
    fn source_current(
        &self,
        muscle: usize,
        unit: f64,
        vectors: &mut Vectors,
    ) -> Option<(
        MuscleConstants<'_>,
        SourceCurrent<Coefficient>,
        [VectorArg; 2],
        usize,
    )> {
        let voltage = self.variables.input(muscle)?;
        let Charged {
            mut of,
            energy,
            read: vectors,
        } = self.charged(muscle, vectors)?;
        let current = SourceCurrent {
            capacitance: energy.capacitance,
            unit_of_charge: energy.unit,
            resistance: of.resistance()?,
            unit: unit.into(),
        };
        let vectors = vectors.map(|vector| Stencil::Mid.of(vector));
        Some((of, current, vectors, voltage))
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
