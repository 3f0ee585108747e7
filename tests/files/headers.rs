//! Units in headers of columns, and the clock of a recording.

use proboscis::control::problem::{Recording, Task};
use proboscis::files::{Loaded, read_problem};
use std::fs;

const SCENE: &str = r#"{
  "name": "cart",
  "bodies": [ { "name": "cart", "mass": "50 g", "position": [0, 0, 0], "box": { "size": [0.02, 0.02, 0.02] } } ],
  "joints": [ { "name": "slide", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart", "at": [0, 0, 0], "stiffness": 12, "damping": 0.1 } ],
  "loads": [ { "name": "pull", "joint": "slide" } ]
}"#;

/// A problem of one recording of a measured quantity in a file of this text, or what is wrong with it.
fn read_as(text: &str, measured: &str, more: &str) -> Result<Loaded, String> {
    let folder = tempfile::tempdir().unwrap();
    let problem = format!(
        r#"{{ "scene": {SCENE}, "identify": {{ "free": {{ "joints.slide.stiffness": {{ "min": 3, "max": 60 }} }},
          "recordings": [ {{ "name": "one", "file": "one.csv", "measured": [ {measured} ]{more} }} ] }} }}"#
    );
    fs::write(folder.path().join("one.csv"), text).unwrap();
    let path = folder.path().join("problem.json");
    fs::write(&path, problem).unwrap();
    read_problem(&path, &[]).map_err(|error| error.to_string())
}

fn read(text: &str, more: &str) -> Result<Loaded, String> {
    read_as(text, r#"{ "joint": "slide", "column": "x" }"#, more)
}

fn of(loaded: Result<Loaded, String>) -> Recording {
    match loaded.unwrap_or_else(|error| panic!("{error}")).task {
        Task::Identify(task) => task.recordings[0].clone(),
        other => panic!("{other:?}"),
    }
}

/// The first reading.
fn first(loaded: Result<Loaded, String>) -> f64 {
    of(loaded).readings().next().expect("a reading").value
}

/// Times in ms and places in mm.
fn readings(text: &str, more: &str) -> Vec<[f64; 2]> {
    let recording = of(read(text, more));
    recording
        .readings()
        .map(|one| [one.time, one.value])
        .collect()
}

fn are_near(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        // A few roundings of decimal fractions.
        assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

const EXPECTED: [[f64; 2]; 3] = [[0.0, 20.0], [10.0, 12.5], [20.0, -3.0]];

fn table([time, place]: [&str; 2]) -> String {
    format!("\"{time}\",\"{place}\"\n0,20\n10,12.5\n20,-3\n")
}

#[test]
fn a_unit_is_read_in_every_usual_form() {
    let forms = [
        "x [mm]", "x(mm)", "x (mm)", "x{mm}", "x <mm>", "x/mm", "x / mm", "x/(mm)", "x_mm",
        "x, mm", "x in mm", "x mm", "x - mm", "x: mm", "x.mm",
    ];
    for header in forms {
        let text = table(["time_ms", header]);
        are_near(&readings(&text, ""), &EXPECTED);
        assert_eq!(read(&text, "").unwrap().notes, [""; 0], "{header}");
    }
    for header in [
        "v [mm/s]",
        "v/(mm/s)",
        "v_mm_s",
        "v_mm_per_s",
        "v mm/s",
        "v_mm/s",
    ] {
        let text = table(["time_ms", header]);
        let found = first(read_as(
            &text,
            r#"{ "joint_rate": "slide", "column": "v" }"#,
            "",
        ));
        // 20 mm/s are 0.02 mm/ms.
        assert!((found - 0.02).abs() < 1e-12, "{header}: {found}");
    }
}

#[test]
fn what_is_no_unit_of_the_quantity_is_refused() {
    let cases = [
        ("x (N)", "a force"),
        ("x/kV", "a voltage"),
        ("x [MM]", "\"MM\" is no known unit"),
        ("x (furlong)", "furlong"),
        ("x/raw", "raw"),
        ("x [mm] filtered", "filtered"),
        ("x [-]", "\"-\" is no known unit"),
    ];
    for (header, told) in cases {
        let error = read(&table(["time_ms", header]), "").unwrap_err();
        for told in [
            told,
            "recordings[0].measured[0].column",
            "a length, as \"x [m]\"",
        ] {
            assert!(error.contains(told), "{told}: {error}");
        }
    }
    let error = read(&table(["time (mm)", "x [mm]"]), "").unwrap_err();
    assert!(error.contains("a time, as \"time [s]\""), "{error}");
}

/// What follows a name is a unit only if it is one of the quantity: an arm that is called A has no ampere.
#[test]
fn a_note_says_which_unit_is_taken_where_there_is_none() {
    for header in ["x", "x_A", "x 2"] {
        let text = table(["time_ms", header]);
        let measured = format!(r#"{{ "joint": "slide", "column": "{header}" }}"#);
        assert_eq!(first(read_as(&text, &measured, "")), 20e3, "{header}");
        let notes = read_as(&text, &measured, "").unwrap().notes;
        assert_eq!(notes.len(), 1, "{notes:?}");
        let told = [format!("{header:?}"), "one.csv".into(), "m is taken".into()];
        told.iter()
            .for_each(|told| assert!(notes[0].contains(told), "{notes:?}"));
    }
}

#[test]
fn a_recording_that_begins_late_is_a_question_with_two_answers() {
    let late = "time [s],x [mm]\n2.74,20\n2.75,12.5\n2.76,-3\n";
    let error = read(late, "").unwrap_err();
    let told = [
        "recordings[0].time",
        "\"time_offset\": \"2.74 s\"",
        "\"time_offset\": 0",
    ];
    told.iter()
        .for_each(|told| assert!(error.contains(told), "{error}"));
    are_near(&readings(late, r#", "time_offset": "2.74 s""#), &EXPECTED);
    let kept = readings(late, r#", "time_offset": 0"#);
    are_near(&kept, &[[2740.0, 20.0], [2750.0, 12.5], [2760.0, -3.0]]);
    let error = read(late, r#", "time_offset": "3 s""#).unwrap_err();
    assert!(
        error.contains("time_offset") && error.contains("no later than"),
        "{error}"
    );
    // The first reading one step after the start, and states of rest, leave nothing open.
    let next = "time [ms],x [mm]\n10,12.5\n20,-3\n";
    are_near(&readings(next, ""), &EXPECTED[1..]);
    let rest = r#", "experiment": { "at_rest": true }"#;
    assert_eq!(readings(late, rest)[0], [2740.0, 20.0]);
}

/// A load from the file of the recording is on its clock, one from elsewhere on its own.
#[test]
fn inputs_of_the_same_file_lose_the_same_time() {
    let text = "time [s],x [mm],f [N]\n2.5,20,1\n2.75,12.5,2\n3,-3,4\n";
    let pull = |csv: &str| {
        format!(
            r#", "time_offset": "2.5 s", "experiment": {{ "loads": {{ "pull": {{ "csv": {{ "file": "one.csv", "values": "f"{csv} }} }} }} }}"#
        )
    };
    let at = |csv: &str, time: f64| of(read(text, &pull(csv))).voltages.at(time)[0];
    assert!((at("", 125.0) - 1.5).abs() < 1e-9 && (at("", 500.0) - 4.0).abs() < 1e-9);
    let own = r#", "time_offset": "2.75 s""#;
    assert!((at(own, 0.0) - 2.0).abs() < 1e-9 && (at(own, 125.0) - 3.0).abs() < 1e-9);
    assert_eq!(at(r#", "time_offset": 0"#, 500.0), 1.0);
}
