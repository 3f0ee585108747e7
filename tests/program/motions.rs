//! Several motions from one file to their folders: the sum, the constants in common, going on, and what is refused.

use crate::commands::summary;
use crate::runs::{read, run, workshop};
use std::fs;

const PROBLEM: &str = "problems/pair_motions.json";
const NAMES: [&str; 3] = ["sine", "ramp", "both"];

#[test]
fn three_recordings_give_one_value_of_each_constant() {
    let folder = workshop();
    let here = folder.path();
    let (status, out, err) = run(here, &["solve", PROBLEM, "-o", "all"]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.contains("3 motions"), "{out}");
    // What all of them say is said once, what one says with its name.
    assert_eq!(err.matches("the end is free").count(), 1, "{err}");
    assert!(err.contains("motion \"ramp\": note: joint joint1"), "{err}");
    assert_eq!(
        err.matches("materials.silicone.viscosity: ").count(),
        1,
        "{err}"
    );
    let all = summary(here, "all");
    assert_eq!(all["status"], "solved");
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let mut sum = 0.0;
    let mut variables = 2;
    for (name, entry) in NAMES.into_iter().zip(all["motions"].as_array().unwrap()) {
        assert_eq!(
            (&entry["name"], &entry["folder"]),
            (&name.into(), &name.into())
        );
        let own = summary(here, &format!("all/{name}"));
        assert_eq!(own["status"], "solved");
        assert_eq!(own["objective"], entry["objective"]);
        assert_eq!(own["parameters"], all["parameters"]);
        assert!(own["resimulation"].is_object());
        sum += number(&own["objective"]);
        variables += own["variables"].as_u64().unwrap() - 2;
        for file in [
            "trajectory.csv",
            "tracking.csv",
            "voltages.svg",
            "report.html",
            "solution.json",
        ] {
            assert!(
                here.join("all").join(name).join(file).is_file(),
                "{name}/{file}"
            );
        }
    }
    assert!(sum > 0.0 && (sum - number(&all["objective"])).abs() < 1e-12 * sum);
    assert_eq!(all["variables"].as_u64(), Some(variables));
    let page = fs::read_to_string(here.join("all/report.html")).unwrap();
    assert!(page.contains("sine/report.html"));
    assert!(NAMES.iter().all(|name| page.contains(name)));

    // A run goes on from the results of all motions.
    let (status, out, err) = run(
        here,
        &["solve", PROBLEM, "-o", "on", "--from", "all", "--no-report"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let on = summary(here, "on");
    assert!(
        on["iterations"].as_u64() < all["iterations"].as_u64(),
        "{on}"
    );
    assert!(!here.join("on/report.html").exists());
    let (status, _, err) = run(here, &["solve", PROBLEM, "-o", "on", "--from", "all/sine"]);
    assert_eq!(status, 2);
    assert!(err.contains("holds no solution.json"), "{err}");
}

#[test]
fn a_stopped_solve_of_several_motions_goes_on() {
    let folder = workshop();
    let here = folder.path();
    let (status, out, err) = run(
        here,
        &[
            "solve",
            PROBLEM,
            "-o",
            "cut",
            "--max-iterations",
            "2",
            "--no-report",
        ],
    );
    assert_eq!(status, 1, "{out}{err}");
    assert_eq!(summary(here, "cut")["status"], "iteration_limit");
    assert_eq!(
        err.matches("the iterations allowed were used up").count(),
        1,
        "{err}"
    );
    assert!(err.contains("to go on: proboscis solve"), "{err}");
    let (status, out, err) = run(
        here,
        &[
            "solve",
            PROBLEM,
            "-o",
            "cut",
            "--from",
            "cut",
            "--no-report",
        ],
    );
    assert_eq!(status, 0, "{out}{err}");
    let solution = read(here.join("cut/ramp/solution.json"));
    assert!(solution["parameters"]["materials.silicone.viscosity"].is_number());
}

#[test]
fn each_motion_is_checked_and_what_cannot_be_done_is_refused() {
    let folder = workshop();
    let here = folder.path();
    let (status, out, err) = run(here, &["check", PROBLEM]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        NAMES
            .iter()
            .all(|name| out.contains(&format!("motion \"{name}\": derivatives agree"))),
        "{out}"
    );
    let auto = "control.intervals=auto";
    let one = "control.motions.ramp.intervals=auto";
    let refusals: [(&[&str], &str); 6] = [
        (
            &["solve", PROBLEM, "--accuracy", "0.01", "--set", one],
            "--accuracy",
        ),
        (
            &["solve", PROBLEM, "--estimate-error", "--set", one],
            "\"intervals\" of some",
        ),
        (
            &["solve", PROBLEM, "--estimate-error", "--set", auto],
            "refined until their errors are confirmed",
        ),
        (&["simulate", PROBLEM], "asks for optimal voltages"),
        (&["equilibrium", PROBLEM], "asks for optimal voltages"),
        (
            &[
                "solve",
                PROBLEM,
                "--set",
                "control.motions.ramp.set={\"scene.materials.silicone.viscosity\":\"900 Pa s\"}",
            ],
            "one constant of all motions",
        ),
    ];
    for (arguments, words) in refusals {
        let (status, out, err) = run(here, arguments);
        assert_eq!(status, 2, "{arguments:?} {out}{err}");
        assert!(err.contains(words), "{arguments:?} {err}");
    }
    // A start that one motion cannot have names the motion.
    let set = "control.motions.ramp.start={\"rest_at_voltages\":{\"muscle2\":\"20 kV\"}}";
    let (status, out, err) = run(here, &["solve", PROBLEM, "-o", "none", "--set", set]);
    assert_ne!(status, 0, "{out}{err}");
    assert!(
        err.contains("control.motions.ramp.start") || err.contains("control.motions[1].start"),
        "{err}"
    );
}

/// Motions that share nothing are solved as each alone: their errors are the greatest of both, and the objective has that of the sum.
#[test]
fn errors_of_several_motions_are_the_greatest_of_all() {
    let folder = workshop();
    let here = folder.path();
    let both = "control.motions=[{\"name\":\"near\"},{\"name\":\"far\",\"duration\":\"0.3 s\"}]";
    let estimate = |output: &str, set: &str| {
        let arguments = [
            "solve",
            "problems/pair.json",
            "--estimate-error",
            "-o",
            output,
            "--no-report",
            "--set",
            "control.intervals=40",
            "--set",
            set,
        ];
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        assert!(out.contains("error about"), "{out}");
        summary(here, output)
    };
    let alone =
        ["control.duration=0.2 s", "control.duration=0.3 s"].map(|set| estimate("one", set));
    let all = estimate("both", both);
    let error =
        |of: &serde_json::Value, name: &str| of["accuracy"]["estimate"][name].as_f64().unwrap();
    for name in ["path", "response"] {
        let each = alone.each_ref().map(|one| error(one, name));
        assert!(
            each[0] > 0.0 && (each[0] / each[1] - 1.0).abs() > 1e-3,
            "{each:?}"
        );
        let greatest = each[0].max(each[1]);
        let found = error(&all, name);
        assert!(
            found >= 0.98 * greatest && found <= 1.3 * greatest,
            "{name}: {found} {each:?}"
        );
    }
    let own = [0, 1].map(|k| all["motions"][k]["objective"].as_f64().unwrap());
    let each = alone
        .each_ref()
        .map(|one| one["objective"].as_f64().unwrap());
    for (own, one) in own.iter().zip(each) {
        assert!((own / one - 1.0).abs() < 1e-6, "{own} {one}");
    }
    // The grids of both motions are those of the problem; finer ones tell the error.
    assert_eq!(all["motions"][0]["intervals"], alone[0]["intervals"]);
    let level = |k: usize| &all["accuracy"]["levels"][k];
    let sum = 2 * alone[0]["intervals"].as_u64().unwrap();
    assert_eq!(
        [0, 1].map(|k| level(k)["intervals"].as_u64()),
        [Some(sum), Some(2 * sum)]
    );
    let asked = [
        "solve",
        "problems/pair.json",
        "--set",
        "control.intervals=40",
        "--set",
        both,
        "--accuracy",
        "0.02",
        "-o",
        "finer",
        "--no-report",
    ];
    let (status, out, err) = run(here, &asked);
    let finer = summary(here, "finer");
    assert_eq!(status, 0, "{out}{err}");
    assert_eq!(finer["accuracy"]["is_met"], true);
    assert!(finer["motions"][1]["intervals"].as_u64() > alone[1]["intervals"].as_u64());
}

#[test]
fn motions_that_share_inputs_refine_one_grid() {
    let folder = workshop();
    let here = folder.path();
    let arguments = [
        "solve",
        "problems/robust_pair.json",
        "-o",
        "robust",
        "--set",
        "control.intervals=auto",
        "--accuracy",
        "0.05",
        "--no-report",
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let all = summary(here, "robust");
    let intervals: Vec<u64> = all["motions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["intervals"].as_u64().unwrap())
        .collect();
    assert!(
        intervals[0] > 20 && intervals.iter().all(|n| *n == intervals[0]),
        "{intervals:?}"
    );
    let inputs = |name: &str| {
        fs::read_to_string(here.join("robust").join(name).join("controls.csv")).unwrap()
    };
    let rows = |name: &str| -> Vec<String> {
        inputs(name)
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(str::to_owned)
            .collect()
    };
    assert!(rows("soft").len() > 20);
    assert_eq!(
        all["shared_inputs"],
        serde_json::json!(["muscle1", "muscle2"])
    );
    let numbers = |name: &str| -> Vec<f64> {
        rows(name)[1..]
            .iter()
            .flat_map(|row| {
                row.split(',')
                    .map(|cell| cell.parse::<f64>().unwrap())
                    .collect::<Vec<_>>()
            })
            .collect()
    };
    for (a, b) in numbers("soft").into_iter().zip(numbers("stiff")) {
        assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b}");
    }
}

#[test]
fn each_motion_is_inspected_and_the_program_of_all() {
    let folder = workshop();
    let here = folder.path();
    let (status, out, err) = run(here, &["inspect", PROBLEM, "-o", "shape"]);
    assert_eq!(status, 0, "{out}{err}");
    let number = |text: &str, name: &str| -> usize {
        let line = text.lines().find(|line| line.starts_with(name));
        let line = line.unwrap_or_else(|| panic!("{name}: {text}"));
        line.split_whitespace().last().unwrap().parse().unwrap()
    };
    let (of_each, of_all) = out.split_once("all motions as one program").unwrap();
    let mut variables = 0;
    for name in NAMES {
        let (_, own) = of_each.split_once(&format!("motion \"{name}\": ")).unwrap();
        assert!(own.contains("muscle electroelasticity"), "{own}");
        variables += number(own, "variables");
        assert!(here.join("shape").join(name).join("jacobian.svg").is_file());
    }
    assert_eq!(number(of_all, "motions"), 3);
    // Both constants are unknowns once.
    assert_eq!(number(of_all, "variables"), variables - 2 * 2);
    let (status, worst, err) = run(here, &["inspect", "problems/robust_pair_worst.json"]);
    let (_, sum, _) = run(here, &["inspect", "problems/robust_pair.json"]);
    assert_eq!(status, 0, "{worst}{err}");
    let inequalities = |text: &str| {
        let (_, of_all) = text.split_once("all motions as one program").unwrap();
        number(of_all, "of them inequalities")
    };
    assert_eq!(inequalities(&worst), inequalities(&sum) + 3);
}

#[test]
fn phases_have_starts() {
    let folder = workshop();
    let path = folder.path();
    let cart = "problems/passing_cart.json";
    let (status, out, err) = run(path, &["solve", cart, "--starts", "2", "-o", "out"]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        out.contains("2 of 2 starts solved, 1 distinct optimum"),
        "{out}"
    );
    let summary = read(path.join("out/summary.json"));
    assert_eq!(summary["motions"][0]["name"], "there");
}

#[test]
fn several_motions_have_starts_and_the_best_of_all_is_kept() {
    let folder = workshop();
    let path = folder.path();
    let motions = "problems/robust_pair.json";
    let (status, _, err) = run(path, &["solve", motions, "-o", "own", "--no-report"]);
    assert_eq!(status, 0, "{err}");
    let own = read(path.join("own/summary.json"));
    let arguments = [
        "solve",
        motions,
        "--starts",
        "3",
        "-o",
        "out",
        "--no-report",
    ];
    let (status, out, err) = run(path, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        out.contains("3 of 3 starts solved, 1 distinct optimum"),
        "{out}"
    );
    let summary = read(path.join("out/summary.json"));
    let each = summary["starts"]["each"].as_array().unwrap();
    let objective = |one: &serde_json::Value| one["objective"].as_f64().unwrap();
    for one in each {
        assert!(
            (objective(one) / objective(&own) - 1.0).abs() < 1e-6,
            "{one}"
        );
        assert!(one["infeasibility"].as_f64().unwrap() < 1e-6);
    }
    let iterations: Vec<&serde_json::Value> = each.iter().map(|one| &one["iterations"]).collect();
    assert!(
        iterations.iter().any(|one| *one != iterations[0]),
        "{iterations:?}"
    );
    assert!(
        err.contains("motion \"soft\": note: joint1 ends at"),
        "{err}"
    );
    // The files are those of the best start, each motion in its folder.
    let best = format!(
        "out/starts/{:02}",
        summary["starts"]["best"].as_u64().unwrap()
    );
    for name in ["middle", "soft", "stiff"] {
        let solution =
            |from: &str| fs::read(path.join(from).join(name).join("solution.json")).unwrap();
        assert!(solution("out") == solution(&best), "{name}");
    }
    let set = "control.motions[1].voltages={\"muscle9\": 0}";
    let wrong = ["solve", motions, "--starts", "2", "--set", set];
    let (status, out, err) = run(path, &wrong);
    assert_eq!((status, out.as_str()), (2, ""), "{err}");
    assert!(err.contains("muscle9"), "{err}");
}
