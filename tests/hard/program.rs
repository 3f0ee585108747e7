//! The program as its users meet it, watched: what it writes has to be sound however it ends.

use crate::common::vtk_arrays::unpacked;
use assert_cmd::Command;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// A run that takes longer hangs: the slowest takes a fiftieth of it.
const LIMIT: Duration = Duration::from_secs(300);

/// Entries of `summary.json` that say nothing where nothing is known.
const UNKNOWN: [&str; 4] = ["is_stable", "unstable_directions", "jacobian", "hessian"];

/// Results of a run.
#[derive(Debug)]
pub(crate) struct Run {
    folder: TempDir,
    /// Exit status.
    pub(crate) exit: i32,
    /// Standard error.
    pub(crate) err: String,
    /// `summary.json`, where it was written.
    pub(crate) summary: Value,
}

/// Runs a problem about a scene and checks that whatever it left is sound.
pub(crate) fn run(scene: &Value, problem: &Value) -> Run {
    run_with(scene, problem, &[], &[])
}

/// Runs with further words on the command line and environment variables.
pub(crate) fn run_with(
    scene: &Value,
    problem: &Value,
    words: &[&str],
    variables: &[(&str, &str)],
) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let mut file = problem.clone();
    file["scene"] = scene.clone();
    fs::write(folder.path().join("problem.json"), file.to_string()).unwrap();
    let mut command = Command::cargo_bin("proboscis").unwrap();
    command
        .current_dir(folder.path())
        .args(["solve", "problem.json", "-o", "out"])
        .args(words)
        .envs(variables.iter().copied())
        .timeout(LIMIT);
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(output.stdout), text(output.stderr));
    let exit = output.status.code();
    let exit = exit.unwrap_or_else(|| panic!("ended by a signal, or hung: {out}{err}"));
    assert!(!err.contains("panicked"), "{err}");
    assert!((0..=2).contains(&exit), "{exit}: {out}{err}");
    let results = folder.path().join("out");
    let summary = match fs::read_to_string(results.join("summary.json")) {
        Ok(text) => serde_json::from_str(&text).unwrap(),
        Err(_) => json!({}),
    };
    if results.exists() {
        let status = summary["status"].as_str().expect("a status");
        let done = [
            "feasible_point",
            "solved",
            "acceptable",
            "simulated",
            "at_rest",
            "path_followed",
        ];
        assert_eq!(exit == 0, done.contains(&status), "{status}: {out}{err}");
        check_folder(&results, exit == 0);
    }
    // A refusal says why.
    assert!(exit == 0 || !err.trim().is_empty(), "{out}");
    Run {
        folder,
        exit,
        err,
        summary,
    }
}

impl Run {
    /// The status word of an answer.
    pub(crate) fn status(&self) -> &str {
        self.summary["status"].as_str().unwrap_or_default()
    }

    /// The same, of a run that answers.
    pub(crate) fn solved(self) -> Self {
        assert_eq!(self.exit, 0, "{}", self.err);
        self
    }

    /// The first line of a refusal, without the name of the file.
    pub(crate) fn refusal(&self) -> String {
        assert_ne!(self.exit, 0, "it was not refused: {}", self.summary);
        let line = self.err.lines().next().unwrap_or_default();
        let line = line.strip_prefix("error: problem.json: ").unwrap_or(line);
        line.to_owned()
    }

    /// A number of `summary.json`.
    pub(crate) fn number(&self, path: &[&str]) -> f64 {
        let entry = path.iter().fold(&self.summary, |value, key| &value[*key]);
        let number = entry.as_f64();
        number.unwrap_or_else(|| panic!("no number at {path:?}: {}", self.summary))
    }

    /// A column of `trajectory.csv` by its name without the unit.
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        table(&self.results().join("trajectory.csv"), name)
    }

    /// A column of `controls.csv` by its name without the unit.
    pub(crate) fn voltages(&self, name: &str) -> Vec<f64> {
        table(&self.results().join("controls.csv"), name)
    }

    /// A column of `path.csv` by its name without the unit.
    pub(crate) fn path(&self, name: &str) -> Vec<f64> {
        table(&self.results().join("path.csv"), name)
    }

    /// The folder of the results.
    pub(crate) fn results(&self) -> PathBuf {
        self.folder.path().join("out")
    }
}

/// Points of a curve.
pub(crate) fn points(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    x.iter().zip(y).map(|(&x, &y)| [x, y]).collect()
}

/// Largest magnitude of a list that is not empty.
pub(crate) fn largest(list: &[f64]) -> f64 {
    assert!(!list.is_empty());
    list.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Largest difference of two lists of one length.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

fn table(path: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().skip(1);
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let is_it = |cell: &&str| cell.split(" [").next() == Some(name);
    let column = header.iter().position(is_it);
    let column = column.unwrap_or_else(|| panic!("no {name} in {header:?}"));
    lines
        .map(|line| line.split(',').nth(column).unwrap().parse().unwrap())
        .collect()
}

/// Checks the files of a run; where it failed, a table may have cells without a number.
fn check_folder(folder: &Path, is_answer: bool) {
    let mut seen = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            check_folder(&path, is_answer);
            continue;
        }
        // Arrays in a zip archive, which ends with its directory.
        if path.extension().is_some_and(|kind| kind == "npz") {
            let bytes = fs::read(&path).unwrap();
            assert!(bytes[bytes.len() - 22..].starts_with(b"PK\x05\x06"));
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let kind = path.extension().and_then(|e| e.to_str()).unwrap();
        let place = path.file_name().unwrap().to_str().unwrap();
        match kind {
            "json" => check_json(&serde_json::from_str(&text).unwrap(), place),
            "csv" => check_csv(&text, place, is_answer),
            "vtu" => check_arrays(&text, place),
            // The code of the page names what is no number.
            "html" => {
                let data = text.split("id=\"data\">").nth(1).unwrap();
                check_words(data.split("</script>").take(1), place);
            }
            _ => check_words([text.as_str()].into_iter(), place),
        }
        seen += 1;
    }
    assert!(seen > 0, "{} is empty", folder.display());
}

/// No entry is a null but those that may be unknown, and no text names a number that is none.
fn check_json(value: &Value, place: &str) {
    match value {
        Value::Object(entries) => {
            for (key, entry) in entries {
                if !(entry.is_null() && UNKNOWN.contains(&key.as_str())) {
                    check_json(entry, &format!("{place}: {key}"));
                }
            }
        }
        Value::Array(entries) => entries.iter().for_each(|entry| check_json(entry, place)),
        Value::Null => panic!("{place} is null"),
        Value::String(text) => check_words([text.as_str()].into_iter(), place),
        Value::Number(_) | Value::Bool(_) => {}
    }
}

fn check_csv(text: &str, place: &str, is_full: bool) {
    for line in text.lines().skip(2) {
        for cell in line.split(',') {
            if cell.is_empty() && !is_full {
                continue;
            }
            let number: f64 = cell
                .parse()
                .unwrap_or_else(|_| panic!("{place}: {cell} is no number"));
            assert!(number.is_finite(), "{place}: {cell}");
        }
    }
}

fn check_words<'a>(parts: impl Iterator<Item = &'a str>, place: &str) {
    for part in parts {
        let mut words = part.split(|c: char| !c.is_alphanumeric());
        let wrong = words.find(|word| ["NaN", "inf", "Infinity"].contains(word));
        assert_eq!(wrong, None, "{place}");
    }
}

/// The arrays of a ParaView file.
fn check_arrays(text: &str, place: &str) {
    let mut seen = 0;
    for array in text.split("<DataArray type=\"Float64\"").skip(1) {
        let content = array.split_once('>').unwrap().1;
        let content = content.split("</DataArray>").next().unwrap();
        for number in unpacked(content).chunks_exact(8) {
            let number = f64::from_le_bytes(number.try_into().unwrap());
            assert!(number.is_finite(), "{place}: {number}");
            seen += 1;
        }
    }
    assert!(seen > 0, "{place} has no numbers");
}

#[test]
fn numbers_that_are_none_are_found() {
    let caught = |check: &dyn Fn()| {
        let check = std::panic::AssertUnwindSafe(check);
        std::panic::catch_unwind(check).is_err()
    };
    check_csv("#\na,b\n1.0,2e-3\n", "good", true);
    assert!(caught(&|| check_csv("#\na,b\n1.0,NaN\n", "bad", false)));
    check_json(&json!({ "is_stable": null, "x": [1.0] }), "good");
    assert!(caught(&|| check_json(&json!({ "x": [1.0, null] }), "bad")));
    check_words(["not solved (infeasible), info"].into_iter(), "good");
    assert!(caught(&|| check_words(
        ["<path d=\"1,inf\">"].into_iter(),
        "bad"
    )));
    let array = |x: f64| {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
        packer.write_all(&x.to_le_bytes()).unwrap();
        let packed = packer.finish().unwrap();
        // One block of eight bytes, no shorter last one.
        let head = [1, 8, 0, packed.len() as u64]
            .map(u64::to_le_bytes)
            .concat();
        let data = [head, packed].map(|bytes| STANDARD.encode(bytes)).concat();
        format!("<DataArray type=\"Float64\" Name=\"J\" format=\"binary\">{data}</DataArray>")
    };
    check_arrays(&array(1.0), "good");
    assert!(caught(&|| check_arrays(&array(f64::NAN), "bad")));
}
