//! Limits of sources as they are written: a part of the problem file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::files::units::quantity::{Current, Power, Quantity, VoltageRate};

/// All of them.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum All {
    /// All of them.
    All,
}

/// Declares limits of one source (`"source": name`) or all (`"sources": "all"`): `min`, `max` or both.
macro_rules! source_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal;)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Name of the source: that of its muscle or electrode.
                #[serde(default)]
                pub source: Option<String>,
                /// All sources.
                #[serde(default)]
                pub sources: Option<All>,
                #[doc = concat!("Lower bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub min: Option<Quantity<$measure>>,
                #[doc = concat!("Upper bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub max: Option<Quantity<$measure>>,
            }
        )*
    };
}

source_limits! {
    /// Limits of the mean current in each interval from one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles
    /// behind resistors: `min`, `max` or both.
    CurrentLimitSpec: Current, "A";
    /// Limits of the mean power in each interval of one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles behind
    /// resistors: `min`, `max` or both.
    PowerLimitSpec: Power, "W";
    /// Limits of the rate of the voltage of one source (`"source": name`) or each (`"sources": "all"`) from interval to interval: `min`,
    /// `max` or both. The duration has to be given.
    VoltageRateLimitSpec: VoltageRate, "V/s";
}
