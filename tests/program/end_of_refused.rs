//! Starts at the end of what is no motion of the robot.

use crate::end_of::good;
use crate::runs::{problem, read, run, workshop};
use serde_json::{Value, json};
use std::fs;

#[test]
fn what_is_no_end_of_a_motion_of_the_robot_is_refused_with_one_line() {
    let folder = workshop();
    let folder = folder.path();
    let pair = problem("pair_constant");
    let short = "simulate.duration=50 ms";
    let constant = problem("elephant_trunk_constant");
    let block = problem("bending_actuator_step");
    let few = "simulate.duration=1 ms";
    good(folder, &["simulate", &pair, "--set", short, "-o", "part"]);
    good(
        folder,
        &["simulate", &constant, "--set", short, "-o", "trunk"],
    );
    let fewer = "scene.solids[0].box.elements=[4,1,2]";
    let coarse = ["simulate", &block, "--set", few, "--set", fewer];
    good(folder, &[&coarse[..], &["-o", "block"]].concat());
    good(
        folder,
        &[
            "equilibrium",
            &pair,
            "--voltages",
            "muscle2=1kV",
            "-o",
            "rest",
        ],
    );
    let (status, ..) = run(
        folder,
        &[
            "solve",
            &problem("pair"),
            "--max-iterations",
            "2",
            "-o",
            "left",
        ],
    );
    assert_eq!(status, 1);
    let elements = "scene.solids[0].box.elements=[5,1,2]";
    let away = "scene.chain.length=52 mm";
    let end_of = |path: &str| format!("simulate.start={{\"end_of\":{path:?}}}");
    for (problem, path, set, expected) in [
        (
            &pair,
            "nowhere",
            short,
            "\"nowhere\", where there is no solution.json",
        ),
        (
            &pair,
            "rest",
            short,
            "a state of rest is \"rest_at_voltages\"",
        ),
        (&pair, "left", short, "whose status is \"iteration_limit\""),
        (&pair, "trunk", short, "a result of the same robot"),
        (&constant, "part", short, "which has no body"),
        (
            &pair,
            "part",
            "simulate.coordinates=redundant",
            "part is in reduced coordinates",
        ),
        (&pair, "part", away, "mm away from where it ended"),
        (
            &block,
            "block",
            elements,
            "block has other nodes of \"beam\"",
        ),
    ] {
        let words = [
            "simulate",
            problem,
            "--set",
            set,
            "--set",
            &end_of(path),
            "-o",
            "out",
        ];
        let (status, said, error) = run(folder, &words);
        assert_eq!(status, 2, "{path} {set}: {said}{error}");
        assert!(
            error.contains("simulate.start.end_of"),
            "{path} {set}: {error}"
        );
        assert!(error.contains(expected), "{path} {set}: {error}");
        assert!(!folder.join("out").exists());
    }
    let both = r#"simulate.start={"end_of":"part","joint_angles":{}}"#;
    let (status, _, error) = run(folder, &["simulate", &pair, "--set", both]);
    assert!(status == 2 && error.contains("exactly one of"), "{error}");
    let onto = ["simulate", &pair, "--set", &end_of("part"), "-o", "part"];
    let (status, _, error) = run(folder, &onto);
    assert!(
        status == 2 && error.contains("would replace part"),
        "{error}"
    );
    // Files that do not belong together, or are cut off.
    let part = folder.join("part");
    let words = ["simulate", &pair, "--set", &end_of("part"), "-o", "out"];
    let kept = fs::read(part.join("continuation.npz")).unwrap();
    for (bytes, expected) in [
        (
            fs::read(folder.join("trunk/continuation.npz")).unwrap(),
            "files of one run",
        ),
        (kept[..kept.len() / 2].to_vec(), "part/continuation.npz: "),
    ] {
        fs::write(part.join("continuation.npz"), bytes).unwrap();
        let (status, _, error) = run(folder, &words);
        assert!(status == 2 && error.contains(expected), "{error}");
    }
    fs::remove_file(part.join("continuation.npz")).unwrap();
    let solution = read(part.join("solution.json"));
    let with = |place: &str, value: Value| {
        let mut changed = solution.clone();
        *changed.pointer_mut(place).unwrap() = value;
        fs::write(part.join("solution.json"), changed.to_string()).unwrap();
        let (status, _, error) = run(folder, &words);
        assert_eq!(status, 2, "{place}: {error}");
        error
    };
    for (place, value, expected) in [
        ("/state/z", json!([]), "does not tell \"state.z\""),
        (
            "/state/momentum",
            json!([]),
            "\"state.momentum\" at its end",
        ),
        (
            "/state/momentum",
            json!([1.0, 2.0, 3.0, 4.0, 5.0]),
            "has 5 coordinates",
        ),
        ("/state/momentum", json!("much"), "state.momentum"),
        (
            "/coordinates",
            json!("polar"),
            "in which \"coordinates\" it is",
        ),
        ("/configuration/bodies", json!({}), "which has no body"),
    ] {
        let error = with(place, value);
        assert!(error.contains(expected), "{place}: {error}");
    }
    // Without a summary nothing tells what it is, which is said.
    fs::write(part.join("solution.json"), solution.to_string()).unwrap();
    fs::remove_file(part.join("summary.json")).unwrap();
    let (status, _, notes) = run(folder, &words);
    assert_eq!(status, 0, "{notes}");
    assert!(notes.contains("no summary.json beside"), "{notes}");
}
