//! Feedback along an optimum, and simulations under it, from files to files.

use crate::commands::summary;
use crate::runs::{read, refused, run, workshop};
use serde_json::Value;
use std::fs;
use std::path::Path;

pub(crate) fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is a number"))
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        Value::Object(keys) => keys.values().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

pub(crate) fn solved(here: &Path, problem: &str, to: &str, set: &[&str]) -> Value {
    let mut arguments = vec!["solve", problem, "-o", to, "--no-report"];
    set.iter().for_each(|set| arguments.extend(["--set", set]));
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    summary(here, to)
}

/// The kept law of the pair is that of its problem, and its closed loop is stable.
#[test]
fn gains_of_the_pair_are_the_kept_ones() {
    let folder = workshop();
    let here = folder.path();
    let summary = solved(here, "problems/pair_feedback.json", "pair", &[]);
    let feedback = &summary["feedback"];
    assert!(number(&feedback["radius"]) < 1.0, "{feedback}");
    assert!(number(&feedback["residual"]) < 1e-10, "{feedback}");
    assert!(number(&feedback["difference"]) < 1e-2, "{feedback}");
    let [own, kept] =
        ["pair/feedback.json", "problems/feedback/pair.json"].map(|file| read(here.join(file)));
    assert_eq!(own["measured"], kept["measured"]);
    assert_eq!(own["inputs"], kept["inputs"]);
    let gains = |law: &Value| -> Vec<f64> {
        let list = law["intervals"].as_array().unwrap();
        list.iter().flat_map(|one| numbers(&one["gain"])).collect()
    };
    let (own, kept) = (gains(&own), gains(&kept));
    assert_eq!(own.len(), 20 * 2 * 3);
    let greatest = kept.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (own, kept) in own.iter().zip(&kept) {
        assert!((own - kept).abs() < 1e-5 * greatest, "{own} {kept}");
    }
    let table = fs::read_to_string(here.join("pair/feedback.csv")).unwrap();
    assert_eq!(table.lines().count(), 2 + 20 + 1);
    assert!(table.contains("muscle1^2 by rate of coordinate of joint1 [V^2/(rad/s)]"));
    // Without the key there are no such files, and those of before are gone.
    let again = solved(here, "problems/pair.json", "pair", &[]);
    assert!(again.get("feedback").is_none());
    for ending in ["json", "csv", "npz"] {
        assert!(!here.join(format!("pair/feedback.{ending}")).exists());
    }
}

/// A trunk of stiffer silicone that starts 5 mm off comes to its goal under feedback, and not without.
#[test]
fn a_stiffer_trunk_follows_under_feedback() {
    let folder = workshop();
    let here = folder.path();
    let scene = here.join("problems/scenes/elephant_trunk.json");
    let mut problem = read(here.join("problems/elephant_trunk.json"));
    problem["feedback"] = serde_json::json!({});
    problem["scene"] = scene.to_str().unwrap().into();
    fs::write(here.join("steered.json"), problem.to_string()).unwrap();
    let report = solved(here, "steered.json", "steered", &[]);
    assert!(number(&report["feedback"]["radius"]) < 0.95);
    assert!(number(&report["feedback"]["open_radius"]) > 0.999);
    let simulate = serde_json::json!({
        "scene": scene.to_str().unwrap(),
        "simulate": {
            "duration": "0.6 s", "step": "2.4 ms",
            "start": { "joint_angles": { "joint1": "1 deg" } },
            "controller": { "feedback": "steered" }
        }
    });
    fs::write(here.join("closed.json"), simulate.to_string()).unwrap();
    let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"";
    let (status, out, err) = run(
        here,
        &["simulate", "closed.json", "-o", "closed", "--set", stiffer],
    );
    assert_eq!(status, 0, "{out}{err}");
    let closed = &summary(here, "closed")["closed_loop"];
    let tip = &closed["markers"]["tip"];
    let [with, without] = ["feedback", "open_loop"].map(|key| &tip[key]);
    assert!(number(&with["greatest"]) > 4e-3, "{tip}");
    let [with, without] = [with, without].map(|of| number(&of["greatest_held"]));
    assert!(without > 5e-3 && with < 0.2 * without, "{tip}");
    assert!(number(&closed["samples"]) == 251.0);
    assert!(closed["samples_at_lower_bound"].as_u64().unwrap() > 0);
    assert!(err.contains("a muscle cannot push"), "{err}");
    assert!(here.join("closed/tracking.svg").exists());
    let figure = fs::read_to_string(here.join("closed/tip_path.svg")).unwrap();
    assert!(figure.contains("without feedback") && figure.contains("reference"));
}

/// The same motion as that of the gains needs no corrections.
#[test]
fn nothing_is_corrected_where_nothing_deviates() {
    let folder = workshop();
    let here = folder.path();
    let problem = "problems/pair_closed_loop.json";
    let start = "simulate.start={\"joint_angles\":{}}";
    let until = "simulate.duration=\"0.19 s\"";
    let arguments = [
        "simulate", problem, "-o", "same", "--set", start, "--set", until,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let closed = &summary(here, "same")["closed_loop"];
    let tip = &closed["markers"]["tip"];
    let [with, without] = ["feedback", "open_loop"].map(|key| number(&tip[key]["last"]));
    assert!(with < 1e-7 && (with - without).abs() < 1e-9, "{closed}");
    assert_eq!(closed["samples"], 20);
}

/// Gains along a motion whose goal nothing holds end with it: the solve says so, as a longer simulation under them does.
#[test]
fn gains_that_hold_no_goal_are_told() {
    let folder = workshop();
    let here = folder.path();
    let told = "feedback does not hold the goal after the end";
    let problem = "problems/pair_feedback.json";
    let solve = |to: &str, set: &[&str]| {
        let mut arguments = vec!["solve", problem, "-o", to, "--no-report"];
        arguments.extend(set.iter().flat_map(|one| ["--set", one]));
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        let holds = read(here.join(to).join("feedback.json"))["held"].is_object();
        (holds, err)
    };
    let (holds, err) = solve("held", &[]);
    assert!(holds && !err.contains(told), "{err}");
    let goal = "control.goal={\"markers\":{\"tip\":[\"-30 mm\",null,null]}}";
    let (holds, err) = solve("ends", &[goal]);
    assert!(!holds && err.contains(told), "{err}");
    let law = format!("simulate.controller.feedback={:?}", here.join("ends"));
    let closed = "problems/pair_closed_loop.json";
    refused(
        here,
        &["simulate", closed, "--set", &law],
        &["does not hold its goal after its end"],
    );
}

/// Two kilogrammes stand upright on a joint whose muscles hold less than a degree of them: m g l is 0.49 N m, theirs 0.34 at most.
#[test]
fn an_unstable_goal_with_named_inputs_is_not_held() {
    let folder = workshop();
    let here = folder.path();
    let heavy = "scene.chain.mass=\"2 kg\"";
    let weight = "scene.gravity=[0,-9.81,0]";
    let start = "control.start={\"joint_angles\":{\"joint1\":\"5 deg\"}}";
    let goal = "control.goal={\"markers\":{\"tip\":[0,null,null]},\"hold\":{}}";
    let set = [heavy, weight, start, goal, "control.intervals=40"];
    let solve = |hold: &str| {
        let mut arguments = vec!["solve", "problems/pair.json", "-o", "up", "--no-report"];
        arguments.extend(set.iter().flat_map(|one| ["--set", one]));
        arguments.extend(["--set", hold]);
        run(here, &arguments)
    };
    let (status, out, err) = solve("control.hold=reported");
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        err.contains("an unstable equilibrium, in 1 direction"),
        "{err}"
    );
    let (status, out, err) = solve("control.hold=required");
    assert_eq!(status, 1, "{out}{err}");
    assert!(format!("{out}{err}").contains("unstable"), "{out}{err}");
}

#[test]
fn wrong_feedback_is_refused() {
    let folder = workshop();
    let here = folder.path();
    let solve = |set: &str, told: &[&str]| {
        refused(
            here,
            &["solve", "problems/pair_feedback.json", "--set", set],
            told,
        );
    };
    solve(
        "feedback={\"weights\":{\"joints\":-1}}",
        &["feedback.weights.joints", "-1"],
    );
    solve(
        "feedback={\"weights\":{\"voltages\":0}}",
        &["feedback.weights.voltages", "positive"],
    );
    solve(
        "feedback={\"weights\":{\"markers\":{\"top\":1}}}",
        &["markers.top", "marker"],
    );
    solve(
        "feedback={\"weights\":{\"joints\":0}}",
        &["feedback.weights", "positive"],
    );
    solve("feedback={\"terminal\":-2}", &["feedback.terminal"]);
    solve(
        "feedback={\"delay\":\"1e6 s\"}",
        &["feedback.delay", "no longer than the motion"],
    );
    solve("feedback={\"gain\":1}", &["gain"]);
    refused(
        here,
        &["solve", "problems/pull_in.json", "--set", "feedback={}"],
        &["feedback", "control"],
    );
    let simulate = |problem: &str, set: &str, told: &[&str]| {
        refused(here, &["simulate", problem, "--set", set], told);
    };
    let own = "problems/pair_closed_loop.json";
    simulate(
        own,
        "simulate.controller.feedback=\"none.json\"",
        &["controller.feedback", "none.json"],
    );
    simulate(
        own,
        "simulate.controller.sample=\"1.5 ms\"",
        &["controller.sample", "multiple"],
    );
    simulate(
        own,
        "simulate.controller.delay=\"-1 ms\"",
        &["controller.delay"],
    );
    simulate(
        own,
        "simulate.controller.delay=\"1e6 s\"",
        &["controller.delay", "no more than the duration"],
    );
    simulate(
        own,
        "simulate.controller.noise={\"angle\":\"-1 deg\"}",
        &["noise.angle"],
    );
    simulate(
        own,
        "simulate.controller.noise={\"length\":\"1 mm\"}",
        &["noise.length", "nothing measures"],
    );
    for problem in [own, "problems/pair_receding.json"] {
        simulate(
            problem,
            "simulate.voltages={\"muscle1\":\"1 kV\"}",
            &["simulate.voltages.muscle1", "the controller gives"],
        );
    }
    simulate(
        own,
        "simulate.step=\"auto\"",
        &["simulate.controller", "step"],
    );
    let law = fs::read_to_string(here.join("problems/feedback/pair.json")).unwrap();
    let changed = |name: &str, from: &str, to: &str, told: &[&str]| {
        assert!(law.contains(from), "{from}");
        fs::write(here.join(name), law.replace(from, to)).unwrap();
        let set = format!("simulate.controller.feedback=\"../{name}\"");
        simulate(own, &set, told);
    };
    changed(
        "unit.json",
        "\"rad/s\"",
        "\"deg/s\"",
        &["unit.json", "measured", "deg/s"],
    );
    changed(
        "robot.json",
        "coordinate of joint1",
        "coordinate of elbow",
        &["elbow"],
    );
    changed("muscle.json", "\"muscle2\"", "\"muscle7\"", &["muscle7"]);
    changed(
        "key.json",
        "\"interval\"",
        "\"time\"",
        &["key.json", "time"],
    );
    changed("bounds.json", "3000.0", "-3000.0", &["bounds"]);
    let place = law.find("\"state\"").unwrap();
    let number = law[place..].find('[').unwrap() + place + 1;
    fs::write(
        here.join("nan.json"),
        format!("{}NaN,{}", &law[..number], &law[number..]),
    )
    .unwrap();
    simulate(
        own,
        "simulate.controller.feedback=\"../nan.json\"",
        &["nan.json"],
    );
    fs::write(
        here.join("long.json"),
        format!("{}0.5,{}", &law[..number], &law[number..]),
    )
    .unwrap();
    simulate(
        own,
        "simulate.controller.feedback=\"../long.json\"",
        &["long.json", "state", "3 numbers"],
    );
}
