//! Components of a scene: terms, connections and observations of each kind of part.

pub(super) mod body;
pub(super) mod circuit;
pub(super) mod component;
pub(super) mod load;
pub(super) mod muscle;
pub(super) mod muscle_constants;
mod spring;
mod tendon;

pub use component::Component;
pub(crate) use component::Kind;
pub use load::{BlockLoad, Faces, Load, LoadPlace};
pub use muscle_constants::capacitance;
pub use spring::Spring;
pub use tendon::Tendon;

use crate::model::terms::Terms;
use component::build;
use std::sync::Arc;

/// Declares the kinds of components between points: a line for each, `list: Type`, in the order in which they are built.
macro_rules! kinds {
    ($($(#[$about:meta])* $list:ident: $kind:ty,)*) => {
        /// The components of a system.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Components {
            $($(#[$about])* pub $list: Vec<$kind>,)*
            /// Loads: forces and torques.
            pub loads: Vec<Load>,
            /// Those that a user of the library defines.
            pub others: Vec<Other>,
        }

        impl Components {
            /// Their terms.
            pub(super) fn build(&self, terms: &mut Terms<'_>) {
                $(build(&self.$list, terms);)*
                self.others.iter().for_each(|other| other.0.build(terms));
            }

            /// All of them but loads, kind by kind.
            pub fn iter(&self) -> impl Iterator<Item = &dyn Component> {
                self.listed().map(|(_, _, part)| part)
            }

            /// The same with the name of the list and the index in it.
            pub(super) fn listed(&self) -> impl Iterator<Item = (&'static str, usize, &dyn Component)> {
                let all = std::iter::empty();
                $(let all = all.chain(self.$list.iter().enumerate().map(|(index, part)| {
                    (stringify!($list), index, part as &dyn Component)
                }));)*
                let others = self.others.iter().enumerate();
                all.chain(others.map(|(index, other)| ("others", index, other.0.as_ref())))
            }

            /// Numbers of components of each kind.
            pub fn counts(&self) -> Vec<(&'static str, usize)> {
                vec![
                    $((stringify!($list), self.$list.len()),)*
                    ("loads", self.loads.len()),
                    ("other components", self.others.len()),
                ]
            }
        }

        $(impl AsMut<Vec<$kind>> for Components {
            fn as_mut(&mut self) -> &mut Vec<$kind> {
                &mut self.$list
            }
        })*

        /// Names of the terms with a potential, kind by kind.
        pub(super) const POTENTIALS: &[&[&str]] = &[$(<$kind>::POTENTIALS),*];

        /// Names of the terms that dissipate, kind by kind.
        pub(super) const DISSIPATIONS: &[&[&str]] = &[$(<$kind>::DISSIPATIONS),*];
    };
}

kinds! {
    /// Springs and dampers.
    springs: Spring,
    /// Tendons.
    tendons: Tendon,
}

/// A component of another crate; equal to itself only.
#[derive(Clone, Debug)]
pub struct Other(pub Arc<dyn Component>);

impl PartialEq for Other {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
