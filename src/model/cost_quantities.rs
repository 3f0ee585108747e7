//! Quantities that costs name, in the units of their costs: N, mA, W, V/µm, m/s.

use crate::functional::Stencil;
use crate::model::quantity::{FieldPlace, MEGAVOLT_PER_METRE, Quantity};

/// A milliampere in A.
pub const MILLIAMPERE: f64 = 1e-3;

impl Quantity {
    /// Tension of a lumped muscle in N.
    pub fn tension(muscle: usize) -> Self {
        Self::Tension { muscle, unit: 1.0 }
    }

    /// Current of the source of a muscle behind a resistor in mA.
    pub fn current(muscle: usize) -> Self {
        let unit = MILLIAMPERE;
        Self::SourceCurrent { muscle, unit }
    }

    /// Power of the source of a muscle behind a resistor in W.
    pub fn power(muscle: usize) -> Self {
        Self::SourcePower { muscle, unit: 1.0 }
    }

    /// Squared field of a lumped muscle in (V/µm)², of one behind a resistor at the instants.
    pub fn squared_field(muscle: usize, is_behind_resistor: bool) -> Self {
        let limit = MEGAVOLT_PER_METRE;
        match is_behind_resistor {
            true => Self::ChargedField {
                muscle,
                limit,
                at: None,
            },
            false => Self::SquaredField {
                place: FieldPlace::Muscle(muscle),
                limit,
                at: Stencil::Mid,
            },
        }
    }

    /// Rate of the coordinate of a joint.
    pub fn joint_rate(joint: usize) -> Self {
        Self::JointStep { joint, h: 1.0 }
    }

    /// Squared speed of a marker in (m/s)².
    pub fn squared_speed(marker: usize) -> Self {
        let limit = 1.0;
        Self::SquaredSpeed { marker, limit }
    }
}
