//! Kept files with something wrong in them are read or refused, never more: no panic, no endless work, no boundless memory.
//!
//! `fuzz/` does the same with random bytes, for as long as one likes.

use proboscis::run::RunError;
use proboscis::scene::{SceneError, read_problem, read_scene};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Names and texts of the kept scenes and problems; the largest block is left out for its size.
fn kept(folder: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let paths = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let is_kept = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        path.is_file() && !name.contains("schema") && name != "block.json"
    };
    let mut files: Vec<_> = paths
        .filter(is_kept)
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect();
    files.sort();
    files
}

/// A folder with the kept scenes and the text of one problem or scene in `changed.json`.
fn beside_scenes(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let scenes = folder.path().join("scenes");
    fs::create_dir(&scenes).unwrap();
    for (name, text) in kept("problems/scenes") {
        fs::write(scenes.join(name), text).unwrap();
    }
    let path = folder.path().join("changed.json");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// One line that names the file and says what is expected, and a place in its text.
fn check(error: SceneError, file: &str, is_text: bool) {
    let told = error.to_string();
    assert!(told.contains(file), "{told}");
    assert!(!told.contains('\n'), "{told}");
    assert!(
        told.contains("found ") && told.contains("expected "),
        "{told}"
    );
    assert!(
        told.len() < 2000,
        "{} characters: {}",
        told.len(),
        &told[..200]
    );
    assert_eq!(error.span().is_some(), is_text, "{told}");
    let excerpt = RunError::from(error).excerpt();
    // Lines that are longer than a page are not shown.
    assert!(is_text || excerpt.is_none(), "{told}");
    assert!(excerpt.is_none_or(|text| text.len() < 30_000), "{told}");
}

/// Reads a changed problem or scene; whether it was refused.
fn is_refused(bytes: &[u8], is_scene: bool) -> bool {
    let (_folder, path) = beside_scenes(bytes);
    let is_text = std::str::from_utf8(bytes).is_ok();
    let answer = match is_scene {
        true => read_scene(&path).map(|_| ()),
        false => read_problem(&path, &[]).map(|_| ()),
    };
    let refused = answer.is_err();
    if let Err(error) = answer {
        check(error, ".json", is_text);
    }
    refused
}

/// Places of all values of a document, as JSON pointers.
fn pointers(value: &Value, here: &str, all: &mut Vec<String>) {
    all.push(here.to_owned());
    match value {
        Value::Object(entries) => entries.iter().for_each(|(key, entry)| {
            let key = key.replace('~', "~0").replace('/', "~1");
            pointers(entry, &format!("{here}/{key}"), all);
        }),
        Value::Array(entries) => entries.iter().enumerate().for_each(|(index, entry)| {
            pointers(entry, &format!("{here}/{index}"), all);
        }),
        _ => {}
    }
}

fn nested(depth: usize) -> Value {
    (0..depth).fold(json!(0), |inner, _| json!([inner]))
}

/// What a slip of the pen, or malice, writes in place of a value.
fn wrong_value() -> impl Strategy<Value = Value> {
    let numbers = select(vec![
        0.0, -1.0, 1e308, -1e308, 1e-308, 5e-324, 1e18, 0.5, 1e9,
    ]);
    let whole = select(vec![
        0,
        1,
        u64::MAX,
        1_000_000_000,
        1_000_000,
        2_147_483_648,
    ]);
    let texts = [
        "",
        "NaN",
        "inf",
        "1e999 mm",
        "1e308 mm",
        "-3 kV",
        "1 m^2147483648",
        "1 m^-9999999999999",
        "1 m/s/s/s/",
        "5 / s",
        "µ",
        "1 kg m s V",
        "ground",
        "segment1",
        "../..",
        "\0",
        "🐘",
    ];
    prop_oneof![
        numbers.prop_map(|number| json!(number)),
        whole.prop_map(|number| json!(number)),
        select(texts.to_vec()).prop_map(|text| json!(text)),
        "[0-9.eE+ */^a-zµ()-]{0,12}".prop_map(|text| json!(text)),
        Just(json!(true)),
        Just(Value::Null),
        Just(json!([])),
        Just(json!({})),
        Just(json!([0, 0, 0])),
        Just(json!({ "name": 1, "at": {} })),
        Just(json!(vec![0; 50_000])),
        Just(json!("x".repeat(100_000))),
        (1_usize..300).prop_map(nested),
    ]
}

/// Changes of the values of a document.
#[derive(Clone, Debug)]
enum Change {
    Delete,
    Duplicate,
    Replace(Value),
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        1 => Just(Change::Delete),
        1 => Just(Change::Duplicate),
        3 => wrong_value().prop_map(Change::Replace),
    ]
}

/// The document changed at a place; an entry that is duplicated stands twice in its list, or under a second key.
fn apply(document: &mut Value, place: Index, change: &Change) {
    let mut all = Vec::new();
    pointers(document, "", &mut all);
    let pointer = place.get(&all);
    if let Change::Replace(value) = change {
        *document.pointer_mut(pointer).unwrap() = value.clone();
        return;
    }
    let Some((parent, key)) = pointer.rsplit_once('/') else {
        return;
    };
    match (document.pointer_mut(parent).unwrap(), change) {
        (Value::Object(entries), Change::Delete) => drop(entries.remove(key)),
        (Value::Object(entries), _) => {
            let copy = entries.get(key).cloned();
            entries.extend(copy.map(|value| (format!("{key}2"), value)));
        }
        (Value::Array(entries), Change::Delete) => drop(entries.remove(key.parse().unwrap())),
        (Value::Array(entries), _) => {
            let copy = entries[key.parse::<usize>().unwrap()].clone();
            entries.push(copy);
        }
        _ => unreachable!("only lists and objects have parts"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_problems_are_read_or_refused(
        (_, text) in select(kept("problems")),
        changes in prop::collection::vec((any::<Index>(), change()), 1..4),
    ) {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        for (place, change) in &changes {
            apply(&mut document, *place, change);
        }
        is_refused(document.to_string().as_bytes(), false);
    }

    #[test]
    fn changed_scenes_are_read_or_refused(
        (_, text) in select(kept("problems/scenes")),
        changes in prop::collection::vec((any::<Index>(), change()), 1..4),
    ) {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        for (place, change) in &changes {
            apply(&mut document, *place, change);
        }
        is_refused(document.to_string().as_bytes(), true);
    }

    #[test]
    fn cut_texts_are_refused((_, text) in select(kept("problems")), at in any::<Index>()) {
        let complete = text.trim_end().len();
        prop_assert!(is_refused(&text.as_bytes()[..at.index(complete)], false));
    }

    #[test]
    fn strange_bytes_are_read_or_refused(
        (_, text) in select(kept("problems")),
        bytes in prop::collection::vec((any::<Index>(), any::<u8>()), 1..5),
        inserted in any::<bool>(),
    ) {
        let mut text = text.into_bytes();
        for (place, byte) in bytes {
            let at = place.index(text.len());
            match inserted {
                true => text.insert(at, byte),
                false => text[at] = byte,
            }
        }
        is_refused(&text, false);
    }

    #[test]
    fn arbitrary_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(is_refused(&bytes, false));
    }

    #[test]
    fn changed_solutions_are_read_or_refused(
        changes in prop::collection::vec((any::<Index>(), change()), 1..4),
    ) {
        let mut solution = json!({
            "time": [0, 0.1, 0.2],
            "voltages": { "muscle1": [0, 1], "muscle2": [0, 1700] },
        });
        for (place, change) in &changes {
            apply(&mut solution, *place, change);
        }
        let problem = json!({
            "scene": "scenes/pair.json",
            "simulate": { "duration": 1, "step": 0.1, "voltages": { "solution": "solution.json" } },
        });
        let (folder, path) = beside_scenes(problem.to_string().as_bytes());
        fs::write(folder.path().join("solution.json"), solution.to_string()).unwrap();
        if let Err(error) = read_problem(&path, &[]) {
            check(error, ".json", true);
        }
    }

    #[test]
    fn overrides_are_taken_or_refused(override_ in "[a-z.\\[\\]0-9=\"{}]{0,40}") {
        let (_folder, path) = beside_scenes(kept("problems")[0].1.as_bytes());
        if let Err(error) = read_problem(&path, &[override_]) {
            let told = error.to_string();
            prop_assert!(told.contains("command line") || told.contains(".json"), "{}", told);
        }
    }
}

#[test]
fn kept_files_are_read() {
    for (folder, is_scene) in [("problems", false), ("problems/scenes", true)] {
        let files = kept(folder);
        assert!(files.len() > 5, "{files:?}");
        for (name, text) in files {
            let needs_a_solution = text.contains("\"solution\"");
            assert_eq!(
                is_refused(text.as_bytes(), is_scene),
                needs_a_solution,
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
    assert_eq!(RunError::from(error).excerpt(), None);
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

/// What is allowed as a number may still be more than the machine holds.
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
            "simulate.step=1e-8 s",
            redundant[1].as_str(),
        ),
        (
            "simulate",
            "clamped_stack_step",
            "scene.solids[0].box.elements=[100,100,100]",
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
