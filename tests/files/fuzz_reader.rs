//! Kept files with something wrong in them are read or refused, never more: no panic, no endless work, no boundless memory.
//!
//! `make fuzz` holds each property for as long as one likes (`FUZZ_SECONDS`), and `PROPTEST_CASES` says how often it is held
//! here; `fuzz/` does the same with random bytes.

use proboscis::app::CommandError;
use proboscis::files::{SceneError, read_problem, read_scene};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};
use std::env::var;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tempfile::TempDir;

/// Names and texts of the kept scenes and problems; the largest block is left out for its size.
pub(crate) fn kept(folder: &str) -> Vec<(String, String)> {
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

/// Cases of a property where nobody asks for more.
const CASES: u32 = 150;

/// Holds a property for the cases or the time that are asked for, and tells how many there were where it is for long.
fn hold<S: Strategy>(name: &str, input: S, law: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let asked = |name: &str| var(name).ok().map(|text| text.parse::<u32>().unwrap());
    let (cases, seconds) = (asked("PROPTEST_CASES"), asked("FUZZ_SECONDS"));
    let config = ProptestConfig {
        cases: cases.unwrap_or(CASES),
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let began = Instant::now();
    let mut held = 0;
    loop {
        let answer = TestRunner::new(config.clone()).run(&input, &law);
        answer.unwrap_or_else(|failure| panic!("{name}: {failure}"));
        held += u64::from(config.cases);
        if began.elapsed().as_secs() >= seconds.unwrap_or(0).into() {
            break;
        }
    }
    if cases.or(seconds).is_some() {
        let seconds = began.elapsed().as_secs_f64();
        println!("{name}: {held} cases in {seconds:.0} s, nothing found");
    }
}

/// A folder with the kept scenes and the text of one problem or scene in `changed.json`.
pub(crate) fn beside_scenes(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let scenes = folder.path().join("scenes");
    fs::create_dir(&scenes).unwrap();
    let meshes = folder.path().join("meshes");
    fs::create_dir(&meshes).unwrap();
    for (to, from) in [(scenes, "problems/scenes"), (meshes, "problems/meshes")] {
        for (name, text) in kept(from) {
            fs::write(to.join(name), text).unwrap();
        }
    }
    let path = folder.path().join("changed.json");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// One line that names the file and says what is expected, and a place in its text.
fn check(error: SceneError, file: &str, is_text: bool) {
    let told = error.to_string();
    assert!(told.contains(file), "{told}");
    assert!(!told.contains(char::is_control), "{told:?}");
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
    let excerpt = CommandError::from(error).excerpt();
    // Lines that are longer than a page are not shown.
    assert!(is_text || excerpt.is_none(), "{told}");
    let is_shown = |c: char| c == '\n' || !c.is_control();
    let shown = excerpt.unwrap_or_default();
    assert!(shown.chars().all(is_shown), "{shown:?}");
    assert!(shown.len() < 30_000, "{told}");
}

thread_local! {
    /// The kept scenes; each thread writes what it changes beside them.
    static FOLDER: (TempDir, PathBuf) = beside_scenes(b"");
}

/// Reads a changed problem or scene; whether it was refused.
pub(crate) fn is_refused(bytes: &[u8], is_scene: bool) -> bool {
    let problem = FOLDER.with(|(_, path)| path.clone());
    // Each where its kept like stands, for what it names relative to itself.
    let path = match is_scene {
        true => problem.with_file_name("scenes").join("changed.json"),
        false => problem,
    };
    fs::write(&path, bytes).unwrap();
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

/// Values that an error of typing, or malice, puts in place of one.
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
        "sc\ne",
        "\u{1b}[31m",
        "\u{9b}2J",
        "\u{202e}lin",
        "</script><script>",
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
pub(crate) enum Change {
    Delete,
    Duplicate,
    Rename(&'static str),
    Replace(Value),
}

pub(crate) fn change() -> impl Strategy<Value = (Index, Change)> {
    let keys = ["", "sc\ne", "\u{1b}]0;x\u{7}", "\u{2028}", "a.b[0]", "name"];
    let change = prop_oneof![
        2 => Just(Change::Delete),
        2 => Just(Change::Duplicate),
        1 => select(keys.to_vec()).prop_map(Change::Rename),
        6 => wrong_value().prop_map(Change::Replace),
    ];
    (any::<Index>(), change)
}

/// One to three changes.
fn changes() -> impl Strategy<Value = Vec<(Index, Change)>> {
    prop::collection::vec(change(), 1..4)
}

/// The document changed at a place; an entry that is duplicated stands twice in its list, or under a second key.
fn apply(document: &mut Value, (place, change): &(Index, Change)) {
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
    let key = key.replace("~1", "/").replace("~0", "~");
    match document.pointer_mut(parent).unwrap() {
        Value::Object(entries) => {
            let value = entries[&key].clone();
            let other = match change {
                Change::Rename(name) => (*name).to_owned(),
                _ => format!("{key}2"),
            };
            if !matches!(change, Change::Duplicate) {
                entries.remove(&key);
            }
            if !matches!(change, Change::Delete) {
                entries.insert(other, value);
            }
        }
        Value::Array(entries) => {
            let index: usize = key.parse().unwrap();
            match change {
                Change::Delete => drop(entries.remove(index)),
                _ => entries.push(entries[index].clone()),
            }
        }
        _ => unreachable!("only lists and objects have parts"),
    }
}

/// The text with all changes.
fn changed(text: &str, changes: &[(Index, Change)]) -> String {
    let mut document: Value = serde_json::from_str(text).unwrap();
    for change in changes {
        apply(&mut document, change);
    }
    document.to_string()
}

#[test]
fn changed_problems_are_read_or_refused() {
    let input = (select(kept("problems")), changes());
    hold("changed problems", input, |((_, text), changes)| {
        is_refused(changed(&text, &changes).as_bytes(), false);
        Ok(())
    });
}

#[test]
fn changed_scenes_are_read_or_refused() {
    let input = (select(kept("problems/scenes")), changes());
    hold("changed scenes", input, |((_, text), changes)| {
        is_refused(changed(&text, &changes).as_bytes(), true);
        Ok(())
    });
}

#[test]
fn cut_texts_are_refused() {
    let input = (select(kept("problems")), any::<Index>());
    hold("cut texts", input, |((_, text), at)| {
        let complete = text.trim_end().len();
        prop_assert!(is_refused(&text.as_bytes()[..at.index(complete)], false));
        Ok(())
    });
}

#[test]
fn strange_bytes_are_read_or_refused() {
    let bytes = prop::collection::vec((any::<Index>(), any::<u8>()), 1..5);
    let input = (select(kept("problems")), bytes, any::<bool>());
    hold("strange bytes", input, |((_, text), bytes, inserted)| {
        let mut text = text.into_bytes();
        for (place, byte) in bytes {
            let at = place.index(text.len());
            match inserted {
                true => text.insert(at, byte),
                false => text[at] = byte,
            }
        }
        is_refused(&text, false);
        Ok(())
    });
}

#[test]
fn arbitrary_bytes_are_refused() {
    let input = prop::collection::vec(any::<u8>(), 0..200);
    hold("arbitrary bytes", input, |bytes| {
        prop_assert!(is_refused(&bytes, false));
        Ok(())
    });
}

#[test]
fn changed_solutions_are_read_or_refused() {
    let solution = json!({
        "time": [0, 0.1, 0.2],
        "voltages": { "muscle1": [0, 1], "muscle2": [0, 1700] },
    });
    let problem = json!({
        "scene": "scenes/pair.json",
        "simulate": { "duration": 1, "step": 0.1, "voltages": { "solution": "solution.json" } },
    });
    let (folder, path) = beside_scenes(problem.to_string().as_bytes());
    hold("changed solutions", changes(), |changes| {
        let text = changed(&solution.to_string(), &changes);
        fs::write(folder.path().join("solution.json"), text).unwrap();
        if let Err(error) = read_problem(&path, &[]) {
            check(error, ".json", true);
        }
        Ok(())
    });
}

#[test]
fn overrides_are_taken_or_refused() {
    let (_folder, path) = beside_scenes(kept("problems")[0].1.as_bytes());
    hold(
        "overrides",
        "[a-z.\\[\\]0-9=\"{}\\\\\\x00-\\x1f\\x7f-\\x9f]{0,40}",
        |written| {
            if let Err(error) = read_problem(&path, &[written]) {
                let told = error.to_string();
                let is_named = told.contains("command line") || told.contains(".json");
                prop_assert!(is_named, "{}", told);
                prop_assert!(!told.contains(char::is_control), "{told:?}");
            }
            Ok(())
        },
    );
}

/// Failures that long runs of the properties have found.
#[test]
fn found_before() {
    let mut scene: Value =
        serde_json::from_str(include_str!("../../problems/scenes/pair.json")).unwrap();
    // The square of a very short axis is zero; its direction is not.
    scene["chain"]["axis"] = json!([0, 1e-308, 0]);
    assert!(!is_refused(scene.to_string().as_bytes(), true));
    scene["chain"]["muscles"]["rest_length"] = json!("1.2e308 mm");
    scene["chain"]["muscles"]["arm"] = json!("1.2e308 mm");
    assert!(is_refused(scene.to_string().as_bytes(), true));
    // A carriage return sets a terminal back to the start of its line.
    assert!(is_refused(b"{ \r\n \"na\rme\": 1 }\r\n", true));
    for text in ["sc\ne", "\u{1b}[31mred", "\u{9b}2J", "\u{202e}lin"] {
        for scene in [json!({ text: 1 }), json!({ "name": text })] {
            assert!(is_refused(scene.to_string().as_bytes(), true), "{text:?}");
            // Characters as they are, not as escapes of JSON.
            let raw = format!("{{ \"{text}\": 1 }}");
            assert!(is_refused(raw.as_bytes(), true), "{text:?}");
        }
    }
}
