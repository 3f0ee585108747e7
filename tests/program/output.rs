//! Output of a motion: all of a short one, the visible instants of a long one, and the selection of its problem.

use crate::runs::{problem, read, run, workshop};
use proboscis::files::npz::NpzWriter;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Header and rows of a table.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().skip(1);
    let header = lines.next().unwrap().split(',').map(str::to_owned);
    let number = |cell: &str| cell.parse().unwrap();
    let rows = lines.map(|line| line.split(',').map(number).collect());
    (header.collect(), rows.collect())
}

/// A naive reader of arrays that are not compressed: what stands between the header of each and the next record.
pub(crate) fn arrays(path: &Path) -> BTreeMap<String, Vec<f64>> {
    let bytes = fs::read(path).unwrap();
    let at = |place: usize, length: usize| {
        let bytes = bytes[place..place + length].iter().rev();
        bytes.fold(0_usize, |number, &byte| number << 8 | usize::from(byte))
    };
    let mut all = BTreeMap::new();
    let mut place = 0;
    while bytes[place..].starts_with(b"PK\x03\x04") {
        let (size, name, extra) = (at(place + 18, 4), at(place + 26, 2), at(place + 28, 2));
        let begin = place + 30 + name + extra;
        let name = String::from_utf8(bytes[place + 30..place + 30 + name].to_vec()).unwrap();
        let numbers = begin + 10 + at(begin + 8, 2);
        let values = bytes[numbers..begin + size].chunks_exact(8);
        let values = values.map(|b| f64::from_le_bytes(b.try_into().unwrap()));
        all.insert(name.trim_end_matches(".npy").to_owned(), values.collect());
        place = begin + size;
    }
    all
}

const LONG: &str = "simulate.duration=9 s";
const STEP: &str = "simulate.step=2 ms";

#[test]
fn a_long_motion_is_sampled_and_all_of_it_is_kept() {
    let folder = workshop();
    let folder = folder.path();
    let constant = problem("elephant_trunk_constant");
    let arguments = [
        "simulate", &constant, "--set", LONG, "--set", STEP, "-o", "long",
    ];
    let (status, said, notes) = run(folder, &arguments);
    assert_eq!(status, 0, "{said}{notes}");
    assert!(
        notes.contains("tables.npz and the solution have all"),
        "{notes}"
    );
    let at = |name: &str| folder.join("long").join(name);
    let (header, rows) = table(&at("trajectory.csv"));
    assert!((2251..4500).contains(&rows.len()), "{} rows", rows.len());
    let summary = read(at("summary.json"));
    assert_eq!(summary["shown"]["instants"], rows.len());
    assert_eq!(summary["shown"]["of"], 4_501);
    // Each row is one of the complete table, the last one the last.
    let all = arrays(&at("tables.npz"));
    let full: Vec<&Vec<f64>> = header
        .iter()
        .map(|h| &all[&format!("trajectory/{h}")])
        .collect();
    assert_eq!(full[0].len(), 4_501);
    let instant = |row: &Vec<f64>| full[0].binary_search_by(|t| t.total_cmp(&row[0])).unwrap();
    for row in &rows {
        let instant = instant(row);
        let expected: Vec<f64> = full.iter().map(|column| column[instant]).collect();
        assert_eq!(*row, expected);
    }
    // The motion begins with a fast oscillation, of which more is shown.
    let within = |from: f64, to: f64| rows.iter().filter(|r| (from..to).contains(&r[0])).count();
    assert!(within(0.0, 100.0) > within(8.9e3, 9e3));
    // Between rows a straight line is not seen to differ.
    let tip = header.iter().position(|h| h == "tip_x [mm]").unwrap();
    let joint = header.iter().position(|h| h == "joint6 [rad]").unwrap();
    for column in [tip, joint] {
        let values = full[column].iter();
        let (low, high) = values.fold((0.0_f64, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!(high - low > 0.1, "{low} to {high}");
        for ends in rows.windows(2) {
            let (from, to) = (instant(&ends[0]), instant(&ends[1]));
            let [first, last] = [&ends[0], &ends[1]].map(|row| row[column]);
            for (i, value) in full[column][from..to].iter().enumerate() {
                let part = i as f64 / (to - from) as f64;
                let line = first * (1.0 - part) + last * part;
                let apart = (line - value).abs();
                assert!(apart <= 0.0021 * (high - low), "instant {}", from + i);
            }
        }
    }
    let (_, controls) = table(&at("controls.csv"));
    assert_eq!(controls.len(), rows.len() - 1);
    assert!(controls.iter().all(|row| row[2] == 1700.0));

    // The solution has its arrays beside it, and is read with them: the same voltages move it the same way.
    let solution = read(at("solution.json"));
    assert_eq!(solution["arrays"]["file"], "solution.npz");
    assert!(solution.get("time").is_none());
    let kept = arrays(&at("solution.npz"));
    assert_eq!(kept["time"].len(), 4_501);
    assert_eq!(
        kept["configuration/bodies/segment1/directors"].len(),
        9 * 4_501
    );
    assert_eq!(kept["voltages/muscle1"], vec![1700.0; 4_500]);
    let again = "simulate.voltages={\"solution\":\"long/solution.json\"}";
    let short = [
        "--set",
        "simulate.duration=0.1 s",
        "--set",
        STEP,
        "--set",
        again,
    ];
    let (status, said, notes) = run(
        folder,
        &[&["simulate", &constant, "-o", "again"][..], &short].concat(),
    );
    assert_eq!(status, 0, "{said}{notes}");
    let again = read(folder.join("again/solution.json"));
    let z = again["state"]["z"].as_array().unwrap();
    assert_eq!(z.len(), 51);
    for (k, row) in z.iter().enumerate() {
        let row: Vec<f64> = row
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect();
        assert_eq!(row, kept["state/z"][6 * k..6 * k + 6], "instant {k}");
    }
    assert!(!folder.join("again/tables.npz").exists());

    // Arrays of another run are not taken for those of this one.
    let mut other = NpzWriter::default();
    other.list("time", &[0.0, 1.0]);
    let (other, _) = other.finish().unwrap();
    fs::write(at("solution.npz"), &other).unwrap();
    let (status, _, error) = run(
        folder,
        &[&["simulate", &constant, "-o", "third"][..], &short].concat(),
    );
    assert_eq!(status, 2, "{error}");
    assert!(error.contains("long/solution.json: arrays"), "{error}");

    // A shorter run of the same folder leaves no arrays of the longer one.
    let (status, ..) = run(
        folder,
        &[
            "simulate",
            &constant,
            "--set",
            "simulate.duration=0.1 s",
            "-o",
            "long",
        ],
    );
    assert_eq!(status, 0);
    assert!(!at("solution.npz").exists() && !at("tables.npz").exists());
    assert_eq!(table(&at("trajectory.csv")).1.len(), 21);
}

#[test]
fn the_output_that_is_asked_for_is_written() {
    let folder = workshop();
    let folder = folder.path();
    let constant = problem("elephant_trunk_constant");
    let output = r#"output={"every":"20 ms","quantities":["tip","energies","joint1"]}"#;
    let voltage = r#"simulate.voltages={"muscle1":{"ramp":{"to":"1.7 kV","duration":"0.2 s"}}}"#;
    let shared = [
        "simulate",
        &constant,
        "--set",
        "simulate.duration=0.3 s",
        "--set",
        voltage,
    ];
    for (name, with) in [("all", &[][..]), ("some", &["--set", output])] {
        let (status, said, notes) = run(folder, &[&shared[..], with, &["-o", name]].concat());
        assert_eq!(status, 0, "{said}{notes}");
        assert!(!folder.join(name).join("tables.npz").exists());
    }
    let (all_header, all) = table(&folder.join("all/trajectory.csv"));
    let (header, rows) = table(&folder.join("some/trajectory.csv"));
    assert_eq!((all.len(), rows.len()), (61, 16));
    let has = |name: &str| header.iter().any(|h| h.starts_with(name));
    assert!(
        [
            "time",
            "tip_z",
            "joint1",
            "kinetic_energy",
            "electrical_energy"
        ]
        .into_iter()
        .all(has)
    );
    assert!(
        !["joint2", "muscle1_stretch", "muscle1_charge", "linear"]
            .into_iter()
            .any(has)
    );
    for (i, row) in rows.iter().enumerate() {
        for (name, value) in header.iter().zip(row) {
            let column = all_header.iter().position(|h| h == name).unwrap();
            assert_eq!(*value, all[4 * i][column], "{name} in row {i}");
        }
    }
    // Voltages are means of the intervals between.
    let [every, sampled] = ["all", "some"].map(|n| table(&folder.join(n).join("controls.csv")).1);
    assert_eq!((every.len(), sampled.len()), (60, 15));
    assert!(sampled[3][2] > sampled[2][2] + 100.0);
    for (i, row) in sampled.iter().enumerate() {
        let mean = every[4 * i..4 * i + 4]
            .iter()
            .map(|row| row[2])
            .sum::<f64>()
            / 4.0;
        assert!((row[2] - mean).abs() < 1e-9 * mean, "row {i}");
        assert_eq!([row[0], row[1]], [every[4 * i][0], every[4 * i + 3][1]]);
    }
    // The solution keeps all.
    let kept = read(folder.join("some/solution.json"));
    assert_eq!(
        kept["state"],
        read(folder.join("all/solution.json"))["state"]
    );
    let summary: Value = read(folder.join("some/summary.json"));
    assert_eq!(summary["shown"]["instants"], 16);
}

#[test]
fn an_output_that_makes_no_sense_is_refused_with_its_place() {
    let folder = workshop();
    let constant = problem("elephant_trunk_constant");
    for (output, place) in [
        (r#"{"every":"0 ms"}"#, "output.every"),
        (r#"{"every":"2 mm"}"#, "output.every"),
        (r#"{"quantities":[]}"#, "output.quantities"),
        (r#"{"quantities":["tip","tipp"]}"#, "output.quantities[1]"),
        (r#"{"evry":1}"#, "output.evry"),
    ] {
        let set = format!("output={output}");
        let (status, _, error) = run(folder.path(), &["simulate", &constant, "--set", &set]);
        assert_eq!(status, 2, "{output}: {error}");
        assert!(error.contains(place), "{output}: {error}");
    }
    let rest = [
        "equilibrium",
        &problem("bending_actuator"),
        "--set",
        "output={}",
    ];
    let (status, _, error) = run(folder.path(), &rest);
    assert!(
        status == 2 && error.contains("which has no times"),
        "{error}"
    );
    assert!(!folder.path().join("results").exists());
}
