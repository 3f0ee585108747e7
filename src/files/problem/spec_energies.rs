//! Weights of energies of sources as they are written.

use crate::files::json::either::{Either, scalar_or_object};
use crate::files::json::objects::read_objects;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

read_objects! {
    /// The weight of an energy of some sources.
    pub struct SourceEnergySpec {
        /// Weight per J.
        pub weight: f64,
        /// Names of lumped muscles.
        pub sources: Vec<String>,
    }
}

/// The weight of an energy of all sources, or of those that are named.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum EnergySpec {
    /// Of all sources, per J.
    All(f64),
    /// Of those that are named.
    Named(SourceEnergySpec),
}

impl Default for EnergySpec {
    fn default() -> Self {
        Self::All(0.0)
    }
}

scalar_or_object! {
    EnergySpec: f64 = Self::All, SourceEnergySpec = Self::Named,
        "a weight, or an object with \"weight\" and \"sources\"";
}
