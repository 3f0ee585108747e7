//! Handles: names of the parts of a system; and the declaration of methods that change a part or a task and return it.

use crate::model::components::Load;
use crate::model::system::{Body, Muscle, Potential, Solid, number_sources};
use crate::model::{System, SystemError};
use std::fmt;
use std::marker::PhantomData;

/// A part of a system.
pub struct Handle<P> {
    index: usize,
    part: PhantomData<fn() -> P>,
}

impl<P> Handle<P> {
    pub(super) fn new(index: usize) -> Self {
        Self {
            index,
            part: PhantomData,
        }
    }

    /// Its index in the list of its kind in the [`System`].
    pub fn index(self) -> usize {
        self.index
    }
}

impl<P> Clone for Handle<P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Handle<P> {}

impl<P> PartialEq for Handle<P> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<P> Eq for Handle<P> {}

impl<P> fmt::Debug for Handle<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Handle({})", self.index)
    }
}

/// Carrier of a point: a body or the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carrier(pub(super) Option<usize>);

/// The ground.
pub const GROUND: Carrier = Carrier(None);

impl From<Handle<Body>> for Carrier {
    fn from(body: Handle<Body>) -> Self {
        Self(Some(body.index))
    }
}

/// A kind of part that a system has.
pub trait Part: Sized {
    /// Takes it into a system; its index in the list of its kind.
    fn join(self, system: &mut System) -> usize;
}

impl System {
    /// A system without parts or gravity.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            bodies: Vec::new(),
            joints: Vec::new(),
            muscles: Vec::new(),
            solids: Vec::new(),
            markers: Vec::new(),
            gravity: None,
            components: crate::model::components::Components::default(),
        }
    }

    /// Adds a part; one without a name is called by its kind and number, such as `muscle1`.
    pub fn add<P: Part>(&mut self, part: P) -> Handle<P> {
        Handle::new(part.join(self))
    }
}

impl System {
    /// A copy whose electrodes have their sources, if it makes sense.
    pub(super) fn checked(&self) -> Result<Self, SystemError> {
        self.check()?;
        let mut system = self.clone();
        number_sources(&mut system.solids, self.muscles.len());
        Ok(system)
    }
}

/// The name, or kind and number where it is empty.
pub(super) fn named(name: String, kind: &str, others: usize) -> String {
    match name.is_empty() {
        true => format!("{kind}{}", others + 1),
        false => name,
    }
}

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
    fn from(of: (Handle<Solid>, &str)) -> Self {
        Self::Electrode(of.0, of.1.to_owned())
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

/// Declares methods of a builder, each by its arguments and the change that it makes.
macro_rules! builder {
    (impl $part:ty; $($(#[$about:meta])* $name:ident($($given:ident: $of:ty),*) |$it:ident| $change:expr;)*) => {
        impl $part {
            $($(#[$about])*
            pub fn $name(mut self, $($given: $of),*) -> Self {
                let $it = &mut self;
                $change;
                self
            })*
        }
    };
}
pub(super) use builder;

/// Declares functions that make a part or what it is made of, each by its arguments and the value.
macro_rules! makers {
    (impl $part:ty => $made:ty; $($(#[$about:meta])* $name:ident($($given:ident: $of:ty),*) = $value:expr;)*) => {
        impl $part {
            $($(#[$about])*
            pub fn $name($($given: $of),*) -> $made {
                $value
            })*
        }
    };
}
pub(super) use makers;
