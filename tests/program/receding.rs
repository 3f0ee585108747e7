//! Simulations under a controller that plans anew over a receding horizon.

use crate::commands::summary;
use crate::feedback::{number, solved};
use crate::runs::{read, refused, run, workshop};
use serde_json::Value;
use std::fs;
use std::path::Path;

const PROBLEM: &str = "problems/pair_receding.json";

/// A pair of stiffer silicone that starts 5 degrees off is brought nearer to its goal than without feedback.
#[test]
fn a_stiffer_pair_is_planned_anew() {
    let folder = workshop();
    let here = folder.path();
    let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"";
    let shorter = "simulate.controller.horizon.intervals=4";
    let arguments = [
        "simulate", PROBLEM, "-o", "planned", "--set", stiffer, "--set", shorter,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let closed = &summary(here, "planned")["closed_loop"];
    let tip = &closed["markers"]["tip"];
    let [with, without] = ["feedback", "open_loop"].map(|key| number(&tip[key]["greatest_held"]));
    assert!(without > 1e-3 && with < 0.4 * without, "{tip}");
    assert_eq!(closed["samples"], 61);
    assert_eq!(
        closed["plans"]["sources"],
        serde_json::json!({ "plan": 61 })
    );
    let [step, all] =
        ["longest_step", "longest_with_preparation"].map(|key| number(&closed["plans"][key]));
    assert!(0.0 < step && step <= all, "{closed}");
    // Inputs that act from each sample on but the last, which is at the end, against squares of the bounds.
    let table = here.join("planned/controls.csv");
    let times = column(&table, "start [ms]");
    let inputs = [1, 2].map(|muscle| column(&table, &format!("muscle{muscle} [V]")));
    let at = |bound: f64| {
        let sampled = (0..times.len()).filter(|&row| (times[row] / 10.0).fract().abs() < 1e-9);
        let is_near = |of: &Vec<f64>, row: usize| (of[row].powi(2) - bound * bound).abs() <= 900.0;
        let near = sampled.filter(|&row| inputs.iter().any(|of| is_near(of, row)));
        near.count() as u64
    };
    assert!((5..60).contains(&at(0.0)), "{}", at(0.0));
    for (key, bound) in [
        ("samples_at_lower_bound", 0.0),
        ("samples_at_upper_bound", 3000.0),
    ] {
        let count = closed[key].as_u64().unwrap();
        assert!(
            (at(bound)..=at(bound) + 1).contains(&count),
            "{key}: {count}"
        );
    }
    assert!(!err.contains("bound"), "{err}");
    for name in ["tracking.svg", "report.html"] {
        assert!(here.join("planned").join(name).exists(), "{name}");
    }
}

/// With an observer of the tip, a delay and constant disturbances it ends at the goal.
#[test]
fn an_observed_pair_is_planned_over_a_delay() {
    let folder = workshop();
    let here = folder.path();
    let mut problem = read(here.join("problems/pair.json"));
    problem["feedback"] = serde_json::json!({
        "delay": "15 ms",
        "observer": { "markers": { "tip": "0.1 mm" }, "lasting": 0.02 }
    });
    fs::write(here.join("problems/observed.json"), problem.to_string()).unwrap();
    let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"";
    let observed = "simulate.controller.horizon.problem=\"observed.json\"";
    let tip = |noise: &str| {
        let noise = format!("simulate.controller.noise={noise}");
        let arguments = [
            "simulate",
            PROBLEM,
            "-o",
            "planned",
            "--no-report",
            "--set",
            stiffer,
            "--set",
            observed,
            "--set",
            &noise,
            "--set",
            "simulate.duration=\"1 s\"",
        ];
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        let closed = &summary(here, "planned")["closed_loop"];
        assert_eq!(
            closed["plans"]["sources"],
            serde_json::json!({ "plan": 101 })
        );
        let tip = &closed["markers"]["tip"];
        ["feedback", "open_loop"].map(|key| number(&tip[key]["last"]))
    };
    let [with, without] = tip("{}");
    assert!(without > 5e-4 && with < 1e-7, "{with} {without}");
    let [noisy, _] = tip("{\"length\":\"0.05 mm\",\"seed\":3}");
    assert!(with < noisy && noisy < 0.3 * without, "{noisy} {without}");
}

/// The values of a column of a table by its title.
fn column(file: &Path, title: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines().skip(1);
    let titles = lines.next().unwrap().split(',');
    let place = titles.clone().position(|own| own == title);
    let place = place.unwrap_or_else(|| panic!("{title}: {:?}", titles.collect::<Vec<_>>()));
    let value = |line: &str| line.split(',').nth(place).unwrap().parse().unwrap();
    lines.map(value).collect()
}

/// A file of a changed problem beside the kept ones.
fn changed(here: &Path, name: &str, key: &str, value: &Value) {
    let mut problem = read(here.join("problems/pair.json"));
    problem["control"][key] = value.clone();
    fs::write(here.join("problems").join(name), problem.to_string()).unwrap();
}

const OF_CHANGED: &str = "simulate.controller.horizon.problem=\"changed.json\"";

/// A robot of softer silicone passes limits that its plans keep: by as much as the tables say.
#[test]
fn limits_that_the_motion_passes_are_told() {
    let folder = workshop();
    let here = folder.path();
    let limits = serde_json::json!([
        { "joint_angle": { "joint": "joint1", "max": "9.2 deg" } },
        { "electric_field": { "muscles": "all", "max": "40 V/um" } },
        { "stretch": { "muscle": "muscle1", "max": 1.5 } }
    ]);
    changed(here, "changed.json", "limits", &limits);
    let softer = "scene.materials.silicone.shear_modulus=\"80 kPa\"";
    let short = "simulate.duration=\"0.3 s\"";
    let mut arguments = vec!["simulate", PROBLEM, "-o", "limited", "--no-report"];
    for set in [OF_CHANGED, softer, short] {
        arguments.extend(["--set", set]);
    }
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let limits = &summary(here, "limited")["closed_loop"]["limits"];
    let fields = [1, 2].map(|muscle| format!("electric field of muscle{muscle}"));
    let names = [
        "limit of joint1",
        &fields[0],
        &fields[1],
        "stretch of muscle1",
    ];
    assert_eq!(limits["compared"], serde_json::json!(names));
    assert!(limits.get("not_compared").is_none());
    let passed = limits["passed"].as_array().unwrap();
    let of = |name: &str| passed.iter().find(|one| one["limit"] == name);
    let table = here.join("limited/trajectory.csv");
    let times = column(&table, "time [ms]");
    let angles = column(&table, "joint1 [rad]");
    let (k, angle) = greatest(&angles);
    let joint = of("limit of joint1").unwrap();
    let excess = angle - 9.2_f64.to_radians();
    assert!(excess > 5e-3, "{excess}");
    assert!((number(&joint["excess"]) - excess).abs() < 1e-12, "{joint}");
    assert!((number(&joint["time"]) - 1e-3 * times[k]).abs() < 1e-9);
    assert_eq!(joint["unit"], "rad");
    // |V|/(t Λ) at both ends of each interval, t = 50 µm.
    for muscle in [1, 2] {
        let voltages = column(
            &here.join("limited/controls.csv"),
            &format!("muscle{muscle} [V]"),
        );
        let stretches = column(&table, &format!("muscle{muscle}_stretch"));
        let field = |k: usize| voltages[k] / 50.0 / stretches[k].min(stretches[k + 1]);
        let all: Vec<f64> = (0..voltages.len()).map(field).collect();
        let (_, field) = greatest(&all);
        match of(&fields[muscle - 1]) {
            Some(told) => {
                assert!(
                    (number(&told["value"]) - field).abs() < 1e-3,
                    "{told} {field}"
                );
                assert_eq!(told["unit"], "V/um");
            }
            None => assert!(field < 40.0 + 1e-6, "{field}"),
        }
    }
    assert!(of("stretch of muscle1").is_none());
    let told = "warning: under the controller a limit is passed, limit of joint1: ";
    assert!(err.contains(told), "{err}");
}

fn greatest(list: &[f64]) -> (usize, f64) {
    let all = list.iter().copied().enumerate();
    all.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap()
}

/// A robot without markers has the distances of its joints from the motion.
#[test]
fn joints_of_a_robot_without_markers() {
    let folder = workshop();
    let here = folder.path();
    let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"";
    let bare = "scene.chain.tip_marker=null";
    let arguments = [
        "simulate", PROBLEM, "-o", "bare", "--set", stiffer, "--set", bare,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let closed = &summary(here, "bare")["closed_loop"];
    assert_eq!(closed["markers"], serde_json::json!({}));
    solved(here, "problems/pair.json", "pair", &[]);
    let last = |run: &str| {
        let angles = column(&here.join(run).join("trajectory.csv"), "joint1 [rad]");
        *angles.last().unwrap()
    };
    let off = (last("bare") - last("pair")).abs();
    let told = &closed["joints"]["joint1"];
    let [with, without] = ["feedback", "open_loop"].map(|key| number(&told[key]["last"]));
    assert!((with - off).abs() < 1e-6 && off > 1e-3, "{told} {off}");
    assert!(without > 2.0 * with, "{told}");
    assert!(
        err.contains("note: joint1: at most 0.08727 rad from the reference"),
        "{err}"
    );
    assert!(here.join("bare/tracking.svg").exists());
}

/// A problem without an optimum is no wrong input.
#[test]
fn horizons_of_problems_without_an_optimum() {
    let folder = workshop();
    let here = folder.path();
    changed(here, "changed.json", "duration", &"4 ms".into());
    let mut problem = read(here.join("problems/changed.json"));
    problem["control"]["intervals"] = 2.into();
    fs::write(here.join("problems/changed.json"), problem.to_string()).unwrap();
    let arguments = ["simulate", PROBLEM, "-o", "none", "--set", OF_CHANGED];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 1, "{out}{err}");
    for told in [
        "controller.horizon",
        "changed.json",
        "no optimum was found: infeasible",
    ] {
        assert!(err.contains(told), "{told}: {err}");
    }
    assert_eq!(summary(here, "none")["status"], "plan_unsolved");
}

#[test]
fn wrong_horizons_are_refused() {
    let folder = workshop();
    let here = folder.path();
    let refused = |set: &str, told: &[&str]| {
        let set = format!("simulate.controller{set}");
        refused(here, &["simulate", PROBLEM, "--set", &set], told);
    };
    refused("={}", &["controller", "neither", "one of them"]);
    refused(".feedback=\"feedback/pair.json\"", &["both", "one of them"]);
    refused(".sample=\"10 ms\"", &["controller.sample", "none beside"]);
    refused(
        ".delay=\"1.5 ms\"",
        &["controller.delay", "multiple of the step"],
    );
    refused(".horizon.intervals=0", &["horizon.intervals", "1 interval"]);
    refused(".horizon.intervals=20000", &["horizon.intervals", "10000"]);
    refused(
        ".noise={\"velocity\":\"1 mm/s\"}",
        &["controller.noise.velocity", "nothing measures"],
    );
    let problem = |name: &str| format!(".horizon.problem=\"{name}\"");
    refused(&problem("none.json"), &["horizon.problem", "none.json"]);
    refused(
        &problem("pair_receding.json"),
        &["horizon.problem", "has none", "control"],
    );
    refused(
        &problem("pair_time.json"),
        &["horizon.problem", "free", "given duration"],
    );
    refused(
        &problem("pair_feedback.json"),
        &["controller.horizon", "integral", "lasting"],
    );
    refused(&problem("elephant_trunk.json"), &["multiples of the step"]);
    let other = "={\"horizon\":{\"problem\":\"elephant_trunk_effort.json\",\"intervals\":2}}";
    refused(
        other,
        &["controller.horizon", "which this robot does not have"],
    );
}
