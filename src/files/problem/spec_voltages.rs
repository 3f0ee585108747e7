//! Voltages as they are written: constant, of a solution, or a table.

use crate::files::json::objects::read_objects;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{Quantity, Time, Voltage};
use schemars::JsonSchema;
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;

/// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
pub type VoltageMap = BTreeMap<String, Quantity<Voltage>>;

/// Voltages by muscle or driven electrode, constant or functions of time; 0 where not named; `{"solution": path}`, or `{"time": [...], "voltages": {...}}`.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum VoltagesSpec {
    /// Those of a `solution.json`.
    Solution(SolutionSpec),
    /// A table.
    Table(TableSpec),
    /// Constant, or functions of time.
    Signals(BTreeMap<String, SignalSpec<Voltage>>),
}

read_objects! {
    /// A solution by its path.
    pub struct SolutionSpec {
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder.
        pub solution: String,
    }
}

/// Voltages that are constant in intervals of time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Start and end of the intervals, growing, the first of them 0; SI unit s.
    pub time: Box<[Quantity<Time>]>,
    /// A voltage for each interval by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not
    /// named.
    pub voltages: BTreeMap<String, Box<[Quantity<Voltage>]>>,
    /// Voltages after the last interval; those of the last interval where not written.
    #[serde(default)]
    pub hold: Option<VoltageMap>,
}

impl Default for VoltagesSpec {
    fn default() -> Self {
        Self::Signals(BTreeMap::new())
    }
}

impl<'de> Deserialize<'de> for VoltagesSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(VoltagesVisitor)
    }
}

struct VoltagesVisitor;

impl<'de> Visitor<'de> for VoltagesVisitor {
    type Value = VoltagesSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "voltages by name, an object with \"solution\", or one with \"time\" and \"voltages\"",
        )
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<VoltagesSpec, A::Error> {
        let mut signals = BTreeMap::new();
        let (mut solution, mut time, mut voltages, mut hold) = (None, None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "solution" => solution = Some(map.next_value()?),
                "time" => time = Some(map.next_value()?),
                "voltages" => voltages = Some(map.next_value()?),
                "hold" => hold = Some(map.next_value()?),
                _ => drop(signals.insert(key, map.next_value()?)),
            }
        }
        let has_signals = !signals.is_empty();
        match (solution, time, voltages, hold) {
            (None, None, None, None) => Ok(VoltagesSpec::Signals(signals)),
            (Some(solution), None, None, None) if !has_signals => {
                Ok(VoltagesSpec::Solution(SolutionSpec { solution }))
            }
            (None, Some(time), Some(voltages), hold) if !has_signals => {
                Ok(VoltagesSpec::Table(TableSpec {
                    time,
                    voltages,
                    hold,
                }))
            }
            (Some(_), ..) => {
                let found = Unexpected::Other("\"solution\" beside voltages");
                Err(A::Error::invalid_value(found, &self))
            }
            (None, time, voltages, _) => {
                let lacks = match (time, voltages) {
                    (None, _) => "a table without \"time\"",
                    (_, None) => "a table without \"voltages\"",
                    _ => "a table beside voltages by name",
                };
                Err(A::Error::invalid_value(Unexpected::Other(lacks), &self))
            }
        }
    }
}
