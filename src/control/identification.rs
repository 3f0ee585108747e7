//! Identification: constants of a system that recordings of its motions are to determine. Units g, mm, ms, N, V.
//!
//! An earlier solution to start from: in memory, or read once the model exists.

use crate::control::boundary_state::BoundaryState;
use crate::control::inputs::Voltages;
use crate::kinematics::Pose;
use crate::model::{Coordinates, FoundParameter, Model, Parameter, Quantity, System};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Debug;
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

/// Free parameters, and the recordings that tell of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The constants.
    pub parameters: Vec<Parameter>,
    /// Constants that are known beside the recordings.
    pub priors: Vec<Prior>,
    /// The recordings.
    pub recordings: Vec<Recording>,
    /// Experiments that could be done next: their readings have times and no values.
    pub candidates: Vec<Recording>,
    /// Length in ms of the steps of the first grid; `None`: by the times of the readings.
    pub step: Option<f64>,
    /// `None`: reduced.
    pub coordinates: Option<Coordinates>,
}

/// A normal distribution of a constant that is known beside the recordings, such as that of a data sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Index of the constant.
    pub constant: usize,
    /// Its mean.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// A motion, or states of rest, under given voltages and loads, with what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name for messages and files.
    pub name: String,
    /// Its scene where that is another one.
    pub scene: Option<Box<ChangedScene>>,
    /// Motion or states of rest.
    pub regime: Regime,
    /// Voltages and loads over time.
    pub voltages: Voltages,
    /// State at time zero.
    pub start: BoundaryState,
    /// Unknown part of that state.
    pub sought_start: SoughtStart,
    /// True if no constant is fitted to it: it checks their prediction.
    pub is_held_out: bool,
    /// Measured quantities with their readings.
    pub channels: Vec<Channel>,
}

/// A scene that is another one in a recording, such as that of a robot with a payload.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangedScene {
    /// Its system.
    pub system: System,
    /// The free parameters in it, in the order of the others.
    pub parameters: Vec<Parameter>,
}

/// Course of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// A motion from time zero on.
    Motion,
    /// A state of rest at each time, under the voltages of that time.
    Rest,
}

/// Unknowns of the state at the start of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SoughtStart {
    /// None.
    #[default]
    Nothing,
    /// Its coordinates; it is at rest or has the momenta that are given.
    Coordinates,
    /// Its coordinates and momenta.
    State,
}

/// A measured quantity: a linear combination of quantities of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name for messages and files.
    pub name: String,
    /// Its parts, each with its factor: the components of a place along a direction.
    pub parts: Vec<(f64, Quantity)>,
    /// Symbol and factor of the SI unit of its values.
    pub unit: (&'static str, f64),
    /// True if the standard deviations of its readings are known; otherwise they are relative, and the residuals tell their size.
    pub is_deviation_known: bool,
    /// The readings, in the order of time.
    pub readings: Vec<Reading>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time in ms.
    pub time: f64,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub deviation: f64,
}

/// Returns true if readings begin later than any two of them are apart: whether the motion begins with the first one is then a question.
pub fn begin_late(times: &[f64]) -> bool {
    let apart = times.windows(2).map(|pair| pair[1] - pair[0]);
    let longest = apart.fold(f64::NEG_INFINITY, f64::max);
    times.len() > 1 && times[0] > longest
}

impl Recording {
    /// Its system and the free parameters of it.
    pub fn of<'a>(
        &'a self,
        system: &'a System,
        parameters: &'a [Parameter],
    ) -> (&'a System, &'a [Parameter]) {
        match &self.scene {
            Some(own) => (&own.system, &own.parameters),
            None => (system, parameters),
        }
    }

    /// Time of the last reading in ms.
    pub fn duration(&self) -> f64 {
        let last = self.channels.iter().filter_map(|one| one.readings.last());
        last.map(|reading| reading.time).fold(0.0, f64::max)
    }

    /// Number of readings.
    pub fn count(&self) -> usize {
        self.channels.iter().map(|one| one.readings.len()).sum()
    }

    /// All readings, channel by channel.
    pub fn readings(&self) -> impl Iterator<Item = &Reading> {
        self.channels.iter().flat_map(|one| &one.readings)
    }
}

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

/// Source of an earlier solution.
pub trait EarlierSolution: Debug + Send + Sync {
    /// The solution, for this model.
    ///
    /// # Errors
    /// It cannot be read, or belongs to another system.
    fn solution(&self, model: &Model) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>>;

    /// The file that it is read from; none where it is in memory.
    fn file(&self) -> Option<&Path> {
        None
    }
}

/// A shared earlier solution; two are equal where they are the same one.
#[derive(Clone, Debug)]
pub struct Earlier(Arc<dyn EarlierSolution>);

impl Earlier {
    /// Shares it.
    pub fn new(earlier: impl EarlierSolution + 'static) -> Self {
        Self(Arc::new(earlier))
    }
}

impl Deref for Earlier {
    type Target = dyn EarlierSolution;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl PartialEq for Earlier {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
