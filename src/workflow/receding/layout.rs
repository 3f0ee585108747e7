//! State and inputs of the program of a receding horizon by their columns.

use std::hash::Hash;

use rustc_hash::FxHashMap;

use crate::control::{Column, Transcription};
use crate::nlp::Nlp;
use crate::nlp::squares::Squares;

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

/// The state and the inputs of a program by their columns.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Number of intervals, and of steps in each of them.
    pub(super) intervals: usize,
    pub(super) parts: usize,
    /// Columns and scales of the coordinates of the state, instant by instant.
    pub(super) coordinates: Vec<(usize, f64)>,
    /// Places of the coordinates that have a momentum, among those of the state.
    pub(super) inert: Vec<usize>,
    /// Rows of the momenta of the first and of the last instant, with their scales.
    pub(super) momenta: [Vec<(usize, f64)>; 2],
    /// Columns of the inputs of each interval.
    pub(super) driven: Vec<Vec<InputColumn>>,
    /// Weight of the rates of each coordinate, for differences of a step.
    pub(super) rates: Vec<f64>,
    /// Rows on which constant disturbances act, with the scaled time of their action, and the number of the force.
    pub(super) forced: Vec<(usize, f64, usize)>,
}

impl Layout {
    /// The layout of a transcription, with the column here of each of its columns.
    pub(super) fn new(
        (motion, own): (&Transcription<'_>, &[usize]),
        (intervals, parts): (usize, usize),
        (state, inert): (&[usize], &[usize]),
        (inputs, rates): (&[(usize, bool)], Vec<f64>),
        (forced, h): (&[usize], f64),
    ) -> Self {
        let unknowns = motion.unknowns();
        let squares = motion.squares();
        let mut ones = vec![1.0; own.len()];
        Squares::of(motion, squares.clone()).square(&mut ones);
        let instants = 0..=intervals;
        let coordinate = |(k, i): (usize, usize)| {
            let column = unknowns.unknown(k * parts, i).expect("an open coordinate");
            (own[column], motion.column_scale(column))
        };
        let row = |k: usize, c: usize| {
            let row = unknowns.row(k * parts, state[c]).expect("a balance");
            (row, motion.row_scale(row))
        };
        let input = |k: usize, (s, is_squared): (usize, bool)| {
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
        let force = |k: usize, (force, &i): (usize, &usize)| {
            let row = unknowns.row(k, i).expect("a balance");
            // Half of it acts before an instant, and half behind.
            let time = if k == 0 || k == last { 0.5 * h } else { h };
            (row, motion.row_scale(row) * time, force)
        };
        let steps = 0..=last;
        Self {
            forced: steps
                .flat_map(|k| forced.iter().enumerate().map(move |one| (k, one)))
                .map(|(k, one)| force(k, one))
                .collect(),
            intervals,
            parts,
            coordinates: instants
                .flat_map(|k| state.iter().map(move |&i| (k, i)))
                .map(coordinate)
                .collect(),
            inert: inert.to_vec(),
            momenta: [0, intervals].map(|k| inert.iter().map(|&c| row(k, c)).collect()),
            driven: (0..intervals)
                .map(|k| inputs.iter().map(|&one| input(k, one)).collect())
                .collect(),
            rates,
        }
    }

    /// Number of coordinates of the state.
    pub(super) fn width(&self) -> usize {
        self.coordinates.len() / (self.intervals + 1)
    }

    /// Columns of the inputs of the last interval.
    pub(super) fn last_inputs(&self) -> impl Iterator<Item = usize> {
        let last = self.driven.last().into_iter().flatten();
        last.map(|input| input.column)
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
    let (mut own, mut first): (Vec<usize>, Vec<Column>) = Default::default();
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
