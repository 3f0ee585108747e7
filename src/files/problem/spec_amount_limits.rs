//! Limits of the volume and mass of muscles as they are written: a part of the problem file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::files::units::quantity::{Mass, Quantity, Volume};

/// Declares limits of an amount of lumped muscles, together: `min`, `max` or both.
macro_rules! amount_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal;)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Names of lumped muscles; all of them where not written.
                #[serde(default)]
                pub muscles: Option<Vec<String>>,
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

amount_limits! {
    /// Limits of the volume of lumped muscles at rest, together, which follows from sought constants: `min`, `max` or both.
    MuscleVolumeLimitSpec: Volume, "m^3";
    /// Limits of the mass of lumped muscles with a density, together, which follows from sought constants: `min`, `max` or both.
    MuscleMassLimitSpec: Mass, "kg";
}
