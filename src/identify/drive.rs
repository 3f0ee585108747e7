//! Constants of the inputs of recordings: gains of sources, and the delay with which all of them act.
//!
//! The input of a source is `g V(t − τ)`, of which a recording says V(t). A robot that rests until its inputs begin and reads no other function of
//! time moves τ later with all of them: a reading at t is that of the motion without delay at t − τ, and before that one of the start.

use std::borrow::Cow;

use crate::control::problem::{BoundaryState, Voltages};
use crate::model::{Constant, Parameter};

/// Gains and delay at values of the constants.
#[derive(Clone, Debug, Default)]
pub(super) struct Drive {
    gains: Vec<Gain>,
    pub(super) delay: Option<Delay>,
}

/// Gain of a source.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    pub(super) source: usize,
    /// Index of the constant.
    pub(super) constant: usize,
    pub(super) value: f64,
}

/// Delay of all inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Delay {
    /// Index of the constant.
    pub(super) constant: usize,
    /// Time in ms.
    pub(super) time: f64,
}

impl Drive {
    pub(super) fn new(parameters: &[Parameter], constants: &[f64]) -> Self {
        let mut out = Self::default();
        for (constant, (parameter, &value)) in parameters.iter().zip(constants).enumerate() {
            for follower in &parameter.constants {
                match follower.constant {
                    Constant::Gain(source) => out.gains.push(Gain {
                        source,
                        constant,
                        value,
                    }),
                    Constant::Delay => {
                        out.delay = Some(Delay {
                            constant,
                            time: value,
                        });
                    }
                    _ => {}
                }
            }
        }
        out
    }

    /// The gain of a source, where it is sought.
    pub(super) fn of_source(&self, source: usize) -> Option<Gain> {
        self.gains
            .iter()
            .copied()
            .find(|gain| gain.source == source)
    }

    /// Sources whose gains are sought.
    pub(super) fn sources(&self) -> impl Iterator<Item = usize> + '_ {
        self.gains.iter().map(|gain| gain.source)
    }

    fn factor(&self, source: usize) -> f64 {
        self.of_source(source).map_or(1.0, |gain| gain.value)
    }

    /// Voltages and loads of a recording with their gains.
    pub(super) fn voltages<'a>(&self, said: &'a Voltages) -> Cow<'a, Voltages> {
        match self.gains.is_empty() {
            true => Cow::Borrowed(said),
            false => Cow::Owned(said.scaled(|source| self.factor(source))),
        }
    }

    /// The start with gains of the voltages under which it rests.
    pub(super) fn start<'a>(&self, said: &'a BoundaryState) -> Cow<'a, BoundaryState> {
        match said {
            BoundaryState::RestAtVoltages(row, rest) if !self.gains.is_empty() => {
                let of = |(source, value): (usize, &f64)| self.factor(source) * value;
                let row = row.iter().enumerate().map(of).collect();
                Cow::Owned(BoundaryState::RestAtVoltages(row, *rest))
            }
            _ => Cow::Borrowed(said),
        }
    }
}
