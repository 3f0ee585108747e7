//! A process without what it takes for granted: where to write, threads, memory, room in files; and signals that ask it to stop.
#![cfg(unix)]

use crate::common::signals::Listening as _;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use rustix::process::geteuid;
use std::fs::{self, File, OpenOptions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;
use tempfile::{TempDir, tempdir};

/// A user of whom nothing runs.
const NOBODY: u32 = 59_731;
/// Time between two looks for what is to come.
const PATIENCE: Duration = Duration::from_millis(5);

fn program() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin("proboscis"))
}

fn problem(name: &str) -> String {
    format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"))
}

/// A file that is always full.
#[cfg(target_os = "linux")]
fn full() -> File {
    OpenOptions::new().write(true).open("/dev/full").unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn summary(folder: &Path) -> serde_json::Value {
    let text = fs::read_to_string(folder.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn words_that_cannot_be_written_change_no_status() {
    let folder = tempdir().unwrap();
    let pair = problem("pair");
    for (arguments, status) in [
        (&["solve", "nothing.json"][..], 2),
        (&["solve", &pair, "-o", "here", "--verbose"], 0),
        (&["solve", &pair, "-o", "here", "--max-iterations", "2"], 1),
        (&["no-such-command"], 2),
    ] {
        let run = || {
            let mut command = program();
            command.args(arguments).current_dir(folder.path());
            command
        };
        let told = run().output().unwrap();
        assert_eq!(told.status.code(), Some(status), "{}", errors(&told));
        assert!(!errors(&told).is_empty(), "{arguments:?} tells nothing");
        let untold = run().stderr(full()).output().unwrap();
        assert_eq!(untold.status.code(), Some(status), "{arguments:?}");
        assert_eq!(untold.stdout.is_empty(), told.stdout.is_empty());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_written_is_an_error() {
    let folder = tempdir().unwrap();
    let (pair, scene) = (problem("pair"), problem("scenes/pair"));
    for arguments in [
        &["expand", &scene][..],
        &["inspect", &pair],
        &["schema", "scene"],
        &["completions", "bash"],
        &["solve", &pair, "-o", "here", "--json"],
        &["--help"],
        &["--version"],
    ] {
        let mut command = program();
        command.args(arguments).current_dir(folder.path());
        let output = command.stdout(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let words = "error: cannot write the answer to standard output: ";
        let errors = errors(&output);
        assert!(
            errors.lines().any(|line| line.starts_with(words)),
            "{errors}"
        );
    }
}

#[test]
fn who_reads_an_answer_may_go() {
    let mut child = program()
        .args(["schema", "problem"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        (output.status.code(), errors(&output)),
        (Some(0), String::new())
    );
}

/// The program under a limit of `prlimit`, as a user of whom nothing else runs where this one may be another.
#[cfg(target_os = "linux")]
struct Limited {
    folder: TempDir,
    program: PathBuf,
}

#[cfg(target_os = "linux")]
impl Limited {
    fn new() -> Self {
        let folder = tempdir().unwrap();
        let all = |mode| fs::Permissions::from_mode(mode);
        fs::set_permissions(folder.path(), all(0o777)).unwrap();
        let program = folder.path().join("proboscis");
        fs::copy(assert_cmd::cargo::cargo_bin("proboscis"), &program).unwrap();
        fs::set_permissions(&program, all(0o755)).unwrap();
        fs::create_dir(folder.path().join("scenes")).unwrap();
        for name in ["pair", "elephant_trunk", "clamped_stack"] {
            for name in [format!("{name}.json"), format!("scenes/{name}.json")] {
                let from = format!("{}/problems/{name}", env!("CARGO_MANIFEST_DIR"));
                fs::copy(from, folder.path().join(name)).unwrap();
            }
        }
        Self { folder, program }
    }

    fn run(&self, limit: &str, arguments: &[&str]) -> Output {
        // What waits for ever ends some time, with a status that no test expects.
        let mut command = Command::new("timeout");
        command.args(["-s", "KILL", "300", "prlimit", limit]);
        command.arg(&self.program).args(arguments);
        command.current_dir(self.folder.path());
        if geteuid().is_root() {
            command.uid(NOBODY).gid(NOBODY);
        }
        command.output().unwrap()
    }
}

#[cfg(target_os = "linux")]
#[test]
fn where_no_thread_can_be_had_all_goes_on_without() {
    let limited = Limited::new();
    for arguments in [
        &["--version"][..],
        &["solve", "pair.json", "-o", "out"],
        &["solve", "pair.json", "-o", "starts", "--starts", "2"],
        &[
            "solve",
            "elephant_trunk.json",
            "-o",
            "trunk",
            "--set",
            "control.intervals=40",
        ],
        &["check", "pair.json"],
        &["equilibrium", "clamped_stack.json", "-o", "block"],
    ] {
        let output = limited.run("--nproc=1", arguments);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            errors(&output)
        );
    }
    // No thread changes no bit.
    let output = limited.run(
        "--nproc=4096",
        &[
            "solve",
            "elephant_trunk.json",
            "-o",
            "threads",
            "--set",
            "control.intervals=40",
        ],
    );
    assert!(output.status.success(), "{}", errors(&output));
    let objective = |name: &str| summary(&limited.folder.path().join(name))["objective"].clone();
    assert!(objective("trunk").is_f64());
    assert_eq!(objective("trunk"), objective("threads"));
}

#[cfg(target_os = "linux")]
#[test]
fn little_address_space_leads_to_a_result_or_one_message() {
    let limited = Limited::new();
    let run = |megabytes: usize, arguments: &[&str]| {
        limited.run(&format!("--as={}", megabytes * 1_000_000), arguments)
    };
    let version = |megabytes: usize| run(megabytes, &["--version"]).status.success();
    let least = (80..600).step_by(5).find(|&megabytes| version(megabytes));
    let least = least.expect("a program of no more than 600 MB");
    let refused = run(least - 5, &["--version"]);
    let told = errors(&refused);
    assert_eq!(refused.status.code(), Some(1), "{told}");
    assert!(told.starts_with("error: too little address space") && told.lines().count() == 1);
    // Further threads may take a part of what is left, or come too late for that.
    for megabytes in (least..least + 40).step_by(5) {
        for _ in 0..3 {
            let output = run(megabytes, &["solve", "pair.json", "-o", "out"]);
            assert!(
                output.status.success(),
                "{megabytes} MB: {}",
                errors(&output)
            );
        }
    }
    let block = ["solve", &problem("block"), "-o", "out"];
    let output = run(least + 40, &block);
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
    assert!(errors(&output).contains("of memory or more, and "));
    let mumps = "control.solver.ipopt={\"linear_solver\":\"mumps\"}";
    let output = run(
        least + 40,
        &["solve", "pair.json", "-o", "out", "--set", mumps],
    );
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
    assert!(
        errors(&output).contains("address space"),
        "{}",
        errors(&output)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_may_not_grow_is_not_there() {
    let limited = Limited::new();
    let output = limited.run("--fsize=2000", &["solve", "pair.json", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    let errors = errors(&output);
    assert!(
        errors.contains("cannot write ") && errors.contains("File too large"),
        "{errors}"
    );
    let names = fs::read_dir(limited.folder.path().join("out")).unwrap();
    let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    assert!(names.is_empty(), "{names:?}");
}

/// A solve that takes long, in a folder that is there when its first iterate is told.
fn long(folder: &Path, more: &[&str]) -> Child {
    program()
        .args(["solve", &problem("elephant_trunk_effort"), "-o", "out"])
        .args(["--set", "control.intervals=600"])
        .args(more)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(File::create(folder.join("errors")).unwrap())
        .spawn_listening()
        .unwrap()
}

/// Waits until a path exists, as long as the program runs.
fn wait_for(child: &mut Child, path: &Path) {
    while !path.exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        thread::sleep(PATIENCE);
    }
}

fn send(child: &Child, signal: Signal) {
    kill(Pid::from_raw(child.id().try_into().unwrap()), signal).unwrap();
}

#[test]
fn signals_that_end_a_process_end_it_with_the_results_so_far() {
    for signal in [
        Signal::SIGTERM,
        Signal::SIGHUP,
        Signal::SIGINT,
        Signal::SIGXCPU,
    ] {
        let folder = tempdir().unwrap();
        let mut child = long(folder.path(), &[]);
        wait_for(&mut child, &folder.path().join("out"));
        send(&child, signal);
        let status = child.wait().unwrap();
        let errors = fs::read_to_string(folder.path().join("errors")).unwrap();
        assert_eq!(status.code(), Some(1), "{signal}: {errors}");
        assert!(
            errors.contains("stopping; the results so far"),
            "{signal}: {errors}"
        );
        let out = folder.path().join("out");
        assert_eq!(summary(&out)["status"], "interrupted", "{signal}");
        assert!(out.join("solution.json").is_file(), "{signal}");
    }
}

#[test]
fn a_signal_that_was_ignored_before_is_ignored() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let mut child = Command::new("sh")
        .args(["-c", "trap '' HUP; exec \"$@\"", "sh"])
        .arg(assert_cmd::cargo::cargo_bin("proboscis"))
        .args(["solve", &problem("elephant_trunk_effort"), "-o", "out"])
        .args(["--set", "control.intervals=600"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn_listening()
        .unwrap();
    wait_for(&mut child, &out);
    send(&child, Signal::SIGHUP);
    send(&child, Signal::SIGHUP);
    assert_eq!(child.try_wait().unwrap(), None);
    send(&child, Signal::SIGTERM);
    let status = child.wait().unwrap();
    assert_eq!((status.code(), status.signal()), (Some(1), None));
}

/// A signal to the program alone, as of `kill`, and not to its group.
#[test]
fn processes_of_starts_stop_with_the_program_and_leave_their_results() {
    let folder = tempdir().unwrap();
    let mut child = long(folder.path(), &["--starts", "2", "--processes"]);
    wait_for(&mut child, &folder.path().join("out/starts/01"));
    send(&child, Signal::SIGTERM);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let summary = summary(&folder.path().join("out"));
    assert_eq!(summary["status"], "interrupted", "{summary}");
    assert!(folder.path().join("out/starts/01/solution.json").is_file());
}
