//! Motions that start at the end of another result.

use crate::commands::summary;
use crate::runs::{problem, read, run, workshop};
use proboscis::files::continuation;
use serde_json::{Value, json};
use std::path::Path;

/// Runs that come to a good end.
pub(crate) fn good(folder: &Path, words: &[&str]) {
    let (status, said, notes) = run(folder, words);
    assert_eq!(status, 0, "{words:?}: {said}{notes}");
}

/// Coordinates and momenta of a simulation, instant by instant.
fn motion(folder: &Path) -> [Vec<Vec<f64>>; 2] {
    let kept = continuation::read(&folder.join("continuation.npz")).unwrap();
    [kept.discrete.z, kept.discrete.momenta]
}

/// Greatest difference of two lists, and greatest entry.
fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> [f64; 2] {
    assert_eq!(a.len(), b.len());
    let [a, b] = [a, b].map(|rows| rows.iter().flatten().copied().collect::<Vec<f64>>());
    let pairs = a.iter().zip(&b);
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    [worst, a.iter().fold(0.0, |m: f64, a| m.max(a.abs()))]
}

const FROM: &str = r#"simulate.start={"end_of":"part"}"#;

/// The whole of a motion, and its two halves: coordinates and momenta from the middle on.
fn halves(name: &str, half: &str, whole: &str, set: &[&str]) -> [[Vec<Vec<f64>>; 2]; 2] {
    let folder = workshop();
    let folder = folder.path();
    let path = problem(name);
    let of = |duration: &str| format!("simulate.duration={duration}");
    let (half, whole) = (of(half), of(whole));
    let mut words = vec!["simulate", &path];
    words.extend(set.iter().flat_map(|set| ["--set", set]));
    good(
        folder,
        &[&words[..], &["--set", &whole, "-o", "whole"]].concat(),
    );
    good(
        folder,
        &[&words[..], &["--set", &half, "-o", "part"]].concat(),
    );
    let on = ["--set", &half, "-o", "on", "--set", FROM];
    good(folder, &[&words[..], &on].concat());
    let [z, momenta] = motion(&folder.join("whole"));
    let middle = z.len() / 2;
    let expected = [z, momenta].map(|rows| rows[middle..].to_vec());
    // The state where it ends moves.
    assert!(
        expected[1][0].iter().any(|p| p.abs() > 1e-3),
        "{name} is at rest"
    );
    let [seconds, counted] = ["whole", "on"].map(|name| {
        let summary = summary(folder, name);
        (
            summary["duration"].as_f64().unwrap(),
            summary["newton_iterations"].as_u64().unwrap(),
        )
    });
    assert!((seconds.0 - 2.0 * counted.0).abs() < 1e-12);
    assert!(counted.1 < seconds.1);
    // Time begins at zero for the method too.
    let kept = continuation::read(&folder.join("on/continuation.npz")).unwrap();
    let mut lists = kept.discrete.end.lists.iter();
    let (_, time) = lists.find(|(name, _)| name == "time").unwrap();
    assert!((time[0] - 1e3 * counted.0).abs() < 1e-9, "{time:?}");
    [expected, motion(&folder.join("on"))]
}

#[test]
fn two_halves_are_the_whole_to_the_bit() {
    let driven = r#"simulate.voltages={"muscle1":"1.7 kV","muscle3":"1.6 kV"}"#;
    let redundant = "simulate.coordinates=redundant";
    let on_sphere = r#"simulate.voltages={"muscle1":"2 kV"}"#;
    for (name, half, whole, set) in [
        ("elephant_trunk_constant", "0.1 s", "0.2 s", &[][..]),
        ("elephant_trunk_constant", "0.1 s", "0.2 s", &[redundant]),
        ("fe_trunk", "10 ms", "20 ms", &[driven]),
        ("satellite", "0.25 s", "0.5 s", &[on_sphere]),
    ] {
        let [expected, found] = halves(name, half, whole, set);
        // Multipliers of the last instant of a motion are those before it.
        let but_last = |rows: &[Vec<f64>]| rows[..rows.len() - 1].to_vec();
        assert!(
            but_last(&expected[0]) == but_last(&found[0]),
            "{name} {set:?}"
        );
        assert!(expected[1] == found[1], "{name} {set:?}");
    }
}

#[test]
fn two_halves_are_the_whole_by_every_method() {
    for method in [
        "{\"galerkin\":2}",
        "\"implicit_euler\"",
        "\"generalised_alpha\"",
    ] {
        let method = format!("simulate.integrator={method}");
        let [expected, found] = halves("elephant_trunk_constant", "0.1 s", "0.2 s", &[&method]);
        for (expected, found) in expected.iter().zip(&found) {
            // First guesses are made of times that are rounded otherwise.
            let [worst, size] = apart(expected, found);
            assert!(worst <= 1e-11 * size, "{method}: {worst:e} of {size:e}");
        }
    }
}

/// The trunk, whose voltages end at 0.1 s, in one motion and in two; the second is of another model, in which no voltage acts.
#[test]
fn a_motion_that_nothing_drives_any_more_moves_on() {
    let folder = workshop();
    let folder = folder.path();
    for (name, steps) in [("elephant_trunk_constant", 10), ("fe_trunk", 4)] {
        let path = problem(name);
        let [half, whole] = [steps, 2 * steps].map(|k| format!("{} ms", 5 * k));
        let until = json!({"time": [0, half], "voltages": {"muscle1": ["1.7 kV"]}, "hold": {}});
        let until = format!("simulate.voltages={until}");
        let words = ["simulate", &path, "--set", "simulate.step=5 ms", "--set"];
        let with = |rest: &[&str]| good(folder, &[&words[..], rest].concat());
        let [half, whole] = [half, whole].map(|time| format!("simulate.duration={time}"));
        with(&[&until, "--set", &whole, "-o", "whole"]);
        with(&[&until, "--set", &half, "-o", "part"]);
        let none = ["simulate.voltages={}", "--set", FROM, "--set", &half];
        with(&[&none[..], &["-o", "on"]].concat());
        let [[whole, _], [on, _]] = ["whole", "on"].map(|name| motion(&folder.join(name)));
        let [worst, size] = apart(&whole[steps..], &on);
        let [moved, _] = apart(&whole[steps..=steps], &whole[2 * steps..]);
        assert!(moved > 1e-3 * size, "{name}: {moved:e} of {size:e}");
        // Each step is solved to round-off.
        assert!(worst < 1e-9 * size, "{name}: {worst:e} of {size:e}");
        // Steps of no given length have to know how fast it starts.
        with(&[&none[..], &["--set", "simulate.step=auto", "-o", "auto"]].concat());
        let [auto, _] = motion(&folder.join("auto"));
        assert!(auto.len() > 3);
        let [worst, _] = apart(&auto[auto.len() - 1..], &on[on.len() - 1..]);
        assert!(worst < 0.2 * moved, "{name}: {worst:e} of {moved:e}");
    }
}

#[test]
fn a_steered_robot_rests_where_it_was_steered_to() {
    let folder = workshop();
    let folder = folder.path();
    good(folder, &["solve", "problems/pair.json", "-o", "part"]);
    let held = ["simulate", "problems/pair_constant.json", "--set", FROM];
    good(folder, &[&held[..], &["-o", "on"]].concat());
    let steered = read(folder.join("part/solution.json"));
    let last = |solution: &Value, name: &str| {
        let all = solution["configuration"]["joints"][name]
            .as_array()
            .unwrap();
        all.iter()
            .map(|u| u.as_f64().unwrap())
            .collect::<Vec<f64>>()
    };
    let joints = steered["configuration"]["joints"].as_object().unwrap();
    let moved = joints.keys().map(|name| {
        let before = last(&steered, name);
        let after = last(&read(folder.join("on/solution.json")), name);
        let goal = before[before.len() - 1];
        assert_eq!(after[0], goal);
        let far = after.iter().map(|u| (u - goal).abs()).fold(0.0, f64::max);
        assert!(far < 1e-7, "{name} swings by {far:e}");
        (goal - before[0]).abs()
    });
    assert!(moved.fold(0.0, f64::max) > 0.05);
    // The muscles are charged at the start: the source has nothing to do.
    let energy = |name: &str| {
        summary(folder, name)["energies"]["electrical_energy"]
            .as_f64()
            .unwrap()
    };
    assert!(energy("part") > 0.01, "{}", energy("part"));
    assert!(
        energy("on").abs() < 1e-6 * energy("part"),
        "{}",
        energy("on")
    );
}

/// A steered motion that ends freely, and goes on as its simulation does: the last momenta are right.
#[test]
fn a_motion_goes_on_from_a_free_end() {
    let folder = workshop();
    let folder = folder.path();
    let free = [
        "control.goal=free",
        r#"control.objective={"effort":1e-3,"final":[{"marker":{"marker":"tip","at":["20 mm",null,null],"weight":1}}]}"#,
    ];
    let solve = [
        "solve",
        "problems/pair.json",
        "--set",
        free[0],
        "--set",
        free[1],
    ];
    good(folder, &[&solve[..], &["-o", "part"]].concat());
    let momentum = read(folder.join("part/solution.json"))["state"]["momentum"].clone();
    let momentum: Vec<f64> = serde_json::from_value(momentum).unwrap();
    assert!(momentum.iter().any(|p| p.abs() > 1e-2), "{momentum:?}");
    let simulate = [
        "simulate",
        "problems/pair_constant.json",
        "--set",
        "simulate.step=10 ms",
    ];
    let under = |rest: &[&str]| good(folder, &[&simulate[..], rest].concat());
    let solution = r#"simulate.voltages={"solution":"part/solution.json"}"#;
    under(&[
        "--set",
        solution,
        "--set",
        "simulate.duration=0.4 s",
        "-o",
        "whole",
    ]);
    let voltages = &read(folder.join("part/solution.json"))["voltages"];
    let last = voltages.as_object().unwrap().iter().map(|(name, list)| {
        (
            name.clone(),
            list.as_array().unwrap().last().unwrap().clone(),
        )
    });
    let last = format!("simulate.voltages={}", Value::Object(last.collect()));
    under(&[
        "--set",
        &last,
        "--set",
        "simulate.duration=0.2 s",
        "-o",
        "on",
        "--set",
        FROM,
    ]);
    let [[whole, momenta], [on, _]] = ["whole", "on"].map(|name| motion(&folder.join(name)));
    assert_eq!(whole.len(), 41);
    let [worst, size] = apart(&momenta[20..21], &[momentum]);
    assert!(worst < 1e-7 * size, "{worst:e} of {size:e}");
    let [worst, size] = apart(&whole[20..], &on);
    assert!(worst < 1e-7 * size, "{worst:e} of {size:e}");
}

/// A problem that begins in motion and ends at rest.
#[test]
fn a_solve_starts_where_a_simulation_ended() {
    let folder = workshop();
    let folder = folder.path();
    let short = [
        "simulate",
        "problems/pair_constant.json",
        "--set",
        "simulate.duration=50 ms",
    ];
    good(folder, &[&short[..], &["-o", "part"]].concat());
    let from = r#"control.start={"end_of":"part"}"#;
    good(
        folder,
        &["solve", "problems/pair.json", "--set", from, "-o", "on"],
    );
    let [z, momenta] = motion(&folder.join("part"));
    let (z, momentum) = (z.last().unwrap(), momenta.last().unwrap());
    assert!(momentum.iter().any(|p| p.abs() > 1e-2), "{momentum:?}");
    let solution = read(folder.join("on/solution.json"));
    let first: Vec<f64> = serde_json::from_value(solution["state"]["z"][0].clone()).unwrap();
    assert_eq!(&first, z);
    let deviation = &summary(folder, "on")["resimulation"];
    assert!(deviation.is_object(), "{deviation}");
}

#[test]
fn a_payload_that_is_picked_up_keeps_the_momentum() {
    let folder = workshop();
    let folder = folder.path();
    let problem = |mass: &str, start: Value| {
        json!({
            "scene": {
                "name": "cart",
                "bodies": [{ "name": "cart", "mass": mass, "sphere": { "radius": "10 mm" }, "position": [0, 0, 0] }],
                "joints": [{ "name": "slide", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart", "at": [0, 0, 0] }],
            },
            "simulate": { "duration": "1 s", "step": "10 ms", "start": start, "voltages": {} },
        })
        .to_string()
    };
    let moving = json!({ "joint_angles": {}, "joint_rates": { "slide": "1 m/s" } });
    std::fs::write(folder.join("empty.json"), problem("1 kg", moving)).unwrap();
    let after = json!({ "end_of": "empty" });
    std::fs::write(folder.join("loaded.json"), problem("4 kg", after)).unwrap();
    good(folder, &["simulate", "empty.json", "-o", "empty"]);
    good(folder, &["simulate", "loaded.json", "-o", "loaded"]);
    // 1 m/s of 1 kg are 0.25 m/s of 4 kg.
    let [z, _] = motion(&folder.join("empty"));
    assert!((z[100][0] - 1000.0).abs() < 1e-9, "{:?}", z[100]);
    let [z, momenta] = motion(&folder.join("loaded"));
    assert!((z[100][0] - 1250.0).abs() < 1e-9, "{:?}", z[100]);
    assert!((momenta[100][0] - momenta[0][0]).abs() < 1e-9);
}
