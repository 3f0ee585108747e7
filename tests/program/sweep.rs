//! Many variants of a problem: which they are, that each is solved once, and what is told of them.

use crate::runs::{read, run, workshop};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Writes a sweep of the kept pair, with few intervals.
fn write(folder: &Path, entries: Value) {
    let mut sweep = json!({ "problem": "problems/pair.json", "set": { "control.intervals": 8 } });
    for (key, value) in entries.as_object().unwrap() {
        sweep[key] = value.clone();
    }
    fs::write(folder.join("sweep.json"), sweep.to_string()).unwrap();
}

/// Headings and rows of the table.
fn table(folder: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let path = folder.join("results/sweeps/sweep/sweep.csv");
    let reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(path);
    let mut reader = reader.unwrap();
    let row = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let head = row(reader.headers().unwrap());
    (
        head,
        reader.records().map(|one| row(&one.unwrap())).collect(),
    )
}

fn column(table: &(Vec<String>, Vec<Vec<String>>), name: &str) -> Vec<String> {
    let at = table.0.iter().position(|head| head == name);
    let at = at.unwrap_or_else(|| panic!("no {name} in {:?}", table.0));
    table.1.iter().map(|row| row[at].clone()).collect()
}

/// Times at which the summaries of the variants were written.
fn written(folder: &Path) -> Vec<std::time::SystemTime> {
    let variants = folder.join("results/sweeps/sweep/variants");
    let folders: BTreeSet<_> = fs::read_dir(variants)
        .unwrap()
        .map(|one| one.unwrap().path())
        .collect();
    let times = folders
        .iter()
        .map(|one| fs::metadata(one.join("summary.json")).unwrap().modified());
    times.map(Result::unwrap).collect()
}

const MODULUS: &str = "scene.materials.silicone.shear_modulus";
const PERMITTIVITY: &str = "scene.materials.silicone.relative_permittivity";

#[test]
fn each_variant_is_solved_once_and_as_if_alone() {
    let folder = workshop();
    let folder = folder.path();
    write(
        folder,
        json!({ "vary": {
        MODULUS: { "from": "80 kPa", "to": "125 kPa", "count": 3, "spacing": "logarithmic" },
        PERMITTIVITY: [3, 4, 3] } }),
    );
    let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
    assert!(
        status == 0 && out.contains("9 variants: 9 solved"),
        "{out}{err}"
    );
    let first = table(folder);
    assert_eq!(
        column(&first, PERMITTIVITY),
        ["3", "3", "3", "4", "4", "4", "3", "3", "3"]
    );
    assert_eq!(
        &column(&first, &format!("{MODULUS} [Pa]"))[2..5],
        ["125000.0", "80000.0", "100000.0"]
    );
    let ends = column(&first, "end: joint1 [rad]");
    assert!(ends.iter().all(|end| end.parse::<f64>().unwrap() != 0.0));
    // Equal variants are one, and all others differ.
    let names: BTreeSet<String> = column(&first, "variant").into_iter().collect();
    assert_eq!(names.len(), 6);
    let times = written(folder);
    assert_eq!(times.len(), 6);

    let alone = [
        "solve",
        "problems/pair.json",
        "--set",
        "control.intervals=8",
        "--set",
        "scene.materials.silicone.shear_modulus=100 kPa",
        "--set",
        "scene.materials.silicone.relative_permittivity=4",
        "-o",
        "alone",
    ];
    assert_eq!(run(folder, &alone).0, 0);
    let variant = &first.1[4][0];
    let [swept, alone] = [
        format!("results/sweeps/sweep/variants/{variant}"),
        "alone".to_owned(),
    ]
    .map(|path| fs::read(folder.join(path).join("solution.json")).unwrap());
    assert!(swept == alone);

    // Nothing is done twice; what is new is added.
    write(
        folder,
        json!({ "vary": { MODULUS: ["80 kPa", "90 kPa", "100 kPa"], PERMITTIVITY: [4] } }),
    );
    let (status, out, _) = run(folder, &["sweep", "sweep.json"]);
    assert!(
        status == 0 && out.contains("3 variants: 3 solved, 2 found solved before"),
        "{out}"
    );
    let after = written(folder);
    assert_eq!(after.len(), 7);
    assert_eq!(times.iter().filter(|time| after.contains(time)).count(), 6);

    let page = fs::read_to_string(folder.join("results/sweeps/sweep/report.html")).unwrap();
    assert!(page.contains("3 of 3 variants") && page.contains("90000.0") && !page.contains("src="));
}

#[test]
fn machines_share_a_sweep() {
    let folder = workshop();
    let folder = folder.path();
    write(
        folder,
        json!({ "vary": { PERMITTIVITY: { "from": 2, "to": 4 } },
        "combine": { "random": { "count": 5, "seed": 3 } } }),
    );
    let (status, out, _) = run(
        folder,
        &[
            "sweep",
            "sweep.json",
            "--shard",
            "2/2",
            "--engine",
            "processes",
        ],
    );
    assert!(
        status == 0 && out.contains("3 not_started, 2 solved"),
        "{out}"
    );
    // What was killed in the middle has no end, and is solved again.
    let one = &column(&table(folder), "variant")[1];
    let end = folder
        .join("results/sweeps/sweep/variants")
        .join(one)
        .join("record.json");
    assert_eq!(read(&end)["is_solved"], true);
    fs::remove_file(end).unwrap();
    let (status, out, _) = run(folder, &["sweep", "sweep.json"]);
    assert!(status == 0 && out.contains("5 solved, 1 found"), "{out}");
    let values: BTreeSet<String> = column(&table(folder), PERMITTIVITY).into_iter().collect();
    let numbers: Vec<f64> = values.iter().map(|text| text.parse().unwrap()).collect();
    assert!(numbers.len() == 5 && numbers.iter().all(|v| (2.0..4.0).contains(v)));
}

#[test]
fn what_is_not_whole_is_solved_again() {
    let folder = workshop();
    let folder = folder.path();
    write(folder, json!({ "vary": { PERMITTIVITY: [3] } }));
    assert_eq!(run(folder, &["sweep", "sweep.json"]).0, 0);
    let name = column(&table(folder), "variant")[0].clone();
    let variant = folder.join("results/sweeps/sweep/variants").join(&name);
    let whole = fs::read(variant.join("trajectory.csv")).unwrap();
    let solved_again = |words: &str| {
        let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
        assert!(status == 0 && !out.contains("found"), "{words}: {out}{err}");
        assert!(err.contains(&name) && err.contains(words), "{words}: {err}");
        assert!(fs::read(variant.join("trajectory.csv")).unwrap() == whole);
        let (_, out, err) = run(folder, &["sweep", "sweep.json"]);
        assert!(out.contains("1 found solved before"), "{out}{err}");
    };
    for file in [
        "solution.json",
        "summary.json",
        "configuration.svg",
        "report.html",
    ] {
        fs::remove_file(variant.join(file)).unwrap();
        solved_again(&format!("{file} is missing"));
    }
    let long = whole.len();
    fs::write(variant.join("trajectory.csv"), &whole[..long / 2]).unwrap();
    solved_again(&format!("{} of {long} bytes", long / 2));
    let mut changed = whole.clone();
    *changed.last_mut().unwrap() = b' ';
    fs::write(variant.join("trajectory.csv"), &changed).unwrap();
    solved_again("trajectory.csv has been changed");
    fs::write(variant.join("record.json"), "{\"set\": [").unwrap();
    solved_again("record.json is not as it was written");
}

#[test]
fn what_is_written_of_a_motion_is_a_part_of_a_variant() {
    let folder = workshop();
    let folder = folder.path();
    write(
        folder,
        json!({ "vary": { "output.quantities": [["joints"], ["markers"]] } }),
    );
    let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
    assert!(
        status == 0 && out.contains("2 variants: 2 solved"),
        "{out}{err}"
    );
    let table = table(folder);
    let names: BTreeSet<String> = column(&table, "variant").into_iter().collect();
    assert_eq!(names.len(), 2);
    let ends = column(&table, "end: joint1 [rad]");
    assert!(!ends[0].is_empty() && ends[1].is_empty(), "{ends:?}");
}

#[test]
fn a_variant_knows_the_solution_that_it_starts_from() {
    let folder = workshop();
    let folder = folder.path();
    let solve = |intervals: &str| {
        let set = format!("control.intervals={intervals}");
        let words = ["solve", "problems/pair.json", "-o", "guess", "--set", &set];
        assert_eq!(run(folder, &words).0, 0);
    };
    solve("6");
    write(
        folder,
        json!({ "vary": { PERMITTIVITY: [3] }, "set": { "control.intervals": 8,
            "control.guess": { "solution": "../guess/solution.json" } } }),
    );
    let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
    assert!(status == 0, "{out}{err}");
    let (_, out, _) = run(folder, &["sweep", "sweep.json"]);
    assert!(out.contains("1 found"), "{out}");
    solve("5");
    let (_, out, _) = run(folder, &["sweep", "sweep.json"]);
    assert!(out.contains("1 solved") && !out.contains("found"), "{out}");
}

#[test]
fn refused_and_unsolved_variants_are_rows() {
    let folder = workshop();
    let folder = folder.path();
    fs::write(
        folder.join("lines.csv"),
        "control.duration,control.solver.max_iterations\n300 ms,100\n,100\n0.3 s,2\n",
    )
    .unwrap();
    write(folder, json!({ "table": "lines.csv" }));
    let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
    assert!(
        status == 0 && err.contains("control.duration"),
        "{out}{err}"
    );
    let rows = table(folder);
    let words = column(&rows, "status");
    assert_eq!(words, ["solved", "refused", "iteration_limit"]);
    let durations = column(&rows, "control.duration [s]");
    assert_eq!(durations, ["0.3", "", "0.3"]);
}

#[test]
fn mistakes_of_a_sweep_have_their_places() {
    let folder = workshop();
    let folder = folder.path();
    let range = |range: Value| json!({ "vary": { "control.duration": range } });
    let cases = [
        (json!({}), "vary"),
        (range(json!([])), "vary.control.duration"),
        (range(json!({ "from": "1 s", "to": "2 s" })), "count"),
        (
            range(json!({ "from": "1 s", "to": "2 ms", "count": 3 })),
            "to",
        ),
        (
            range(json!({ "from": 0, "to": 1, "count": 3, "spacing": "logarithmic" })),
            "above zero",
        ),
        (
            range(json!({ "from": 0, "to": 1, "count": 1 })),
            "from 2 to",
        ),
        (
            json!({ "vary": { "control.durations": ["1 s"] } }),
            "durations",
        ),
        (
            json!({ "vary": { "control.duration": ["1 s"], "control.intervals": [5, 6] }, "combine": "together" }),
            "1, as in the first list",
        ),
        (
            json!({ "vary": { "control.duration": ["1 s"] }, "combine": { "random": { "count": 0 } } }),
            "0 variants",
        ),
        (
            json!({ "set": { "control.duration": "2 s" }, "vary": { "control.duration": ["1 s"] } }),
            "one value",
        ),
        (
            json!({ "problem": "problems/elbow_torque.json", "vary": { "scene.muscles[0].layer_thickness": ["50 um"], "scene.muscles.left.layer_thickness": ["60 um", "70 um"] } }),
            "expected one value",
        ),
        (
            json!({ "problem": "problems/elbow_torque.json", "vary": { "scene.muscles.right.layer_thickness": ["50 um"] }, "set": { "scene.muscles[1].layer_thickness": "60 um" } }),
            "expected one value",
        ),
        (json!({ "table": "none.csv" }), "none.csv"),
        (
            json!({ "table": "none.csv", "vary": { "control.duration": ["1 s"] } }),
            "either",
        ),
        (
            json!({ "problem": "none.json", "vary": { "control.duration": ["1 s"] } }),
            "none.json",
        ),
    ];
    for (entries, words) in cases {
        write(folder, entries.clone());
        let (status, out, err) = run(folder, &["sweep", "sweep.json"]);
        assert!(
            status == 2 && err.contains(words) && err.contains("sweep.json"),
            "{entries}: {out}{err}"
        );
        assert!(!folder.join("results").exists());
    }
    let (status, _, err) = run(folder, &["sweep", "sweep.json", "--shard", "3/2"]);
    assert!(status == 2 && err.contains("i/n"), "{err}");
}
