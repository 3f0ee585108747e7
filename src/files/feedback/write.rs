//! Writer of `feedback.json` and of the table of gains.

use crate::feedback::{Filter, Law, Point, Reading};
use crate::files::feedback::record::{
    FilterRecord, ForceRecord, InputRecord, LastingRecord, LawRecord, MeasuredRecord,
    ObserverRecord, PointRecord, ReadingRecord, factor_of, integrated, unit_of, unit_of_force,
    unit_of_input,
};
use crate::files::lay_out;
use crate::model::System;
use nalgebra::DMatrix;
use std::fmt::Write;

/// Factors of the units of a law: of what is measured and integrated, of inputs, and of inputs or their squares.
struct Factors {
    read: Vec<f64>,
    inputs: Vec<f64>,
    acting: Vec<f64>,
}

impl Factors {
    fn new(law: &Law, system: &System) -> Self {
        let measured = law.measured.iter().map(|one| unit_of(one).1);
        let integrals = law.integral.of.iter();
        let integrals = integrals.map(|&of| integrated(unit_of(&law.measured[of]).1));
        let inputs: Vec<f64> = units(law, system).map(|(_, factor)| factor).collect();
        let acting = law.inputs.iter().zip(&inputs);
        let acting: Vec<f64> = acting
            .map(|(input, factor)| match input.is_squared {
                true => factor * factor,
                false => *factor,
            })
            .collect();
        let corrections = (0..law.delay).flat_map(|_| acting.iter().copied());
        let forces = law
            .lasting()
            .iter()
            .map(|force| unit_of_force(force.is_length).1);
        let against = acting.iter().copied().take(law.targets());
        Self {
            read: measured
                .chain(forces)
                .chain(against)
                .chain(integrals)
                .chain(corrections)
                .collect(),
            acting,
            inputs,
        }
    }

    fn gain(&self, point: &Point) -> Vec<Vec<f64>> {
        matrix(&point.gain, [&self.acting, &self.read])
    }

    fn filter(&self, filter: &Filter, outputs: &[f64]) -> FilterRecord {
        let state = &self.read[..filter.by_state.nrows()];
        FilterRecord {
            readings: scaled(&filter.readings, outputs),
            by_state: matrix(&filter.by_state, [state, state]),
            by_inputs: matrix(&filter.by_inputs, [state, &self.acting]),
            output: matrix(&filter.output, [outputs, state]),
            gain: matrix(&filter.gain, [state, outputs]),
        }
    }

    fn observer(&self, law: &Law) -> Option<ObserverRecord> {
        let observer = law.observer.as_ref()?;
        let readings = observer.readings.iter();
        let outputs = readings.clone().map(|one| factor_of(one, &law.measured));
        let outputs: Vec<f64> = outputs.collect();
        let record = |reading: &Reading| match reading {
            Reading::State(place) => ReadingRecord::Measured(*place),
            Reading::Marker(name, axis) => ReadingRecord::Marker(name.clone(), *axis),
        };
        let filter = |one: &Filter| self.filter(one, &outputs);
        Some(ObserverRecord {
            readings: readings.map(record).collect(),
            intervals: observer.points.iter().map(filter).collect(),
            held: observer.held.as_ref().map(filter),
            jump: scaled(&observer.jump, &self.read),
            lasting: observer.lasting.as_ref().map(|lasting| {
                let size = law.measured.len();
                let rows = &self.read[size..size + lasting.on.len()];
                LastingRecord {
                    forces: lasting
                        .on
                        .iter()
                        .map(|force| ForceRecord {
                            on: force.name.clone(),
                            unit: unit_of_force(force.is_length).0.to_owned(),
                        })
                        .collect(),
                    by_inputs: matrix(&lasting.by_inputs, [rows, &self.acting]),
                }
            }),
        })
    }

    fn point(&self, point: &Point) -> PointRecord {
        PointRecord {
            state: scaled(&point.state, &self.read),
            inputs: scaled(&point.inputs, &self.inputs),
            gain: self.gain(point),
            offset: scaled(&point.offset, &self.acting),
        }
    }
}

/// Numbers times their factors.
fn scaled(values: &[f64], factors: &[f64]) -> Vec<f64> {
    let all = values.iter().zip(factors);
    all.map(|(value, factor)| value * factor).collect()
}

/// A matrix row by row, with the factors of what it gives and of what it is multiplied by.
fn matrix(of: &DMatrix<f64>, [rows, columns]: [&[f64]; 2]) -> Vec<Vec<f64>> {
    let row = |(i, row): (usize, &f64)| {
        let all = columns.iter().enumerate();
        all.map(|(j, column)| of[(i, j)] * row / column).collect()
    };
    rows.iter().enumerate().map(row).collect()
}

/// Units and factors of the inputs.
fn units<'l>(law: &'l Law, system: &System) -> impl Iterator<Item = (&'static str, f64)> + 'l {
    let sources = system.sources();
    law.inputs.iter().map(move |input| {
        let source = sources.iter().find(|source| source.name == input.name);
        source.map_or(("V", 1.0), unit_of_input)
    })
}

/// The text of `feedback.json`.
pub fn law_json(law: &Law, system: &System) -> String {
    let record = record(law, system);
    lay_out(&serde_json::to_string(&record).expect("numbers and names are JSON"))
}

/// A law in SI units.
pub(super) fn record(law: &Law, system: &System) -> LawRecord {
    let factors = Factors::new(law, system);
    let measured = law.measured.iter().map(|one| MeasuredRecord {
        name: one.name.clone(),
        unit: unit_of(one).0.to_owned(),
        is_memory: one.memory.is_some(),
    });
    let inputs = law.inputs.iter().zip(units(law, system));
    let places = |places: &[[f64; 3]]| places.iter().map(|place| place.map(|x| x / 1e3)).collect();
    LawRecord {
        scene: system.name.clone(),
        interval: law.h / 1e3,
        delay_intervals: law.delay,
        measured: measured.collect(),
        inputs: inputs
            .map(|(input, (unit, factor))| InputRecord {
                name: input.name.clone(),
                unit: unit.to_owned(),
                is_squared: input.is_squared,
                bounds: input.bounds.map(|bound| bound * factor),
            })
            .collect(),
        integrals: law.integral.of.clone(),
        intervals: law
            .points
            .iter()
            .map(|point| factors.point(point))
            .collect(),
        held: law.held.as_ref().map(|point| factors.point(point)),
        observer: factors.observer(law),
        markers: law
            .markers
            .iter()
            .map(|(name, path)| (name.clone(), places(path)))
            .collect(),
    }
}

/// The table of gains: a row for the start of each interval, and one for the time after the end where the goal is held.
pub fn law_csv(law: &Law, system: &System, head: &str) -> String {
    let factors = Factors::new(law, system);
    let mut out = format!("# {head}\ntime [s]");
    let names: Vec<(String, &str)> = law
        .measured
        .iter()
        .map(|one| match one.is_rate {
            true => (format!("rate of {}", one.name), unit_of(one).0),
            false => (one.name.clone(), unit_of(one).0),
        })
        .collect();
    let integrals = law.integral.of.iter().map(|&of| {
        let (name, unit) = &names[of];
        (format!("integral of {name}"), format!("{unit} s"))
    });
    let forces = law.lasting().iter().map(|force| {
        let unit = unit_of_force(force.is_length).0;
        (
            format!("constant disturbance on {}", force.name),
            unit.to_owned(),
        )
    });
    let acting: Vec<(&str, &str, &str)> = law
        .inputs
        .iter()
        .zip(units(law, system))
        .map(|(input, (unit, _))| (&*input.name, unit, if input.is_squared { "^2" } else { "" }))
        .collect();
    let against = acting.iter().take(law.targets());
    let against = against.map(|(name, unit, square)| {
        let name = format!("{name}{square} against constant disturbances");
        (name, format!("{unit}{square}"))
    });
    let mut read: Vec<(String, String)> = names
        .iter()
        .map(|(name, unit)| (name.clone(), (*unit).to_owned()))
        .chain(forces)
        .chain(against)
        .chain(integrals)
        .collect();
    for k in 0..law.delay {
        for (name, unit, square) in &acting {
            let name = format!("correction of {name}{square} in interval {k}");
            read.push((name, format!("{unit}{square}")));
        }
    }
    for (input, unit, square) in &acting {
        for (name, of) in &read {
            write!(out, ",{input}{square} by {name} [{unit}{square}/({of})]")
                .expect("text takes everything");
        }
    }
    let points = law.points.iter().enumerate();
    let held = law.held.iter().map(|point| (law.points.len(), point));
    for (k, point) in points.chain(held) {
        write!(out, "\n{}", law.h * k as f64 / 1e3).expect("text takes everything");
        for value in factors.gain(point).iter().flatten() {
            write!(out, ",{value}").expect("text takes everything");
        }
    }
    out.push('\n');
    out
}
