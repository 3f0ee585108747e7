//! Studies that are refused, and those that are kept.

use crate::runs::run;
use crate::study::{steps, wheel, write};
use proboscis::study::read::read_study;
use serde_json::{Value, json};
use std::fs;

#[test]
fn wrong_studies_are_refused_with_place_found_and_expected() {
    let folder = wheel();
    let path = folder.path();
    let refused = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut study = steps();
        change(&mut study);
        write(path, "study.json", &study);
        let (status, out, err) = run(path, &["study", "study.json"]);
        assert_eq!(status, 2, "{out}{err}");
        assert_eq!(out, "");
        let first = err.lines().next().unwrap();
        for word in words {
            assert!(first.contains(word), "no {word:?} in {first}");
        }
        assert!(!path.join("results").exists(), "{first}");
    };
    let word = |key: &str| format!("study.json: {key}: found ");
    refused(
        &|s| s["methods"] = json!([]),
        &[&word("methods"), "no method", "1 method or more"],
    );
    refused(
        &|s| s["metods"] = json!([]),
        &[&word("metods"), "did you mean \"methods\"?"],
    );
    refused(
        &|s| s["methods"][1]["name"] = json!("angle"),
        &[&word("methods[1].name"), "\"angle\" a second time"],
    );
    refused(
        &|s| s["problem"] = json!("nowhere.json"),
        &[
            &word("problem"),
            "nowhere.json",
            "no file",
            "expected the path of a problem file",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "-1 ms"]),
        &[
            &word("refine.set.simulate.step[2]"),
            "-1",
            "expected a positive size",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "30 ms"]),
        &[
            &word("refine.set.simulate.step"),
            "30 ms",
            "the coarsest point first",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "1 us"]),
        &[&word("refine"), "expected \"sizes\""],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.duration"] = json!(["1 s"]),
        &[
            &word("refine.set.simulate.step"),
            "5 values",
            "expected 1, as many as of \"simulate.duration\"",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms"]),
        &[&word("methods[0]"), "2 points", "expected 3 or more"],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["10 ms", "20 ms", "40 ms"]),
        &[
            &word("refine.set.simulate.step"),
            "10 ms, 20 ms, 40 ms",
            "expected values that fall, the coarsest point first",
        ],
    );
    refused(
        &|s| {
            s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms"]);
            s["reference"] = json!({ "method": "angle" });
        },
        &[&word("reference"), "2 points", "expected 3 or more"],
    );
    refused(
        &|s| {
            let set = json!({ "simulate.step": ["1 ms"] });
            s["reference"] = json!({ "method": "angle", "refine": { "name": "step", "set": set } });
        },
        &[
            &word("reference.refine"),
            "found 1 point,",
            "from which a limit is extrapolated",
        ],
    );
    // A wrong override is told where it stands in the study.
    refused(
        &|s| s["methods"][1]["set"]["simulate.coordinates"] = json!("reducd"),
        &[
            &word("methods[1].set.simulate.coordinates"),
            "\"reducd\"",
            "problem.json",
            "did you mean \"reduced\"?",
        ],
    );
    refused(
        &|s| s["set"] = json!({ "scene.bodies[0].mass": "-1 kg" }),
        &[
            &word("set.scene.bodies[0].mass"),
            "-1 kg",
            "expected a positive value",
        ],
    );
    refused(
        &|s| s["set"] = json!({ "simulate..step": 1 }),
        &[
            &word("set.simulate..step"),
            "expected a place in the problem",
        ],
    );
    refused(
        &|s| s["reference"] = json!({ "method": "angel" }),
        &[
            &word("reference.method"),
            "\"angel\"",
            "did you mean \"angle\"?",
        ],
    );
    refused(
        &|s| s["markers"] = json!(["rin"]),
        &[&word("markers[0]"), "\"rin\"", "did you mean \"rim\"?"],
    );
    refused(
        &|s| s["measures"] = json!(["end", "objective"]),
        &[
            &word("measures[1]"),
            "\"objective\"",
            "a simulation does not have",
            "\"energy_balance\"",
        ],
    );
    refused(
        &|s| s["measures"] = json!([]),
        &[&word("measures"), "1 measure or more"],
    );
    refused(
        &|s| s["runs"] = json!(4),
        &[&word("runs"), "found 4", "5 runs or more"],
    );
    refused(
        &|s| s["methods"][1]["set"]["simulate.duration"] = json!("2 s"),
        &[
            &word("methods[1]"),
            "2 s",
            "expected 1 s, as of the first point",
        ],
    );
    let (status, _, err) = run(path, &["study", "none.json"]);
    assert!(status == 2 && err.contains("no readable file"), "{err}");
    let (status, _, err) = run(path, &["study", "study.json", "--runs", "0"]);
    assert!(status == 2 && err.contains("--runs"), "{err}");
}

#[test]
fn every_kept_study_is_right() {
    let mut count = 0;
    for entry in fs::read_dir("problems/studies").unwrap() {
        let path = entry.unwrap().path();
        let study = read_study(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(
            study.methods.len() > 1 && study.runs >= 5,
            "{}",
            path.display()
        );
        count += 1;
    }
    assert!(count >= 8, "{count} studies");
}
