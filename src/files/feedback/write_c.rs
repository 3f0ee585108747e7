//! The law of a controller as a C file without dependencies: tables, and a function that a driver board calls once an interval.

use crate::feedback::Law;
use crate::files::feedback::record::{LawRecord, PointRecord};
use crate::files::feedback::write::record;
use crate::model::System;
use std::fmt::Write;

/// Code behind the tables.
const CODE: &str = include_str!("controller.c");

/// The text of `feedback.c`; `head` says where it is from.
pub fn law_c(law: &Law, system: &System, head: &str) -> String {
    let record = record(law, system);
    let points = || record.intervals.iter().chain(&record.held);
    let mut out = format!("/* {}\n *\n", comment(head));
    out.push_str(&interface(&record));
    let (states, inputs) = (record.measured.len(), record.inputs.len());
    let integrals = record.integrals.len();
    let sizes = [
        ("POINTS", points().count()),
        ("STATES", states),
        ("INPUTS", inputs),
        ("INTEGRALS", integrals),
        ("DELAY", record.delay_intervals),
    ];
    for (name, size) in sizes {
        writeln!(out, "#define FEEDBACK_{name} {size}").expect("text takes everything");
    }
    out.push_str("#define FEEDBACK_READ (FEEDBACK_STATES + FEEDBACK_INTEGRALS + FEEDBACK_DELAY * FEEDBACK_INPUTS)\n\n");
    let mut table = |declaration: &str, rows: Vec<String>| {
        let rows = rows.join(",\n  ");
        writeln!(out, "static const {declaration} = {{\n  {rows}\n}};\n")
            .expect("text takes everything");
    };
    let interval = vec![number(record.interval)];
    table("double feedback_interval[1]", interval);
    // C has no empty arrays.
    let places = record.integrals.iter().copied().chain([0]);
    let places = places.map(|place| place.to_string());
    table(
        "int feedback_integrated[FEEDBACK_INTEGRALS + 1]",
        places.collect(),
    );
    let squared = record.inputs.iter().map(|one| u8::from(one.is_squared));
    let squared = squared.map(|is_squared| is_squared.to_string());
    table("int feedback_squared[FEEDBACK_INPUTS]", squared.collect());
    let bounds = record.inputs.iter().map(|one| row(&one.bounds));
    table(
        "double feedback_bounds[FEEDBACK_INPUTS][2]",
        bounds.collect(),
    );
    let of = |list: fn(&PointRecord) -> &Vec<f64>| points().map(|p| row(list(p))).collect();
    let states = of(|point| &point.state);
    table(
        "double feedback_state[FEEDBACK_POINTS][FEEDBACK_STATES]",
        states,
    );
    let given = of(|point| &point.inputs);
    table(
        "double feedback_given[FEEDBACK_POINTS][FEEDBACK_INPUTS]",
        given,
    );
    let gain = |point: &PointRecord| {
        let rows: Vec<String> = point.gain.iter().map(|one| row(one)).collect();
        format!("{{ {} }}", rows.join(", "))
    };
    table(
        "double feedback_gain[FEEDBACK_POINTS][FEEDBACK_INPUTS][FEEDBACK_READ]",
        points().map(gain).collect(),
    );
    if record.delay_intervals > 0 {
        let none = vec![0.0; inputs];
        let offset = |point: &PointRecord| match point.offset.is_empty() {
            true => row(&none),
            false => row(&point.offset),
        };
        table(
            "double feedback_offset[FEEDBACK_POINTS][FEEDBACK_INPUTS]",
            points().map(offset).collect(),
        );
    }
    out + CODE
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
    let measured = record.measured.iter();
    let measured = measured.map(|one| format!("{} [{}]", one.name, one.unit));
    out.push_str(&list("measured", measured.collect()));
    let inputs = record.inputs.iter();
    let inputs = inputs.map(|one| {
        let [low, high] = one.bounds;
        format!("{} [{}], from {low} to {high}", one.name, one.unit)
    });
    out.push_str(&list("inputs", inputs.collect()));
    out + " */\n#include <math.h>\n#include <string.h>\n\n"
}

/// Text that ends no comment.
fn comment(text: &str) -> String {
    text.replace("*/", "* /").replace('\n', " ")
}

fn row(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("{{ {} }}", values.join(", "))
}

/// A number as C reads it back to the bit.
fn number(value: f64) -> String {
    match value.is_infinite() {
        true if value < 0.0 => "-HUGE_VAL".to_owned(),
        true => "HUGE_VAL".to_owned(),
        false => format!("{value:?}"),
    }
}
