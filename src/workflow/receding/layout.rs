//! State and inputs of the program of a receding horizon by their columns.
//!
//! The motion that a receding horizon follows, with the costs of deviations from it: those of the regulator.

use crate::control::{Column, Transcription};
use crate::dynamics::Start;
use crate::feedback::LawInput;
use crate::model::Model;
use crate::nlp::Nlp;
use crate::nlp::squares::Squares;
use crate::workflow::regulator::{Regulated, RegulatedStep};
use nalgebra::DMatrix;
use rustc_hash::FxHashMap;
use std::hash::Hash;

/// An input of an interval: its column, with its value as it acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputColumn {
    pub(super) column: usize,
    /// Factor of the column.
    pub(super) scale: f64,
    /// True if it acts by its square and the column is none.
    pub(super) is_root: bool,
}

impl InputColumn {
    /// The input as it acts, with its first and second derivative by the column.
    pub(super) fn reading(&self, x: f64) -> [f64; 3] {
        let (value, slope) = (self.scale * x, self.scale);
        match self.is_root {
            true => [value * value, 2.0 * value * slope, 2.0 * slope * slope],
            false => [value, slope, 0.0],
        }
    }
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
    /// Number of steps in an interval, and the length of one in ms.
    pub(super) parts: usize,
    pub(super) h: f64,
}

impl Steered {
    /// Momenta of a state of coordinates and rates.
    pub(super) fn momenta(&self, model: &Model, state: &[f64]) -> Vec<f64> {
        let of = &self.coordinates;
        let mut z = model.reference_coordinates();
        let mut rates = vec![0.0; model.coordinate_count()];
        of.iter().zip(state).for_each(|(&i, value)| z[i] = *value);
        let of_rates = self.inert.iter().zip(&state[of.len()..]);
        of_rates.for_each(|(&c, rate)| rates[of[c]] = *rate);
        let start = Start::with_rates(model, z, &rates);
        let inert = self.inert.iter();
        inert.map(|&c| start.momentum[of[c]]).collect()
    }
}

/// The state and the inputs of a program by their columns.
#[derive(Clone, Debug)]
pub(super) struct Layout<'m> {
    pub(super) steered: &'m Steered,
    /// Number of intervals.
    pub(super) intervals: usize,
    /// Columns and scales of the coordinates of the state, instant by instant.
    pub(super) coordinates: Vec<(usize, f64)>,
    /// Rows of the momenta of the first and of the last instant, with their scales.
    pub(super) momenta: [Vec<(usize, f64)>; 2],
    /// Columns of the inputs of each interval.
    pub(super) driven: Vec<Vec<InputColumn>>,
    /// Rows on which constant disturbances act, with the scaled time of their action, and the number of the force.
    pub(super) forced: Vec<(usize, f64, usize)>,
}

impl<'m> Layout<'m> {
    /// The layout of a transcription, with the column here of each of its columns.
    pub(super) fn new(motion: &Transcription<'_>, own: &[usize], steered: &'m Steered) -> Self {
        let Steered { parts, h, .. } = *steered;
        let intervals = motion.intervals() / parts;
        let unknowns = motion.unknowns();
        let squares = motion.squares();
        let mut ones = vec![1.0; own.len()];
        Squares::of(motion, squares.clone()).square(&mut ones);
        let coordinate = |k: usize, i: usize| {
            let column = unknowns.unknown(k * parts, i).expect("an open coordinate");
            (own[column], motion.column_scale(column))
        };
        let row = |k: usize, c: usize| {
            let row = unknowns.row(k * parts, steered.coordinates[c]);
            let row = row.expect("a balance");
            (row, motion.row_scale(row))
        };
        let input = |k: usize, s: usize, is_squared: bool| {
            let column = unknowns.scalar(k * parts, s).expect("a sought input");
            let scale = motion.column_scale(column);
            let is_square = squares.contains(&column);
            InputColumn {
                column: own[column],
                // V² = scale² u w of w = V²/u.
                scale: if is_square {
                    scale * scale / ones[column]
                } else {
                    scale
                },
                is_root: is_squared && !is_square,
            }
        };
        let last = intervals * parts;
        let mut out = Self {
            forced: Vec::new(),
            steered,
            intervals,
            coordinates: Vec::new(),
            momenta: [0, intervals].map(|k| steered.inert.iter().map(|&c| row(k, c)).collect()),
            driven: Vec::new(),
        };
        for k in 0..=last {
            // Half of a force acts before an instant, and half behind.
            let time = if k == 0 || k == last { 0.5 * h } else { h };
            for (force, &i) in steered.forced.iter().enumerate() {
                let row = unknowns.row(k, i).expect("a balance");
                out.forced.push((row, motion.row_scale(row) * time, force));
            }
        }
        for k in 0..=intervals {
            let coordinates = steered.coordinates.iter();
            out.coordinates
                .extend(coordinates.map(|&i| coordinate(k, i)));
        }
        for k in 0..intervals {
            let inputs = steered.inputs.iter();
            let inputs = inputs.map(|&(s, is_squared)| input(k, s, is_squared));
            out.driven.push(inputs.collect());
        }
        out
    }

    /// Number of coordinates of the state.
    pub(super) fn width(&self) -> usize {
        self.coordinates.len() / (self.intervals + 1)
    }
}

/// The first place of each entry of a list.
pub(super) fn places<T: Copy + Eq + Hash>(list: &[T]) -> FxHashMap<T, usize> {
    let mut places = FxHashMap::default();
    for (place, one) in list.iter().enumerate() {
        places.entry(*one).or_insert(place);
    }
    places
}

/// A column of a coordinate within an interval, those at both of its ends, and the part of the interval that has passed there.
pub(super) type Between = (usize, [usize; 2], f64);

/// Numbers columns of which an input has one for all steps of an interval: the number of each column, and the first column of each number.
pub(super) fn held_over_parts(
    columns: &[Column],
    inputs: &[usize],
    parts: usize,
) -> (Vec<usize>, Vec<Column>) {
    let (mut own, mut first) = (Vec::new(), Vec::new());
    let mut numbers = FxHashMap::default();
    for &column in columns {
        let same = match column {
            Column::Interval { k, s } if k % parts > 0 && inputs.contains(&s) => {
                let k = k - k % parts;
                numbers.get(&Column::Interval { k, s }).copied()
            }
            _ => None,
        };
        own.push(same.unwrap_or(first.len()));
        if same.is_none() {
            numbers.entry(column).or_insert(first.len());
            first.push(column);
        }
    }
    (own, first)
}

/// Columns of coordinates within intervals.
pub(super) fn between(columns: &[Column], parts: usize) -> Vec<Between> {
    let places = places(columns);
    let all = columns.iter().enumerate();
    let of = all.filter_map(|(place, &column)| match column {
        Column::Instant { k, i } if k % parts > 0 => {
            let at = |k| places.get(&Column::Instant { k, i }).copied();
            let from = k - k % parts;
            let part = (k - from) as f64 / parts as f64;
            Some((place, [at(from)?, at(from + parts)?], part))
        }
        _ => None,
    });
    of.collect()
}

/// The motion at an instant, with the costs there.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Coordinates, then rates of those that have momenta: rad, mm, rad/ms, mm/ms.
    pub(super) state: Vec<f64>,
    /// The momenta.
    pub(super) momentum: Vec<f64>,
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
    /// That of a regulator, with the momenta of a state; none where the goal is not held.
    pub(super) fn new(of: &Regulated, momentum: impl Fn(&[f64]) -> Vec<f64>) -> Option<Self> {
        let (held_step, held) = of.held.as_ref()?;
        let law = &of.law;
        let mut after = of.end_cost.clone();
        let mut ends = vec![];
        for step in of.steps.iter().rev() {
            after = step.riccati(&after)?.cost;
            ends.push(after.clone());
        }
        ends.reverse();
        let point = |at: &crate::feedback::Point, step: &RegulatedStep, end: &DMatrix<f64>| Point {
            state: at.state.clone(),
            momentum: momentum(&at.state),
            inputs: acting(&law.inputs, &at.inputs),
            places: step.places.clone(),
            end: end.clone(),
            slope: step.lasting.as_ref().map(|[_, slope]| slope.clone()),
        };
        let motion = law.points.iter().zip(&of.steps).zip(&ends);
        let mut points: Vec<Point> = motion
            .map(|((at, step), end)| point(at, step, end))
            .collect();
        points.push(point(law.held.as_ref()?, held_step, &held.cost));
        let costs = &held_step.costs.inputs;
        Some(Self {
            points,
            rest: of.lasting.clone(),
            inputs: costs.diagonal().iter().copied().collect(),
        })
    }

    /// The motion at an instant, also behind its end.
    pub(super) fn at(&self, k: usize) -> &Point {
        &self.points[k.min(self.points.len() - 1)]
    }
}

/// Inputs as they act: squares where they do by them.
fn acting(of: &[LawInput], inputs: &[f64]) -> Vec<f64> {
    let all = of.iter().zip(inputs);
    all.map(|(of, input)| if of.is_squared { input * input } else { *input })
        .collect()
}
