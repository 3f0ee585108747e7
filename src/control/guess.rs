//! Initial guess of the solver: interpolated between start and goal, simulated, or an earlier solution.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::boundary_state::other_mesh;
use crate::control::identification::{Costates, EarlierSolution, Solution};
use crate::control::problem::{Control, Guess};
use crate::control::resample;
use crate::control::resample::Grids;
use crate::coordinates::CoordinateMap;
use crate::dynamics::{DiscreteTrajectory, simulate};
use crate::model::{Coordinates, Graph, Model, Role};
use crate::stop;
use std::borrow::Cow;
use std::error::Error;
use std::fmt::Debug;

/// Added to the rest voltages, as a part of their size: at zero the motion does not depend on a voltage to first order.
const LIFT: f64 = 0.1;

/// A start of the solver: a motion, an interval length, and costates where they are known.
#[derive(Clone, Debug)]
pub struct InitialGuess {
    /// Coordinates, multipliers and voltages.
    pub discrete: DiscreteTrajectory,
    /// Interval length in ms.
    pub h: f64,
    /// Costates and bound multipliers.
    pub costates: Option<Costates>,
    /// Changes that an earlier solution needed.
    pub carried: Carried,
}

impl InitialGuess {
    /// A motion without costates.
    pub fn of_motion(discrete: DiscreteTrajectory, h: f64) -> Self {
        Self {
            discrete,
            h,
            costates: None,
            carried: Carried::default(),
        }
    }
}

/// Changes that an earlier solution needed to be a guess.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried {
    /// Its duration in ms and that of the guess, where they differ: it is stretched in time.
    pub stretched: Option<[f64; 2]>,
    /// True if the guess is the motion under its voltages: it does not give the places of the nodes of these meshes.
    pub simulated: bool,
}

/// Durations that differ by no more than this part are one: a solver may end so far outside a bound.
const SAME_DURATION: f64 = 1e-6;

/// The guess of a control problem on `control.intervals` intervals of about `h` ms; `earlier` is the solution it
/// names, or one that comes before it. A duration that is given stays; one that is free starts from that of the earlier
/// solution, within its bounds.
pub fn guess(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    h: f64,
    earlier: Option<&Solution>,
) -> InitialGuess {
    match (&control.guess, earlier) {
        (_, Some(solved)) => from_solution(model, boundary, control, solved),
        (Guess::Simulate(voltages), _) => {
            let voltages = |time| voltages.at(time).to_vec();
            InitialGuess::of_motion(under_voltages(model, boundary, control, h, voltages), h)
        }
        _ => interpolate(model, boundary, control, h),
    }
}

/// The motion of the model on `control.intervals` intervals of h ms under voltages by source at a time in ms, and under those that
/// `control` gives.
fn under_voltages(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    h: f64,
    voltages: impl Fn(f64) -> Vec<f64>,
) -> DiscreteTrajectory {
    let intervals = control.intervals;
    let scalars = |from: f64, to: f64| {
        let time = 0.5 * (from + to);
        let mut voltages = voltages(time);
        for (source, voltage) in voltages.iter_mut().enumerate() {
            *voltage = control.given_voltage(source, time).unwrap_or(*voltage);
        }
        model.scalars(&voltages)
    };
    let start = &boundary.start;
    let (mut discrete, _) = simulate(model, start, h, intervals, scalars, |_| stop::go_on());
    // A simulation that ends early is held where it ended.
    while discrete.intervals() < intervals {
        discrete.z.push(discrete.z[discrete.z.len() - 1].clone());
        let last = discrete.scalars.last().cloned();
        let still = || model.variables.scalars(&scalars(0.0, h));
        discrete.scalars.push(last.unwrap_or_else(still));
    }
    discrete
}

/// 3s² − 2s³ between start and goal; rest voltages of the goal lifted a little.
fn interpolate(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    h: f64,
) -> InitialGuess {
    let intervals = control.intervals;
    let lift = LIFT * control.voltage_size(&model.system);
    let n = model.coordinate_count();
    let start = &boundary.start.z;
    let end = match &boundary.goal.rest {
        Some(rest) => rest.z.clone(),
        None => {
            let mut end = start.clone();
            for (value, given) in end.iter_mut().zip(&boundary.goal.coordinates) {
                *value = given.unwrap_or(*value);
            }
            end
        }
    };
    let map = &model.action.map;
    let smooth = |s: f64| s * s * (3.0 - 2.0 * s);
    let ends = joints_of(model, start).zip(joints_of(model, &end));
    let z = (0..=intervals).map(|k| {
        let s = smooth(k as f64 / intervals as f64);
        match (&ends, model.coordinates) {
            // Between poses of a tree the path leads over joint coordinates.
            (Some((a, b)), Coordinates::Redundant) => {
                let joints: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + s * (b - a)).collect();
                model.coordinates_at(&joints)
            }
            _ => {
                let mut z = start.clone();
                for i in 0..n {
                    z[i] += s * (end[i] - start[i]);
                }
                z[n..map.unknowns()].fill(0.0);
                map.mean_of_charts(&[(1.0 - s, start), (s, &end)], &mut z);
                z
            }
        }
    });
    let rest = boundary.rest[1].as_ref().or(boundary.rest[0].as_ref());
    let mut held: Vec<f64> = rest.map_or_else(|| vec![0.0; model.sources.len()], Clone::clone);
    for (voltage, source) in held.iter_mut().zip(&model.sources) {
        if !source.is_load() {
            *voltage += lift;
        }
    }
    let scalars = model.scalars(&held);
    let scalars = vec![model.variables.scalars(&scalars); intervals];
    InitialGuess::of_motion(DiscreteTrajectory::in_steps(h, z.collect(), scalars), h)
}

/// Joint coordinates of a state, where they determine all of it.
fn joints_of(model: &Model, z: &[f64]) -> Option<Vec<f64>> {
    let tells_all = Graph::new(&model.system).has_one_coordinate_a_joint(&model.system);
    tells_all.then_some(())?;
    let instant = model.action.map.placed(z);
    Some(model.joints(&instant, &vec![0.0; model.joint_readings.len()]))
}

/// An earlier solution: as it is on the same grid, carried over from another one, stretched in time where its duration is
/// not allowed; from other coordinates the joints and further data of the poses. Where it lacks the places of the nodes, the
/// motion under its voltages.
fn from_solution(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    solved: &Solution,
) -> InitialGuess {
    let map = &model.action.map;
    let has_same_coordinates = solved.coordinates == model.coordinates
        && other_mesh(model, &solved.meshes).is_none()
        && solved.z.iter().all(|z| z.len() == boundary.start.z.len());
    let solved = &*on_uniform_grid(solved, has_same_coordinates.then_some(map));
    let intervals = control.intervals;
    let before = solved.times[solved.intervals()];
    let duration = control.duration.nearest(before);
    let h = duration / intervals as f64;
    let is_stretched = (duration - before).abs() > SAME_DURATION * duration;
    let stretch = if is_stretched { duration / before } else { 1.0 };
    let grids = Grids::new(solved.intervals(), intervals, stretch);
    let carried = Carried {
        stretched: is_stretched.then_some([before, duration]),
        simulated: !has_same_coordinates && !map.of_nodes.is_empty(),
    };
    if carried.simulated {
        let voltages = |time: f64| {
            let k = (time / h) as usize;
            grids.mean(&solved.voltages, k.min(intervals - 1))
        };
        let discrete = under_voltages(model, boundary, control, h, voltages);
        return InitialGuess {
            carried,
            ..InitialGuess::of_motion(discrete, h)
        };
    }
    let z = match has_same_coordinates {
        true => resample::coordinates(solved, grids, map, model.multiplier_time),
        false => along_joints(model, solved, intervals),
    };
    let discrete = DiscreteTrajectory {
        held: held(model, control, solved),
        ..DiscreteTrajectory::in_steps(h, z, scalars(model, solved, grids, intervals))
    };
    InitialGuess {
        discrete,
        h,
        costates: has_same_coordinates
            .then(|| resample::costates(model, boundary, control, solved, grids))
            .flatten(),
        carried,
    }
}

/// Scalars that hold the goal, where they are sought and known of the solution.
fn held(model: &Model, control: &Control, solved: &Solution) -> Option<Vec<f64>> {
    let hold = solved.hold.as_ref().filter(|_| control.seeks_hold())?;
    Some(model.variables.scalars(&model.scalars(hold)))
}

/// Coordinates at the instants of another grid by joint coordinates and poses of a solution, from which the model takes its own.
fn along_joints(model: &Model, solved: &Solution, intervals: usize) -> Vec<Vec<f64>> {
    let at = |k: usize| {
        let s = k as f64 / intervals as f64 * solved.intervals() as f64;
        let i = (s.floor() as usize).min(solved.intervals() - 1);
        let f = s - i as f64;
        let (a, b) = (&solved.joints[i], &solved.joints[i + 1]);
        let joints: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + f * (b - a)).collect();
        match solved.poses.get(i..=i + 1) {
            Some([from, to]) => {
                let poses = from.iter().zip(to).map(|(from, to)| from.towards(to, f));
                model.coordinates_of_poses(&poses.collect::<Vec<_>>(), &joints)
            }
            _ => model.coordinates_at(&joints),
        }
    };
    (0..=intervals).map(at).collect()
}

/// Scalars of the intervals of another grid: voltages, parameters within their bounds, and potentials where the solution has them.
fn scalars(model: &Model, solved: &Solution, grids: Grids, intervals: usize) -> Vec<Vec<f64>> {
    // Gauss's laws are linear in potentials: from zero they are solved at once.
    let potentials = model.variables.range(Role::Potential);
    let mut rows = solved.potentials.iter();
    let has_potentials =
        !solved.potentials.is_empty() && rows.all(|row| row.len() == potentials.len());
    let at = |k: usize| {
        let mut scalars = model
            .variables
            .scalars(&model.scalars(&grids.mean(&solved.voltages, k)));
        let of_parameters = model.variables.range(Role::Parameter);
        for (s, parameter) in of_parameters.zip(&model.analysis.parameters) {
            let mut found = solved.parameters.iter();
            if let Some(found) = found.find(|found| found.name == parameter.name) {
                scalars[s] = found.value.clamp(parameter.lower, parameter.upper);
            }
        }
        if has_potentials {
            scalars[potentials.clone()].copy_from_slice(&grids.mean(&solved.potentials, k));
        }
        scalars
    };
    (0..intervals).map(at).collect()
}

/// Deviation of an instant, in mean steps, that is rounding.
const ROUNDING: f64 = 1e-6;

/// The motion as it is where its steps are equal, otherwise at as many equal ones: coordinates along lines, voltages and
/// potentials of the step that the middle of an interval is in; costates belong to other rows and are left out. `map` is
/// what the coordinates mean, where they are those of the model.
pub(super) fn on_uniform_grid<'s>(
    solved: &'s Solution,
    map: Option<&CoordinateMap>,
) -> Cow<'s, Solution> {
    let intervals = solved.intervals();
    let end = solved.times[intervals];
    let time = |k: f64| end * k / intervals as f64;
    let mut times = (0..).zip(&solved.times);
    if times.all(|(k, t)| (t - time(f64::from(k))).abs() <= ROUNDING * end / intervals as f64) {
        return Cow::Borrowed(solved);
    }
    let step_at = |time: f64| {
        let after = solved.times.partition_point(|&t| t <= time);
        after.clamp(1, intervals) - 1
    };
    let place = |k: usize| {
        let at = time(k as f64);
        let i = step_at(at);
        let part = (at - solved.times[i]) / (solved.times[i + 1] - solved.times[i]);
        (i, part)
    };
    let along = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let row = |k: usize| {
            let (i, part) = place(k);
            let ends = rows[i].iter().zip(&rows[i + 1]);
            ends.map(|(a, b)| a + part * (b - a)).collect()
        };
        (0..=intervals).map(row).collect()
    };
    let configurations = || {
        let mut z = along(&solved.z);
        let Some(map) = map else {
            return z;
        };
        for (k, z) in z.iter_mut().enumerate() {
            let (i, part) = place(k);
            let ends = [(1.0 - part, &*solved.z[i]), (part, &*solved.z[i + 1])];
            map.mean_of_charts(&ends, z);
        }
        z
    };
    let within = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let row = |k: usize| rows.get(step_at(time(k as f64 + 0.5))).cloned();
        (0..intervals).filter_map(row).collect()
    };
    let near = |k: usize| {
        let at = time(k as f64);
        let i = step_at(at);
        i + usize::from(2.0 * at > solved.times[i] + solved.times[i + 1])
    };
    Cow::Owned(Solution {
        coordinates: solved.coordinates,
        multiplier_time: solved.multiplier_time,
        hold: solved.hold.clone(),
        meshes: solved.meshes.clone(),
        parameters: solved.parameters.clone(),
        times: (0..=intervals).map(|k| time(k as f64)).collect(),
        joints: along(&solved.joints),
        poses: (0..=intervals)
            .filter_map(|k| solved.poses.get(near(k)).cloned())
            .collect(),
        z: configurations(),
        momentum: solved.momentum.clone(),
        voltages: within(&solved.voltages),
        potentials: within(&solved.potentials),
        costates: None,
        barrier: None,
    })
}

impl EarlierSolution for Solution {
    fn solution(&self, _: &Model) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>> {
        Ok(Cow::Borrowed(self))
    }
}
