//! The example of a robot and its controller in two processes: a second of a robot of finite elements, of which the controller knows a lumped one.

#[path = "../../examples/two_processes.rs"]
#[expect(dead_code, unreachable_pub, reason = "it is a program")]
mod example;

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::process::{Command, Stdio};

const ADDRESS: &str = "PROBOSCIS_TEST_ADDRESS";
const PROBLEM: &str = "PROBOSCIS_TEST_PROBLEM";

/// Not a test by itself: the process of the robot.
#[test]
fn as_robot() {
    if let Ok(address) = std::env::var(ADDRESS) {
        let problem = std::env::var(PROBLEM).unwrap();
        let problem: Vec<String> = problem.lines().map(str::to_owned).collect();
        let [x, y, _] = example::robot(&address, &problem).unwrap()["tip"];
        println!("\ntip {x} {y}");
    }
}

/// Numbers of answers by their origin, and the angle of the arm in the end.
fn played(problem: &[String]) -> (BTreeMap<&'static str, usize>, f64) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let robot = Command::new(std::env::current_exe().unwrap())
        .args(["two_processes::as_robot", "--exact", "--nocapture"])
        .env(ADDRESS, listener.local_addr().unwrap().to_string())
        .env(PROBLEM, problem.join("\n"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let sources = example::control(&listener, problem).unwrap();
    let out = robot.wait_with_output().unwrap();
    assert!(out.status.success());
    let out = String::from_utf8(out.stdout).unwrap();
    let line = out.lines().find_map(|line| line.strip_prefix("tip "));
    let tip: Vec<f64> = line
        .unwrap()
        .split(' ')
        .map(|x| x.parse().unwrap())
        .collect();
    (sources, tip[0].atan2(tip[1]).abs())
}

/// The angle of the goal as `tests/reference/pair.json` has it.
const GOAL: f64 = 0.1514;

#[test]
fn a_robot_of_finite_elements_in_another_process_ends_at_the_goal() {
    let (sources, angle) = played(&example::usual());
    println!("{sources:?} {angle}");
    assert_eq!(sources, BTreeMap::from([("plan", 100)]));
    assert!((angle - GOAL).abs() < 2e-3, "{angle}");
    // Without constant disturbances it ends beside it: the robot is another one.
    let mut unaware = example::usual();
    let controller = r#"simulate.controller={"horizon":{"problem":"pair.json","intervals":10},"noise":{"angle":"0.01 deg"}}"#;
    *unaware.last_mut().unwrap() = controller.to_owned();
    let (_, angle) = played(&unaware);
    println!("{angle}");
    assert!((angle - GOAL).abs() > 5e-3, "{angle}");
}
