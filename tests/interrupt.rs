//! Ctrl-C stops a solve in good order; pressed twice it ends the process; what a killed program started ends with it.

mod common;

use std::io::{self, BufRead, BufReader};
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, thread};

use common::programs::{HS071_START, hs071};
use common::signals::Listening as _;
use proboscis::ipopt::{Options, StartingPoint, solve};
use proboscis::nlp::Status;
use proboscis::stop;

/// Run in a process of its own by the next test: solves until interrupted, then waits for the second Ctrl-C.
#[test]
#[ignore = "part of another test"]
fn solves_until_interrupted() {
    stop::install(|words| println!("{words}"));
    stop::install(|_| panic!("only the first one counts"));
    assert!(!stop::requested());
    println!("\nready");
    let start = StartingPoint {
        x: HS071_START.to_vec(),
        costates: None,
    };
    let mut wait = |_: &_, _: &proboscis::ipopt::Reached<'_>| {
        // Leaves the core to others.
        thread::sleep(Duration::from_millis(1));
        ControlFlow::Continue(())
    };
    loop {
        let solution = solve(&mut hs071(), &start, &Options::default(), &mut wait)
            .expect("Ipopt can be called");
        if solution.status == Status::Interrupted {
            break;
        }
    }
    assert!(stop::requested());
    println!("\nstopped");
    // Until the second one, or until nobody waits for it.
    io::copy(&mut io::stdin().lock(), &mut io::sink()).expect("an input without an end");
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
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn_listening()
        .expect("it can be run again");
    let _input = child.stdin.take();
    let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
    let mut wait_for = |word| lines.any(|line| line.expect("text") == word);
    assert!(wait_for("ready"));
    common::signals::interrupt(&child);
    assert!(wait_for("stopped"));
    common::signals::interrupt(&child);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
}

/// Processes that a killed program leaves running.
#[cfg(target_os = "linux")]
mod killed {
    use std::fs;
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::thread;
    use std::time::Duration;

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

    /// Seconds of computing that the processes of a group have taken.
    fn seconds(group: u32) -> f64 {
        let group = group.to_string();
        let entries = fs::read_dir("/proc").expect("it is there");
        let ticks = entries.filter_map(|entry| {
            let stat = fs::read_to_string(entry.ok()?.path().join("stat")).ok()?;
            let words: Vec<&str> = stat.rsplit(") ").next()?.split(' ').collect();
            // State, parent, group; user and system time are the 12th and 13th.
            let is_of_group = words.get(2) == Some(&group.as_str());
            let time = |at: usize| words.get(at)?.parse::<f64>().ok();
            is_of_group.then(|| Some(time(11)? + time(12)?))?
        });
        // A hundred ticks are a second.
        0.01 * ticks.sum::<f64>()
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
            // Looks again until it is so; where it never is, the limit of the whole suite ends this test.
            let wait_until = |is_so: &mut dyn FnMut() -> bool| {
                while !is_so() {
                    thread::sleep(Duration::from_millis(10));
                }
            };
            let mut has_ended = || program.try_wait().expect("its state").is_some();
            wait_until(&mut || running(group) > 1 || has_ended());
            // Until they compute, so that not the beginning alone is seen: a run reads for less than a tenth of a second.
            wait_until(&mut || seconds(group) > 0.5 || has_ended());
            assert!(!has_ended(), "{arguments:?}: too short a run");
            program.kill().expect("it runs");
            program.wait().expect("it ends");
            wait_until(&mut || running(group) == 0);
        }
    }
}
