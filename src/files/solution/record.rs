//! Types of `solution.json`.

use crate::files::npz::NpzError;
use crate::model::system::{Joint, JointKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

/// ms in a s.
pub(super) const SECOND: f64 = 1e3;
/// mm in a m.
pub(super) const METRE: f64 = 1e3;

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
    pub(crate) joints: Option<BTreeMap<String, Vec<f64>>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) configuration: Option<ConfigurationRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) voltages: Option<BTreeMap<String, Vec<f64>>>,
    /// Loads by interval, in N and N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) loads: Option<BTreeMap<String, Vec<f64>>>,
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
    pub(crate) joints: BTreeMap<String, Vec<f64>>,
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

/// An earlier solution cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct SolutionError {
    /// The file.
    pub path: PathBuf,
    /// Reason.
    pub reason: Reason,
}

/// The content of a file, or why it is no solution.
pub(super) type Result<T, E = Reason> = std::result::Result<T, E>;

/// Reason why a file is no solution of a scene.
#[derive(Debug, thiserror::Error)]
pub enum Reason {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// There is not enough memory for its contents.
    #[error("found {found}, expected {expected}")]
    TooLarge {
        /// Its size.
        found: String,
        /// The largest one.
        expected: String,
    },
    /// It is not JSON.
    #[error("no JSON: {0}")]
    NoJson(serde_json::Error),
    /// It is JSON, but no solution.
    #[error(
        "{place}: {found}; a solution.json holds \"time\", \"voltages\", and joint coordinates in \"configuration\" or \"joints\""
    )]
    NoSolution {
        /// Path in the file.
        place: String,
        /// Value that was found there.
        found: String,
    },
    /// Its names are not those of the scene.
    #[error("belongs to another scene: {0}")]
    OtherScene(String),
    /// Its arrays cannot be used.
    #[error("its arrays in {}: {cause}", path.display())]
    Arrays {
        /// Their file.
        path: PathBuf,
        /// Cause.
        cause: NpzError,
    },
    /// Its arrays were written with another file.
    #[error("its arrays in {} were written with another solution", .0.display())]
    OtherArrays(PathBuf),
    /// Its parts do not fit together.
    #[error("{0}")]
    Contradiction(String),
}
