//! `feedback.json` and the table of gains: types, units, and what is written of a law.

use crate::feedback::{Filter, Forced, Law, LawInput, Measured, Memory, Point, Reading};
use crate::files::lay_out;
use crate::model::System;
use crate::model::system::Source;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LawRecord {
    /// Name of the scene.
    pub(super) scene: String,
    /// Length of the intervals in s.
    pub(super) interval: f64,
    /// Intervals from a measurement to its effect, over which gains predict.
    #[serde(default)]
    pub(super) delay_intervals: usize,
    pub(super) measured: Vec<MeasuredRecord>,
    pub(super) inputs: Vec<InputRecord>,
    /// Places among what is measured of deviations that are integrated over time.
    pub(super) integrals: Vec<usize>,
    /// One for each interval.
    pub(super) intervals: Vec<PointRecord>,
    /// After the end, where the goal is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) held: Option<PointRecord>,
    /// The filter that finds what is measured from other readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) observer: Option<ObserverRecord>,
    /// Places of markers in m at the instants.
    pub(super) markers: BTreeMap<String, Vec<[f64; 3]>>,
}

/// An observer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObserverRecord {
    pub(super) readings: Vec<ReadingRecord>,
    pub(super) intervals: Vec<FilterRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) held: Option<FilterRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) lasting: Option<LastingRecord>,
    /// State at the end of the motion as a deviation from the goal that is held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) jump: Vec<f64>,
}

/// Constant disturbances that the filter finds, and what inputs change of them at the goal.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LastingRecord {
    pub(super) forces: Vec<ForceRecord>,
    /// A row for each force, over the inputs or their squares.
    pub(super) by_inputs: Vec<Vec<f64>>,
}

/// A constant disturbance on a coordinate: N m, N.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ForceRecord {
    pub(super) on: String,
    pub(super) unit: String,
}

/// A reading of an observer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ReadingRecord {
    /// A coordinate, by its place among what is measured.
    Measured(usize),
    /// A component of the place of a marker in m, by the name of the marker and the axis, 0 to 2.
    Marker(String, usize),
}

/// The filter in an interval: readings, and the matrices A, B, C and M row by row, over what is measured and the constant disturbances.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterRecord {
    pub(super) readings: Vec<f64>,
    pub(super) by_state: Vec<Vec<f64>>,
    pub(super) by_inputs: Vec<Vec<f64>>,
    pub(super) output: Vec<Vec<f64>>,
    pub(super) gain: Vec<Vec<f64>>,
}

/// A coordinate or its rate: rad, m, rad/s, m/s; or what a muscle remembers: a number, C.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasuredRecord {
    pub(super) name: String,
    pub(super) unit: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) is_memory: bool,
}

/// A voltage or a load: V, or the unit of the load.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InputRecord {
    pub(super) name: String,
    pub(super) unit: String,
    /// True if gains are for the square of the voltage.
    pub(super) is_squared: bool,
    pub(super) bounds: [f64; 2],
}

/// The law in an interval.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointRecord {
    pub(super) state: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    /// A row for each input, over what is measured, then constant disturbances and the changes of inputs against them, then the integrals, then the
    /// corrections of the inputs in each interval of the delay.
    pub(super) gain: Vec<Vec<f64>>,
    /// Correction of each input whatever is measured, where a delay leads behind the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) offset: Vec<f64>,
}

/// Unit of a measured quantity, and its factor from the units inside.
pub(crate) fn unit_of(measured: &Measured) -> (&'static str, f64) {
    match (measured.memory, measured.is_length, measured.is_rate) {
        (Some(Memory::Number), ..) => ("1", 1.0),
        (Some(Memory::Charge(unit)), ..) => ("C", 1e-3 * unit),
        (None, false, false) => ("rad", 1.0),
        (None, false, true) => ("rad/s", 1e3),
        (None, true, false) => ("m", 1e-3),
        (None, true, true) => ("m/s", 1.0),
    }
}

/// Unit of a constant disturbance, and its factor from the units inside.
pub(super) fn unit_of_force(is_length: bool) -> (&'static str, f64) {
    match is_length {
        true => ("N", 1.0),
        false => ("N m", 1e-3),
    }
}

/// Unit of an input, and its factor from the units inside.
pub(super) fn unit_of_input(source: &Source) -> (&'static str, f64) {
    let (unit, size) = source.kind.si();
    (unit, 1.0 / size)
}

/// Factor of a reading from the units inside.
pub(crate) fn factor_of(reading: &Reading, measured: &[Measured]) -> f64 {
    match reading {
        Reading::State(place) => unit_of(&measured[*place]).1,
        Reading::Marker(..) => 1e-3,
    }
}

/// Factors of the units of a law: of all columns of its gains, of inputs, and of inputs in the units in which they act.
pub(super) struct Factors {
    pub(super) read: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    pub(super) acting: Vec<f64>,
}

/// The lists of a law that its columns follow from.
pub(super) struct Listed<'a> {
    pub(super) measured: &'a [Measured],
    pub(super) inputs: &'a [LawInput],
    pub(super) forces: &'a [Forced],
    pub(super) integrals: &'a [usize],
    pub(super) delay: usize,
}

impl Factors {
    /// Of a law with these lists, whose `inputs` have these factors.
    pub(super) fn new(of: &Listed<'_>, inputs: Vec<f64>) -> Self {
        let acting = of.inputs.iter().zip(&inputs);
        let acting = acting.map(|(input, factor)| match input.is_squared {
            true => factor * factor,
            false => *factor,
        });
        let acting: Vec<f64> = acting.collect();
        let mut read: Vec<f64> = of.measured.iter().map(|one| unit_of(one).1).collect();
        let integrals = of.integrals.iter();
        // A factor from rad or mm, of an integral over ms.
        let integrals: Vec<f64> = integrals.map(|&of| 1e-3 * read[of]).collect();
        if !of.forces.is_empty() {
            let forces = of.forces.iter();
            read.extend(forces.map(|force| unit_of_force(force.is_length).1));
            read.extend(&acting);
        }
        read.extend(integrals);
        (0..of.delay).for_each(|_| read.extend(&acting));
        Self {
            read,
            inputs,
            acting,
        }
    }

    /// Of a law of a system.
    fn of_law(law: &Law, system: &System) -> Self {
        let of = Listed {
            measured: &law.measured,
            inputs: &law.inputs,
            forces: law.lasting(),
            integrals: &law.integral.of,
            delay: law.delay,
        };
        Self::new(&of, units(law, system).map(|(_, factor)| factor).collect())
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
    let factors = Factors::of_law(law, system);
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
    let factors = Factors::of_law(law, system);
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
