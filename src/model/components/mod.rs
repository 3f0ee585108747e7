//! Components of a scene: terms, connections and observations of each kind of part.

pub(super) mod body;
pub(super) mod circuit;
pub(super) mod component;
pub(super) mod contact;
pub(super) mod contact_law;
pub(super) mod contact_shape;
pub(super) mod load;
pub(super) mod muscle;
pub(super) mod muscle_constants;
mod soft_contact;
mod spring;
mod tendon;

pub use component::{Component, Other};
pub use contact::{Contact, ContactSide};
pub use contact_law::{ContactElasticLaw, ElasticSolid, Restitution, SLIP_SPEED};
pub use contact_shape::ContactShape;
pub use load::{BlockLoad, Faces, Load, LoadPlace};
pub use muscle_constants::capacitance;
pub use soft_contact::SoftContact;
pub use spring::Spring;
pub use tendon::Tendon;

use crate::model::terms::Terms;

/// The components of a system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Components {
    /// Springs and dampers.
    pub springs: Vec<Spring>,
    /// Tendons.
    pub tendons: Vec<Tendon>,
    /// Contacts.
    pub contacts: Vec<Contact>,
    /// Loads: forces and torques.
    pub loads: Vec<Load>,
    /// Those that a user of the library defines.
    pub others: Vec<Other>,
}

impl Components {
    /// Their terms.
    pub(super) fn build(&self, terms: &mut Terms<'_>) {
        for (index, spring) in self.springs.iter().enumerate() {
            spring.add(Some(index), terms);
        }
        for (index, tendon) in self.tendons.iter().enumerate() {
            tendon.add(Some(index), terms);
        }
        self.contacts.iter().for_each(|one| one.build(terms));
        self.others.iter().for_each(|other| other.0.build(terms));
    }

    /// All of them but loads, kind by kind.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Component> {
        let springs = self.springs.iter().map(|spring| spring as &dyn Component);
        let tendons = self.tendons.iter().map(|tendon| tendon as &dyn Component);
        let contacts = self.contacts.iter().map(|one| one as &dyn Component);
        let others = self.others.iter().map(|other| other.0.as_ref());
        springs.chain(tendons).chain(contacts).chain(others)
    }

    /// Numbers of components of each kind.
    pub fn counts(&self) -> [(&'static str, usize); 5] {
        [
            ("springs", self.springs.len()),
            ("tendons", self.tendons.len()),
            ("contacts", self.contacts.len()),
            ("loads", self.loads.len()),
            ("other components", self.others.len()),
        ]
    }
}
