//! Components of a scene: terms, connections and observations of each kind of part.

pub(super) mod body;
pub(super) mod circuit;
pub(super) mod load;
pub(super) mod muscle;
mod sought_muscle;
mod spring;
mod tendon;

pub use load::{BlockLoad, Faces, Load, LoadPlace};
pub use muscle::capacitance;
pub use spring::Spring;
pub use tendon::Tendon;

use crate::model::component::Component;
use crate::model::terms::Terms;
use std::sync::Arc;

/// The components of a system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Components {
    /// Springs and dampers.
    pub springs: Vec<Spring>,
    /// Tendons.
    pub tendons: Vec<Tendon>,
    /// Loads: forces and torques.
    pub loads: Vec<Load>,
    /// Those that a user of the library defines.
    pub others: Vec<Other>,
}

impl Components {
    /// Their terms.
    pub(super) fn build(&self, terms: &mut Terms<'_>) {
        let springs = self.springs.iter().enumerate();
        springs.for_each(|(index, spring)| spring.add(Some(index), terms));
        let others = self.iter().skip(self.springs.len());
        others.for_each(|component| component.build(terms));
        for term in [spring::ELASTICITY, spring::DAMPING] {
            terms.without(term, "no spring");
        }
        terms.without(tendon::ELASTICITY, "no tendon");
    }

    /// All of them but loads, kind by kind.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Component> {
        let springs = self.springs.iter().map(|spring| spring as &dyn Component);
        let tendons = self.tendons.iter().map(|tendon| tendon as &dyn Component);
        let others = self.others.iter().map(|other| other.0.as_ref());
        springs.chain(tendons).chain(others)
    }
}

/// A component of another crate; equal to itself only.
#[derive(Clone, Debug)]
pub struct Other(pub Arc<dyn Component>);

impl PartialEq for Other {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
