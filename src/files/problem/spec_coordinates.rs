//! The word for coordinates.

use schemars::JsonSchema;
use serde::Deserialize;

/// Coordinates in which a problem is solved; reduced where the joints form a tree, unless written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CoordinatesSpec {
    /// Independent joint coordinates.
    Reduced,
    /// Directors with multipliers.
    Redundant,
}
