//! Path limits of a problem: bounds of quantities along the motion, or at a single time.

use crate::math::Vector;
use crate::model::system::Muscle;
use crate::model::{Amount, Reaction, Region, System};
use std::sync::Arc;

/// An inequality that holds at every instant or in every interval.
#[derive(Clone, Debug, PartialEq)]
pub enum PathConstraint {
    /// Joint coordinate (rad or mm).
    JointAngle {
        /// Joint index.
        joint: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Mean rate of a joint coordinate in each interval (rad/ms or mm/ms).
    JointRate {
        /// Joint index.
        joint: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Stretch Λ of a muscle at the instants.
    Stretch {
        /// Muscle index.
        muscle: usize,
        /// Lower bound or 0.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Force in N with which a lumped muscle pulls its ends together, in the middle of the intervals.
    Tension {
        /// Muscle index.
        muscle: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// True electric field |V|/(t Λ) of a lumped muscle, in the intervals and at the instants; behind a resistor, where V follows from
    /// the charge, at the instants.
    ElectricField {
        /// Muscle index.
        muscle: usize,
        /// Breakdown value in V/mm.
        max: f64,
    },
    /// Component, along a direction of the ground frame, of the force in N from the parent of a joint on its child, or of the torque in N mm
    /// about the point of the joint, at the instants between intervals.
    Reaction {
        /// Joint index.
        joint: usize,
        /// Force or torque.
        of: Reaction,
        /// Unit vector.
        along: Vector,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Size in mm/ms of the mean velocity of a marker in each interval.
    MarkerSpeed {
        /// Marker index.
        marker: usize,
        /// Lower bound or 0.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// True electric field |F⁻ᵀE| in the finite elements of a block, at centres and Gauss points, in the intervals and at
    /// the instants.
    BlockField {
        /// Block: those of the scene, then those of the muscles of finite elements.
        block: usize,
        /// Region of its mesh; all elements where there is none.
        region: Option<usize>,
        /// Breakdown value in V/mm.
        max: f64,
    },
    /// Current of the source of a lumped muscle in A: behind a resistor its mean in each interval, otherwise that between the middles of
    /// neighbouring intervals.
    Current {
        /// Muscle index.
        muscle: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Power of the source of a lumped muscle in W, at the times of a current.
    Power {
        /// Muscle index.
        muscle: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Rate of the voltage of a source in V/ms between the middles of neighbouring intervals.
    VoltageRate {
        /// Source index.
        source: usize,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Voltage of a source no larger than a sought parameter in the intervals.
    PeakVoltage {
        /// Source index.
        source: usize,
        /// Index of the parameter.
        parameter: usize,
        /// Unit of voltages in V.
        unit: f64,
    },
    /// Volume in mm³ or mass in g of lumped muscles at rest, together.
    OfMuscles {
        /// Muscle indices.
        muscles: Arc<[usize]>,
        /// Volume or mass.
        amount: Amount,
        /// Lower bound or −∞.
        min: f64,
        /// Upper bound or ∞.
        max: f64,
    },
    /// Another one at a single time: at the instant nearest to a part of the duration, or in the interval before it.
    Once {
        /// Part of the duration, above 0 and at most 1, the end.
        part: f64,
        /// The limit.
        limit: Box<Self>,
    },
    /// A marker relative to a region at the instants.
    Marker {
        /// Marker index.
        marker: usize,
        /// Region.
        region: Region,
        /// Inside or outside.
        side: Side,
    },
}

impl PathConstraint {
    /// The same at a single time.
    #[must_use]
    pub fn at_part(self, part: f64) -> Self {
        let limit = Box::new(self);
        Self::Once { part, limit }
    }

    /// The limit by itself, and the part of the duration at which alone it holds.
    pub(super) fn with_part(&self) -> (&Self, Option<f64>) {
        match self {
            Self::Once { part, limit } => (limit, Some(*part)),
            limit => (limit, None),
        }
    }

    /// Returns true if it bounds what is the same constant in two systems that differ: the amount of muscles of one shape and density.
    pub(super) fn is_as_in(&self, one: &System, other: &System) -> bool {
        let shape = |muscle: &Muscle| {
            let of = (muscle.from, muscle.to, muscle.cross_section);
            (of, muscle.prestretch, muscle.material.density)
        };
        let Self::OfMuscles { muscles, .. } = self else {
            return false;
        };
        let of = |system: &System, m: usize| system.muscles.get(m).map(shape);
        let mut muscles = muscles.iter();
        muscles.all(|&m| of(one, m) == of(other, m))
    }

    /// The source of whose current or power it is a limit.
    pub(super) fn source(&self) -> Option<usize> {
        match *self.with_part().0 {
            Self::Current { muscle, .. } | Self::Power { muscle, .. } => Some(muscle),
            _ => None,
        }
    }
}

/// Side of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Inside.
    Inside,
    /// Outside.
    Outside,
}
