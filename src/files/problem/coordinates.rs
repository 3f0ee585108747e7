//! Conversion of counts and coordinates, which several tasks have.

use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::at::At;
use crate::files::scene::graph::tree_freedoms;
use crate::model::Coordinates;
use schemars::JsonSchema;
use serde::Deserialize;

/// A number of things from one to a limit.
pub(crate) fn count(value: usize, noun: &str, most: usize, at: &Scope<'_>) -> Result<()> {
    let expected = match value {
        0 => format!("1 {noun} or more"),
        _ if value > most => format!("no more than {most} {noun}s"),
        _ => return Ok(()),
    };
    Err(at.wrong(value.to_string(), expected))
}

pub(crate) fn coordinates(
    spec: Option<CoordinatesSpec>,
    at: &At<'_>,
) -> Result<Option<Coordinates>> {
    let (bodies, joints) = (at.system.bodies.len(), &at.system.joints);
    match spec {
        None => Ok(None),
        Some(CoordinatesSpec::Redundant) => Ok(Some(Coordinates::Redundant)),
        Some(CoordinatesSpec::Reduced) if tree_freedoms(bodies, joints).is_none() => {
            let place = at.key("coordinates");
            let found = "\"reduced\", though the joints close a loop";
            Err(place.wrong(found, "\"redundant\""))
        }
        Some(CoordinatesSpec::Reduced) => Ok(Some(Coordinates::Reduced)),
    }
}

/// Coordinates in which a problem is solved; reduced where the joints form a tree, unless written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CoordinatesSpec {
    /// Independent joint coordinates.
    Reduced,
    /// Directors with multipliers.
    Redundant,
}
