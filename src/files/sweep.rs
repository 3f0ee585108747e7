//! A sweep as it is written: the serde types of the sweep file.

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

use crate::files::json::objects::read_objects;
use crate::files::study::ChangesSpec;

read_objects! {
    /// A sweep: one problem solved in many variants.
    pub struct SweepSpec {
        /// JSON Schema of this file, for editors.
        #[serde(rename = "$schema", default)]
        #[expect(dead_code, reason = "read by editors only")]
        pub(crate) schema: Option<String>,
        /// Title of the page; the name of the file where not written.
        pub title: Option<String>,
        /// Path of the problem file, relative to this file.
        pub problem: String,
        /// Overrides of all variants.
        pub set?: ChangesSpec,
        /// Entries that vary, by their places in the problem, or in its scene after `scene.`.
        pub vary: BTreeMap<String, VarySpec>,
        /// Combination of the values; as a grid where not written.
        pub combine?: CombineSpec,
        /// Path of a CSV file with a variant per line, in place of `vary`: its headers are places, its cells values.
        pub table: Option<String>,
    }
}

/// The values of one entry.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum VarySpec {
    /// These.
    Values(Vec<Value>),
    /// Those of a range.
    Range(RangeSpec),
}

read_objects! {
    /// A range of numbers, or of quantities of one unit.
    pub struct RangeSpec {
        /// The first value: a number, or a text with a unit.
        pub from: Value,
        /// The last value, in the same unit.
        pub to: Value,
        /// Number of values, both ends included; 2 or more. Not for values at random.
        pub count: Option<usize>,
        /// Spacing of the values; even where not written.
        pub spacing?: SpacingSpec,
    }

    /// Spacing of values.
    #[derive(Default)]
    pub enum SpacingSpec {
        /// Equal differences.
        #[default]
        Linear,
        /// Equal ratios, of values above zero.
        Logarithmic,
    }
}

/// Combination of the values of several entries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CombineSpec {
    /// Each with each.
    #[default]
    Grid,
    /// The first of each, the second of each, and so on: lists of one length.
    Together,
    /// Values drawn at random from each list or range.
    Random(RandomSpec),
}

read_objects! {
    /// Variants at random.
    #[derive(Copy, PartialEq, Eq)]
    pub struct RandomSpec {
        /// Number of variants.
        pub count: usize,
        /// Equal seeds give equal variants; 1 where not written.
        #[serde(default = "one")]
        pub seed: u64,
    }
}

fn one() -> u64 {
    1
}
