//! Files of results are whole: whoever kills the program, wherever the disk is full, whatever the solver met.
#![cfg(unix)]

use crate::common::random::Random;
use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};
use tempfile::{TempDir, tempdir};

fn problem(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"))
}

/// A run with its results in `out` of a folder.
struct Run {
    command: &'static str,
    problem: &'static str,
    set: Vec<String>,
}

impl Run {
    fn new(command: &'static str, problem: &'static str, set: &[&str]) -> Self {
        let set = set.iter().map(|&change| change.to_owned()).collect();
        Self {
            command,
            problem,
            set,
        }
    }

    /// The words after the name of the program.
    fn words(&self) -> Vec<String> {
        let path = problem(self.problem).display().to_string();
        let head = [self.command.to_owned(), path];
        let set = self
            .set
            .iter()
            .flat_map(|c| ["--set".to_owned(), c.clone()]);
        let tail = ["-o", "out", "--quiet"].map(str::to_owned);
        head.into_iter().chain(set).chain(tail).collect()
    }

    fn command(&self, folder: &Path) -> Command {
        let mut command = Command::new(cargo_bin("proboscis"));
        command.current_dir(folder).args(self.words());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command
    }
}

/// Names of the files of a folder and of `fields` within it.
fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut all = BTreeSet::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(files(&path)),
            false => drop(all.insert(path)),
        }
    }
    all
}

fn is_partial(path: &Path) -> bool {
    let name = path.file_name().unwrap().to_string_lossy();
    name.starts_with('.') && name.ends_with(".partial")
}

/// Checks that each file is complete, and where there is a summary that all are of its run; `intervals` are those of the runs that may have
/// written them.
fn check_whole(folder: &Path, intervals: &[usize]) -> usize {
    let all: Vec<PathBuf> = files(folder)
        .into_iter()
        .filter(|f| !is_partial(f))
        .collect();
    let summary = fs::read_to_string(folder.join("summary.json")).ok();
    let summary: Option<Value> = summary.map(|text| serde_json::from_str(&text).unwrap());
    let of_summary = summary.map(|summary| {
        let count = summary.get("intervals").or(summary.get("steps"));
        [count.unwrap().as_u64().unwrap() as usize]
    });
    let intervals = of_summary.as_ref().map_or(intervals, |count| {
        assert!(intervals.contains(&count[0]), "{count:?}");
        count
    });
    for path in &all {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        // Arrays in a zip archive, which ends with its directory.
        if path.extension().is_some_and(|end| end == "npz") {
            let bytes = fs::read(path).unwrap();
            assert!(
                bytes[bytes.len() - 22..].starts_with(b"PK\x05\x06"),
                "{name}"
            );
            continue;
        }
        let text = fs::read_to_string(path).unwrap();
        let told = || format!("{name}, {} bytes", text.len());
        let one_of = |count: usize, more: usize| intervals.iter().any(|n| n + more == count);
        match path.extension().and_then(|end| end.to_str()).unwrap() {
            "json" => {
                let value: Value =
                    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", told()));
                let keys: &[&str] = match name.as_str() {
                    "solution.json" => &["time", "voltages", "state"],
                    "summary.json" => &["command", "status", "seconds", "versions"],
                    other => panic!("{other}"),
                };
                assert!(
                    keys.iter().all(|key| value.get(key).is_some()),
                    "{}",
                    told()
                );
                if name == "solution.json" {
                    assert!(
                        one_of(value["time"].as_array().unwrap().len(), 1),
                        "{}",
                        told()
                    );
                }
            }
            "csv" => {
                let rows: Vec<usize> = text.lines().skip(1).map(|l| l.split(',').count()).collect();
                assert!(
                    text.ends_with('\n') && text.starts_with("# proboscis"),
                    "{}",
                    told()
                );
                assert!(rows.iter().all(|&cells| cells == rows[0]), "{}", told());
                let more = usize::from(name == "trajectory.csv");
                assert!(
                    one_of(rows.len() - 1, more),
                    "{}: {} rows",
                    told(),
                    rows.len()
                );
            }
            "svg" => assert!(text.trim_end().ends_with("</svg>"), "{}", told()),
            "html" => assert!(text.trim_end().ends_with("</html>"), "{}", told()),
            "vtu" | "pvd" => assert!(text.trim_end().ends_with("</VTKFile>"), "{}", told()),
            other => panic!("a file of an unknown kind {other}: {}", told()),
        }
    }
    all.len()
}

/// Kills two runs by turns at random times of their lives and looks at the files each time.
fn kill(runs: [Run; 2], intervals: [usize; 2], trials: usize, seed: u64) -> (TempDir, usize) {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let life = runs.each_ref().map(|run| {
        let began = Instant::now();
        assert!(run.command(folder.path()).status().unwrap().success());
        began.elapsed()
    });
    let mut life = life[0].min(life[1]);
    let complete = check_whole(&out, &intervals);
    assert!(complete > 8, "{complete} files");
    let mut random = Random(seed);
    let mut killed = 0;
    for trial in 0..trials {
        let mut child = runs[trial % 2].command(folder.path()).spawn().unwrap();
        std::thread::sleep(life.mul_f64(random.between(0.0, 1.2)));
        child.kill().unwrap();
        let is_killed = child.wait().unwrap().code().is_none();
        killed += usize::from(is_killed);
        // However fast the machine is by now, most trials come before the end, and some after it.
        life = life.mul_f64(if is_killed { 1.1 } else { 0.8 });
        let whole = check_whole(&out, &intervals);
        // A summary is gone while the files of another run take their names.
        let unnamed = usize::from(!out.join("summary.json").exists());
        assert_eq!(whole + unnamed, complete, "trial {trial}");
    }
    (folder, killed)
}

#[test]
fn a_killed_run_leaves_the_files_before_or_those_after() {
    let finer = Run::new("solve", "pair", &["control.intervals=24"]);
    let (folder, killed) = kill([Run::new("solve", "pair", &[]), finer], [20, 24], 30, 1);
    assert!(killed > 5, "{killed} were killed before their end");
    let out = folder.path().join("out");
    let partial = || files(&out).into_iter().filter(|f| is_partial(f)).count();
    // All files of a run are partial until the last one is written.
    let at_once = files(&out).len() - partial();
    assert!(partial() <= killed * at_once, "{} partial files", partial());

    // What is old is cleared by the next run, what is young may belong to another one.
    let long_ago = SystemTime::now() - Duration::from_secs(3600);
    File::create(out.join(".summary.json.abcdef.partial")).unwrap();
    for path in files(&out).iter().filter(|f| is_partial(f)) {
        let file = File::options().write(true).open(path).unwrap();
        file.set_modified(long_ago).unwrap();
    }
    File::create(out.join(".controls.csv.abcdef.partial")).unwrap();
    let run = Run::new("solve", "pair", &[]);
    assert!(run.command(folder.path()).status().unwrap().success());
    assert_eq!(partial(), 1);
    assert!(out.join(".controls.csv.abcdef.partial").exists());
}

#[test]
fn a_killed_simulation_of_a_block_leaves_whole_fields() {
    let run = |step: &str| {
        let coarse = "scene.solids[0].box.elements=[1,1,4]";
        let changes = [coarse, "simulate.duration=5 ms", step];
        Run::new("simulate", "clamped_stack_step", &changes)
    };
    let runs = [run("simulate.step=0.5 ms"), run("simulate.step=0.5 ms")];
    let (_, killed) = kill(runs, [10, 10], 10, 2);
    assert!(killed > 1, "{killed} were killed before their end");
}

/// A run that may write files of no more than so many blocks of the shell.
fn limited(run: &Run, folder: &Path, blocks: usize) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script]).arg(cargo_bin("proboscis"));
    command
        .args(run.words())
        .current_dir(folder)
        .output()
        .unwrap()
}

#[test]
fn where_a_file_cannot_be_written_all_others_stay_whole() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    assert!(
        Run::new("solve", "pair", &[])
            .command(folder.path())
            .status()
            .unwrap()
            .success()
    );
    let complete = check_whole(&out, &[20]);
    let finer = Run::new("solve", "pair", &["control.intervals=24"]);
    let mut told = BTreeSet::new();
    for blocks in [0, 1, 2, 4, 8, 12, 16, 24, 32, 64, 128, 500] {
        let output = limited(&finer, folder.path(), blocks);
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{blocks}: {err}");
        assert!(
            err.starts_with("error: cannot write out/"),
            "{blocks}: {err}"
        );
        told.insert(err);
        assert_eq!(check_whole(&out, &[20, 24]), complete, "{blocks}");
        assert!(files(&out).iter().all(|file| !is_partial(file)), "{blocks}");
    }
    assert!(told.len() > 2, "different files fail: {told:?}");
    // Nothing of the finer grid has taken a name.
    check_whole(&out, &[20]);
    let output = limited(&finer, folder.path(), 1_000_000);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(check_whole(&out, &[24]), complete);
}

#[test]
fn a_solve_that_cannot_be_evaluated_leaves_whole_files() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    assert!(
        Run::new("solve", "pair", &[])
            .command(folder.path())
            .status()
            .unwrap()
            .success()
    );
    check_whole(&out, &[20]);
    // Squares of these voltages are not finite.
    let changes = [
        "control.voltage_bounds=[\"0 V\",\"1e200 V\"]",
        "control.guess={\"simulate\":{\"voltages\":{\"muscle2\":\"1e180 V\"}}}",
    ];
    let output = Run::new("solve", "pair", &changes)
        .command(folder.path())
        .stdout(Stdio::piped())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text.starts_with("not solved (invalid number)"), "{text}");
    check_whole(&out, &[20]);
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["status"], "invalid_number");
    assert_eq!(summary["objective"], Value::Null);
    // The point itself is finite: another solve can begin there.
    let solution = fs::read_to_string(out.join("solution.json")).unwrap();
    assert!(!solution.contains("null"));
    let guess = format!(
        "control.guess={{\"solution\":{:?}}}",
        out.join("solution.json")
    );
    let changes = ["control.voltage_bounds=[\"0 V\",\"3 kV\"]", &guess];
    let output = Run::new("solve", "pair", &changes)
        .command(folder.path())
        .output()
        .unwrap();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
}
