//! Inputs: the parts of a system that take a voltage, and loads.

use crate::interface::handle::Handle;
use crate::model::System;
use crate::model::components::Load;
use crate::model::system::{Muscle, Potential, Solid};

/// Part that an input drives: a muscle, a driven electrode of a solid by its name, or a load.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// A muscle.
    Muscle(Handle<Muscle>),
    /// A driven electrode.
    Electrode(Handle<Solid>, String),
    /// A load.
    Load(Handle<Load>),
}

impl From<Handle<Muscle>> for Input {
    fn from(muscle: Handle<Muscle>) -> Self {
        Self::Muscle(muscle)
    }
}

impl From<Handle<Load>> for Input {
    fn from(load: Handle<Load>) -> Self {
        Self::Load(load)
    }
}

impl From<(Handle<Solid>, &str)> for Input {
    fn from((solid, electrode): (Handle<Solid>, &str)) -> Self {
        Self::Electrode(solid, electrode.to_owned())
    }
}

impl Input {
    /// Its place in the list of sources of a system; `None` where that has no such part.
    pub(super) fn source(&self, system: &System) -> Option<usize> {
        match self {
            Self::Muscle(muscle) => {
                let index = muscle.index();
                (index < system.muscles.len()).then_some(index)
            }
            Self::Load(load) => {
                let index = load.index();
                let exists = index < system.components.loads.len();
                exists.then(|| system.first_load() + index)
            }
            Self::Electrode(solid, name) => system.solids.get(solid.index()).and_then(|solid| {
                let electrode = solid.electrodes.iter().find(|e| e.name == *name)?;
                match electrode.potential {
                    Potential::Driven { source, .. } => Some(source),
                    Potential::Given(_) | Potential::Floating => None,
                }
            }),
        }
    }
}
