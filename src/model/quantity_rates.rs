//! Rates of quantities as their steps within intervals, or from interval to interval.

use crate::functional::Stencil;
use crate::model::quantity::{Quantity, joint_unit};
use crate::model::system::System;

impl Quantity {
    /// The quantity that is subtracted in the interval before, where steps between intervals are limited.
    pub fn before(&self) -> Option<Self> {
        match *self {
            Self::VoltageStep { .. } | Self::ChargeStep { .. } => Some(self.clone()),
            Self::EnergyStep {
                muscle, unit, h, ..
            } => Some(Self::EnergyStep {
                muscle,
                at: Stencil::Here,
                unit,
                h,
            }),
            Self::ReactionStep {
                joint,
                of,
                along,
                unit,
                h,
                ..
            } => Some(Self::ReactionStep {
                joint,
                of,
                along,
                at: Stencil::Next,
                unit,
                h,
            }),
            _ => None,
        }
    }

    /// The same with another length of the intervals in ms in messages.
    pub fn with_interval(mut self, length: f64) -> Self {
        match &mut self {
            Self::JointStep { h, .. }
            | Self::VoltageStep { h, .. }
            | Self::ChargeStep { h, .. }
            | Self::EnergyStep { h, .. }
            | Self::ReactionStep { h, .. } => *h = length,
            _ => {}
        }
        self
    }

    /// Length of the intervals in ms by which a step is a rate.
    pub fn interval(&self) -> Option<f64> {
        match *self {
            Self::JointStep { h, .. }
            | Self::VoltageStep { h, .. }
            | Self::ChargeStep { h, .. }
            | Self::EnergyStep { h, .. }
            | Self::ReactionStep { h, .. } => Some(h),
            _ => None,
        }
    }

    /// Factor of the rate in its plain unit over the step per ms, of a step within an interval.
    pub fn rate_factor(&self, system: &System) -> Option<f64> {
        match *self {
            Self::JointStep { joint, .. } => Some(match joint_unit(system, joint) {
                "mm" => 1.0,
                _ => 1e3,
            }),
            _ => None,
        }
    }

    /// Unit in which the steps of the quantity between intervals are rows.
    pub fn step_unit(&self) -> f64 {
        match *self {
            Self::VoltageStep { unit, .. }
            | Self::ChargeStep { unit, .. }
            | Self::EnergyStep { unit, .. }
            | Self::ReactionStep { unit, .. } => unit,
            _ => 1.0,
        }
    }
}
