//! Trajectory of a motion: instants, joint coordinates, poses, places of markers, voltages and observed columns.
//!
//! The record of a motion: coordinates, momenta and voltages on a time grid.
//!
//! Inputs at an instant: the limits from the intervals on both of its sides, with weights of which the sum is 1.
//!
//! A quantity of the table is the mean of its values on both sides, each weighted by the length of the other interval. Where the inputs are
//! continuous both are equal; where they switch it is a mean of both; where they are constant over intervals it is of second order.
//!
//! The state of a stepper at the end of a step: from it the next steps have the bits that they would have had without a stop.
//!
//! Besides the state of the equations that is the tangent which was factorised last, where later steps go on with it: its factors are made
//! again from the same matrix by the same method.

use crate::dynamics::energies::Work;
use crate::dynamics::solving::{Inputs, Solving};
use crate::kinematics::Pose;
use crate::model::system::{Attachment, Joint, JointKind, System};
use crate::model::{Model, Time, nearest_turn};
use crate::sparse::MethodState;
use crate::sparse::multigrid::MultigridReport;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fmt;
use std::fmt::Write;

/// Values over time: N + 1 instants and the N intervals between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// Instants in ms, N + 1 of them; at least one.
    pub times: Vec<f64>,
    /// Joint coordinates in rad or mm, per instant; named by [`Trajectory::coordinates`].
    pub joints: Vec<Vec<f64>>,
    /// Poses per instant and body.
    pub poses: Vec<Vec<Pose>>,
    /// Places of the markers in mm, per instant and marker of the system.
    pub marks: Vec<Vec<Vector3<f64>>>,
    /// Voltages in V and loads in N or N mm, per interval and source.
    pub voltages: Vec<Vec<f64>>,
    /// The same at both ends of each interval, where they vary within intervals; otherwise empty.
    pub ends: Vec<[Vec<f64>; 2]>,
    /// Charge in mC of each muscle behind a circuit, per instant.
    pub charges: BTreeMap<usize, Vec<f64>>,
}

impl Trajectory {
    /// The motion of a model: poses, joint coordinates without jumps, and a voltage for every muscle.
    pub fn from_discrete(model: &Model, discrete: &DiscreteTrajectory) -> Self {
        let mut instant = model.action.map.instant();
        let mut near = vec![0.0; model.joint_readings.len()];
        let mut trajectory = Self {
            times: discrete.times.clone(),
            charges: model.circuit_charges(&discrete.z),
            ..Self::default()
        };
        for z in &discrete.z {
            instant.z.copy_from_slice(z);
            model.action.map.vectors(&mut instant);
            near = model.joints(&instant, &near);
            let with_coordinate = near
                .iter()
                .zip(&model.system.joints)
                .filter(|(_, joint)| joint.has_coordinate());
            trajectory
                .joints
                .push(with_coordinate.map(|(&value, _)| value).collect());
            trajectory.poses.push(model.poses(&instant));
            let marks = model.markers.iter().map(|&vector| instant.x[vector]);
            trajectory.marks.push(marks.collect());
        }
        let rows = discrete.scalars.iter();
        trajectory.voltages = rows.map(|scalars| by_source(model, scalars)).collect();
        let at_end = |of: &Inputs| by_source(model, &model.variables.scalars(&of.values));
        let ends = discrete.ends.iter();
        trajectory.ends = ends.map(|ends| ends.each_ref().map(at_end)).collect();
        trajectory
    }

    /// Place in mm of a material point at instant `k`: c + R R₀ᵀ (X − c₀); points of the ground stay.
    pub fn point(&self, k: usize, point: &Attachment, system: &System) -> Vector3<f64> {
        point.place(&self.poses[k], |body| system.bodies[body].pose())
    }

    /// Path in mm of a marker of the system, instant by instant.
    pub fn path(&self, marker: usize) -> Vec<Vector3<f64>> {
        self.marks.iter().map(|places| places[marker]).collect()
    }

    /// Voltages in V, by source, of each interval: without loads.
    pub fn voltages(&self, system: &System) -> impl Iterator<Item = &[f64]> {
        let first = system.first_load();
        self.voltages.iter().map(move |row| &row[..first])
    }

    /// Voltage of a source at both ends of each interval.
    pub fn voltages_at_ends(&self, source: usize) -> impl Iterator<Item = [f64; 2]> {
        let constant = self.voltages.iter().enumerate();
        constant.map(move |(k, row)| match self.ends.get(k) {
            Some(ends) => ends.each_ref().map(|row| row[source]),
            None => [row[source]; 2],
        })
    }

    /// Number N of intervals.
    pub fn intervals(&self) -> usize {
        self.times.len().saturating_sub(1)
    }

    /// Names and units of the joint coordinates, in the order of `joints`: one for each revolute or prismatic joint.
    pub fn coordinates(&self, system: &System) -> Vec<Coordinate> {
        let coordinate = |joint: &Joint| {
            let unit = match joint.kind {
                JointKind::Revolute { .. } => "rad",
                JointKind::Prismatic { .. } => "mm",
                _ => return None,
            };
            Some(Coordinate {
                name: joint.name.clone(),
                unit,
            })
        };
        system.joints.iter().filter_map(coordinate).collect()
    }

    /// Columns of a joint with several coordinates and without a chart; angles go on beyond whole turns.
    fn several(&self, joint: &Joint, system: &System) -> Vec<Column> {
        let names = joint.several_names().into_iter();
        let mut columns: Vec<Column> = names
            .map(|(name, unit)| Column {
                name,
                unit,
                values: Vec::with_capacity(self.poses.len()),
            })
            .collect();
        if columns.is_empty() {
            return columns;
        }
        let reference: Vec<Pose> = system.bodies.iter().map(|body| body.pose()).collect();
        for poses in &self.poses {
            let values = joint.several(poses, &reference).unwrap_or_default();
            for (column, value) in columns.iter_mut().zip(values) {
                let before = column.values.last().copied().unwrap_or(0.0);
                column.values.push(match column.unit {
                    "rad" => nearest_turn(value, before),
                    _ => value,
                });
            }
        }
        columns
    }

    /// Returns the observations that need no model: time, joint coordinates and marker positions.
    pub fn observe(&self, system: &System) -> Observations {
        let mut columns = vec![Column {
            name: "time".to_owned(),
            unit: "ms",
            values: self.times.clone(),
        }];
        for (i, coordinate) in self.coordinates(system).into_iter().enumerate() {
            columns.push(Column {
                name: coordinate.name,
                unit: coordinate.unit,
                values: self.joints.iter().map(|u| u[i]).collect(),
            });
        }
        let several = system.joints.iter();
        columns.extend(several.flat_map(|joint| self.several(joint, system)));
        for (m, marker) in system.markers.iter().enumerate() {
            let path = self.path(m);
            for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
                columns.push(Column {
                    name: format!("{}_{axis}", marker.name),
                    unit: "mm",
                    values: path.iter().map(|p| p[i]).collect(),
                });
            }
        }
        Observations { columns }
    }
}

/// Voltages and loads by source of an interval with these scalars; zero of sources that do nothing.
pub fn by_source(model: &Model, scalars: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; model.sources.len()];
    for (variable, &scalar) in model.variables.of(Time::Interval).iter().zip(scalars) {
        if let Some(source) = variable.source {
            row[source] = scalar;
        }
    }
    row
}

/// Name and unit of a joint coordinate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordinate {
    /// Name of the joint.
    pub name: String,
    /// `rad` or `mm`.
    pub unit: &'static str,
}

/// Columns of numbers with names and units: one row per instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// The columns, all of one length.
    pub columns: Vec<Column>,
}

/// One observed quantity over the instants.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name, such as `kinetic_energy` or `tip_x`.
    pub name: String,
    /// Unit, such as `N mm`; empty for a pure number.
    pub unit: &'static str,
    /// One value per instant.
    pub values: Vec<f64>,
}

/// N + 1 instants and N intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiscreteTrajectory {
    /// Times of the instants in ms.
    pub times: Vec<f64>,
    /// Coordinates and multipliers of each instant; multipliers of the last instant are those before it.
    pub z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at each instant.
    pub momenta: Vec<Vec<f64>>,
    /// Rates of the coordinates at the start, where they are known.
    pub rates: Option<Vec<f64>>,
    /// Time in ms to which prescribed motions have come at the start.
    pub begun: f64,
    /// Voltages of each interval in V and potentials in their unit, by scalar of the interval.
    pub scalars: Vec<Vec<f64>>,
    /// Inputs at both ends of each interval; empty where they are constant in all of them.
    pub ends: Vec<[Inputs; 2]>,
    /// Scalars after the last interval, where the inputs that hold the end of the motion were found with it.
    pub held: Option<Vec<f64>>,
    /// Times at which energies and momenta are read.
    pub reading: Reading,
    /// Work of forces without a potential in each interval, where instants alone do not determine it.
    pub works: Vec<Work>,
    /// The method that factorised the tangents of the steps.
    pub solver: String,
    /// Report of the steps.
    pub report: StepperReport,
    /// State from which the motion can be resumed.
    pub end: StepState,
}

/// Times to which the energies and momenta of a method belong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// At the midpoints of intervals, where the midpoint rule sees energies.
    #[default]
    Intervals,
    /// At instants, by their momenta.
    Instants,
    /// At instants, each with the inputs and potentials of the interval that ends there: equilibria.
    States,
}

impl DiscreteTrajectory {
    /// A motion in equal steps of h ms.
    pub fn in_steps(h: f64, z: Vec<Vec<f64>>, scalars: Vec<Vec<f64>>) -> Self {
        Self {
            times: (0..z.len()).map(|k| k as f64 * h).collect(),
            z,
            scalars,
            ..Self::default()
        }
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.scalars.len()
    }
}

/// One side of an instant.
#[derive(Debug)]
pub(super) struct Side {
    /// Voltages, loads and potentials.
    pub(super) scalars: Vec<f64>,
    /// Rates per ms of the inputs among them; zero of all others.
    pub(super) rates: Vec<f64>,
    /// Its weight.
    pub(super) weight: f64,
}

/// The sides of instant k: the one before it and the one after it, where there are such intervals.
pub(super) fn sides(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> Vec<Side> {
    let none = || vec![0.0; model.action.intervals.scalars];
    let count = discrete.intervals();
    if count == 0 {
        let (scalars, rates, weight) = (none(), none(), 1.0);
        return vec![Side {
            scalars,
            rates,
            weight,
        }];
    }
    let inputs = model.variables.inputs();
    let length = |interval: usize| discrete.times[interval + 1] - discrete.times[interval];
    let side = |interval: usize, end: usize, weight: f64| {
        let mut scalars = discrete.scalars[interval].clone();
        let mut rates = none();
        if let Some(ends) = discrete.ends.get(interval) {
            scalars[inputs.clone()].copy_from_slice(&ends[end].values);
            rates[inputs.clone()].copy_from_slice(&ends[end].rates);
        }
        Side {
            scalars,
            rates,
            weight,
        }
    };
    if discrete.reading == Reading::States {
        return vec![side(k.max(1) - 1, 1, 1.0)];
    }
    if k > 0 && k < count {
        let [before, after] = [length(k - 1), length(k)];
        let part = after / (before + after);
        return vec![side(k - 1, 1, part), side(k, 0, 1.0 - part)];
    }
    let mut only = match k {
        0 => side(0, 0, 1.0),
        _ => side(k - 1, 1, 1.0),
    };
    extrapolate(model, discrete, k, &mut only);
    vec![only]
}

/// Extrapolates the potentials, which are known within intervals, to the first or the last instant k, unless the inputs switch before the next
/// instant.
fn extrapolate(model: &Model, discrete: &DiscreteTrajectory, k: usize, side: &mut Side) {
    let potentials = model.variables.algebraic();
    let count = discrete.intervals();
    let is_known = k > 0 && discrete.reading == Reading::Instants;
    if potentials.is_empty()
        || count < 2
        || is_known
        || jump(model, discrete, k.clamp(1, count - 1))
    {
        return;
    }
    let at = |interval: usize| match discrete.reading {
        Reading::Intervals => 0.5 * (discrete.times[interval] + discrete.times[interval + 1]),
        Reading::Instants | Reading::States => discrete.times[interval + 1],
    };
    let [near, far] = if k == 0 {
        [0, 1]
    } else {
        [count - 1, count - 2]
    };
    let part = (discrete.times[k] - at(near)) / (at(near) - at(far));
    for i in potentials {
        let [near, far] = [near, far].map(|interval| discrete.scalars[interval][i]);
        side.scalars[i] = near + part * (near - far);
    }
}

/// Returns true if inputs switch at an instant between two intervals.
fn jump(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> bool {
    let inputs = model.variables.inputs();
    let [before, after] = match (discrete.ends.get(k - 1), discrete.ends.get(k)) {
        (Some(before), Some(after)) => [&before[1].values[..], &after[0].values[..]],
        _ => [k - 1, k].map(|interval| &discrete.scalars[interval][inputs.clone()]),
    };
    let size = before
        .iter()
        .chain(after)
        .fold(0.0_f64, |size, x| size.max(x.abs()));
    // Limits of what is continuous differ by rounding.
    before
        .iter()
        .zip(after)
        .any(|(a, b)| (a - b).abs() > 1e-9 * size)
}

/// All that the next steps follow from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepState {
    /// Identity of the equations and method: the digits of [`StepState::equations_hash`].
    pub of: String,
    /// State of the equations, list by list; none before the first step.
    pub lists: Vec<(String, Vec<f64>)>,
    /// The tangent that is kept, where one is.
    pub tangent: Option<TangentState>,
    /// Report of the steps.
    pub report: StepperReport,
    /// Length in ms that the next step may have, where a tolerance controls it.
    pub wanted: Option<f64>,
    /// The tolerance that controls the steps: tighter than the one asked for where that left too great an error.
    pub tolerance: Option<f64>,
}

/// A tangent that is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TangentState {
    /// Step in ms that it belongs to; none where there are no factors.
    pub step: Option<f64>,
    /// True if the symmetric part of the matrix is factorised.
    pub is_approximate: bool,
    /// Method of its factorisation.
    pub method: MethodState,
    /// Entries of the matrix.
    pub matrix: Vec<f64>,
}

impl StepState {
    /// Returns the hash of the equations of a method for a model.
    pub fn equations_hash(model: &Model, solving: Solving) -> String {
        let mut digits = Digits(0xcbf2_9ce4_8422_2325);
        let (coordinates, system) = (model.coordinates, &model.presolved.system);
        write!(digits, "{solving:?} {coordinates:?} {system:?}").expect("digits take everything");
        format!("{:016x}", digits.0)
    }

    /// The same at time zero, with nothing counted so far.
    pub fn begun_anew(mut self) -> Self {
        let is_time = |name: &str| name == "time" || name.ends_with(" time");
        let now = self.lists.iter().find(|(name, _)| name == "time");
        let now = now
            .and_then(|(_, time)| time.first().copied())
            .unwrap_or(0.0);
        for (_, times) in self.lists.iter_mut().filter(|(name, _)| is_time(name)) {
            times.iter_mut().for_each(|time| *time -= now);
        }
        self.report = StepperReport::default();
        self.tolerance = None;
        self
    }
}

/// The hash FNV-1a of a formatted text.
struct Digits(u64);

impl Write for Digits {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

/// Counts and times of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepperReport {
    /// Steps taken, halved ones included.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Steps that had to be halved.
    pub halved: usize,
    /// Factorisations of the tangent.
    pub factorisations: usize,
    /// Seconds in the rows and the tangent.
    pub assembly: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Seconds in solutions with them.
    pub solution: f64,
    /// Systems for which a direct solver took over from an iteration.
    pub fallbacks: usize,
    /// Counts of the iterations with multigrid.
    pub multigrid: MultigridReport,
    /// Energy in mJ that the steps made, or lost where negative, where the method has a balance of energy.
    pub made: f64,
    /// Greatest energy in mJ that one step exchanged.
    pub exchanged: f64,
}
