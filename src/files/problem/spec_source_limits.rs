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
    /// Limits of the current from one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both.
    ///
    /// Behind a resistor it is the mean current in each interval. Otherwise it is the charge that flows from the middle of an interval to that
    /// of the next one, where the voltage jumps too; from and to states of rest that are known it is that of half an interval.
    CurrentLimitSpec: Current, "A";
    /// Limits of the power of one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both, at the
    /// times of a current.
    ///
    /// Without a resistor it is that of the stored energy and of the work on the motion, as in the table; losses of charging in steps do not
    /// count.
    PowerLimitSpec: Power, "W";
    /// Limits of the rate of the voltage of one source (`"source": name`) or each (`"sources": "all"`) from interval to interval: `min`,
    /// `max` or both.
    VoltageRateLimitSpec: VoltageRate, "V/s";
}
