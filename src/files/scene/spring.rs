//! Springs, dampers and tendons as they are written, and their conversion to components, whose rules stand in the model.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::point::PointSpec;
use crate::files::units::quantity::{Damping, Length, Quantity, Stiffness};
use crate::model::components::{Spring, Tendon};
use crate::model::system::Attachment;

objects! {
    /// A linear spring, a damper, or both, between two points: force k (length − rest length) + c (rate of the length).
    pub struct SpringSpec {
        /// Name, unique among springs, tendons and contacts.
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

    /// An elastic cable that slides without friction through points and takes no compression: tension k max(length − rest length, 0).
    pub struct TendonSpec {
        /// Name, unique among springs, tendons and contacts.
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

/// The spring that is written.
pub(crate) fn spring(spec: &SpringSpec, bodies: &[String], scope: &Scope<'_>) -> Result<Spring> {
    refuse!(if spec.stiffness.is_none() && spec.damping.is_none(), scope;
        found "neither of them", expected "\"stiffness\" or \"damping\"");
    refuse!(if spec.rest_length.is_some() && spec.stiffness.is_none(), scope.key("rest_length");
        found "\"rest_length\"",
        expected "no such key, as a spring without \"stiffness\" does not read it");
    let (from, to) = (
        spec.from.attachment(bodies, &scope.key("from"))?,
        spec.to.attachment(bodies, &scope.key("to"))?,
    );
    let rest_length = spec.rest_length.as_ref().map(Quantity::value);
    Ok(Spring {
        name: spec.name.clone(),
        from,
        to,
        stiffness: Quantity::present(&spec.stiffness),
        damping: Quantity::present(&spec.damping),
        rest_length: rest_length.unwrap_or_else(|| (to.at - from.at).norm()),
    })
}

/// The tendon that is written.
pub(crate) fn tendon(spec: &TendonSpec, bodies: &[String], scope: &Scope<'_>) -> Result<Tendon> {
    let through: Vec<Attachment> =
        (scope.key("through")).each(&spec.through, |point, at| point.attachment(bodies, at))?;
    let spans = through
        .windows(2)
        .map(|pair| (pair[1].at - pair[0].at).norm());
    let rest_length = spec.rest_length.as_ref().map(Quantity::value);
    Ok(Tendon {
        name: spec.name.clone(),
        stiffness: spec.stiffness.value(),
        rest_length: rest_length.unwrap_or_else(|| spans.sum()),
        smoothing: Quantity::present(&spec.smoothing).unwrap_or(0.0),
        through,
    })
}
