//! Springs and dampers.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::point::PointSpec;
use crate::files::units::quantity::{Damping, Length, Quantity, Stiffness};
use crate::model::components::Spring;

objects! {
    /// A linear spring, a damper, or both, between two points: force k (length − rest length) + c (rate of the length).
    pub struct SpringSpec {
        /// Name, unique among springs and tendons.
        pub name: String,
        /// One end.
        pub from: PointSpec,
        /// The other end.
        pub to: PointSpec,
        /// Stiffness k, SI unit N/m.
        pub stiffness: Option<Quantity<Stiffness>>,
        /// Damping c, SI unit N s/m.
        pub damping: Option<Quantity<Damping>>,
        /// Length without force, SI unit m; the distance of the ends where not written.
        pub rest_length: Option<Quantity<Length>>,
    }
}

impl ComponentSpec for SpringSpec {
    type Part = Spring;

    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Spring> {
        refuse!(if self.stiffness.is_none() && self.damping.is_none(), scope;
            found "neither of them", expected "\"stiffness\" or \"damping\"");
        refuse!(if self.rest_length.is_some() && self.stiffness.is_none(), scope.key("rest_length");
            found "\"rest_length\"",
            expected "no such key, as a spring without \"stiffness\" does not read it");
        let (from, to) = (
            self.from.attachment(bodies, &scope.key("from"))?,
            self.to.attachment(bodies, &scope.key("to"))?,
        );
        let rest_length = self.rest_length.as_ref().map(Quantity::value);
        Ok(Spring {
            name: self.name.clone(),
            from,
            to,
            stiffness: Quantity::present(&self.stiffness),
            damping: Quantity::present(&self.damping),
            rest_length: rest_length.unwrap_or_else(|| (to.at - from.at).norm()),
        })
    }
}

/// A kind of component as it is written.
pub(in crate::files::scene) trait ComponentSpec {
    /// The component of the system.
    type Part;

    /// The component, whose rules are those of the system.
    ///
    /// # Errors
    /// A name is wrong, or a key.
    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Self::Part>;
}
