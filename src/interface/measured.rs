//! Costs of tensions, fields, currents, powers and rates of a control problem, along its motion.
//!
//! [`Control::minimise`] takes the same quantities at the end.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::interface::control::Control;
use crate::interface::handle::Handle;
use crate::math::Signal;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{Pulling, Quantity};

impl Control {
    /// The tension of a lumped muscle follows a function of time in N: minimises ∫ (T − r)² dt in N² s, with a weight.
    pub fn track_tension(
        self,
        muscle: Handle<Muscle>,
        along: impl Into<Signal>,
        weight: f64,
    ) -> Self {
        self.measured(
            Quantity::tension(Pulling::Muscle(muscle.index())),
            Some(along.into()),
            weight,
        )
    }

    /// The rate of the coordinate of a joint follows a function of time in rad/s or m/s: minimises ∫ (ω − r)² dt, with a weight.
    pub fn track_joint_rate(
        self,
        joint: Handle<Joint>,
        along: impl Into<Signal>,
        weight: f64,
    ) -> Self {
        self.measured(
            Quantity::joint_rate(joint.index()),
            Some(along.into()),
            weight,
        )
    }

    /// The current of the source of a muscle behind a resistor follows a function of time in mA: minimises ∫ (I − r)² dt in mA² s, with a weight.
    pub fn track_current(
        self,
        muscle: Handle<Muscle>,
        along: impl Into<Signal>,
        weight: f64,
    ) -> Self {
        self.measured(
            Quantity::current(muscle.index()),
            Some(along.into()),
            weight,
        )
    }

    /// The power of the source of a muscle behind a resistor follows a function of time in W: minimises ∫ (P − r)² dt in W² s, with a weight.
    pub fn track_power(
        self,
        muscle: Handle<Muscle>,
        along: impl Into<Signal>,
        weight: f64,
    ) -> Self {
        self.measured(Quantity::power(muscle.index()), Some(along.into()), weight)
    }

    /// Minimises ∫ |v|² dt of the velocity of a marker in m²/s, with a weight.
    pub fn low_speed(self, marker: Handle<Marker>, weight: f64) -> Self {
        self.measured(Quantity::squared_speed(marker.index()), None, weight)
    }

    /// Minimises ∫ E² dt of the true electric field of a lumped muscle without a resistor in (V/µm)² s, with a weight.
    pub fn low_field(self, muscle: Handle<Muscle>, weight: f64) -> Self {
        self.measured(Quantity::squared_field(muscle.index(), false), None, weight)
    }

    fn measured(self, quantity: Quantity, along: Option<Signal>, weight: f64) -> Self {
        let function = match along {
            Some(reference) => CostFunction::Square { reference },
            None => CostFunction::Itself,
        };
        self.minimise(QuantityCost {
            quantity,
            weight,
            function,
            during: During::Motion,
        })
    }
}
