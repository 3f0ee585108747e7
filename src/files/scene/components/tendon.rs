//! Tendons.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope};
use crate::files::scene::components::spring::ComponentSpec;
use crate::files::scene::point::PointSpec;
use crate::files::units::quantity::{Length, Quantity, Stiffness};
use crate::model::components::Tendon;
use crate::model::system::Attachment;

objects! {
    /// An elastic cable that slides without friction through points and takes no compression: tension k max(length − rest length, 0).
    pub struct TendonSpec {
        /// Name, unique among springs and tendons.
        pub name: String,
        /// The points, two or more: the ends, and between them those that it slides through.
        pub through: Vec<PointSpec>,
        /// Stiffness k of the whole cable, SI unit N/m.
        pub stiffness: Quantity<Stiffness>,
        /// Length up to which it is slack, SI unit m; the length of the path where not written.
        pub rest_length: Option<Quantity<Length>>,
        /// Width around the rest length over which the stiffness grows from zero to k, SI unit m, for optimal control; it jumps where not written.
        pub smoothing: Option<Quantity<Length>>,
    }
}

impl ComponentSpec for TendonSpec {
    type Part = Tendon;

    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Tendon> {
        let through: Vec<Attachment> =
            (scope.key("through")).each(&self.through, |point, at| point.attachment(bodies, at))?;
        let spans = through
            .windows(2)
            .map(|pair| (pair[1].at - pair[0].at).norm());
        let rest_length = self.rest_length.as_ref().map(Quantity::value);
        Ok(Tendon {
            name: self.name.clone(),
            stiffness: self.stiffness.value(),
            rest_length: rest_length.unwrap_or_else(|| spans.sum()),
            smoothing: Quantity::present(&self.smoothing).unwrap_or(0.0),
            through,
        })
    }
}
