//! Sites of quantities in time: instants and intervals.

use crate::functional::Stencil;
use crate::model::quantity::Quantity;

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

    /// The same quantity of the instants, measured at the start or end of the intervals, where it may read sought constants; none of one that
    /// is not offered there.
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
