//! Ctrl-C stops a solve in good order; pressed twice it ends the process.

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
    let mut wait = |_: &_, _: &[f64]| {
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
