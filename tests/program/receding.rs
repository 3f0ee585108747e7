//! Simulations under a controller that plans anew over a receding horizon.

use crate::commands::summary;
use crate::feedback::number;
use crate::runs::{read, refused, run, workshop};

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
    for name in ["tracking.svg", "report.html"] {
        assert!(here.join("planned").join(name).exists(), "{name}");
    }
}

/// With an observer of the tip, a delay and lasting forces it ends at the goal.
#[test]
fn an_observed_pair_is_planned_over_a_delay() {
    let folder = workshop();
    let here = folder.path();
    let mut problem = read(here.join("problems/pair.json"));
    problem["feedback"] = serde_json::json!({
        "delay": "15 ms",
        "observer": { "markers": { "tip": "0.1 mm" }, "lasting": 0.02 }
    });
    std::fs::write(here.join("problems/observed.json"), problem.to_string()).unwrap();
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
