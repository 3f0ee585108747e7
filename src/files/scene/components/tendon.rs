//! Tendons.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::components::spring::ComponentSpec;
use crate::files::scene::names::attachment;
use crate::files::scene::point::PointSpec;
use crate::files::units::quantity::{Length, Quantity, Stiffness};
use crate::model::components::Tendon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An elastic cable that slides without friction through points and takes no compression: tension k max(length − rest length, 0).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TendonSpec {
    /// Name, unique among springs and tendons.
    pub name: String,
    /// The points, two or more: the ends, and between them those that it slides through.
    pub through: Vec<PointSpec>,
    /// Stiffness k of the whole cable, SI unit N/m.
    pub stiffness: Quantity<Stiffness>,
    /// Length up to which it is slack, SI unit m; the length of the path where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_length: Option<Quantity<Length>>,
    /// Width around the rest length over which the stiffness grows from zero to k, SI unit m, for optimal control; it jumps where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<Quantity<Length>>,
}

impl ComponentSpec for TendonSpec {
    type Part = Tendon;

    fn name(&self) -> &String {
        &self.name
    }

    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Tendon, SceneError> {
        let place = scope.key("through");
        if self.through.len() < 2 {
            let found = format!("{} points", self.through.len());
            return Err(place.wrong(found, "2 points or more"));
        }
        let point = |(index, point): (usize, &PointSpec)| {
            attachment(&point.body, &point.at, bodies, &place.index(index))
        };
        let points = self.through.iter().enumerate().map(point);
        let through = points.collect::<Result<Vec<_>, _>>()?;
        let spans = || {
            through
                .windows(2)
                .map(|pair| (pair[1].at - pair[0].at).norm())
        };
        if let Some(index) = spans().position(|span| span == 0.0) {
            let expected =
                "another place than the point before, as the span has no direction there";
            let place = place.index(index + 1).key("at");
            return Err(place.wrong("the place of the point before", expected));
        }
        let stiffness = scope.key("stiffness").positive(&self.stiffness)?;
        let rest_length = match &self.rest_length {
            Some(length) => scope.key("rest_length").positive(length)?,
            None => spans().sum(),
        };
        let smoothing = match &self.smoothing {
            Some(width) => {
                let place = scope.key("smoothing");
                let value = place.positive(width)?;
                if value > 2.0 * rest_length {
                    return Err(place.wrong(width.to_string(), "at most twice the rest length"));
                }
                value
            }
            None => 0.0,
        };
        Ok(Tendon {
            name: self.name.clone(),
            through,
            stiffness,
            rest_length,
            smoothing,
        })
    }
}
