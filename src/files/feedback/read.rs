//! Reader of `feedback.json`, for a system with joints and sources of the same names.

use crate::feedback::{
    Filter, Forced, Integral, Lasting, Law, LawInput, Measured, Memory, Observer, Point, Reading,
};
use crate::files::feedback::record::{
    Factors, FilterRecord, InputRecord, LawRecord, Listed, MeasuredRecord, ObserverRecord,
    PointRecord, ReadingRecord, factor_of, unit_of, unit_of_force, unit_of_input,
};
use crate::files::json::document::Document;
use crate::files::json::error::{Result, SceneError};
use crate::files::json::scope::{Scope, refuse};
use crate::files::problem::at::At;
use crate::files::scene::names::names;
use crate::model::system::System;
use nalgebra::DMatrix;
use std::path::Path;

/// Most intervals of a delay.
const MOST_DELAYED: usize = 10_000;

/// The law of a file.
///
/// # Errors
/// It cannot be read, lacks something, or is one of another robot.
pub(crate) fn read_law(path: &Path, system: &System) -> Result<Law> {
    let document = Document::read(path)?;
    let record: LawRecord = document.parse()?;
    let scope = Scope::of(&document);
    refuse!(if !(record.interval > 0.0 && record.interval.is_finite()), scope.key("interval");
        found record.interval, expected "a positive time in s");
    let measured: Vec<Measured> = scope.key("measured").each(&record.measured, of_measured)?;
    let inputs = At::new(&scope, system).key("inputs");
    let inputs: Vec<(LawInput, f64)> = inputs.each(&record.inputs, of_input)?;
    let (inputs, of_inputs) = inputs.into_iter().unzip::<_, _, Vec<_>, Vec<_>>();
    check_sizes(&record, measured.len(), &scope)?;
    let forces = forces(&record, &scope)?;
    let of = Listed {
        measured: &measured,
        inputs: &inputs,
        forces: &forces,
        integrals: &record.integrals,
        delay: record.delay_intervals,
    };
    let Factors {
        read,
        acting,
        inputs: of_inputs,
    } = Factors::new(&of, of_inputs);
    let point = |record: &PointRecord, place: &Scope<'_>| {
        let measured = &read[..measured.len()];
        Ok::<Point, SceneError>(Point {
            state: list(&record.state, measured, &place.key("state"))?,
            inputs: list(&record.inputs, &of_inputs, &place.key("inputs"))?,
            gain: matrix(&record.gain, [&acting, &read], &place.key("gain"))?,
            offset: match record.offset.is_empty() {
                true => Vec::new(),
                false => list(&record.offset, &acting, &place.key("offset"))?,
            },
        })
    };
    let place = scope.key("intervals");
    refuse!(if record.intervals.is_empty(), place; found "none", expected "one interval or more");
    let points: Vec<Point> = place.each(&record.intervals, point)?;
    let held = scope.optional("held", &record.held, |at, one| point(one, at))?;
    let markers = markers(&record, points.len() + 1, system);
    let observer = scope.optional("observer", &record.observer, |place, one| {
        let factors = [&read[..measured.len() + forces.len()], &acting];
        let observer = observer(one, &measured, forces, points.len(), factors, place)?;
        refuse!(if observer.held.is_some() != held.is_some(), place.key("held");
            found "one of two", expected "a filter where the goal is held");
        Ok(observer)
    })?;
    Ok(Law {
        measured,
        inputs,
        integral: Integral {
            of: record.integrals,
        },
        h: 1e3 * record.interval,
        delay: record.delay_intervals,
        points,
        held,
        observer,
        markers,
    })
}

/// Refuses integrals of what is not measured, and a delay that is too long.
fn check_sizes(record: &LawRecord, measured: usize, scope: &Scope<'_>) -> Result<()> {
    let place = scope.key("integrals");
    for (i, &of) in record.integrals.iter().enumerate() {
        refuse!(if of >= measured, place.index(i);
            found of, expected format!("a place below {measured}"));
    }
    refuse!(if record.delay_intervals > MOST_DELAYED, scope.key("delay_intervals");
        found record.delay_intervals, expected format!("no more than {MOST_DELAYED}"));
    Ok(())
}

/// The constant disturbances that the observer finds.
fn forces(record: &LawRecord, scope: &Scope<'_>) -> Result<Vec<Forced>> {
    let observer = record.observer.as_ref();
    let Some(lasting) = observer.and_then(|one| one.lasting.as_ref()) else {
        return Ok(Vec::new());
    };
    let place = scope.key("observer").key("lasting").key("forces");
    refuse!(if lasting.forces.is_empty(), place; found "none", expected "one force or more");
    place.each(&lasting.forces, |force, place| {
        let mut kinds = [false, true].into_iter();
        let own = kinds.find(|&is_length| unit_of_force(is_length).0 == force.unit);
        let wrong = || {
            let found = format!("{:?}", force.unit);
            place.key("unit").wrong(found, "\"N m\" or \"N\"")
        };
        Ok(Forced {
            name: force.on.clone(),
            is_length: own.ok_or_else(wrong)?,
        })
    })
}

/// Places in mm of markers that the system has, at a number of instants.
fn markers(record: &LawRecord, instants: usize, system: &System) -> Vec<(String, Vec<[f64; 3]>)> {
    let mut markers = Vec::new();
    let known = names(&system.markers, |marker| &marker.name);
    for (name, path) in &record.markers {
        // A marker that this robot does not have is not compared.
        if known.contains(name) && path.len() == instants {
            let path = path.iter().map(|place| place.map(|x| 1e3 * x));
            markers.push((name.clone(), path.collect()));
        }
    }
    markers
}

fn of_measured(record: &MeasuredRecord, place: &Scope<'_>) -> Result<Measured> {
    let plain = [(false, false), (false, true), (true, false), (true, true)];
    let plain = plain.map(|(is_length, is_rate)| (is_length, is_rate, None));
    let remembered = [Memory::Number, Memory::Charge(1.0)].map(|one| (false, false, Some(one)));
    let (kinds, expected) = match record.is_memory {
        true => (&remembered[..], "1 or C"),
        false => (&plain[..], "rad, m, rad/s or m/s"),
    };
    let all = kinds.iter().map(|&(is_length, is_rate, memory)| Measured {
        name: record.name.clone(),
        is_rate,
        is_length,
        memory,
    });
    let mut own = all.filter(|one| unit_of(one).0 == record.unit);
    let wrong = || {
        place
            .key("unit")
            .wrong(format!("{:?}", record.unit), expected)
    };
    own.next().ok_or_else(wrong)
}

/// An input, and the factor of its unit.
fn of_input(record: &InputRecord, place: &At<'_>) -> Result<(LawInput, f64)> {
    let mut sources = place.sources.iter();
    let source = match sources.find(|source| source.is_load() && source.name == record.name) {
        Some(load) => load,
        None => &place.sources[place.key("name").driven(&record.name)?],
    };
    let (unit, factor) = unit_of_input(source);
    refuse!(if unit != record.unit, place.key("unit");
        found format!("{:?}", record.unit),
        expected format!("{unit:?}, the unit of {}", source.name));
    let [low, high] = record.bounds;
    let is_root = !record.is_squared || low >= 0.0;
    refuse!(if !(low <= high && is_root), place.key("bounds");
        found format!("[{low}, {high}]"),
        expected "a lower and an upper bound, of a squared voltage none below zero");
    let input = LawInput {
        name: record.name.clone(),
        is_squared: record.is_squared,
        bounds: record.bounds.map(|bound| bound / factor),
    };
    Ok((input, factor))
}

/// Finite numbers, as many as there are factors, in the units inside.
fn list(values: &[f64], factors: &[f64], place: &Scope<'_>) -> Result<Vec<f64>> {
    refuse!(if values.len() != factors.len(), place;
        found format!("{} numbers", values.len()), expected factors.len().to_string());
    let infinite = values.iter().position(|value| !value.is_finite());
    refuse!(if let Some(i) = infinite, place.index(i); found values[i], expected "a finite number");
    let all = values.iter().zip(factors);
    Ok(all.map(|(value, factor)| value / factor).collect())
}

/// A matrix of finite numbers row by row, with the factors of what it gives and of what it is multiplied by.
fn matrix(
    rows: &[Vec<f64>],
    [of_rows, columns]: [&[f64]; 2],
    place: &Scope<'_>,
) -> Result<DMatrix<f64>> {
    refuse!(if rows.len() != of_rows.len(), place;
        found format!("{} rows", rows.len()), expected of_rows.len().to_string());
    let mut out = DMatrix::zeros(of_rows.len(), columns.len());
    for (i, (row, of)) in rows.iter().zip(of_rows).enumerate() {
        let factors: Vec<f64> = columns.iter().map(|column| of / column).collect();
        for (j, value) in list(row, &factors, &place.index(i))?
            .into_iter()
            .enumerate()
        {
            out[(i, j)] = value;
        }
    }
    Ok(out)
}

/// The observer of a law, over its measured quantities and inputs with these factors.
fn observer(
    record: &ObserverRecord,
    measured: &[Measured],
    forces: Vec<Forced>,
    intervals: usize,
    [state, acting]: [&[f64]; 2],
    place: &Scope<'_>,
) -> Result<Observer> {
    let reading = |one: &ReadingRecord, place: &Scope<'_>| match one {
        ReadingRecord::Measured(own) if *own < measured.len() => Ok(Reading::State(*own)),
        ReadingRecord::Measured(own) => {
            Err(place.wrong(own.to_string(), format!("a place below {}", measured.len())))
        }
        ReadingRecord::Marker(name, axis) if *axis < 3 => Ok(Reading::Marker(name.clone(), *axis)),
        ReadingRecord::Marker(_, axis) => Err(place.wrong(axis.to_string(), "0, 1 or 2")),
    };
    let readings: Vec<Reading> = place.key("readings").each(&record.readings, reading)?;
    refuse!(if readings.is_empty(), place.key("readings");
        found "none", expected "one reading or more");
    let outputs = readings.iter().map(|one| factor_of(one, measured));
    let outputs: Vec<f64> = outputs.collect();
    let filter = |one: &FilterRecord, place: &Scope<'_>| {
        Ok::<Filter, SceneError>(Filter {
            readings: list(&one.readings, &outputs, &place.key("readings"))?,
            by_state: matrix(&one.by_state, [state, state], &place.key("by_state"))?,
            by_inputs: matrix(&one.by_inputs, [state, acting], &place.key("by_inputs"))?,
            output: matrix(&one.output, [&outputs, state], &place.key("output"))?,
            gain: matrix(&one.gain, [state, &outputs], &place.key("gain"))?,
        })
    };
    let of_intervals = place.key("intervals");
    refuse!(if record.intervals.len() != intervals, of_intervals;
        found record.intervals.len(), expected format!("{intervals}, one for each interval"));
    let lasting = place.optional("lasting", &record.lasting, |place, one| {
        let factors = [&state[measured.len()..], acting];
        Ok(Lasting {
            on: forces,
            by_inputs: matrix(&one.by_inputs, factors, &place.key("by_inputs"))?,
        })
    })?;
    let jump = match record.jump.is_empty() {
        true => Vec::new(),
        false => list(&record.jump, &state[..measured.len()], &place.key("jump"))?,
    };
    Ok(Observer {
        jump,
        lasting,
        points: of_intervals.each(&record.intervals, filter)?,
        held: place.optional("held", &record.held, |at, one| filter(one, at))?,
        readings,
    })
}
