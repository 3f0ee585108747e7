//! Quantities that a problem may bound or prescribe, at the instants or in the intervals.

use crate::functional::Stencil;
use crate::math::Vector;
use crate::model::system::{Amount, JointKind, System};
use crate::model::variables::Size;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Something to measure.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Coordinate of a revolute joint (rad, in the branch nearest to `near`) or prismatic joint (mm), at the instants.
    Joint {
        /// Joint index.
        joint: usize,
        /// Branch of an angle.
        near: f64,
    },
    /// Step of the coordinate of a revolute joint (rad, at most half a turn) or prismatic joint (mm) in an interval.
    JointStep {
        /// Joint index.
        joint: usize,
        /// Length of the interval in ms, for messages.
        h: f64,
    },
    /// Squared stretch Λ² of a muscle at the instants.
    SquaredStretch {
        /// Muscle index.
        muscle: usize,
        /// Start or end of the intervals, `Here` or `Next`, for one that reads a sought constant, which belongs to intervals.
        at: Option<Stencil>,
    },
    /// Capacitance of a lumped muscle in mC/V at the instants.
    Capacitance {
        /// Muscle index.
        muscle: usize,
    },
    /// (|e|/E)² of the true field e under the voltages of an interval.
    SquaredField {
        /// Place where it is read.
        place: FieldPlace,
        /// E in V/mm.
        limit: f64,
        /// At the start, in the middle or at the end of the interval: `Here`, `Mid` or `Next`.
        at: Stencil,
    },
    /// (|e|/E)² of the true field e of a muscle behind a resistor, at the instants.
    ChargedField {
        /// Muscle index.
        muscle: usize,
        /// E in V/mm.
        limit: f64,
        /// Same as `SquaredStretch::at`.
        at: Option<Stencil>,
    },
    /// Current of the source of a muscle, or of electrodes, behind a resistor in the middle of the intervals.
    SourceCurrent {
        /// Index of the muscle or source.
        muscle: usize,
        /// Unit in A.
        unit: f64,
    },
    /// Power of the source of a muscle behind a resistor in the middle of the intervals.
    SourcePower {
        /// Muscle index.
        muscle: usize,
        /// Unit in W.
        unit: f64,
    },
    /// Force with which a lumped muscle pulls its ends together, in the middle of the intervals.
    Tension {
        /// Muscle index.
        muscle: usize,
        /// Unit in N.
        unit: f64,
    },
    /// Impulse in N ms with which a part pulls its ends together in an interval.
    PullStep(Pulling),
    /// Charge in mC of a muscle or of electrodes behind the resistor of a source, at the instants.
    Charge {
        /// Source index.
        source: usize,
    },
    /// Mean charge `½ (C_k + C_{k+1}) V` in mC of a lumped muscle under the voltage of its source in the intervals.
    MeanCharge {
        /// Muscle index.
        muscle: usize,
    },
    /// Voltage in V of the electrodes behind the resistor of a source, in the middle of the intervals.
    ElectrodeVoltage {
        /// Source index.
        source: usize,
    },
    /// Voltage of a source in V in the intervals, of which the steps between them are limited.
    VoltageStep {
        /// Source index.
        source: usize,
        /// Unit of the steps in V.
        unit: f64,
        /// Length of the interval in ms, for messages.
        h: f64,
    },
    /// Mean charge `½ (C_k + C_{k+1}) V` in mC of a lumped muscle under the voltage of its source in the intervals, of which the steps between
    /// them are limited.
    ChargeStep {
        /// Muscle index.
        muscle: usize,
        /// Unit of the steps in mC.
        unit: f64,
        /// Length of the interval in ms, for messages.
        h: f64,
    },
    /// Stored energy `½ C V²` in mJ of a lumped muscle under the voltage of its source, of which the step from the start of the interval before to
    /// the end of an interval is limited.
    EnergyStep {
        /// Muscle index.
        muscle: usize,
        /// At the start or at the end of the interval: `Here` or `Next`.
        at: Stencil,
        /// Unit of the steps in mJ.
        unit: f64,
        /// Length of the interval in ms, for messages.
        h: f64,
    },
    /// Impulse of a joint along a direction in N ms, or its moment about the joint in N mm ms: at the start of an interval, or minus that at its
    /// end, so that the step from one interval to the next is the whole impulse at the instant between them, which is limited.
    ReactionStep {
        /// Joint index.
        joint: usize,
        /// The impulse of its force or of its torque.
        of: Reaction,
        /// Unit vector of the ground frame.
        along: Vector,
        /// At the start or at the end of the interval: `Here` or `Next`.
        at: Stencil,
        /// Unit of the steps in N ms or N mm ms.
        unit: f64,
        /// Length of the interval in ms, for messages.
        h: f64,
    },
    /// A component of the place of a marker in mm at the instants.
    MarkerPlace {
        /// Marker index.
        marker: usize,
        /// Component 0, 1 or 2.
        axis: usize,
        /// Same as `SquaredStretch::at`.
        at: Option<Stencil>,
    },
    /// Step of a component of the place of a marker in an interval, in mm.
    MarkerStep {
        /// Marker index.
        marker: usize,
        /// Component 0, 1 or 2.
        axis: usize,
    },
    /// (|v|/u)² of the mean velocity v of a marker in an interval.
    SquaredSpeed {
        /// Marker index.
        marker: usize,
        /// u in mm/ms.
        limit: f64,
    },
    /// a·b of a direction a fixed to a body and a direction b, at the instants.
    Direction {
        /// Body index.
        body: usize,
        /// a in the reference configuration, a unit vector of the ground frame.
        axis: Vector,
        /// b, a unit vector of the ground frame.
        along: Vector,
    },
    /// A sought parameter that bounds voltages, in kV, in the intervals.
    PeakVoltage {
        /// Index of the parameter.
        parameter: usize,
    },
    /// (V² − s²)/u² of the voltage V of a source and a sought parameter s, in the intervals.
    PeakExcess {
        /// Source index.
        source: usize,
        /// Index of the parameter.
        parameter: usize,
        /// u in V.
        unit: f64,
    },
    /// Volume or mass of lumped muscles at rest, together, which follows from constants alone.
    OfMuscles {
        /// Muscle indices.
        muscles: Arc<[usize]>,
        /// Volume or mass.
        amount: Amount,
        /// Unit in mm³ or g.
        unit: f64,
    },
    /// (|x − c|/r)² of a marker for a ball, Σ ((x − c)_i/a_i)¹⁶ for a box, at the instants.
    MarkerRegion {
        /// Marker index.
        marker: usize,
        /// The region.
        region: Region,
        /// As of a stretch.
        at: Option<Stencil>,
    },
}

/// V/mm in a V/µm.
pub(super) const MEGAVOLT_PER_METRE: f64 = 1e3;

impl Quantity {
    /// A component of the place of a marker in mm at the instants.
    pub fn marker_place(marker: usize, axis: usize) -> Self {
        let at = None;
        Self::MarkerPlace { marker, axis, at }
    }

    /// Unit of its values; none of a ratio.
    pub fn unit(&self, system: &System) -> &'static str {
        match *self {
            Self::Joint { joint, .. } | Self::JointStep { joint, .. } => joint_unit(system, joint),
            Self::Capacitance { .. } => "mF",
            Self::MarkerPlace { .. } | Self::MarkerStep { .. } => "mm",
            Self::PeakVoltage { .. } => "kV",
            Self::PullStep(_) => "N ms",
            Self::Charge { .. } | Self::MeanCharge { .. } => "mC",
            Self::ElectrodeVoltage { .. } => "V",
            Self::SquaredStretch { .. }
            | Self::SquaredField { .. }
            | Self::SquaredSpeed { .. }
            | Self::ChargedField { .. }
            | Self::SourceCurrent { .. }
            | Self::SourcePower { .. }
            | Self::Tension { .. }
            | Self::VoltageStep { .. }
            | Self::ChargeStep { .. }
            | Self::EnergyStep { .. }
            | Self::ReactionStep { .. }
            | Self::PeakExcess { .. }
            | Self::Direction { .. }
            | Self::MarkerRegion { .. } => "",
            Self::OfMuscles { amount, .. } => amount.unit().0,
        }
    }

    /// Name of a quantity that a cost names, such as `muscle1_tension`; none of places and joint coordinates.
    pub fn column(&self, system: &System) -> Option<String> {
        let of_muscle = |muscle: usize| &system.muscles[muscle].name;
        let (name, what) = match *self {
            Self::Tension { muscle, .. } => (of_muscle(muscle), "tension"),
            Self::ChargedField { muscle, .. }
            | Self::SquaredField {
                place: FieldPlace::Muscle(muscle),
                ..
            } => (of_muscle(muscle), "field"),
            Self::SourceCurrent { muscle, .. } => (of_muscle(muscle), "current"),
            Self::SourcePower { muscle, .. } => (of_muscle(muscle), "power"),
            Self::JointStep { joint, .. } => (&system.joints[joint].name, "rate"),
            Self::SquaredSpeed { marker, .. } => (&system.markers[marker].name, "speed"),
            _ => return None,
        };
        Some(format!("{name}_{what}"))
    }

    /// Returns a value as shown to users: a coordinate, stretch, field or distance, and its unit.
    pub fn plain(&self, value: f64, system: &System) -> (f64, &'static str) {
        match *self {
            Self::SquaredStretch { .. } => (value.sqrt(), ""),
            Self::JointStep { joint, h } => match joint_unit(system, joint) {
                "mm" => (value / h, "m/s"),
                _ => (1e3 * value / h, "rad/s"),
            },
            Self::SquaredField { limit, .. } | Self::ChargedField { limit, .. } => {
                (value.sqrt() * limit / MEGAVOLT_PER_METRE, "V/um")
            }
            Self::SquaredSpeed { limit, .. } => (value.sqrt() * limit, "m/s"),
            Self::SourceCurrent { unit, .. } => (1e3 * value * unit, "mA"),
            Self::SourcePower { unit, .. } => (value * unit, "W"),
            Self::Tension { unit, .. } => (value * unit, "N"),
            Self::VoltageStep { unit, h, .. } => (value * unit / h, "kV/s"),
            Self::ChargeStep { unit, h, .. } => (1e3 * value * unit / h, "mA"),
            Self::EnergyStep { unit, h, .. } => (value * unit / h, "W"),
            Self::ReactionStep { of, unit, h, .. } => match of {
                Reaction::Force => (value * unit / h, "N"),
                Reaction::Torque => (value * unit / h, "N mm"),
            },
            Self::OfMuscles { amount, unit, .. } => {
                let (name, size) = amount.unit();
                (value * unit / size, name)
            }
            Self::MarkerRegion { region, .. } => match region {
                Region::Sphere { radius, .. } => (value.sqrt() * radius, "mm from its centre"),
                Region::Box { .. } => (value.powf(1.0 / 16.0), "half edges from its centre"),
            },
            Self::Joint { .. }
            | Self::Capacitance { .. }
            | Self::Direction { .. }
            | Self::PeakVoltage { .. }
            | Self::PeakExcess { .. }
            | Self::PullStep(_)
            | Self::Charge { .. }
            | Self::MeanCharge { .. }
            | Self::ElectrodeVoltage { .. }
            | Self::MarkerPlace { .. }
            | Self::MarkerStep { .. } => (value, self.unit(system)),
        }
    }

    /// The source whose current or power it is, behind a resistor.
    pub fn source(&self) -> Option<usize> {
        match *self {
            Self::SourceCurrent { muscle, .. } | Self::SourcePower { muscle, .. } => Some(muscle),
            _ => None,
        }
    }

    /// Returns the period of its values: a full turn of an angle.
    pub fn period(&self, system: &System) -> Option<f64> {
        match *self {
            Self::Joint { joint, .. } => (joint_unit(system, joint) == "rad").then_some(TAU),
            _ => None,
        }
    }

    /// Returns the typical size of its values: lengths or not.
    pub fn size(&self, system: &System) -> Size {
        match *self {
            Self::Joint { joint, .. } if joint_unit(system, joint) == "rad" => Size::One,
            Self::Joint { .. } | Self::MarkerPlace { .. } | Self::MarkerStep { .. } => Size::Length,
            _ => Size::One,
        }
    }
}

/// Unit of a joint coordinate.
pub fn joint_unit(system: &System, joint: usize) -> &'static str {
    match system.joints[joint].kind {
        JointKind::Prismatic { .. } => "mm",
        _ => "rad",
    }
}

/// A region of space in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Box between two corners.
    Box {
        /// Lower corner.
        min: Vector,
        /// Upper corner.
        max: Vector,
    },
    /// Ball.
    Sphere {
        /// Centre.
        centre: Vector,
        /// Radius.
        radius: f64,
    },
}

/// Place where a true electric field is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldPlace {
    /// In a lumped muscle.
    Muscle(usize),
    /// At a point of a finite element.
    Element {
        /// Block: those of the scene, then those of the muscles of finite elements.
        block: usize,
        /// Element of its mesh.
        element: usize,
        /// Gauss point; the centre where there is none.
        point: Option<usize>,
    },
}

/// Force or torque that a joint transmits along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Force in N.
    Force,
    /// Torque in N mm about the point of the joint.
    Torque,
}

/// A part between points that pulls its ends together; a lumped muscle has a quantity of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulling {
    /// A spring with its damper.
    Spring(usize),
    /// A tendon.
    Tendon(usize),
}

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

impl Quantity {
    /// Returns true if it is measured in the intervals rather than at the instants.
    pub fn is_of_intervals(&self) -> bool {
        matches!(
            self,
            Self::SquaredStretch { at: Some(_), .. }
                | Self::ChargedField { at: Some(_), .. }
                | Self::MarkerPlace { at: Some(_), .. }
                | Self::MarkerRegion { at: Some(_), .. }
                | Self::SquaredField { .. }
                | Self::MarkerStep { .. }
                | Self::SquaredSpeed { .. }
                | Self::JointStep { .. }
                | Self::PeakVoltage { .. }
                | Self::PeakExcess { .. }
                | Self::OfMuscles { .. }
                | Self::SourceCurrent { .. }
                | Self::SourcePower { .. }
                | Self::Tension { .. }
                | Self::VoltageStep { .. }
                | Self::ChargeStep { .. }
                | Self::EnergyStep { .. }
                | Self::ReactionStep { .. }
                | Self::PullStep(_)
                | Self::MeanCharge { .. }
                | Self::ElectrodeVoltage { .. }
        )
    }

    /// Returns true if it is read from the inputs of an interval, and of a state of rest under them as well; one of three of a field.
    pub fn is_of_held_inputs(&self) -> bool {
        match self {
            Self::SquaredField { at, .. } => *at == Stencil::Here,
            Self::SourceCurrent { .. }
            | Self::SourcePower { .. }
            | Self::Tension { .. }
            | Self::MeanCharge { .. }
            | Self::ElectrodeVoltage { .. } => true,
            _ => false,
        }
    }

    /// Returns true if its values are steps within intervals, whose rates they are over the length of the interval.
    pub fn is_step(&self) -> bool {
        matches!(
            self,
            Self::JointStep { .. } | Self::MarkerStep { .. } | Self::PullStep(_)
        )
    }

    /// The same quantity evaluated at interval ends, so that it may depend on free parameters; `None` if unsupported.
    pub fn in_intervals(&self, at: Stencil) -> Option<Self> {
        let at = Some(at);
        match *self {
            Self::SquaredStretch { muscle, .. } => Some(Self::SquaredStretch { muscle, at }),
            Self::ChargedField { muscle, limit, .. } => {
                Some(Self::ChargedField { muscle, limit, at })
            }
            Self::MarkerPlace { marker, axis, .. } => Some(Self::MarkerPlace { marker, axis, at }),
            Self::MarkerRegion { marker, region, .. } => {
                Some(Self::MarkerRegion { marker, region, at })
            }
            _ => None,
        }
    }

    /// Returns the noun of its time, in front of the number of the instant or interval.
    pub fn when(&self) -> &'static str {
        match self {
            Self::SquaredField { at, .. } => match at {
                Stencil::Here => "at the start of interval",
                Stencil::Next => "at the end of interval",
                _ => "in the middle of interval",
            },
            Self::SquaredStretch { at, .. }
            | Self::ChargedField { at, .. }
            | Self::MarkerPlace { at, .. }
            | Self::MarkerRegion { at, .. } => match at {
                Some(Stencil::Next) => "at the end of interval",
                _ => "at instant",
            },
            Self::MarkerStep { .. }
            | Self::SquaredSpeed { .. }
            | Self::JointStep { .. }
            | Self::PeakVoltage { .. }
            | Self::PeakExcess { .. }
            | Self::OfMuscles { .. }
            | Self::SourceCurrent { .. }
            | Self::SourcePower { .. }
            | Self::Tension { .. }
            | Self::PullStep(_)
            | Self::MeanCharge { .. }
            | Self::ElectrodeVoltage { .. } => "in interval",
            Self::VoltageStep { .. }
            | Self::ChargeStep { .. }
            | Self::EnergyStep { .. }
            | Self::ReactionStep { .. } => "before interval",
            _ => "at instant",
        }
    }
}
