//! A closed loop with parts of its disturbance: each is a simulation of its own.

use crate::commands::summary;
use crate::feedback::number;
use crate::runs::{refused, run, workshop};
use proboscis::report::page::compared::data;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const PROBLEM: &str = "problems/pair_disturbed.json";
const STIFFER: &str = "scene.materials.silicone.shear_modulus=\"120 kPa\"";

fn simulated(here: &Path, to: &str, set: &[&str]) -> Value {
    let mut arguments = vec!["simulate", PROBLEM, "-o", to];
    set.iter().for_each(|set| arguments.extend(["--set", set]));
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    summary(here, to)["closed_loop"].clone()
}

/// Start and stiffness between those without a disturbance and those of the problem: the same numbers as of problems that have these values.
#[test]
fn parts_of_a_disturbance_are_simulations_of_their_own() {
    let folder = workshop();
    let here = folder.path();
    let disturbance = json!({
        "without": {
            "simulate.start.joint_angles.joint1": 0,
            "scene.materials.silicone.shear_modulus": "100 kPa",
        },
        "sizes": [0, 0.25, 1, 1.5],
    });
    let disturbance = format!("simulate.controller.disturbance={disturbance}");
    let whole = simulated(here, "parts", &[&disturbance, STIFFER]);
    let parts = whole["disturbance"].as_array().unwrap();
    let alone = |angle: &str, modulus: &str| {
        let none = "simulate.controller.disturbance=null";
        let angle = format!("simulate.start.joint_angles.joint1=\"{angle}\"");
        let modulus = format!("scene.materials.silicone.shear_modulus=\"{modulus}\"");
        let of = simulated(here, "alone", &[none, &angle, &modulus]);
        assert!(of.get("disturbance").is_none());
        of["markers"].clone()
    };
    let expected = [
        (0.0, alone("0 deg", "100 kPa")),
        (0.25, alone("1.25 deg", "105 kPa")),
        (1.0, alone("5 deg", "120 kPa")),
        (1.5, alone("7.5 deg", "130 kPa")),
    ];
    assert_eq!(parts.len(), expected.len());
    let mut greatest = Vec::new();
    for (part, (size, markers)) in parts.iter().zip(&expected) {
        assert_eq!(number(&part["size"]), *size);
        assert_eq!(&part["markers"], markers, "{size}");
        greatest.push(number(&markers["tip"]["open_loop"]["last"]));
    }
    assert_eq!(whole["markers"], expected[2].1);
    let grows = greatest.windows(2).all(|two| two[1] > two[0] + 1e-4);
    assert!(greatest[0] < 1e-6 && grows, "{greatest:?}");
    shown(&here.join("parts/report.html"));
}

/// The page has curves of each size with and without feedback, and one reference, in three planes and over time.
fn shown(page: &Path) {
    let data = data(&fs::read_to_string(page).unwrap()).unwrap();
    let mut charts = data["charts"].as_array().unwrap().iter();
    let chart = charts.find(|chart| chart["kind"] == "sizes").unwrap();
    assert_eq!(chart["sizes"], json!([0.0, 0.25, 1.0, 1.5]));
    assert_eq!(chart["shown"], 2);
    let panels = chart["panels"].as_array().unwrap();
    assert_eq!(panels.len(), 4);
    for (i, panel) in panels.iter().enumerate() {
        let series = panel["series"].as_array().unwrap();
        let of = |name: &str| -> Vec<&Value> {
            series.iter().filter(|one| one["name"] == name).collect()
        };
        let [with, without, reference] = ["with feedback", "without feedback", "reference"].map(of);
        for list in [&with, &without] {
            let sizes: Vec<u64> = list
                .iter()
                .map(|one| one["size"].as_u64().unwrap())
                .collect();
            assert_eq!(sizes, [0, 1, 2, 3]);
            assert!(
                list.windows(2)
                    .all(|two| two[0]["points"] != two[1]["points"])
            );
        }
        assert_eq!(reference.len(), usize::from(i < 3));
        assert!(reference.iter().all(|one| one["size"].is_null()));
    }
}

/// Without a key there is neither chart nor number; a robot without markers shows its joints.
#[test]
fn disturbances_are_shown_where_they_are_asked_for() {
    let folder = workshop();
    let here = folder.path();
    let bare = "scene.chain.tip_marker=null";
    let closed = simulated(
        here,
        "bare",
        &[bare, "simulate.controller.disturbance.sizes=[0,1]"],
    );
    let joints = [0, 1].map(|i| &closed["disturbance"][i]["joints"]["joint1"]["feedback"]);
    let [none, whole] = joints.map(|of| number(&of["greatest"]));
    // Between instants of the law the reference is a line.
    assert!(
        none < 0.1 * whole && (whole - 5_f64.to_radians()).abs() < 1e-9,
        "{none} {whole}"
    );
    let page = |to: &str| fs::read_to_string(here.join(to).join("report.html")).unwrap();
    let kinds = |to: &str| -> Vec<Value> {
        let data = data(&page(to)).unwrap();
        let charts = data["charts"].as_array().unwrap().iter();
        charts.map(|chart| chart["kind"].clone()).collect()
    };
    assert!(kinds("bare").contains(&"sizes".into()));
    simulated(here, "none", &["simulate.controller.disturbance=null"]);
    assert!(!kinds("none").contains(&"sizes".into()));
}

#[test]
fn wrong_disturbances_are_refused() {
    let folder = workshop();
    let here = folder.path();
    let refuse = |disturbance: Value, told: &[&str]| {
        let set = format!("simulate.controller.disturbance={disturbance}");
        refused(here, &["simulate", PROBLEM, "--set", &set], told);
    };
    let start = "simulate.start.joint_angles.joint1";
    refuse(
        json!({ "without": {} }),
        &["disturbance.without", "nothing"],
    );
    refuse(
        json!({ "without": { "simulate.start.joint_angles.joint2": "0 deg" } }),
        &["joint2", "has a value"],
    );
    refuse(
        json!({ "without": { start: "0 rad" } }),
        &["0 rad", "5 deg"],
    );
    refuse(json!({ "without": { start: 3 } }), &["without", "5 deg"]);
    refuse(
        json!({ "without": { start: "100 deg" }, "sizes": [0.5] }),
        &["disturbance.sizes", "2 to 20 sizes"],
    );
    refuse(
        json!({ "without": { start: "0 deg" }, "sizes": [0, 0] }),
        &["disturbance.sizes[1]", "the smallest first"],
    );
    refuse(
        json!({ "without": { start: "0 deg" }, "sizes": [-1, 0] }),
        &["disturbance.sizes[0]", "from 0 on"],
    );
    refuse(
        json!({ "without": { "simulate.duration": "-1 s" } }),
        &["disturbance.without", "duration"],
    );
}
