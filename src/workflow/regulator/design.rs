//! The design of a regulator: linearised steps with integrals, and the costs of deviations.
//!
//! The state at rest that a regulator holds.
//!
//! At the end of an optimum bodies rest, and what muscles remember may go on: branches of rubber relax long after. Inputs that hold the goal lead to the
//! state in which a step changes nothing, `f(x) = x`, which Newton's method finds from the end with the linearised step A: `(1 − A) δx = f(x) − x`.

use crate::control::problem::{Control, Regulator};
use crate::dynamics::{
    DiscreteTrajectory, Independent, LinearStep, Linearisation, StepError, StepInput, Stepper,
    momentum_derivatives, rates_of_momentum, step_inputs,
};
use crate::feedback::Costs;
use crate::math::Vector;
use crate::model::{Model, Time};
use crate::workflow::optimum::Optimum;
use crate::workflow::regulator::regulated::{MOST, NoRegulator, RegulatedStep};
use nalgebra::{DMatrix, DVector};

/// An optimal motion along which feedback is designed.
#[derive(Clone, Copy, Debug)]
pub struct Along<'a> {
    /// The model that moves.
    pub model: &'a Model,
    /// The problem that the motion solves.
    pub control: &'a Control,
    /// The motion as unknowns of the model.
    pub discrete: &'a DiscreteTrajectory,
    /// The momentum at its start.
    pub momentum: &'a [f64],
    /// Voltages that hold its goal, by source, where it is held.
    pub rest: Option<&'a [f64]>,
}

impl<'a> Along<'a> {
    /// An optimum of a problem.
    pub fn new(
        optimum: &'a Optimum,
        discrete: &'a DiscreteTrajectory,
        control: &'a Control,
    ) -> Self {
        let found = optimum.motion.hold.as_deref();
        Self {
            model: &optimum.model,
            control,
            discrete,
            momentum: &optimum.boundary.start.momentum,
            rest: found.or(optimum.boundary.rest[1].as_deref()),
        }
    }
}

/// Coordinates and momenta at an instant, those of coordinates that follow from independent ones being zero.
#[derive(Clone)]
pub(super) struct State {
    pub(super) z: Vec<f64>,
    pub(super) momentum: Vec<f64>,
}

/// The design of a regulator.
pub(super) struct Design<'a> {
    pub(super) model: &'a Model,
    pub(super) task: &'a Regulator,
    pub(super) discrete: &'a DiscreteTrajectory,
    /// The momentum at the start.
    momentum: Vec<f64>,
    /// Voltages that hold the goal, by source.
    pub(super) rest: Option<&'a [f64]>,
    pub(super) inputs: Vec<StepInput>,
    pub(super) bounds: Vec<[f64; 2]>,
    /// Range of each input, or of its square.
    pub(super) ranges: Vec<f64>,
    /// Independent coordinates along the motion.
    pub(super) independent: Independent,
    pub(super) coordinates: Vec<usize>,
    pub(super) momenta: Vec<usize>,
    /// Places of the coordinates that are integrated.
    pub(super) integrated: Vec<usize>,
    /// Places of the coordinates, and of their momenta in the state, on which constant disturbances act.
    pub(super) forced: Vec<[usize; 2]>,
    pub(super) h: f64,
    /// The state at rest that is held: at first the end of the optimum.
    pub(super) goal: State,
    /// True if none is known.
    pub(super) is_restless: bool,
}

impl<'a> Design<'a> {
    pub(super) fn new(along: Along<'a>, task: &'a Regulator) -> Result<Self, NoRegulator> {
        let Along {
            model,
            control,
            discrete,
            momentum,
            rest,
        } = along;
        let scalars = model.variables.of(Time::Interval);
        let mut inputs = step_inputs(model);
        inputs.retain(|input| {
            let source = scalars[input.scalar].source;
            source.is_some_and(|source| !control.is_given(source))
        });
        let bounds = inputs.iter();
        let bounds = bounds.map(|input| control.bounds(&scalars[input.scalar]));
        let bounds: Vec<[f64; 2]> = bounds.collect();
        let mut ranges = Vec::new();
        for (input, [low, high]) in inputs.iter_mut().zip(&bounds) {
            input.is_squared &= *low >= 0.0 && high.is_finite();
            let range = match input.is_squared {
                true => high * high - low * low,
                false => high - low,
            };
            let is_range = range.is_finite() && range > 0.0;
            ranges.push(match is_range {
                true => range,
                false => control.size(&scalars[input.scalar], model),
            });
        }
        if inputs.is_empty() {
            return Err(NoRegulator::NoInput);
        }
        let independent = Independent::new(model, &discrete.z).map_err(NoRegulator::State)?;
        let mut start = momentum.to_vec();
        independent.reduce(model, &discrete.z[0], &mut start);
        let mut linearisation = Linearisation::new(model, &independent, &inputs);
        if linearisation.size() > MOST {
            return Err(NoRegulator::Large(linearisation.size()));
        }
        let coordinates = linearisation.coordinates().to_vec();
        let of_joints = |place: &usize| coordinates[*place] < model.action.map.of_bodies;
        let places = (0..coordinates.len()).filter(of_joints);
        let lasting = task.observer.as_ref().and_then(|one| one.lasting);
        let inert = linearisation.momenta();
        let forced = |place: usize| {
            let own = inert.iter().position(|&i| i == coordinates[place])?;
            Some([place, coordinates.len() + own])
        };
        let forced = places.clone().filter_map(forced);
        let forced = forced.filter(|_| lasting.is_some()).collect();
        let mut out = Self {
            model,
            task,
            discrete,
            momentum: start,
            rest,
            independent,
            bounds,
            ranges,
            momenta: linearisation.momenta().to_vec(),
            forced,
            integrated: places.filter(|_| task.integral > 0.0).collect(),
            goal: State {
                z: discrete.z.last().expect("an instant").clone(),
                momentum: vec![0.0; model.coordinate_count()],
            },
            is_restless: false,
            inputs,
            coordinates,
            h: discrete.times[1] - discrete.times[0],
        };
        if let Some(rest) = rest {
            let found = out.at_rest(&mut linearisation, &model.scalars(rest));
            out.is_restless = found.is_none();
            out.goal = found.unwrap_or(out.goal);
        }
        Ok(out)
    }

    /// The motion under the inputs of the optimum, in short steps: its states at the instants.
    pub(super) fn motion(&self) -> Result<Vec<State>, NoRegulator> {
        let mut states = vec![State {
            z: self.discrete.z[0].clone(),
            momentum: self.momentum.clone(),
        }];
        for scalars in &self.discrete.scalars {
            let inputs = self.model.variables.split(scalars)[0];
            let last = states.last().expect("the start");
            let next = self.after(last, inputs);
            states.push(next.map_err(|error| NoRegulator::Step(error.to_string()))?);
        }
        Ok(states)
    }

    /// Number of the short steps of an interval.
    fn parts(&self) -> usize {
        (self.h / self.task.step - 1e-9).ceil().max(1.0) as usize
    }

    /// The state after an interval under inputs.
    pub(super) fn after(&self, state: &State, inputs: &[f64]) -> Result<State, StepError> {
        let State { z, momentum } = state;
        let mut stepper = Stepper::new(self.model, z, momentum, Default::default());
        let parts = self.parts();
        for _ in 0..parts {
            stepper.step(self.h / parts as f64, inputs)?;
        }
        let z = stepper.coordinates().to_vec();
        let mut momentum = stepper.momentum().to_vec();
        self.independent.reduce(self.model, &z, &mut momentum);
        Ok(State { z, momentum })
    }

    /// The linearised interval from a state under inputs: the product of its short steps, and E, the state after it by constant disturbances on joints. In
    /// a step of h each adds h/2 to the momentum before it and h/2 to that after it.
    pub(super) fn linearised(
        &self,
        linearisation: &mut Linearisation<'_>,
        state: &State,
        inputs: &[f64],
    ) -> Option<(LinearStep, DMatrix<f64>)> {
        let State { z, momentum } = state;
        let mut stepper = Stepper::new(self.model, z, momentum, Default::default());
        let parts = self.parts();
        let h = self.h / parts as f64;
        let mut whole: Option<(LinearStep, DMatrix<f64>)> = None;
        for _ in 0..parts {
            let before = stepper.coordinates().to_vec();
            stepper.step(h, inputs).ok()?;
            let ends = [&*before, stepper.coordinates()];
            let step = linearisation.step(ends, stepper.scalars(), h)?;
            let of = self.forced.iter().map(|[_, momentum]| momentum);
            let mut by_forces = step.by_state.select_columns(of.clone());
            let after = of.enumerate();
            after.for_each(|(force, &row)| by_forces[(row, force)] += 1.0);
            by_forces *= 0.5 * h;
            whole = Some(match whole {
                None => (step, by_forces),
                Some((done, forces)) => {
                    by_forces += &step.by_state * forces;
                    let done = LinearStep {
                        by_state: &step.by_state * done.by_state,
                        by_inputs: &step.by_state * done.by_inputs + step.by_inputs,
                        momentum: step.momentum,
                    };
                    (done, by_forces)
                }
            });
        }
        whole
    }

    /// A step with integrals and costs at its start, without a gain.
    pub(super) fn augmented(
        &self,
        (step, by_forces): &(LinearStep, DMatrix<f64>),
        at: &State,
    ) -> RegulatedStep {
        let (n, u) = (step.by_state.nrows(), self.inputs.len());
        let size = n + self.integrated.len();
        let mut by_state = with_ones(&step.by_state, size);
        for (i, &place) in self.integrated.iter().enumerate() {
            by_state[(n + i, place)] = self.h;
        }
        let input = |i: usize| self.task.inputs / (self.ranges[i] * self.ranges[i]);
        let coordinates = self.coordinates.len();
        RegulatedStep {
            by_state,
            by_inputs: step.by_inputs.clone().resize_vertically(size, 0.0),
            rates: self.rate_weights(size),
            costs: Costs {
                state: self.state_costs(at),
                inputs: DMatrix::from_fn(u, u, |i, j| if i == j { input(i) } else { 0.0 }),
            },
            places: self.place_costs(at).resize(coordinates, coordinates, 0.0),
            gain: DMatrix::zeros(u, size),
            cost: DMatrix::zeros(size, size),
            // Integral states have no constant-disturbance input.
            by_forces: by_forces.clone(),
            lasting: None,
        }
    }

    /// Q at an instant.
    pub(super) fn state_costs(&self, at: &State) -> DMatrix<f64> {
        let (n, m) = (self.coordinates.len(), self.momenta.len());
        let mut costs = self.place_costs(at);
        for (place, &of) in self.integrated.iter().enumerate() {
            let unit = self.unit(self.coordinates[of]) * Regulator::INTEGRAL_TIME;
            costs[(n + m + place, n + m + place)] = self.task.integral / unit.powi(2);
        }
        costs
    }

    /// Weights of the differences of a state of a size over an interval: those of coordinates that have momenta.
    fn rate_weights(&self, size: usize) -> Vec<f64> {
        let mut out = vec![0.0; size];
        for (weight, &i) in out.iter_mut().zip(&self.coordinates) {
            if self.momenta.contains(&i) {
                let unit = Regulator::RATE_TIME / (self.unit(i) * self.h);
                *weight = self.task.rates * unit.powi(2);
            }
        }
        out
    }

    /// Deviation of a coordinate that costs as much as one of a mm.
    pub(super) fn unit(&self, i: usize) -> f64 {
        match self.model.is_length(i) {
            true => 1.0,
            false => Regulator::DEGREE,
        }
    }

    /// The part of Q that is of coordinates and markers; those that follow from the coordinates of the state cost as these do.
    fn place_costs(&self, at: &State) -> DMatrix<f64> {
        let n = self.coordinates.len();
        let size = n + self.momenta.len() + self.integrated.len();
        let mut costs = DMatrix::zeros(size, size);
        let weight = |i: usize| self.task.coordinates / self.unit(i).powi(2);
        for (place, &i) in self.coordinates.iter().enumerate() {
            if !self.model.is_memory(i) {
                costs[(place, place)] += weight(i);
            }
        }
        for (i, slopes) in self.independent.slopes(self.model, &at.z).followers() {
            let mut own = costs.view_mut((0, 0), (n, n));
            own.ger(weight(i), &slopes, &slopes, 1.0);
        }
        for &(marker, weight) in &self.task.markers {
            let mut place = DMatrix::zeros(3, size);
            let rows = self.by_coordinates(marker, at);
            place.columns_mut(0, rows.ncols()).copy_from(&rows);
            costs += weight * place.transpose() * place;
        }
        costs
    }

    /// Derivatives of the place of a marker by the coordinates of the state.
    pub(super) fn by_coordinates(&self, marker: usize, at: &State) -> DMatrix<f64> {
        let map = &self.model.action.map;
        let instant = map.placed(&at.z);
        let mut rows = DMatrix::zeros(self.model.coordinate_count(), 3);
        for (axis, mut row) in rows.column_iter_mut().enumerate() {
            let mut unit = Vector::zeros();
            unit[axis] = 1.0;
            let vector = self.model.markers[marker];
            map.pull_back_one(vector, &instant.columns, &unit, row.as_mut_slice());
        }
        self.independent.slopes(self.model, &at.z).rows(&mut rows);
        rows.select_rows(&self.coordinates).transpose()
    }

    /// Derivatives of coordinates and momenta by coordinates and rates.
    pub(super) fn by_rates(&self, at: &State) -> DMatrix<f64> {
        let (n, m) = (self.coordinates.len(), self.momenta.len());
        let [mass, by] = self.of_momenta(at);
        let mut out = DMatrix::identity(n + m, n + m);
        out.view_mut((n, 0), (m, n)).copy_from(&by);
        out.view_mut((n, n), (m, m)).copy_from(&mass);
        out
    }

    /// Derivatives of the momenta of the state by rates and by coordinates.
    pub(super) fn of_momenta(&self, State { z, momentum }: &State) -> [DMatrix<f64>; 2] {
        let rates = rates_of_momentum(self.model, z, 0.0, momentum);
        let [mass, by] = momentum_derivatives(self.model, &self.independent, z, &rates);
        [
            mass.select_rows(&self.momenta)
                .select_columns(&self.momenta),
            by.select_rows(&self.momenta)
                .select_columns(&self.coordinates),
        ]
    }
}

/// A matrix in the corner of a unit matrix of a size.
pub(super) fn with_ones(of: &DMatrix<f64>, size: usize) -> DMatrix<f64> {
    let mut out = DMatrix::identity(size, size);
    out.view_mut((0, 0), of.shape()).copy_from(of);
    out
}

/// Most iterations, and a change of all coordinates, relative to their typical sizes, that ends them.
const ITERATIONS: usize = 20;
const SMALL: f64 = 1e-10;

impl Design<'_> {
    /// The state at rest near the end under inputs by scalar; the end itself where nothing is remembered, and `None` where none is found.
    pub(super) fn at_rest(
        &self,
        linearisation: &mut Linearisation<'_>,
        inputs: &[f64],
    ) -> Option<State> {
        let mut state = self.goal.clone();
        let sizes = self.model.sizes();
        if self.model.memory().next().is_none() {
            return Some(state);
        }
        for _ in 0..ITERATIONS {
            let after = self.after(&state, inputs).ok()?;
            let (step, _) = self.linearised(linearisation, &state, inputs)?;
            let by = &step.by_state;
            let change = DVector::from_iterator(by.nrows(), self.change([&state, &after]));
            let matrix = DMatrix::identity(by.nrows(), by.ncols()) - by;
            let change = matrix.lu().solve(&change)?;
            let (places, momenta) = change.as_slice().split_at(self.coordinates.len());
            let own = self.coordinates.iter().zip(places);
            own.for_each(|(&i, change)| state.z[i] += change);
            let rates = &mut vec![0.0; self.model.coordinate_count()];
            self.independent.close(self.model, &mut state.z, rates);
            let own = self.momenta.iter().zip(momenta);
            own.for_each(|(&i, change)| state.momentum[i] += change);
            if !change.iter().all(|value| value.is_finite()) {
                return None;
            }
            let mut own = self.coordinates.iter().zip(places);
            if own.all(|(&i, change)| change.abs() < SMALL * sizes[i]) {
                return Some(state);
            }
        }
        None
    }

    /// Change of the coordinates, then of the momenta, between two states.
    pub(super) fn change<'s>(
        &'s self,
        [from, to]: [&'s State; 2],
    ) -> impl Iterator<Item = f64> + 's {
        let coordinates = self.coordinates.iter().map(|&i| to.z[i] - from.z[i]);
        let momenta = self.momenta.iter();
        let momenta = momenta.map(|&i| to.momentum[i] - from.momentum[i]);
        coordinates.chain(momenta)
    }
}
