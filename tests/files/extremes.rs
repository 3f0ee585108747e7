//! Files that are deep, long or ask for what no memory holds.

use crate::fuzz_reader::{beside_scenes, is_refused, kept};
use proboscis::app::CommandError;
use proboscis::files::read_problem;
use std::path::Path;

#[test]
fn kept_files_are_read() {
    for (folder, is_scene) in [("problems", false), ("problems/scenes", true)] {
        let files = kept(folder);
        assert!(files.len() > 5, "{files:?}");
        for (name, text) in files {
            let mut others = [
                "\"solution\"",
                "\"csv\"",
                "\"recordings\"",
                "\"controller\"",
            ]
            .into_iter();
            let needs_another = others.any(|key| text.contains(key));
            assert_eq!(
                is_refused(text.as_bytes(), is_scene),
                needs_another,
                "{name}"
            );
        }
    }
}

#[test]
fn deep_nesting_is_refused() {
    let deep = |open: &str, close: &str, depth: usize| {
        format!(
            "{{ \"scene\": {}0{} }}",
            open.repeat(depth),
            close.repeat(depth)
        )
    };
    for depth in [100, 127, 128, 129, 1000, 1_000_000] {
        assert!(
            is_refused(deep("[", "]", depth).as_bytes(), false),
            "{depth}"
        );
        assert!(
            is_refused(deep("{\"a\":", "}", depth).as_bytes(), false),
            "{depth}"
        );
        assert!(
            is_refused(deep("[", "", depth).as_bytes(), false),
            "{depth}"
        );
    }
    let (_folder, path) = beside_scenes(kept("problems")[0].1.as_bytes());
    let long = format!("{}a=1", "a.".repeat(50_000));
    let error = read_problem(&path, &[long]).unwrap_err();
    assert!(error.to_string().starts_with("command line: "));
}

/// A whole file on one line: a mistake so far to the right cannot be marked, but is told.
#[test]
fn mistakes_in_a_long_line_are_told() {
    let name = "x".repeat(70_000);
    let text = format!("{{ \"scene\": {{ \"name\": \"{name}\", \"gravty\": 0 }} }}");
    let (_folder, path) = beside_scenes(text.as_bytes());
    let error = read_problem(&path, &[]).unwrap_err();
    assert_eq!(error.path(), "scene.gravty");
    assert!(error.span().unwrap().start > 65_536);
    assert_eq!(CommandError::from(error).excerpt(), None);
}

/// Long keys around many values: each place written out would be gigabytes.
#[test]
fn long_keys_are_held_once() {
    let key = format!("\"{}\":", "k".repeat(20_000));
    let depth = 100;
    let values = "0,".repeat(200_000);
    let (open, close) = (format!("{{{key}").repeat(depth), "}".repeat(depth));
    let text = format!("{open}{{\"values\":[{values}0]}}{close}");
    assert!(is_refused(text.as_bytes(), false));
}

#[test]
fn sizes_that_nobody_means_are_refused() {
    let path =
        |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let cases = [
        (
            "pair",
            "control.intervals=1000001",
            "control.intervals",
            "1000000 intervals",
        ),
        (
            "pair",
            "control.intervals=1e18",
            "control.intervals",
            "a whole number",
        ),
        (
            "pair",
            "control.intervals=18446744073709551615",
            "control.intervals",
            "1000000 intervals",
        ),
        (
            "pair",
            "control.solver={\"max_iterations\":1000000000000}",
            "control.solver.max_iterations",
            "below",
        ),
        (
            "pair",
            "scene.chain.segments=1000000000",
            "chain.segments",
            "from 1 to 1000",
        ),
        (
            "pair_constant",
            "simulate.step=1e-300 s",
            "simulate.step",
            "1e8 steps",
        ),
        (
            "pair_constant",
            "simulate.duration=1e300 s",
            "simulate.step",
            "1e8 steps",
        ),
        (
            "pull_in",
            "equilibrium.path=18446744073709551615",
            "equilibrium.path",
            "1000000 points",
        ),
        (
            "clamped_stack",
            "scene.solids[0].box.elements=[1000000000,1,4]",
            "solids[0].box.elements",
            "1000000 elements",
        ),
        (
            "clamped_stack",
            "scene.solids[0].box.elements=[4294967296,4294967296,4]",
            "solids[0].box.elements",
            "1000000 elements",
        ),
        (
            "fe_trunk",
            "scene.chain.muscles.elements=[100,100,50]",
            "chain",
            "1000000 elements in all",
        ),
    ];
    for (problem, change, place, expected) in cases {
        let error = read_problem(&path(problem), &[change.to_owned()]).expect_err(change);
        let told = error.to_string();
        assert_eq!(error.path(), place, "{told}");
        assert!(error.expected().contains(expected), "{told}");
    }
}

/// An allowed number may still be more than the machine holds.
#[cfg(target_os = "linux")]
#[test]
fn what_the_memory_cannot_hold_is_refused_before_it_is_filled() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let redundant = ["control", "simulate"].map(|task| format!("{task}.coordinates=redundant"));
    let cases = [
        (
            "solve",
            "elephant_trunk",
            "control.intervals=1000000",
            redundant[0].as_str(),
        ),
        (
            "inspect",
            "elephant_trunk",
            "control.intervals=1000000",
            redundant[0].as_str(),
        ),
        (
            "simulate",
            "elephant_trunk_constant",
            "simulate.step=1e-6 s",
            redundant[1].as_str(),
        ),
        (
            "simulate",
            "creeping_block",
            "scene.solids[0].box.elements=[50,50,50]",
            "scene.gravity=[0,0,0]",
        ),
    ];
    for (command, problem, size, more) in cases {
        let mut program = assert_cmd::Command::cargo_bin("proboscis").unwrap();
        let output = program
            .current_dir(folder.path())
            .args([command, &path(problem), "--set", size, "--set", more])
            .output()
            .unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{size}: {err}");
        assert!(err.contains("GB of memory or more"), "{size}: {err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        assert!(!folder.path().join("results").exists(), "{size}");
    }
}
