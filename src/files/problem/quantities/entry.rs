//! Entries of limits, costs and recorded quantities in a problem file, and conversion of their parts.

use crate::control::problem::{CostFunction, During, Limit, QuantityCost};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::scene::names::names;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::units::quantity::{Kind, PhysicalQuantity, Quantity as Written};
use crate::math::Signal;
use crate::model::system::System;
use crate::model::{Plane, Quantity, What};
use schemars::JsonSchema;
use serde::Deserialize;

/// All of them.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum All {
    /// All of them.
    All,
}

/// An entry of the limits of a problem; the scope is that of its key.
pub(super) trait LimitEntry {
    /// The limits that it stands for.
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>>;

    /// Returns true if it bounds what follows from constants alone.
    fn is_timeless(&self) -> bool {
        false
    }
}

/// An entry of the costs of a problem, along the motion or at its end; the scope is that of its key.
pub(super) trait CostEntry {
    /// The costs that it stands for.
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>>;
}

/// A quantity of a recording by its name, which stands at `place`; `scope` has the directions beside it.
pub(super) struct Named<'a> {
    pub(super) name: &'a str,
    pub(super) along: Option<[f64; 3]>,
    pub(super) about: Option<[f64; 3]>,
    pub(super) from: Option<&'a PlaneSpec>,
    pub(super) system: &'a System,
    pub(super) place: &'a Scope<'a>,
    pub(super) scope: &'a Scope<'a>,
}

/// Symbol of an SI unit and its factor.
pub(super) type SiUnit = (&'static str, f64);

/// A recorded quantity: what it is of, what it is called, its parts, and its unit.
pub(in crate::files::problem) struct Recorded {
    pub(in crate::files::problem) of: String,
    pub(in crate::files::problem) name: String,
    pub(in crate::files::problem) parts: Vec<(f64, Quantity)>,
    pub(in crate::files::problem) kind: Kind,
    pub(in crate::files::problem) unit: SiUnit,
}

impl Recorded {
    /// A quantity as it is, of a kind with an SI unit.
    pub(super) fn plain(of: &str, name: String, quantity: Quantity, unit: (Kind, SiUnit)) -> Self {
        Self {
            of: of.to_owned(),
            name,
            parts: vec![(1.0, quantity)],
            kind: unit.0,
            unit: unit.1,
        }
    }

    /// The same, called by a word and the name of what it is of.
    pub(super) fn named(word: &str, of: &str, quantity: Quantity, unit: (Kind, SiUnit)) -> Self {
        Self::plain(of, format!("{word} of {of}"), quantity, unit)
    }
}

/// Limits of some quantities by the same bounds.
pub(super) fn limits_of(whats: impl IntoIterator<Item = What>, bounds: [f64; 2]) -> Vec<Limit> {
    let limit = |what| Limit::new(what, bounds);
    whats.into_iter().map(limit).collect()
}

/// Both bounds, of which one at least is written.
pub(super) fn bounds<M: PhysicalQuantity>(
    [min, max]: [&Option<Written<M>>; 2],
    scope: &Scope<'_>,
) -> Result<[f64; 2]> {
    let of =
        |bound: &Option<Written<M>>, absent: f64| bound.as_ref().map_or(absent, Written::value);
    let bounds = [of(min, f64::NEG_INFINITY), of(max, f64::INFINITY)];
    check_bounds(bounds, min.is_some() || max.is_some(), scope)
}

/// Bounds of which one at least is written, and which are not crossed.
pub(super) fn check_bounds(
    bounds: [f64; 2],
    is_written: bool,
    scope: &Scope<'_>,
) -> Result<[f64; 2]> {
    if !is_written {
        return Err(scope.wrong("no bound", "\"min\", \"max\" or both"));
    }
    if bounds[0] > bounds[1] {
        let found = "\"max\" below \"min\"";
        return Err(scope.key("max").wrong(found, "bounds that are not crossed"));
    }
    Ok(bounds)
}

/// The weight of a cost, 1 where not written.
pub(super) fn weight(spec: Option<f64>, scope: &Scope<'_>) -> Result<f64> {
    match spec.unwrap_or(1.0) {
        weight if weight > 0.0 => Ok(weight),
        weight => {
            let place = scope.key("weight");
            Err(place.wrong(weight.to_string(), "a positive weight"))
        }
    }
}

/// The weighted squared deviation of a quantity from a function of time.
pub(super) fn square(
    quantity: Quantity,
    reference: impl Into<Signal>,
    weight: f64,
    during: During,
) -> QuantityCost {
    let reference = reference.into();
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during,
    }
}

/// The weighted integral or value of a quantity that is a square.
pub(super) fn itself(quantity: Quantity, weight: f64, during: During) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Itself,
        during,
    }
}

/// A plane that is fixed to a body, or to the ground where none is named.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// Name of the body.
    #[serde(default)]
    pub body: Option<String>,
    /// A point of the plane in the reference configuration, SI unit m.
    pub point: Point,
    /// Its normal in the reference configuration, of any length; distances on its side are positive.
    pub normal: [f64; 3],
}

impl PlaneSpec {
    /// The plane that it stands for.
    pub(super) fn plane(&self, system: &System, scope: &Scope<'_>) -> Result<Plane> {
        let bodies = names(&system.bodies, |body| &body.name);
        let place = scope.key("body");
        let body = self.body.as_ref();
        let body = body.map(|name| place.find(name, &bodies, "the name of a body"));
        Ok(Plane {
            body: body.transpose()?,
            point: vector(&self.point),
            normal: unit_axis(&self.normal, &scope.key("normal"))?,
        })
    }
}
