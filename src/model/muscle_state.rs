//! Tension, electric field, current and power of a lumped muscle at a time.

use crate::coordinates::Configuration;
use crate::energy::Energy;
use crate::math::{Derivatives, Local, Vector};
use crate::model::charged::{ChargePlace, Charged};
use crate::model::circuit::Circuit;
use crate::model::components::{capacitance, muscle};
use crate::model::model::Model;
use crate::model::quantity::MEGAVOLT_PER_METRE;
use crate::model::system::{Fidelity, Muscle};
use nalgebra::SVector;

/// A lumped muscle whose state is read at times: a placed configuration with rates `w` of the vectors, and the scalars there.
#[derive(Clone, Debug)]
pub struct MuscleReading {
    /// Index of the muscle.
    pub muscle: usize,
    /// Coordinates of its Maxwell branches.
    branches: Vec<usize>,
    drive: Option<Drive>,
}

/// Origin of the voltage between the electrodes.
#[derive(Clone, Copy, Debug)]
enum Drive {
    /// The scalar of a source.
    Source(usize),
    /// The charge that flows through a circuit, with the scalar of its source where it is ever other than zero.
    Circuit(Charged, Option<usize>),
    /// A given charge.
    Charge(Charged),
}

/// Electrical state of a muscle with a source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceFlow {
    /// Current from the source in A.
    pub current: f64,
    /// Power of the source in W.
    pub power: f64,
}

impl Model {
    /// The lumped muscles.
    pub fn muscle_readings(&self) -> Vec<MuscleReading> {
        let lumped = self.system.muscles.iter().enumerate();
        let lumped = lumped.filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped);
        let readings = lumped.map(|(m, _)| MuscleReading {
            muscle: m,
            branches: self.branches_of(m),
            drive: self.drive(m),
        });
        readings.collect()
    }

    fn drive(&self, muscle: usize) -> Option<Drive> {
        let input = self.variables.input(muscle);
        let charged = self.charged().find(|charged| charged.muscle == muscle);
        match charged {
            Some(charged) => Some(match charged.place {
                ChargePlace::Coordinate(_) => Drive::Circuit(charged, input),
                ChargePlace::Input(_) => Drive::Charge(charged),
            }),
            None => input.map(Drive::Source),
        }
    }
}

impl MuscleReading {
    /// Returns true if there is a voltage between its electrodes, so that it has a field.
    pub fn has_voltage(&self) -> bool {
        self.drive.is_some()
    }

    /// Returns true if a source supplies its charge.
    pub fn has_source(&self) -> bool {
        matches!(self.drive, Some(Drive::Source(_) | Drive::Circuit(..)))
    }

    fn voltage(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> Option<f64> {
        let of = &model.system.muscles[self.muscle];
        Some(match self.drive? {
            Drive::Source(scalar) => of.voltage_at_rest(scalars[scalar]),
            Drive::Circuit(charged, _) | Drive::Charge(charged) => {
                charged.voltage(model, at, scalars)
            }
        })
    }

    /// Force in N with which it pulls its ends together: of elasticity, voltage, viscosity and Maxwell branches.
    pub fn tension(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> f64 {
        let (of, span) = (&model.system.muscles[self.muscle], model.spans[self.muscle]);
        let voltage = self.voltage(model, at, scalars);
        let viscous = self.branches.iter().map(|&coordinate| at.z[coordinate]);
        muscle::tension(of, [&at.x[span], &at.w[span]], voltage, viscous)
    }

    /// True electric field |V|/(t Λ) in V/µm; zero without a voltage.
    pub fn field(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> f64 {
        let of = &model.system.muscles[self.muscle];
        let stretch = at.x[model.spans[self.muscle]].norm() / of.length();
        let voltage = self.voltage(model, at, scalars).unwrap_or(0.0);
        voltage.abs() / (of.layer_thickness * stretch) / MEGAVOLT_PER_METRE
    }

    /// Current and power of its source while the voltage of the source is constant: `V ∂C/∂r·ṙ` with that through a leak, or
    /// `(V − Q/C)/R` through a resistor.
    pub fn flow(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> Option<SourceFlow> {
        let of = &model.system.muscles[self.muscle];
        let span = model.spans[self.muscle];
        let (voltage, current) = match self.drive? {
            Drive::Source(scalar) => {
                let voltage = scalars[scalar];
                let charging = voltage * capacitance_rate(of, [&at.x[span], &at.w[span]])?;
                let leak = of.circuit.as_ref().and_then(Circuit::leak_conductance);
                (voltage, leak.map_or(charging, |g| charging + g * voltage))
            }
            Drive::Circuit(charged, scalar) => {
                let voltage = scalar.map_or(0.0, |scalar| scalars[scalar]);
                let across = charged.voltage(model, at, scalars);
                (voltage, (voltage - across) / of.circuit?.resistance?)
            }
            Drive::Charge(_) => return None,
        };
        let power = voltage * current;
        Some(SourceFlow { current, power })
    }

    /// Current in A and power in W that charge it while its voltage changes at a rate, at a placed instant: `C V̇` and `C V V̇`; none through
    /// a resistor.
    pub fn charging(
        &self,
        model: &Model,
        at: &Configuration,
        [scalars, rates]: [&[f64]; 2],
    ) -> [f64; 2] {
        let Some(Drive::Source(scalar)) = self.drive else {
            return [0.0; 2];
        };
        let current = self.capacitance(model, at) * rates[scalar];
        [current, scalars[scalar] * current]
    }

    /// Charge and energy that the source supplies where its voltage switches, in mC and mJ, at a placed instant: `C (V₂ − V₁)` and
    /// `½ C (V₂² − V₁²)`; none through a resistor.
    pub fn switched(&self, model: &Model, at: &Configuration, scalars: [&[f64]; 2]) -> [f64; 2] {
        let Some(Drive::Source(scalar)) = self.drive else {
            return [0.0; 2];
        };
        let [before, after] = scalars.map(|scalars| scalars[scalar]);
        let charge = self.capacitance(model, at) * (after - before);
        [charge, 0.5 * charge * (after + before)]
    }

    fn capacitance(&self, model: &Model, at: &Configuration) -> f64 {
        let length = at.x[model.spans[self.muscle]].norm();
        let of = capacitance(&model.system.muscles[self.muscle]);
        of.map_or(0.0, |of| of.at_length(length))
    }
}

/// ∂C/∂r·ṙ in mC/(V ms) of a span and its rate.
fn capacitance_rate(muscle: &Muscle, [r, rate]: [&Vector; 2]) -> Option<f64> {
    let local = capacitance(muscle)?.at::<1>(r, &SVector::zeros());
    Some(local.plain::<1>().force(0).dot(rate))
}
