//! Costs of tensions, fields, currents, powers and rates of a control problem, along its motion.
//!
//! [`Control::minimise`] takes the same quantities at the end.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::functional::Stencil;
use crate::interface::control::Control;
use crate::interface::handle::Handle;
use crate::math::Signal;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{FieldPlace, Quantity};

/// A milliampere in A, and a V/µm in V/mm: units of costs.
const MILLIAMPERE: f64 = 1e-3;
const VOLT_PER_MICROMETRE: f64 = 1e3;

impl Control {
    /// The tension of a lumped muscle follows a function of time in N: minimises ∫ (T − r)² dt in N² s, with a weight.
    pub fn track_tension(
        self,
        muscle: Handle<Muscle>,
        along: impl Into<Signal>,
        weight: f64,
    ) -> Self {
        let muscle = muscle.index();
        self.measured(
            Quantity::Tension { muscle, unit: 1.0 },
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
        let joint = joint.index();
        self.measured(
            Quantity::JointStep { joint, h: 1.0 },
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
        let (muscle, unit) = (muscle.index(), MILLIAMPERE);
        self.measured(
            Quantity::SourceCurrent { muscle, unit },
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
        let muscle = muscle.index();
        self.measured(
            Quantity::SourcePower { muscle, unit: 1.0 },
            Some(along.into()),
            weight,
        )
    }

    /// Minimises ∫ |v|² dt of the velocity of a marker in m²/s, with a weight.
    pub fn low_speed(self, marker: Handle<Marker>, weight: f64) -> Self {
        let (marker, limit) = (marker.index(), 1.0);
        self.measured(Quantity::SquaredSpeed { marker, limit }, None, weight)
    }

    /// Minimises ∫ E² dt of the true electric field of a lumped muscle without a resistor in (V/µm)² s, with a weight.
    pub fn low_field(self, muscle: Handle<Muscle>, weight: f64) -> Self {
        let quantity = Quantity::SquaredField {
            place: FieldPlace::Muscle(muscle.index()),
            limit: VOLT_PER_MICROMETRE,
            at: Stencil::Mid,
        };
        self.measured(quantity, None, weight)
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
