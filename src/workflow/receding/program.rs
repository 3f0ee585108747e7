//! The program of a receding horizon: the discrete equations of the next intervals, with the costs of deviations from a motion.
//!
//! ```text
//! minimise  ½ Σ_{k=1..N−1} δq_kᵀ Q_k δq_k + ½ r Σ_{k=0..N−1} |δq_{k+1} − δq_k|²/h² + ½ Σ_{k=0..N−1} δu_kᵀ R δu_k + ½ (δq_N, δp_N)ᵀ S_N (δq_N, δp_N)
//! ```
//!
//! with the costs of the regulator (`workflow::regulator`): S_N counts all that follows. The equations are those of the transcription with the
//! state q_0, p_0 at their start. Their last row, which says that the motion comes to rest, has the momentum p_N as an unknown here. The motion is that
//! of the regulator in short steps, a number of them in each interval, under the same inputs: these are one column. All costs are weights of products of
//! deviations `d`, `½ dᵀW d`, and their derivatives follow from those of the deviations.

use crate::control::{Column, Numbering, Transcription};
use crate::dynamics::{Independent, Start};
use crate::feedback::product;
use crate::model::Model;
use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Nlp, Stage};
use crate::workflow::regulator::Regulated;
use nalgebra::DMatrix;
use std::mem;

/// The program.
#[derive(Debug)]
pub(super) struct Program<'m> {
    motion: InSquares<Transcription<'m>>,
    pub(super) reference: &'m Reference,
    pub(super) steered: &'m Steered,
    /// Number of intervals.
    pub(super) intervals: usize,
    /// Instant by instant the coordinates of the state and the inputs of the interval behind it; at the end coordinates and momenta.
    pub(super) readings: Vec<Reading>,
    /// Place of the first one of the end.
    end: usize,
    /// Rows of the momenta of the first instant, of all that has some there, and of the last one, with their scales.
    pub(super) momenta: [Vec<(usize, f64)>; 2],
    /// Instant by instant the columns of the coordinates that follow from those of the state, with their factors.
    pub(super) followers: Vec<(usize, f64)>,
    /// Rows on which constant disturbances act, with the scaled time of their action, and the number of the force.
    forced: Vec<(usize, f64, usize)>,
    bounds: Bounds,
    row_bounds: Bounds,
    jacobian: Entries,
    hessian: Entries,
    /// Numbers of entries of the motion alone.
    counts: [usize; 2],
    /// Columns of coordinates within an interval, with those at both of its ends, and the part of it that has passed there.
    pub(super) between: Vec<Between>,
    /// Number of columns of the motion.
    pub(super) columns: usize,
    /// Instant of the reference at which the horizon begins.
    pub(super) begin: usize,
    /// Momenta at the start, in the order of their rows.
    pub(super) momentum: Vec<f64>,
    /// Deviation of each reading at the point evaluated last, with its first and second derivative by the column, and the slope of the costs by it.
    deviations: Vec<[f64; 3]>,
    slopes: Vec<f64>,
    /// Constant disturbances with their effects.
    pub(super) lasting: Lasting,
}

/// Constant disturbances, with what they change of the motion that is followed.
#[derive(Clone, Debug)]
pub(super) struct Lasting {
    /// The forces, then the changes of the inputs against them.
    values: Vec<f64>,
    /// Changes of the state at rest, coordinates then momenta, and of the inputs; slope of the cost at the end.
    pub(super) state: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    pub(super) slope: Vec<f64>,
}

impl<'m> Program<'m> {
    /// The program of a transcription with an open start without momenta, and an end at rest with no coordinate given.
    pub(super) fn new(
        motion: Transcription<'m>,
        reference: &'m Reference,
        steered: &'m Steered,
    ) -> Self {
        let inert = steered.inert.len();
        let (state, inputs) = (steered.coordinates.len() + inert, steered.inputs.len());
        let intervals = motion.intervals() / steered.parts;
        let columns = motion.variables().count();
        let row = |k: usize, i: usize| {
            let row = motion.unknowns().row(k, i).expect("a balance");
            (row, motion.row_scale(row))
        };
        let followers = steered.independent.followers();
        let at_start: Vec<_> = steered.moved().map(|i| row(0, i)).collect();
        let at_end = steered.inert().map(|i| row(motion.intervals(), i));
        let momenta = [at_start, at_end.collect()];
        let instants = (0..=motion.intervals()).step_by(steered.parts);
        let followers = instants.flat_map(|k| followers.iter().map(move |&i| (k, i)));
        let followers = followers.map(|(k, i)| {
            let column = motion.unknowns().unknown(k, i);
            let column = column.expect("an open coordinate");
            (column, motion.column_scale(column))
        });
        let followers: Vec<(usize, f64)> = followers.collect();
        let squares = motion.squares();
        let of_squares = Squares::of(&motion, squares.clone());
        let mut ones = vec![1.0; columns];
        of_squares.square(&mut ones);
        // V² = scale² u w of w = V²/u.
        let unit = |column: usize| squares.contains(&column).then(|| 1.0 / ones[column]);
        let mut readings = readings(&motion, steered, unit);
        let end = readings.len() - steered.coordinates.len();
        let at_end = momenta[1].iter().zip(columns..);
        readings.extend(at_end.map(|(&(_, scale), column)| Reading {
            column,
            scale: 1.0 / scale,
            is_root: false,
        }));
        let [jacobian, hessian] = [motion.jacobian_structure(), motion.hessian_structure()];
        let mut bounds = motion.variables().clone();
        of_squares.square(&mut bounds.lower);
        of_squares.square(&mut bounds.upper);
        (0..inert).for_each(|_| bounds.push(f64::NEG_INFINITY, f64::INFINITY));
        let mut out = Self {
            row_bounds: motion.constraints().clone(),
            counts: [jacobian.count(), hessian.count()],
            between: between(motion.unknowns(), steered.parts),
            forced: forced(&motion, steered),
            motion: InSquares::new(motion, of_squares, &jacobian, &hessian),
            reference,
            steered,
            intervals,
            deviations: vec![[0.0; 3]; readings.len()],
            slopes: vec![0.0; readings.len()],
            readings,
            end,
            momentum: vec![0.0; momenta[0].len()],
            momenta,
            followers,
            lasting: Lasting {
                values: vec![0.0; steered.forced.len() + inputs],
                state: vec![0.0; state],
                inputs: vec![0.0; inputs],
                slope: vec![0.0; state],
            },
            bounds,
            jacobian,
            hessian,
            columns,
            begin: 0,
        };
        out.add_structure();
        out
    }

    /// Number of readings of an instant and the interval behind it.
    fn stride(&self) -> usize {
        self.end / self.intervals
    }

    /// The readings of an instant and the interval behind it, or of the end.
    pub(super) fn at(&self, k: usize) -> &[Reading] {
        let first = k * self.stride();
        match k < self.intervals {
            true => &self.readings[first..first + self.stride()],
            false => &self.readings[first..],
        }
    }

    /// Those of the inputs of an interval.
    pub(super) fn of_inputs(&self, k: usize) -> &[Reading] {
        &self.at(k)[self.steered.coordinates.len()..]
    }

    /// Adds the entries of the momenta at the end, and of the costs.
    fn add_structure(&mut self) {
        for (place, &(row, _)) in self.momenta[1].iter().enumerate() {
            self.jacobian.push(row, self.columns + place);
        }
        let mut hessian = mem::take(&mut self.hessian);
        let column = |place: usize| self.readings[place].column;
        self.weights(|a, b, _| {
            let [a, b] = [a, b].map(column);
            hessian.push(a.max(b), a.min(b));
        });
        self.hessian = hessian;
    }

    /// Values and changes by constant disturbances of what is read at an instant of the horizon and in the interval behind it, or at its end.
    fn targets(&self, k: usize) -> impl Iterator<Item = (&f64, &f64)> {
        let point = self.reference.at(self.begin + k);
        let (state, inputs) = match k < self.intervals {
            true => (
                &point.state[..self.steered.coordinates.len()],
                &*point.inputs,
            ),
            false => (&*point.state, &[][..]),
        };
        let state = state.iter().zip(&self.lasting.state);
        state.chain(inputs.iter().zip(&self.lasting.inputs))
    }

    /// Inputs of the first interval: V, N, N mm.
    pub(super) fn first_inputs(&self, x: &[f64], out: &mut [f64]) {
        let inputs = self.of_inputs(0).iter();
        let inputs = inputs.zip(&self.steered.inputs);
        for (value, (input, (_, is_squared))) in out.iter_mut().zip(inputs) {
            let [acting, ..] = input.of(x[input.column]);
            *value = match is_squared {
                true => acting.max(0.0).sqrt(),
                false => acting,
            };
        }
    }

    /// The state of the reference at an instant of the horizon, and its inputs, as values of the columns.
    pub(super) fn refer(&self, k: usize, x: &mut [f64]) {
        for (reading, (value, _)) in self.at(k).iter().zip(self.targets(k)) {
            let value = match reading.is_root {
                true => value.sqrt(),
                false => *value,
            };
            x[reading.column] = value / reading.scale;
        }
        let values = &self.reference.at(self.begin + k).followers;
        let followers = self.followers[k * values.len()..].iter().zip(values);
        followers.for_each(|(&(column, scale), value)| x[column] = value / scale);
    }

    /// The motion that is followed as values of the columns, on straight lines between its instants.
    pub(super) fn refer_all(&self, x: &mut [f64]) {
        (0..=self.intervals).for_each(|k| self.refer(k, x));
        for &(i, [from, to], part) in &self.between {
            x[i] = x[from] + part * (x[to] - x[from]);
        }
    }

    /// Columns and rows of the motion.
    pub(super) fn unknowns(&self) -> &Numbering {
        self.motion.program.unknowns()
    }

    /// Takes constant disturbances, and the changes of inputs against them, for the horizon that begins now.
    pub(super) fn load(&mut self, forces: &[f64], against: &[f64]) {
        let end = self.reference.at(self.begin + self.intervals);
        let (Some(rest), Some(slope)) = (&self.reference.rest, &end.slope) else {
            return;
        };
        let Lasting {
            values,
            state,
            inputs,
            slope: of_end,
        } = &mut self.lasting;
        let all = values.iter_mut().zip(forces.iter().chain(against));
        all.for_each(|(to, value)| *to = *value);
        inputs.copy_from_slice(against);
        for (matrix, to) in [(rest, state), (slope, of_end)] {
            let rows = to.iter_mut().enumerate();
            rows.for_each(|(row, to)| *to = product(matrix, row, values));
        }
    }

    /// Holds the state at the start: values of its columns, and its momenta.
    pub(super) fn hold_start(&mut self, values: &[f64], momenta: &[f64]) {
        for (reading, value) in self.readings.iter().zip(values) {
            self.bounds.lower[reading.column] = *value;
            self.bounds.upper[reading.column] = *value;
        }
        self.momentum.copy_from_slice(momenta);
    }
}

impl Nlp for Program<'_> {
    fn variables(&self) -> &Bounds {
        &self.bounds
    }

    fn constraints(&self) -> &Bounds {
        &self.row_bounds
    }

    fn jacobian_structure(&self) -> Entries {
        self.jacobian.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.hessian.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.deviate(x);
        let d = &self.deviations;
        let mut sum = 0.0;
        self.weights(|a, b, weight| {
            let part = if a == b { 0.5 } else { 1.0 };
            sum += part * weight * d[a][0] * d[b][0];
        });
        let of_end = d[self.end..].iter().zip(&self.lasting.slope);
        sum + of_end.map(|([d, ..], slope)| d * slope).sum::<f64>()
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.deviate(x);
        grad.fill(0.0);
        let readings = self.readings.iter().zip(&self.deviations);
        for ((reading, [_, by_column, _]), slope) in readings.zip(&self.slopes) {
            grad[reading.column] += by_column * slope;
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.motion.constraint(&x[..self.columns], g);
        for (&(row, scale), momentum) in self.momenta[0].iter().zip(&self.momentum) {
            g[row] += scale * momentum;
        }
        for (&(row, _), momentum) in self.momenta[1].iter().zip(&x[self.columns..]) {
            g[row] -= momentum;
        }
        for &(row, time, force) in &self.forced {
            g[row] += time * self.lasting.values[force];
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        let (motion, momenta) = values.split_at_mut(self.counts[0]);
        self.motion.jacobian(&x[..self.columns], motion);
        momenta.fill(-1.0);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        let (motion, costs) = values.split_at_mut(self.counts[1]);
        let of_motion = &x[..self.columns];
        self.motion.hessian(of_motion, sigma, costates, motion);
        self.deviate(x);
        let d = &self.deviations;
        let mut costs = costs.iter_mut();
        self.weights(|a, b, weight| {
            let own = match a == b {
                true => d[a][2] * self.slopes[a],
                false => 0.0,
            };
            let value = costs.next().expect("an entry");
            *value = sigma * (weight * d[a][1] * d[b][1] + own);
        });
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        let mut stages = self.motion.stages()?;
        let last = Stage::Of(2 * (self.intervals * self.steered.parts) as u32);
        stages.resize(self.variables().count(), last);
        Some(stages)
    }
}

impl Program<'_> {
    /// Finds the deviations of all readings at a point, and the slopes of the costs by them.
    fn deviate(&mut self, x: &[f64]) {
        let (mut deviations, mut slopes) =
            (mem::take(&mut self.deviations), mem::take(&mut self.slopes));
        let mut places = deviations.iter_mut().zip(&self.readings);
        for k in 0..=self.intervals {
            for ((target, change), (deviation, reading)) in self.targets(k).zip(&mut places) {
                *deviation = reading.of(x[reading.column]);
                deviation[0] = deviation[0] - target - change;
            }
        }
        slopes.fill(0.0);
        let of_end = slopes[self.end..].iter_mut();
        let of_end = of_end.zip(&self.lasting.slope);
        of_end.for_each(|(to, slope)| *to = *slope);
        self.weights(|a, b, weight| {
            slopes[a] += weight * deviations[b][0];
            if a != b {
                slopes[b] += weight * deviations[a][0];
            }
        });
        (self.deviations, self.slopes) = (deviations, slopes);
    }

    /// Hands over the weights of products of deviations, with the places of both among the readings: of rates over each step, of the state at each
    /// instant and of the inputs behind it, and of the state at the end.
    fn weights(&self, mut put: impl FnMut(usize, usize, f64)) {
        let (stride, end) = (self.stride(), self.end);
        for k in 0..=self.intervals {
            let (first, point) = (k * stride, self.reference.at(self.begin + k));
            let is_end = first == end;
            let costs = if is_end { &point.end } else { &point.places };
            for a in 0..costs.nrows() {
                (0..=a).for_each(|b| put(first + a, first + b, costs[(a, b)]));
            }
            if is_end {
                break;
            }
            for (c, &weight) in self.steered.rates.iter().enumerate() {
                if weight > 0.0 {
                    let [here, next] = [first + c, first + stride + c];
                    put(here, here, weight);
                    put(next, here, -weight);
                    put(next, next, weight);
                }
            }
            for (i, &weight) in self.reference.inputs.iter().enumerate() {
                let place = first + self.steered.coordinates.len() + i;
                put(place, place, weight);
            }
        }
    }
}

/// A coordinate, a momentum or an input as it acts, read from a column.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) column: usize,
    /// Factor of the column.
    pub(super) scale: f64,
    /// True if an input acts by its square and the column is none.
    pub(super) is_root: bool,
}

impl Reading {
    /// Its value, with its first and second derivative by the column.
    pub(super) fn of(&self, x: f64) -> [f64; 3] {
        let (value, slope) = (self.scale * x, self.scale);
        match self.is_root {
            true => [value * value, 2.0 * value * slope, 2.0 * slope * slope],
            false => [value, slope, 0.0],
        }
    }
}

/// The coordinates of the state at each instant and the inputs of the interval behind it; `unit` is that of a square where a column is one.
fn readings(
    motion: &Transcription<'_>,
    steered: &Steered,
    unit: impl Fn(usize) -> Option<f64>,
) -> Vec<Reading> {
    let unknowns = motion.unknowns();
    let mut out = Vec::new();
    for k in (0..=motion.intervals()).step_by(steered.parts) {
        let coordinates = steered.coordinates.iter();
        let coordinates = coordinates.map(|&i| (unknowns.unknown(k, i), false));
        let inputs = steered.inputs.iter().filter(|_| k < motion.intervals());
        let inputs = inputs.map(|&(s, is_squared)| (unknowns.scalar(k, s), is_squared));
        for (column, is_squared) in coordinates.chain(inputs) {
            let column = column.expect("an open coordinate or a sought input");
            let scale = motion.column_scale(column);
            let unit = unit(column);
            out.push(Reading {
                column,
                scale: unit.map_or(scale, |unit| scale * scale * unit),
                is_root: is_squared && unit.is_none(),
            });
        }
    }
    out
}

/// Rows on which constant disturbances act, with the scaled time of their action, and the number of the force.
fn forced(motion: &Transcription<'_>, steered: &Steered) -> Vec<(usize, f64, usize)> {
    let mut out = Vec::new();
    for k in 0..=motion.intervals() {
        // Half of a force acts before an instant, and half behind.
        let is_end = k == 0 || k == motion.intervals();
        let time = if is_end { 0.5 * steered.h } else { steered.h };
        for (force, &i) in steered.forced.iter().enumerate() {
            let row = motion.unknowns().row(k, i).expect("a balance");
            out.push((row, motion.row_scale(row) * time, force));
        }
    }
    out
}

/// A column of a coordinate within an interval, those at both of its ends, and the part of the interval that has passed there.
pub(super) type Between = (usize, [usize; 2], f64);

/// Columns of coordinates within intervals.
fn between(unknowns: &Numbering, parts: usize) -> Vec<Between> {
    let all = unknowns.columns.iter().enumerate();
    let of = all.filter_map(|(place, &column)| match column {
        Column::Instant { k, i } if k % parts > 0 => {
            let from = k - k % parts;
            let part = (k - from) as f64 / parts as f64;
            let [before, after] = [from, from + parts].map(|k| unknowns.unknown(k, i));
            Some((place, [before?, after?], part))
        }
        _ => None,
    });
    of.collect()
}

/// State and inputs of a horizon, in the order of its law.
#[derive(Clone, Debug)]
pub(super) struct Steered {
    /// Coordinates of the state, and places of those with momenta among them.
    pub(super) coordinates: Vec<usize>,
    pub(super) inert: Vec<usize>,
    /// Scalars of the inputs, with those that act by their squares.
    pub(super) inputs: Vec<(usize, bool)>,
    /// Weight of the rate of each coordinate, for differences of a step.
    pub(super) rates: Vec<f64>,
    /// Coordinates on which constant disturbances act.
    pub(super) forced: Vec<usize>,
    /// The coordinates of the state, which determine all others.
    pub(super) independent: Independent,
    /// Number of steps in an interval, and the length of one in ms.
    pub(super) parts: usize,
    pub(super) h: f64,
}

impl Steered {
    /// The coordinates of the state that have momenta.
    pub(super) fn inert(&self) -> impl Iterator<Item = usize> + '_ {
        self.inert.iter().map(|&c| self.coordinates[c])
    }

    /// All coordinates that have momenta.
    pub(super) fn moved(&self) -> impl Iterator<Item = usize> + '_ {
        let followers = self.independent.followers();
        self.inert().chain(followers.iter().copied())
    }

    /// The start at a state of coordinates and rates; others follow from where they are at z.
    pub(super) fn start(&self, model: &Model, state: &[f64], mut z: Vec<f64>) -> Start {
        let (places, of_rates) = state.split_at(self.coordinates.len());
        let mut rates = vec![0.0; model.coordinate_count()];
        let coordinates = self.coordinates.iter().zip(places);
        coordinates.for_each(|(&i, value)| z[i] = *value);
        let inert = self.inert().zip(of_rates);
        inert.for_each(|(i, rate)| rates[i] = *rate);
        self.independent.close(model, &mut z, &mut rates);
        Start::with_rates(model, z, &rates)
    }
}

/// The motion at an instant, with the costs there.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Coordinates, then momenta of those that have them.
    pub(super) state: Vec<f64>,
    /// Coordinates that follow from these.
    pub(super) followers: Vec<f64>,
    /// Inputs of the interval behind it, or their squares: V, V², N, N mm.
    pub(super) inputs: Vec<f64>,
    /// Cost of the coordinates.
    pub(super) places: DMatrix<f64>,
    /// Cost of coordinates and momenta, as those of all time that follows.
    pub(super) end: DMatrix<f64>,
    /// Slope of that cost by constant disturbances and the inputs against them; none without such forces.
    pub(super) slope: Option<DMatrix<f64>>,
}

/// A motion that ends in a state that is held.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// Its instants; the last is the state that is held.
    points: Vec<Point>,
    /// Cost of each input, or of its square.
    pub(super) inputs: Vec<f64>,
    /// Change of the state at rest by constant disturbances and the inputs against them; none without such forces.
    pub(super) rest: Option<DMatrix<f64>>,
}

impl Reference {
    /// That of a regulator; none where the goal is not held.
    pub(super) fn new(of: &Regulated, model: &Model, steered: &Steered) -> Option<Self> {
        let (held, _) = of.held.as_ref()?;
        let law = &of.law;
        let motion = law.points.iter().zip(&of.steps);
        let all = motion.chain([(law.held.as_ref()?, held)]);
        let mut z = model.reference_coordinates();
        let points = all.map(|(at, step)| Point {
            state: {
                let start = steered.start(model, &at.state, mem::take(&mut z));
                let mut momentum = start.momentum;
                z = start.z;
                steered.independent.reduce(model, &z, &mut momentum);
                let momenta = steered.inert().map(|i| momentum[i]);
                let places = at.state[..step.places.nrows()].iter().copied();
                places.chain(momenta).collect()
            },
            followers: (steered.independent.followers().iter())
                .map(|&i| z[i])
                .collect(),
            inputs: (law.inputs.iter().zip(&at.inputs))
                .map(|(of, input)| of.acting(*input))
                .collect(),
            places: step.places.clone(),
            end: step.cost.clone(),
            slope: step.lasting.as_ref().map(|[_, slope]| slope.clone()),
        });
        let costs = &held.costs.inputs;
        Some(Self {
            points: points.collect(),
            rest: of.lasting.clone(),
            inputs: costs.diagonal().iter().copied().collect(),
        })
    }

    /// The motion at an instant, also behind its end.
    pub(super) fn at(&self, k: usize) -> &Point {
        &self.points[k.min(self.points.len() - 1)]
    }
}
