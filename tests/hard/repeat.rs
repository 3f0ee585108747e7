//! Nothing at all, and the same twice.

use crate::page::{Case, Verdict};
use crate::program::{Run, largest, points, run, run_with};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::Series;
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

#[test]
fn no_gravity_no_mass_no_voltage() {
    let plain = trunk(3, silicone());
    let task = simulate("0.5 s", "5 ms", json!({ "muscle2": "1.7 kV" }));
    let columns = |run: &Run| -> Vec<Vec<f64>> {
        (1..=3).map(|j| run.column(&format!("joint{j}"))).collect()
    };
    let moved = run(&plain, &task).solved();
    let expected = columns(&moved);
    assert!(largest(&expected[0]) > 0.1);
    // Zeros that are written are as good as nothing, bit for bit.
    let mut weightless = plain.clone();
    weightless["gravity"] = json!([0, 0, 0]);
    assert_eq!(columns(&run(&weightless, &task).solved()), expected);
    let mut massless = trunk(3, silicone_with(json!({ "density": null })));
    let light = columns(&run(&massless, &task).solved());
    massless["materials"]["silicone"]["density"] = json!("0 kg/m^3");
    assert_eq!(columns(&run(&massless, &task).solved()), light);
    assert_ne!(light, expected);
    let zero = simulate("0.5 s", "5 ms", json!({ "muscle2": "0 V" }));
    for scene in [&plain, &weightless, &massless] {
        // Straight, at rest and without voltage nothing moves, not even by rounding.
        let still = run(scene, &zero).solved();
        assert!(columns(&still).iter().flatten().all(|&angle| angle == 0.0));
        assert!(
            still
                .column("total_energy")
                .iter()
                .all(|&e| e.abs() < 1e-12)
        );
        let rest = run(scene, &equilibrium(json!({}))).solved();
        assert!((1..=3).all(|j| rest.summary["joints"][format!("joint{j}")] == 0.0));
        assert_eq!(rest.summary["is_stable"], true);
        let stay = run(
            scene,
            &control("0.2 s", 20, json!({ "rest_at_voltages": {} })),
        )
        .solved();
        assert!(stay.number(&["objective"]) < 1e-6);
        assert!(largest(&stay.column("joint1")) < 1e-5);
    }
    let times = moved.column("time");
    Case {
        name: "nothing-at-all",
        title: "No gravity, no mass, no voltage",
        law: "A gravity or density that is written as zero leaves the same bits as none. Without voltage the straight trunk does not move, not \
              even by rounding, rests stably, and to stay costs nothing.",
        verdict: Verdict::Answer,
        seen: vec![
            "gravity of zero and none: the same bits; density of zero and none: the same bits".to_owned(),
            "all angles 0.0 at all instants without voltage".to_owned(),
        ],
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint1 [rad]", Extent::Padded),
        curves: vec![
            Series::curve("muscles with mass", points(&times, &expected[0]), hue(0)),
            Series::curve("muscles without mass", points(&times, &light[0]), hue(1)).dashed(Dash::Dashed),
            Series::curve("no voltage", points(&times, &vec![0.0; times.len()]), hue(2)),
        ],
    }
    .record();
}

/// All files of a folder but the page, with what differs from run to run by nature taken out: times spent.
fn files(folder: &Path) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            for (inner, text) in files(&path) {
                out.insert(format!("{name}/{inner}"), text);
            }
            continue;
        }
        // It has seconds too.
        if name == "continuation.npz" {
            continue;
        }
        if name.ends_with(".npz") {
            out.insert(name, format!("{:?}", fs::read(&path).unwrap()));
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let text = match name.as_str() {
            "report.html" => continue,
            "summary.json" => timeless(serde_json::from_str(&text).unwrap()).to_string(),
            _ => text,
        };
        out.insert(name, text);
    }
    out
}

/// A summary without seconds.
fn timeless(value: Value) -> Value {
    match value {
        Value::Object(entries) => entries
            .into_iter()
            .filter(|(key, _)| !key.contains("seconds"))
            .map(|(key, entry)| (key, timeless(entry)))
            .collect(),
        Value::Array(list) => list.into_iter().map(timeless).collect(),
        other => other,
    }
}

#[test]
fn the_same_run_twice_leaves_the_same_bits() {
    let block = silicone_with(json!({ "dielectric": "ideal" }));
    let cases = [
        (
            "simulation of the trunk",
            trunk(6, silicone()),
            simulate("0.5 s", "5 ms", json!({ "muscle2": "1.7 kV" })),
        ),
        (
            "optimal control",
            trunk(2, silicone()),
            control("0.4 s", 64, bent()),
        ),
        (
            "equilibrium",
            trunk(6, silicone()),
            equilibrium(json!({ "muscle2": "1.7 kV", "muscle3": "1.6 kV" })),
        ),
        (
            "simulation of a block",
            cube(block, "hex8_q1p0", 2),
            simulate("4 ms", "0.5 ms", json!({ "cube.top": "300 kV" })),
        ),
    ];
    let mut seen = Vec::new();
    for (name, scene, task) in &cases {
        let first = run(scene, task).solved();
        let expected = files(&first.results());
        assert!(expected.len() > 1 && expected.contains_key("summary.json"));
        for threads in ["1", "2", "2"] {
            let again = run_with(scene, task, &[], &[("RAYON_NUM_THREADS", threads)]).solved();
            let found = files(&again.results());
            assert_eq!(
                found.keys().collect::<Vec<_>>(),
                expected.keys().collect::<Vec<_>>()
            );
            for (file, text) in &expected {
                assert!(
                    found[file] == *text,
                    "{name}: {file} differs on {threads} threads"
                );
            }
        }
        let bytes: usize = expected.values().map(String::len).sum();
        seen.push(format!(
            "{name}: {} files of {bytes} bytes, four times the same",
            expected.len()
        ));
    }
    Case {
        name: "same-run-twice",
        title: "The same run four times, on one thread and on two",
        law: "All files of a run but for the seconds in summary.json and the page that shows them have the same bits each time and on any number of threads.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("run", Extent::Padded),
        y: Axis::linear("files with the same bits", Extent::FromZero),
        curves: Vec::new(),
    }
    .record();
}
