//! Types of `solution.json`.

use crate::files::json::scope::{Result, Scope};
use crate::model::system::{Joint, JointKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// ms in a s.
pub(super) const SECOND: f64 = 1e3;
/// mm in a m.
pub(super) const METRE: f64 = 1e3;

/// Values over time by name.
pub(super) type Columns = BTreeMap<String, Vec<f64>>;

/// The file.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct SolutionRecord {
    #[serde(default)]
    pub(super) scene: String,
    /// File that holds the arrays of a long motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) arrays: Option<ArraysOf>,
    /// Instants in s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) time: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) joints: Option<Columns>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) configuration: Option<ConfigurationRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) voltages: Option<Columns>,
    /// Loads by interval, in N and N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) loads: Option<Columns>,
    /// Voltages that hold the goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hold: Option<BTreeMap<String, f64>>,
    /// Loads that hold the goal, where they are not those of the last interval, in N and N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) hold_loads: Option<BTreeMap<String, f64>>,
    /// Potentials of elastic blocks by interval, as multiples of their unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) potentials: Vec<Vec<f64>>,
    /// Free parameters by their names, in SI units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) parameters: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) coordinates: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) state: Option<StateRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) costates: Option<Multipliers>,
    /// Barrier parameter of a solve that has not come to its end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) barrier: Option<f64>,
}

impl SolutionRecord {
    /// The instants in ms, which increase.
    pub(crate) fn times(&self, at: &Scope<'_>) -> Result<Vec<f64>> {
        let times: Vec<f64> = self.time.iter().map(|time| time * SECOND).collect();
        at.key("time").increasing(&times)?;
        Ok(times)
    }

    /// Coordinates of joints, with the keys at which they stand.
    pub(crate) fn joint_columns(
        &self,
        at: &Scope<'_>,
    ) -> Result<(&Columns, &'static [&'static str])> {
        match (&self.configuration, &self.joints) {
            (Some(configuration), _) => Ok((&configuration.joints, &["configuration", "joints"])),
            (None, Some(joints)) => Ok((joints, &["joints"])),
            (None, None) => Err(at.wrong("neither of them", "\"configuration\" or \"joints\"")),
        }
    }
}

/// A file of arrays next to a solution.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ArraysOf {
    /// Its name.
    pub(super) file: String,
    /// Digits of its contents: another file is not taken for it.
    pub(super) digits: String,
}

#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct ConfigurationRecord {
    #[serde(default)]
    pub(crate) bodies: BTreeMap<String, Body>,
    pub(crate) joints: Columns,
}

/// Centre (m) and directors d₁, d₂, d₃ of a body at each instant.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Body {
    pub(crate) centre: Vec<[f64; 3]>,
    pub(crate) directors: Vec<[[f64; 3]; 3]>,
}

/// Times in ms, coordinates and multipliers by instant, and reference places of the nodes of each mesh.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct StateRecord {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) times_ms: Vec<f64>,
    pub(super) multiplier_time_ms: f64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) momentum: Vec<f64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) meshes_mm: BTreeMap<String, Vec<[f64; 3]>>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Multipliers {
    pub(super) rows: Vec<f64>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

/// Length of a unit of the file in the units inside: rad for angles, m for displacements.
pub(super) fn unit(joint: &Joint) -> f64 {
    match joint.kind {
        JointKind::Prismatic { .. } => METRE,
        _ => 1.0,
    }
}
