//! Entries of limits, costs and recorded quantities in a problem file, and conversion of their parts.

use crate::control::problem::{CostFunction, Limit};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::units::quantity::{Kind, PhysicalQuantity, Quantity as Written};
use crate::math::Signal;
use crate::model::{Plane, Quantity, What};

read_objects! {
    /// All of them.
    pub enum All {
        /// All of them.
        All,
    }
}

/// An entry of the limits of a problem, which stands under its key.
pub(super) trait LimitEntry {
    /// The limits that it stands for.
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>>;
}

/// An entry of the costs of a problem, along the motion or at its end, which stands under its key.
pub(super) trait CostEntry {
    /// The quantities that it stands for, and the function of each that is minimised.
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>>;
}

/// A quantity, and its function in a cost.
pub(super) type Cost = (Quantity, CostFunction);

/// Declares limits: what they are of, the type and unit of their bounds `min` and `max`, and the limits that an entry stands for.
macro_rules! limits {
    ($($(#[$about:meta])* $name:ident { $($of_what:tt)* } within $bound:ty, $unit:literal => |$of:ident, $at:ident| $limits:expr;)*) => {$(
        $crate::files::json::objects::read_objects! {
            $(#[$about])*
            pub struct $name {
                $($of_what)*
                #[doc = concat!("Lower bound", $unit, ".")]
                pub min: Option<$bound>,
                #[doc = concat!("Upper bound", $unit, ".")]
                pub max: Option<$bound>,
            }
        }

        impl LimitEntry for $name {
            fn limits(&self, $at: &At<'_>) -> Result<Vec<Limit>> {
                let $of = self;
                Ok($limits)
            }
        }
    )*};
}
pub(super) use limits;

/// Declares costs: what they are of, what their `weight` is of, and the costs that an entry stands for.
macro_rules! costs {
    ($($(#[$about:meta])* $name:ident { $($of_what:tt)* } weight of $weight:literal => |$of:ident, $at:ident| $costs:expr;)*) => {$(
        $crate::files::json::objects::read_objects! {
            $(#[$about])*
            pub struct $name {
                $($of_what)*
                #[doc = concat!("Weight of ", $weight, "; 1 where not written.")]
                pub weight: Option<f64>,
            }
        }

        impl CostEntry for $name {
            fn costs(&self, $at: &At<'_>) -> Result<Vec<Cost>> {
                let $of = self;
                Ok($costs)
            }
        }
    )*};
}
pub(super) use costs;

/// A quantity of a recording by its name, which stands at `place`; the directions beside it stand at `at`.
pub(super) struct Named<'a> {
    pub(super) name: &'a str,
    pub(super) along: Option<[f64; 3]>,
    pub(super) about: Option<[f64; 3]>,
    pub(super) from: Option<&'a PlaneSpec>,
    pub(super) place: &'a At<'a>,
    pub(super) at: &'a At<'a>,
}

impl Named<'_> {
    /// The quantity, called by a word and the name of what it is of.
    pub(super) fn recorded(&self, word: &str, quantity: Quantity, kind: Kind) -> Recorded {
        Recorded {
            of: self.name.to_owned(),
            name: format!("{word} of {}", self.name),
            parts: vec![(1.0, quantity)],
            kind,
        }
    }
}

/// A recorded quantity: what it is of, or its column where one is written; what it is called, its parts, and its kind.
pub(in crate::files::problem) struct Recorded {
    pub(in crate::files::problem) of: String,
    pub(in crate::files::problem) name: String,
    pub(in crate::files::problem) parts: Vec<(f64, Quantity)>,
    pub(in crate::files::problem) kind: Kind,
}

/// Limits of some quantities by the same bounds.
pub(super) fn limits_of(whats: impl IntoIterator<Item = What>, bounds: [f64; 2]) -> Vec<Limit> {
    let limit = |what| Limit::new(what, bounds);
    whats.into_iter().map(limit).collect()
}

/// Both bounds, of which one at least is written.
pub(super) fn bounds<M: PhysicalQuantity>(
    written: [&Option<Written<M>>; 2],
    at: &At<'_>,
) -> Result<[f64; 2]> {
    bounds_by(written, at, |_, bound| Ok(bound.value()))
}

/// Both bounds as they are read, of which one at least is written, and which are not crossed.
pub(super) fn bounds_by<B>(
    [min, max]: [&Option<B>; 2],
    at: &At<'_>,
    read: impl Fn(&At<'_>, &B) -> Result<f64>,
) -> Result<[f64; 2]> {
    let bound = |key: &str, written: &Option<B>, absent: f64| {
        let written = written.as_ref();
        written.map_or(Ok(absent), |written| read(&at.key(key), written))
    };
    let bounds = [
        bound("min", min, f64::NEG_INFINITY)?,
        bound("max", max, f64::INFINITY)?,
    ];
    refuse!(if min.is_none() && max.is_none(), at;
        found "no bound", expected "\"min\", \"max\" or both");
    refuse!(if bounds[0] > bounds[1], at.key("max");
        found "\"max\" below \"min\"", expected "bounds that are not crossed");
    Ok(bounds)
}

/// The squared deviation of a quantity from a function of time.
pub(super) fn square(quantity: Quantity, reference: impl Into<Signal>) -> Cost {
    let reference = reference.into();
    (quantity, CostFunction::Square { reference })
}

/// Those of a quantity of each of some parts from a value, 0 where not written.
pub(super) fn squares(
    parts: Vec<usize>,
    quantity: impl Fn(usize) -> Quantity,
    value: Option<f64>,
) -> Vec<Cost> {
    let cost = |part| square(quantity(part), value.unwrap_or(0.0));
    parts.into_iter().map(cost).collect()
}

read_objects! {
    /// A plane that is fixed to a body, or to the ground where none is named.
    pub struct PlaneSpec {
        /// Name of the body.
        pub body: Option<String>,
        /// A point of the plane in the reference configuration, SI unit m.
        pub point: Point,
        /// Its normal in the reference configuration, of any length; distances on its side are positive.
        pub normal: [f64; 3],
    }
}

impl PlaneSpec {
    /// The plane that it stands for.
    pub(super) fn plane(&self, at: &At<'_>) -> Result<Plane> {
        Ok(Plane {
            body: at.optional("body", &self.body, |at, name| at.body(name))?,
            point: vector(&self.point),
            normal: unit_axis(&self.normal, &at.key("normal"))?,
        })
    }
}
