//! The observer of a regulator: a Kalman filter along the motion, from the covariances of what is measured and of what disturbs.
//!
//! Constant disturbances on joints are entries of its state that change by chance. Its covariances P follow the Riccati recursion of `(Aᵀ, Cᵀ)` forward in time, from that of a robot which has done the first step for ever.

use crate::control::problem::{Observation, Regulator};
use crate::dynamics::Linearisation;
use crate::feedback::{Costs, Filter, HeldGain, Observer, Reading, held_gain, riccati_step};
use crate::workflow::regulator::design::{Design, State};
use crate::workflow::regulator::regulated::{NoRegulator, Regulated, RegulatedStep, Reproduced};
use nalgebra::{DMatrix, DVector};

/// Scales: units of the state and standard deviations of the readings.
struct Scales {
    state: DVector<f64>,
    readings: DVector<f64>,
}

/// A step over coordinates and rates, in which the units of the state and the deviations of the readings are one.
struct Scaled {
    /// Aᵀ, B and Cᵀ.
    by_state: DMatrix<f64>,
    by_inputs: DMatrix<f64>,
    output: DMatrix<f64>,
    noise: Costs,
    /// Readings of the motion at its start.
    readings: Vec<f64>,
}

/// Derivatives of readings by the state, of mm or rad by mm or rad, that are rounding.
const BLIND: f64 = 1e-9;
/// Factors of standard deviations of readings, to tell whether small ones are lost in rounding.
const COARSER: [f64; 3] = [1e1, 1e3, 1e5];
/// Reason why a state cannot be found.
const NOT_SEEN: &str =
    "the state is not observable from these measurements; expected more measured joints or markers";

impl Design<'_> {
    /// The observer of a motion and of its held goal, with the spectral radius of its errors.
    pub(super) fn observer(
        &self,
        observation: &Observation,
        steps: &[RegulatedStep],
        motion: &[State],
        held: Option<&(RegulatedStep, HeldGain)>,
        forces: Option<DMatrix<f64>>,
    ) -> Result<(Observer, f64), NoRegulator> {
        let goal = &self.goal;
        let readings = self.readings(observation)?;
        let scales = self.scales(observation, forces.as_ref());
        let end = match held {
            Some(_) => goal,
            None => motion.last().expect("an instant"),
        };
        let at_rest = |step: &Scaled| {
            held_gain([&step.by_state, &step.output], &step.noise)
                .map_err(|_| NoRegulator::Observer(self.not_seen(step)))
        };
        let mut points = Vec::new();
        let mut covariance: Option<DMatrix<f64>> = None;
        let mut radius = 0.0;
        for (k, step) in steps.iter().enumerate() {
            let is_last = k + 1 == steps.len();
            let next = if is_last { end } else { &motion[k + 1] };
            let scaled = self.scaled_step(observation, step, [&motion[k], next], &scales);
            let before = match covariance.take() {
                Some(known) => known,
                None => {
                    let first = at_rest(&scaled)?;
                    radius = first.radius;
                    first.cost
                }
            };
            let pair = [&scaled.by_state, &scaled.output];
            let after = riccati_step(pair, &scaled.noise, &before);
            covariance = Some(after.ok_or(NoRegulator::Recursion(k))?.cost);
            points.push(self.filter(scaled, &before, &scales)?);
        }
        let is_held = held.is_some();
        let held = held.map(|(step, _)| {
            let scaled = self.scaled_step(observation, step, [goal; 2], &scales);
            let of = at_rest(&scaled)?;
            radius = of.radius;
            self.filter(scaled, &of.cost, &scales)
        });
        // A stable robot comes to rest by itself, whatever is measured.
        let mut outputs = points.iter().flat_map(|point| &point.output);
        if outputs.all(|value| value.abs() <= BLIND) {
            return Err(NoRegulator::Observer(NOT_SEEN.to_owned()));
        }
        let observer = Observer {
            held: held.transpose()?,
            readings,
            points,
            jump: self.jump(motion, is_held),
            lasting: forces.map(|forces| self.lasting(forces)),
        };
        Ok((observer, radius))
    }

    /// An observer that takes in the whole state as it is measured, and predicts it.
    pub(super) fn whole(&self, of: &Regulated, motion: &[State]) -> Observer {
        let goal = &self.goal;
        let size = of.law.measured.len();
        let filter = |step: &RegulatedStep, [at, next]: [&State; 2], readings: &[f64]| {
            let by_state = step.by_state.view((0, 0), (size, size)) * self.by_rates(at);
            Filter {
                readings: readings.to_vec(),
                by_state: self.over_rates(by_state, next),
                by_inputs: self.over_rates(step.by_inputs.rows(0, size).into_owned(), next),
                output: DMatrix::identity(size, size),
                gain: DMatrix::identity(size, size),
            }
        };
        let points = of.steps.iter().zip(&of.law.points).enumerate();
        let next = |k: usize| match k + 1 == of.steps.len() && of.held.is_some() {
            true => goal,
            false => &motion[k + 1],
        };
        let held = of.held.as_ref().zip(of.law.held.as_ref());
        Observer {
            readings: (0..size).map(Reading::State).collect(),
            points: points
                .map(|(k, (step, point))| filter(step, [&motion[k], next(k)], &point.state))
                .collect(),
            held: held.map(|((step, _), point)| filter(step, [goal; 2], &point.state)),
            jump: self.jump(motion, of.held.is_some()),
            lasting: None,
        }
    }

    /// The state at the end of the motion as a deviation from the goal, where that is held.
    fn jump(&self, motion: &[State], is_held: bool) -> Vec<f64> {
        if !is_held {
            return Vec::new();
        }
        let end = self.measured(motion.last().expect("an instant"));
        let goal = self.measured(&self.goal);
        end.iter().zip(goal).map(|(end, goal)| end - goal).collect()
    }

    /// Words on a step whose state does not follow from its readings.
    fn not_seen(&self, step: &Scaled) -> String {
        let forces = self.forced.len();
        let n = step.by_state.nrows() - forces;
        let own = |of: &DMatrix<f64>| of.view((0, 0), (n, n)).into_owned();
        let noise = Costs {
            state: own(&step.noise.state),
            inputs: step.noise.inputs.clone(),
        };
        let output = step.output.rows(0, n).into_owned();
        let is_seen = |factor: &f64| {
            let mut noise = step.noise.clone();
            noise.inputs *= factor.powi(2);
            held_gain([&step.by_state, &step.output], &noise).is_ok()
        };
        if let Some(factor) = COARSER.into_iter().find(is_seen) {
            return format!(
                "rounding hides the state behind readings of so small standard deviations; expected about {factor} times as large ones"
            );
        }
        match forces > 0 && held_gain([&own(&step.by_state), &output], &noise).is_ok() {
            true => format!(
                "{forces} constant disturbances, one on each joint, do not follow from what is measured; expected as many independent joints or components of markers, or no \"lasting\""
            ),
            false => NOT_SEEN.to_owned(),
        }
    }

    /// The readings: measured joints, then the places of measured markers.
    fn readings(&self, observation: &Observation) -> Result<Vec<Reading>, NoRegulator> {
        let system = &self.model.system;
        let mut out = Vec::new();
        for &(joint, _) in &observation.joints {
            let own = self.model.joint_readings[joint].coordinate;
            let place = self.coordinates.iter().position(|&i| Some(i) == own);
            let place = place.ok_or_else(|| {
                let name = &system.joints[joint].name;
                NoRegulator::Observer(format!("joint {name:?} does not move freely"))
            })?;
            out.push(Reading::State(place));
        }
        for &(marker, _) in &observation.markers {
            let name = &system.markers[marker].name;
            out.extend((0..3).map(|axis| Reading::Marker(name.clone(), axis)));
        }
        Ok(out)
    }

    fn scales(&self, observation: &Observation, forces: Option<&DMatrix<f64>>) -> Scales {
        let coordinates = self.coordinates.iter().map(|&i| self.unit(i));
        let rates = self.momenta.iter();
        let rates = rates.map(|&i| self.unit(i) / Regulator::RATE_TIME);
        let forces = forces.into_iter().flat_map(|forces| self.greatest(forces));
        let joints = observation.joints.iter().map(|(_, deviation)| *deviation);
        let markers = observation.markers.iter();
        let markers = markers.flat_map(|(_, deviation)| [*deviation; 3]);
        Scales {
            state: DVector::from_vec(coordinates.chain(rates).chain(forces).collect()),
            readings: DVector::from_vec(joints.chain(markers).collect()),
        }
    }

    /// The force on each joint that the ranges of all inputs make; the greatest of all where no input acts.
    fn greatest(&self, forces: &DMatrix<f64>) -> Vec<f64> {
        let of = |row: usize| {
            let all = self.ranges.iter().enumerate();
            all.map(|(i, range)| (forces[(row, i)] * range).abs())
                .fold(0.0, f64::max)
        };
        let own: Vec<f64> = (0..forces.nrows()).map(of).collect();
        let most = own.iter().copied().fold(0.0, f64::max);
        own.into_iter()
            .map(|one| if one > 1e-6 * most { one } else { most })
            .collect()
    }

    /// Derivatives of coordinates and rates at the state after a step, by those of coordinates and momenta.
    fn over_rates(&self, of_next: DMatrix<f64>, next: &State) -> DMatrix<f64> {
        let (rows, columns) = of_next.shape();
        let by = self.by_rates(next).lu().solve(&of_next);
        by.unwrap_or_else(|| DMatrix::from_element(rows, columns, f64::NAN))
    }

    /// A step over coordinates and rates from one state to the next, scaled.
    fn scaled_step(
        &self,
        observation: &Observation,
        step: &RegulatedStep,
        [at, next]: [&State; 2],
        Scales { state, readings }: &Scales,
    ) -> Scaled {
        let (n, size) = (self.coordinates.len() + self.momenta.len(), state.len());
        let to_rates = |of_next: DMatrix<f64>| {
            let by = self.over_rates(of_next, next);
            by.map_with_location(|i, _, by| by / state[i])
        };
        let of_state = to_rates(step.by_state.view((0, 0), (n, n)) * self.by_rates(at));
        let of_inputs = to_rates(step.by_inputs.rows(0, n).into_owned());
        let mut by_state = of_state.resize(size, size, 0.0);
        if size > n {
            let of_forces = to_rates(step.by_forces.rows(0, n).into_owned());
            let mut view = by_state.view_mut((0, n), of_forces.shape());
            view.copy_from(&of_forces);
            (n..size).for_each(|i| by_state[(i, i)] = 1.0 / state[i]);
        }
        let by_inputs = of_inputs.resize_vertically(size, 0.0);
        let (values, output) = self.read(observation, at, size);
        let noise = |i: usize| observation.inputs * self.ranges[i];
        let disturbed = by_inputs.map_with_location(|_, j, by| by * noise(j));
        let mut covariance = &disturbed * disturbed.transpose();
        for i in self.coordinates.len()..n {
            covariance[(i, i)] += observation.rates * observation.rates;
        }
        let lasting = observation.lasting.unwrap_or(0.0);
        (n..size).for_each(|i| covariance[(i, i)] = lasting * lasting);
        let [by_state, output] = [by_state, output].map(|of| of.transpose());
        Scaled {
            by_state: by_state.map_with_location(|j, _, by| by * state[j]),
            output: output.map_with_location(|j, i, by| by * state[j] / readings[i]),
            noise: Costs {
                state: covariance,
                inputs: DMatrix::identity(output.ncols(), output.ncols()),
            },
            by_inputs,
            readings: values,
        }
    }

    /// The readings of a state, and C, their derivatives by coordinates, rates and constant disturbances.
    fn read(&self, observation: &Observation, at: &State, size: usize) -> (Vec<f64>, DMatrix<f64>) {
        let joints = observation.joints.len();
        let mut by_state = DMatrix::zeros(joints + 3 * observation.markers.len(), size);
        let mut readings = Vec::new();
        for (row, &(joint, _)) in observation.joints.iter().enumerate() {
            let own = self.model.joint_readings[joint].coordinate;
            for (place, &i) in self.coordinates.iter().enumerate() {
                if Some(i) == own {
                    readings.push(at.z[i]);
                    by_state[(row, place)] = 1.0;
                }
            }
        }
        let instant = self.model.action.map.placed(&at.z);
        for (number, &(marker, _)) in observation.markers.iter().enumerate() {
            readings.extend(&instant.x[self.model.markers[marker]]);
            let rows = self.by_coordinates(marker, at);
            let place = (joints + 3 * number, 0);
            by_state.view_mut(place, rows.shape()).copy_from(&rows);
        }
        (readings, by_state)
    }

    /// The filter of a step with the covariance P before its readings: `M = P Cᵀ (C P Cᵀ + R)⁻¹`.
    fn filter(
        &self,
        scaled: Scaled,
        covariance: &DMatrix<f64>,
        Scales {
            state,
            readings: of,
        }: &Scales,
    ) -> Result<Filter, NoRegulator> {
        let toward = scaled.output.transpose() * covariance;
        let inner = &scaled.noise.inputs + &toward * &scaled.output;
        let inner = inner.cholesky();
        let inner = inner.ok_or_else(|| NoRegulator::Observer(self.not_seen(&scaled)))?;
        let gain = inner.solve(&toward);
        let [by_state, output, gain] =
            [scaled.by_state, scaled.output, gain].map(|of| of.transpose());
        Ok(Filter {
            readings: scaled.readings,
            by_state: by_state.map_with_location(|i, j, by| by * state[i] / state[j]),
            by_inputs: scaled.by_inputs.map_with_location(|i, _, by| by * state[i]),
            output: output.map_with_location(|i, j, by| by * of[i] / state[j]),
            gain: gain.map_with_location(|i, j, gain| gain * state[i] / of[j]),
        })
    }
}

/// Deviation of each coordinate at the start, in rad or as a part of the length of the system.
const OFF: f64 = 1e-5;

/// Compares at the first, middle and last interval.
pub(super) fn reproduced(
    design: &Design<'_>,
    linearisation: &Linearisation<'_>,
    steps: &[RegulatedStep],
    motion: &[State],
) -> Vec<Reproduced> {
    let last = steps.len() - 1;
    let mut intervals = vec![0, last / 2, last];
    intervals.dedup();
    let at = |k: usize| Reproduced {
        interval: k,
        difference: difference(design, linearisation, &steps[k], motion, k),
    };
    intervals.into_iter().map(at).collect()
}

/// The relative difference of an interval; NaN where a step fails.
fn difference(
    design: &Design<'_>,
    linearisation: &Linearisation<'_>,
    step: &RegulatedStep,
    motion: &[State],
    k: usize,
) -> f64 {
    let model = design.model;
    let sizes = model.sizes();
    let mut z = motion[k].z.clone();
    let mut off = DVector::zeros(step.by_state.ncols());
    for (place, &i) in linearisation.coordinates().iter().enumerate() {
        off[place] = OFF * sizes[i];
        z[i] += off[place];
    }
    let rates = &mut vec![0.0; model.coordinate_count()];
    design.independent.close(model, &mut z, rates);
    let change = -(&step.gain * &off);
    let mut given = model.variables.split(&design.discrete.scalars[k])[0].to_vec();
    let mut acted = DVector::zeros(design.inputs.len());
    for (i, input) in design.inputs.iter().enumerate() {
        let value = &mut given[input.scalar];
        let before = *value;
        // A square below zero is none: both leave it out alike.
        (*value, acted[i]) = match input.is_squared {
            true => {
                let square = (before * before + change[i]).max(0.0);
                (square.sqrt(), square - before * before)
            }
            false => (before + change[i], change[i]),
        };
    }
    let linear = &step.by_state * &off + &step.by_inputs * acted;
    let momentum = motion[k].momentum.clone();
    let Ok(moved) = design.after(&State { z, momentum }, &given) else {
        return f64::NAN;
    };
    let [moved, motion] =
        [&moved, &motion[k + 1]].map(|of| linearisation.state(&of.z, &of.momentum));
    let places = linearisation.coordinates().len();
    // Coordinates and momenta have units of their own.
    let ranges = [0..places, places..linearisation.size()].into_iter();
    let relative = ranges.map(|range| {
        let size = range.clone().map(|i| linear[i].abs()).fold(0.0, f64::max);
        let far = |i: usize| (moved[i] - motion[i] - linear[i]).abs();
        match size > 0.0 {
            true => range.map(far).fold(0.0, f64::max) / size,
            false => 0.0,
        }
    });
    relative.fold(0.0, f64::max)
}
