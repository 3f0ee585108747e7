//! Solution of a task as it is stored: enough to start any later run exactly.

use std::collections::BTreeMap;

use crate::kinematics::Pose;
use crate::model::{Coordinates, FoundParameter};

/// A motion with voltages and, from an optimisation, costates. Times in ms, voltages in V.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Coordinates in which `z` and the costates are meant.
    pub coordinates: Coordinates,
    /// Instants.
    pub times: Vec<f64>,
    /// Joint coordinates by instant and joint.
    pub joints: Vec<Vec<f64>>,
    /// Poses by instant and body.
    pub poses: Vec<Vec<Pose>>,
    /// Coordinates and multipliers by instant.
    pub z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at the end, where it is known.
    pub momentum: Vec<f64>,
    /// Reference places in mm of the nodes of each solid and each muscle of finite elements, by its name, where they are known.
    pub meshes: BTreeMap<String, Vec<[f64; 3]>>,
    /// Time h₀ in ms that scales the multipliers in `z`.
    pub multiplier_time: f64,
    /// Voltages by interval and muscle.
    pub voltages: Vec<Vec<f64>>,
    /// Voltages by muscle that hold the goal, where there is one and they are known.
    pub hold: Option<Vec<f64>>,
    /// Potentials by interval, where a scene has any.
    pub potentials: Vec<Vec<f64>>,
    /// Parameters that were sought.
    pub parameters: Vec<FoundParameter>,
    /// Multipliers of the optimisation.
    pub costates: Option<Costates>,
    /// Barrier parameter of a solve that has not come to its end.
    pub barrier: Option<f64>,
}

/// Multipliers of an optimisation, unscaled, in the order of its rows and variables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Costates {
    /// Of the rows.
    pub rows: Vec<f64>,
    /// Of the lower bounds of the variables.
    pub lower: Vec<f64>,
    /// Of the upper bounds of the variables.
    pub upper: Vec<f64>,
}

impl Solution {
    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.voltages.len()
    }
}
