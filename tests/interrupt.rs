//! Ctrl-C stops a solve in good order; pressed twice it ends the process; what a killed program started ends with it.

mod common;

use std::env;
use std::io::{BufRead, BufReader};
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use common::programs::{HS071_START, hs071};
use proboscis::ipopt::{Options, StartingPoint, Status, interrupt, solve};

/// Run in a process of its own by the next test: solves until interrupted, then waits for the second Ctrl-C.
#[test]
#[ignore = "part of another test"]
fn solves_until_interrupted() {
    interrupt::install();
    interrupt::install();
    assert!(!interrupt::requested());
    println!("\nready");
    let began = Instant::now();
    let start = StartingPoint {
        x: HS071_START.to_vec(),
        costates: None,
    };
    let mut wait = |_: &_, _: &proboscis::ipopt::Reached<'_>| {
        thread::sleep(Duration::from_millis(20));
        ControlFlow::Continue(())
    };
    loop {
        let solution = solve(&mut hs071(), &start, &Options::default(), &mut wait)
            .expect("Ipopt can be called");
        if solution.status == Status::Interrupted {
            break;
        }
        assert!(
            began.elapsed() < Duration::from_secs(20),
            "the signal never came"
        );
    }
    assert!(interrupt::requested());
    println!("\nstopped");
    thread::sleep(Duration::from_secs(20));
}

#[test]
fn ctrl_c_stops_the_solve_and_the_second_one_the_process() {
    let mut child = Command::new(env::current_exe().expect("the path of this test"))
        .args([
            "--ignored",
            "--exact",
            "--nocapture",
            "--test-threads=1",
            "solves_until_interrupted",
        ])
        .stdout(Stdio::piped())
        .spawn()
        .expect("it can be run again");
    let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
    let mut wait_for = |word| lines.any(|line| line.expect("text") == word);
    assert!(wait_for("ready"));
    common::signals::interrupt(&child);
    assert!(wait_for("stopped"));
    common::signals::interrupt(&child);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
}

/// What a killed program leaves running.
#[cfg(target_os = "linux")]
mod killed {
    use std::fs;
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::thread;
    use std::time::{Duration, Instant};

    /// Processes of a group that run; what has ended but was not waited for does not.
    fn running(group: u32) -> usize {
        let group = group.to_string();
        let entries = fs::read_dir("/proc").expect("it is there");
        let is_running = |path: &Path| {
            // Number (name) state parent group ...
            let stat = fs::read_to_string(path.join("stat")).unwrap_or_default();
            let after_name = stat.rsplit(") ").next().unwrap_or_default();
            let mut words = after_name.split(' ');
            !matches!(words.next(), None | Some("" | "Z" | "X")) && words.nth(1) == Some(&group)
        };
        let paths = entries.map(|entry| entry.expect("a name").path());
        paths.filter(|path| is_running(path)).count()
    }

    #[test]
    fn processes_end_with_the_program_that_started_them_when_it_is_killed() {
        let folder = tempfile::tempdir().expect("a folder");
        let problem =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk_effort.json");
        let sweep = serde_json::json!({
            "problem": problem,
            "set": { "control.intervals": 6000 },
            "vary": { "control.duration": ["0.2 s", "0.25 s"] }
        });
        fs::write(folder.path().join("sweep.json"), sweep.to_string()).expect("it can be written");
        let problem = problem.to_str().expect("a path");
        let commands = [
            &[
                "solve",
                problem,
                "--set",
                "control.intervals=6000",
                "--starts",
                "2",
                "--processes",
            ][..],
            &["sweep", "sweep.json", "--engine", "processes"],
        ];
        for arguments in commands {
            let mut program = Command::new(env!("CARGO_BIN_EXE_proboscis"))
                .args(arguments)
                .current_dir(folder.path())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .process_group(0)
                .spawn()
                .expect("it runs");
            let group = program.id();
            let wait_until = |is_so: fn(usize) -> bool, seconds| {
                let began = Instant::now();
                while !is_so(running(group)) && began.elapsed() < Duration::from_secs(seconds) {
                    thread::sleep(Duration::from_millis(10));
                }
                running(group)
            };
            let started = wait_until(|count| count > 1, 60);
            assert!(started > 1, "{arguments:?} starts no process");
            // Until they compute, so that not the beginning alone is seen.
            thread::sleep(Duration::from_millis(500));
            assert!(running(group) > 1, "{arguments:?}: too short a run");
            program.kill().expect("it runs");
            program.wait().expect("it ends");
            let left = wait_until(|count| count == 0, 10);
            if left > 0 {
                crate::common::signals::kill_group(&program);
            }
            assert_eq!(left, 0, "processes of {arguments:?} go on");
        }
    }
}
