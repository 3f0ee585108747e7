//! The law of a controller as a C file without dependencies: tables, and a function that a driver board calls once an interval.

use crate::feedback::Law;
use crate::files::feedback::record::{
    FilterRecord, ForceRecord, LawRecord, PointRecord, ReadingRecord, record, unit_of_force,
};
use crate::model::System;
use std::fmt::Write;

/// Code behind the tables.
const CODE: &str = include_str!("controller.c");

/// A matrix row by row.
type Rows = Vec<Vec<f64>>;

/// The text of `feedback.c`; `head` says where it is from.
pub fn law_c(law: &Law, system: &System, head: &str) -> String {
    let record = record(law, system);
    let mut out = format!("/* {}\n *\n", comment(head));
    out.push_str(&interface(&record));
    sizes(&record, &mut out);
    tables(&record, &mut out);
    observer_tables(&record, &mut out);
    out + CODE
}

/// The intervals, then the time after them.
fn points(record: &LawRecord) -> impl Iterator<Item = &PointRecord> {
    record.intervals.iter().chain(&record.held)
}

/// Definitions of all sizes.
fn sizes(record: &LawRecord, out: &mut String) {
    let (states, inputs) = (record.measured.len(), record.inputs.len());
    let observer = record.observer.as_ref();
    let forces = observer.and_then(|one| Some(one.lasting.as_ref()?.forces.len()));
    let sizes = [
        ("POINTS", points(record).count()),
        ("END", record.intervals.len()),
        ("STATES", states),
        (
            "READINGS",
            observer.map_or(states, |one| one.readings.len()),
        ),
        ("INPUTS", inputs),
        ("INTEGRALS", record.integrals.len()),
        ("DELAY", record.delay_intervals),
        ("OBSERVER", observer.map_or(0, |_| 1)),
        ("FORCES", forces.unwrap_or(0)),
        ("TARGETS", forces.map_or(0, |_| inputs)),
    ];
    for (name, size) in sizes {
        writeln!(out, "#define FEEDBACK_{name} {size}").expect("text takes everything");
    }
    out.push_str(
        "#define FEEDBACK_ESTIMATED (FEEDBACK_STATES + FEEDBACK_FORCES)\n\
         #define FEEDBACK_FOUND (FEEDBACK_ESTIMATED + FEEDBACK_TARGETS)\n\
         #define FEEDBACK_READ (FEEDBACK_FOUND + FEEDBACK_INTEGRALS + FEEDBACK_DELAY * FEEDBACK_INPUTS)\n\n",
    );
}

/// Adds a table of rows of a type: its name, its sizes, and the rows.
fn table(out: &mut String, of: &str, sizes: &[&str], rows: impl Iterator<Item = String>) {
    let (kind, name) = of.split_once(' ').unwrap_or(("double", of));
    let sizes = sizes.iter().map(|size| match size.parse::<usize>() {
        Ok(size) => format!("[{size}]"),
        Err(_) => format!("[FEEDBACK_{size}]"),
    });
    let sizes: String = sizes.collect();
    let rows: Vec<String> = rows.collect();
    let rows = rows.join(",\n  ");
    writeln!(
        out,
        "static const {kind} feedback_{name}{sizes} = {{\n  {rows}\n}};\n"
    )
    .expect("text takes everything");
}

/// Tables of the motion and of its gains.
fn tables(record: &LawRecord, out: &mut String) {
    let interval = [number(record.interval)];
    table(out, "interval", &["1"], interval.into_iter());
    // C has no empty arrays.
    if !record.integrals.is_empty() {
        let places = record.integrals.iter().map(usize::to_string);
        table(out, "int integrated", &["INTEGRALS"], places);
    }
    let squared = record.inputs.iter().map(|one| u8::from(one.is_squared));
    let squared = squared.map(|is_squared| is_squared.to_string());
    table(out, "int squared", &["INPUTS"], squared);
    let bounds = record.inputs.iter().map(|one| row(&one.bounds));
    table(out, "bounds", &["INPUTS", "2"], bounds);
    if record.observer.is_none() {
        let states = points(record).map(|point| row(&point.state));
        table(out, "state", &["POINTS", "STATES"], states);
    }
    let given = points(record).map(|point| row(&point.inputs));
    table(out, "given", &["POINTS", "INPUTS"], given);
    let gains = points(record).map(|point| matrix(&point.gain));
    table(out, "gain", &["POINTS", "INPUTS", "READ"], gains);
    if record.delay_intervals > 0 {
        let none = vec![0.0; record.inputs.len()];
        let offset = points(record).map(|point| match point.offset.is_empty() {
            true => row(&none),
            false => row(&point.offset),
        });
        table(out, "offset", &["POINTS", "INPUTS"], offset);
    }
}

/// Tables of the observer, where there is one.
fn observer_tables(record: &LawRecord, out: &mut String) {
    let Some(observer) = &record.observer else {
        return;
    };
    let filters = || observer.intervals.iter().chain(&observer.held);
    let readings = filters().map(|one| row(&one.readings));
    table(out, "reading", &["POINTS", "READINGS"], readings);
    let mut of = |name: &str, rows: &str, columns: &str, list: fn(&FilterRecord) -> &Rows| {
        let list = filters().map(|one| matrix(list(one)));
        table(out, name, &["POINTS", rows, columns], list);
    };
    of("by_state", "ESTIMATED", "ESTIMATED", |one| &one.by_state);
    of("by_input", "ESTIMATED", "INPUTS", |one| &one.by_inputs);
    of("output", "READINGS", "ESTIMATED", |one| &one.output);
    of("filter", "ESTIMATED", "READINGS", |one| &one.gain);
    let lasting = observer.lasting.as_ref();
    let forces = lasting.map_or(&[][..], |one| &one.forces);
    let size = record.measured.len() + forces.len();
    let jump = observer.jump.iter().copied().chain(std::iter::repeat(0.0));
    table(out, "jump", &["ESTIMATED"], jump.take(size).map(number));
    if let Some(lasting) = lasting {
        // Forces that cannot be held count in N and N mm.
        let kinds = [true, false].map(unit_of_force);
        let unit = |force: &ForceRecord| {
            let own = kinds.iter().find(|(unit, _)| *unit == force.unit);
            1.0 / own.map_or(1.0, |(_, factor)| *factor)
        };
        let units: Vec<f64> = forces.iter().map(unit).collect();
        let scaled = |(of, unit): (&Vec<f64>, &f64)| of.iter().map(|value| value * unit).collect();
        let rows: Rows = lasting.by_inputs.iter().zip(&units).map(scaled).collect();
        let units = units.into_iter().map(number);
        table(out, "force_unit", &["FORCES"], units);
        let rows = rows.iter().map(|one| row(one));
        table(out, "force", &["FORCES", "INPUTS"], rows);
    }
}

/// The head comment: what is measured and given, in which order and units, and when.
fn interface(record: &LawRecord) -> String {
    let (h, delay) = (record.interval, record.delay_intervals);
    let mut out = format!(
        " * Intervals take {h} s. Call feedback_start once, and at the start of each interval feedback_step"
    );
    match delay {
        0 => out.push_str(":\n * it takes what is measured then, and gives the inputs that act until the next one.\n"),
        _ => write!(
            out,
            " with what was\n * measured {delay} intervals before: it gives the inputs that act from now on. feedback_planned gives those of the first {delay}.\n"
        )
        .expect("text takes everything"),
    }
    let list = |title: &str, rows: Vec<String>| {
        let rows = rows.iter().enumerate();
        let rows = rows.map(|(place, row)| format!(" *   [{place}] {}\n", comment(row)));
        format!(" * {title}:\n{}", rows.collect::<String>())
    };
    let of_state = |place: usize| {
        let one = &record.measured[place];
        format!("{} [{}]", one.name, one.unit)
    };
    let measured = match &record.observer {
        None => (0..record.measured.len()).map(of_state).collect(),
        Some(observer) => {
            let readings = observer.readings.iter().map(|reading| match reading {
                ReadingRecord::Measured(place) => of_state(*place),
                ReadingRecord::Marker(name, axis) => {
                    format!("place of {name} along {} [m]", ["x", "y", "z"][*axis])
                }
            });
            readings.collect()
        }
    };
    out.push_str(&list("measured", measured));
    let inputs = record.inputs.iter();
    let inputs = inputs.map(|one| {
        let [low, high] = one.bounds;
        format!("{} [{}], from {low} to {high}", one.name, one.unit)
    });
    out.push_str(&list("inputs", inputs.collect()));
    out + " */\n#include <math.h>\n#include <string.h>\n\n"
}

/// Text that begins and ends no comment.
fn comment(text: &str) -> String {
    let text = text.replace("*/", "* /").replace("/*", "/ *");
    text.replace('\n', " ")
}

fn row(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("{{ {} }}", values.join(", "))
}

fn matrix(rows: &[Vec<f64>]) -> String {
    let rows: Vec<String> = rows.iter().map(|one| row(one)).collect();
    format!("{{ {} }}", rows.join(", "))
}

/// A number as C reads it back to the bit.
fn number(value: f64) -> String {
    match value.is_infinite() {
        true if value < 0.0 => "-HUGE_VAL".to_owned(),
        true => "HUGE_VAL".to_owned(),
        false => format!("{value:?}"),
    }
}
