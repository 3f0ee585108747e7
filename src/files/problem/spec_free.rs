//! Sought constants of a scene as they are written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::files::units::quantity::{Quantity, SoughtConstant};

/// A constant that is sought between bounds.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreeSpec {
    /// Lower bound, in the unit of the constant.
    pub min: Quantity<SoughtConstant>,
    /// Upper bound.
    pub max: Quantity<SoughtConstant>,
    /// Value at which the solver starts; the value of the scene where not written.
    #[serde(default)]
    pub guess: Option<Quantity<SoughtConstant>>,
    /// Other constants by their paths that are this one times a number.
    #[serde(default)]
    pub also: BTreeMap<String, f64>,
}

/// Sought constants by their paths in the scene.
pub type FreeMap = BTreeMap<String, FreeSpec>;
