//! The example of a robot and its controller in two processes: a second of a stiffer robot, which ends at the goal.

#[path = "../../examples/two_processes.rs"]
#[expect(dead_code, unreachable_pub, reason = "it is a program")]
mod example;

use std::net::TcpListener;
use std::process::{Command, Stdio};

const ADDRESS: &str = "PROBOSCIS_TEST_ADDRESS";

/// Not a test by itself: the process of the robot.
#[test]
fn as_robot() {
    if let Ok(address) = std::env::var(ADDRESS) {
        let [x, y] = example::robot(&address).unwrap();
        println!("\ntip {x} {y}");
    }
}

#[test]
fn a_stiffer_robot_in_another_process_ends_at_the_goal() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let robot = Command::new(std::env::current_exe().unwrap())
        .args(["two_processes::as_robot", "--exact", "--nocapture"])
        .env(ADDRESS, listener.local_addr().unwrap().to_string())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let planned = example::control(&listener).unwrap();
    assert_eq!(planned, 100);
    let out = robot.wait_with_output().unwrap();
    assert!(out.status.success());
    let out = String::from_utf8(out.stdout).unwrap();
    let line = out.lines().find_map(|line| line.strip_prefix("tip "));
    let tip: Vec<f64> = line
        .unwrap()
        .split(' ')
        .map(|x| x.parse().unwrap())
        .collect();
    // The angle of the goal as `tests/reference/pair.json` has it, and the arm of 50 mm.
    let angle = tip[0].atan2(tip[1]).abs();
    println!("{tip:?} {angle}");
    assert!((angle - 0.1514).abs() < 2e-3, "{angle}");
}
