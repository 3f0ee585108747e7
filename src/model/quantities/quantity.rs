//! Quantities that a problem may bound, follow, minimise or record: what is measured, at what time, and what of it.

use crate::model::quantities::what::{
    At, FieldPlace, Of, Pulling, Reaction, Region, What, joint_unit,
};
use crate::model::system::System;
use std::f64::consts::TAU;

/// A quantity at some times.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Measured variable.
    pub what: What,
    /// Time at which it is read.
    pub at: At,
    /// Its value, or a step of it.
    pub of: Of,
    /// Unit in which it is measured: a jump is measured in its own unit, of which the row is in this one.
    pub unit: f64,
    /// Length of the intervals in ms by which steps are rates, for messages.
    pub h: Option<f64>,
}

/// V/mm in a V/µm.
pub(crate) const MEGAVOLT_PER_METRE: f64 = 1e3;
/// A milliampere in A.
pub const MILLIAMPERE: f64 = 1e-3;

impl Quantity {
    /// The value of what is measured, at the time that is its own, in its unit inside.
    pub fn of(what: What) -> Self {
        Self {
            at: what.time(),
            what,
            of: Of::Value,
            unit: 1.0,
            h: None,
        }
    }

    /// The step within intervals of h ms.
    pub fn step(what: What, h: f64) -> Self {
        Self {
            at: At::Middle,
            of: Of::Step,
            h: Some(h),
            ..Self::of(what)
        }
    }

    /// The step from the interval before to an interval of h ms, whose rows are in a unit.
    pub fn jump(what: What, unit: f64, h: f64) -> Self {
        Self {
            of: Of::Jump,
            unit,
            h: Some(h),
            ..Self::of(what)
        }
    }

    /// The same at another time.
    #[must_use]
    pub fn at(self, at: At) -> Self {
        Self { at, ..self }
    }

    /// The same in a unit.
    #[must_use]
    pub fn in_unit(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// The coordinate of a joint.
    pub fn joint(joint: usize, near: f64) -> Self {
        Self::of(What::Joint { joint, near })
    }

    /// Rate of the coordinate of a joint.
    pub fn joint_rate(joint: usize) -> Self {
        Self::step(What::Joint { joint, near: 0.0 }, 1.0)
    }

    /// A component of the place of a marker in mm at the instants.
    pub fn marker_place(marker: usize, axis: usize) -> Self {
        Self::of(What::Place { marker, axis })
    }

    /// Mean force in N in the intervals with which a part pulls its ends together.
    pub fn tension(part: Pulling) -> Self {
        Self::of(What::Tension(part))
    }

    /// Current of the source of a muscle behind a resistor in mA.
    pub fn current(muscle: usize) -> Self {
        Self::of(What::Current(muscle)).in_unit(MILLIAMPERE)
    }

    /// Power of the source of a muscle behind a resistor in W.
    pub fn power(muscle: usize) -> Self {
        Self::of(What::Power(muscle))
    }

    /// Squared field of a lumped muscle in (V/µm)², of one behind a resistor at the instants.
    pub fn squared_field(muscle: usize, is_behind_resistor: bool) -> Self {
        let what = match is_behind_resistor {
            true => What::ChargedField(muscle),
            false => What::Field(FieldPlace::Muscle(muscle)),
        };
        Self::of(what).in_unit(MEGAVOLT_PER_METRE)
    }

    /// Squared speed of a marker in (m/s)².
    pub fn squared_speed(marker: usize) -> Self {
        Self::of(What::Speed(marker))
    }

    /// Unit of its values; none of a ratio.
    pub fn unit(&self, system: &System) -> &'static str {
        self.what.unit(self.of, system)
    }

    /// Name of a quantity that a cost names, such as `muscle1_tension`; none of places and joint coordinates.
    pub fn column(&self, system: &System) -> Option<String> {
        let column = self.what.column(self.of)?;
        let &(kind, index) = self.what.parts().first()?;
        Some(format!("{}_{column}", kind.names(system)[index]))
    }

    /// Returns a value as shown to users: a coordinate, stretch, field or distance, and its unit.
    pub fn plain(&self, value: f64, system: &System) -> (f64, &'static str) {
        let (size, per_time) = (value * self.unit, value * self.unit / self.h.unwrap_or(1.0));
        match (&self.what, self.of) {
            (What::Stretch(_), _) => (value.sqrt(), ""),
            (What::Joint { joint, .. }, Of::Step) => match joint_unit(system, *joint) {
                "mm" => (per_time, "m/s"),
                _ => (1e3 * value / self.h.unwrap_or(1.0), "rad/s"),
            },
            (What::Field(_) | What::ChargedField(_), _) => {
                (value.sqrt() * self.unit / MEGAVOLT_PER_METRE, "V/um")
            }
            (What::Speed(_), _) => (value.sqrt() * self.unit, "m/s"),
            (What::Current(_), _) => (1e3 * value * self.unit, "mA"),
            (What::Power(_), _) => (size, "W"),
            (What::Tension(_) | What::ContactForce(_), _) => (size, "N"),
            (What::Voltage(_), _) => (per_time, "kV/s"),
            (What::MeanCharge(_), Of::Jump) => {
                (1e3 * value * self.unit / self.h.unwrap_or(1.0), "mA")
            }
            (What::Energy(_), _) => (per_time, "W"),
            (What::Reaction { of, .. }, _) => match of {
                Reaction::Force => (per_time, "N"),
                Reaction::Torque => (per_time, "N mm"),
            },
            (What::Amount { amount, .. }, _) => {
                let (name, one) = amount.unit();
                (size / one, name)
            }
            (What::Region { region, .. }, _) => match region {
                Region::Sphere { radius, .. } => (value.sqrt() * radius, "mm from its centre"),
                Region::Box { .. } => (value.powf(1.0 / 16.0), "half edges from its centre"),
            },
            _ => (value, self.unit(system)),
        }
    }

    /// The source whose current or power it is, behind a resistor.
    pub fn source(&self) -> Option<usize> {
        match self.what {
            What::Current(source) | What::Power(source) => Some(source),
            _ => None,
        }
    }

    /// Returns the period of its values: a full turn of an angle.
    pub fn period(&self, system: &System) -> Option<f64> {
        match self.what {
            What::Joint { joint, .. } if self.of == Of::Value => {
                (joint_unit(system, joint) == "rad").then_some(TAU)
            }
            _ => None,
        }
    }

    /// Returns true if it is measured in the intervals rather than at the instants.
    pub fn is_of_intervals(&self) -> bool {
        self.at != At::Instant
    }

    /// Returns true if it is read from the inputs of an interval, and of a state of rest under them as well; one of three of a field.
    pub fn is_of_held_inputs(&self) -> bool {
        match self.what {
            What::Field(_) => self.at == At::Start,
            What::Current(_)
            | What::Power(_)
            | What::Tension(_)
            | What::MeanCharge(_)
            | What::ElectrodeVoltage(_) => self.of == Of::Value,
            _ => false,
        }
    }

    /// Returns true if its values are steps within intervals, whose rates they are over the length of the interval.
    pub fn is_step(&self) -> bool {
        self.of == Of::Step
    }

    /// The same quantity evaluated at interval ends, so that it may depend on free parameters; `None` if unsupported.
    pub fn in_intervals(&self, at: At) -> Option<Self> {
        match self.what {
            What::Stretch(_) | What::ChargedField(_) | What::Place { .. } | What::Region { .. }
                if self.of == Of::Value =>
            {
                Some(self.clone().at(at))
            }
            _ => None,
        }
    }

    /// Returns the noun of its time, in front of the number of the instant or interval.
    pub fn when(&self) -> &'static str {
        let is_field = matches!(self.what, What::Field(_));
        match (self.of, self.at) {
            (Of::Jump, _) => "before interval",
            (Of::Step, _) => "in interval",
            (Of::Value, At::Start) if is_field => "at the start of interval",
            (Of::Value, At::Middle) if is_field => "in the middle of interval",
            (Of::Value, At::Middle) => "in interval",
            (Of::Value, At::End) => "at the end of interval",
            (Of::Value, At::Instant | At::Start) => "at instant",
        }
    }

    /// The quantity that is subtracted in the interval before, where steps between intervals are limited.
    pub fn before(&self) -> Option<Self> {
        let at = match self.at {
            At::Start => At::End,
            At::End => At::Start,
            at => at,
        };
        (self.of == Of::Jump).then(|| self.clone().at(at))
    }

    /// The same with another length of the intervals in ms in messages.
    #[must_use]
    pub fn with_interval(mut self, length: f64) -> Self {
        self.h = self.h.and(Some(length));
        self
    }

    /// Length of the intervals in ms by which a step is a rate.
    pub fn interval(&self) -> Option<f64> {
        self.h
    }

    /// Factor of the rate in its plain unit over the step per ms, of a step within an interval.
    pub fn rate_factor(&self, system: &System) -> Option<f64> {
        match (&self.what, self.of) {
            (What::Joint { joint, .. }, Of::Step) => Some(match joint_unit(system, *joint) {
                "mm" => 1.0,
                _ => 1e3,
            }),
            _ => None,
        }
    }

    /// Unit in which the steps of the quantity between intervals are rows.
    pub fn step_unit(&self) -> f64 {
        match self.of {
            Of::Jump => self.unit,
            Of::Value | Of::Step => 1.0,
        }
    }
}
