//! A voltage as a function of time, as it is written.

use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::files::json::either::{Either, ScalarOrObject, scalar_or_object};
use crate::files::units::quantity::{Angle, Quantity, Time, Voltage};

/// A constant voltage (SI unit V), or exactly one of `ramp`, `sine` and `table`.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum SignalSpec {
    /// Constant.
    Constant(Quantity<Voltage>),
    /// A function of time.
    Function(Box<FunctionSpec>),
}

/// A function of time: exactly one of the three.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FunctionSpec {
    /// Linear between two values, constant before and after.
    #[serde(default)]
    pub ramp: Option<RampSpec>,
    /// A sine.
    #[serde(default)]
    pub sine: Option<SineSpec>,
    /// Linear between values at times, constant before and after.
    #[serde(default)]
    pub table: Option<SignalTableSpec>,
}

/// Linear between two values, constant before and after.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RampSpec {
    /// Value up to the start, SI unit V; 0 where not written.
    #[serde(default)]
    pub from: Option<Quantity<Voltage>>,
    /// Value from the end on, SI unit V.
    pub to: Quantity<Voltage>,
    /// Time at which it begins, SI unit s; 0 where not written.
    #[serde(default)]
    pub start: Option<Quantity<Time>>,
    /// Time that it takes, SI unit s.
    pub duration: Quantity<Time>,
}

/// `mean + amplitude sin(2π t/period + phase)`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SineSpec {
    /// Mean, SI unit V; 0 where not written.
    #[serde(default)]
    pub mean: Option<Quantity<Voltage>>,
    /// Amplitude, SI unit V.
    pub amplitude: Quantity<Voltage>,
    /// Period, SI unit s.
    pub period: Quantity<Time>,
    /// Phase, SI unit rad; 0 where not written.
    #[serde(default)]
    pub phase: Option<Quantity<Angle>>,
}

/// Values at times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalTableSpec {
    /// Times, growing, SI unit s.
    pub time: Vec<Quantity<Time>>,
    /// A value at each, SI unit V.
    pub values: Vec<Quantity<Voltage>>,
}

scalar_or_object! {
    SignalSpec: Quantity<Voltage> = Self::Constant, Box<FunctionSpec> = Self::Function,
        "a voltage such as \"1.7 kV\", or an object with \"ramp\", \"sine\" or \"table\"";
}
