//! Inputs that are given as functions of time: they cost nothing, are verified by their functions, and hold or repeat only what they do.

use crate::loads::{loaded, solved};
use proboscis::control::BoundaryConditions;
use proboscis::control::problem::{BoundaryState, Control};
use proboscis::prelude::System;

/// The pendulum that a motor swings up in 1.2 s, in a wind, with further changes.
fn blown(wind: &str, more: &[&str]) -> (System, Control) {
    let mut changes = vec![format!("control.loads={{\"wind\": {wind}}}")];
    changes.extend(more.iter().map(|change| (*change).to_owned()));
    loaded(&changes)
}

fn refusal(system: &System, control: &Control) -> Option<String> {
    let error = BoundaryConditions::resolve(system, control, 20.0).err();
    error.map(|error| error.to_string())
}

#[test]
fn a_given_input_costs_nothing() {
    let (system, control) = blown("\"0.05 N\"", &[]);
    let optimum = solved(&system, &control);
    let motor = |row: &Vec<f64>| row[0] / 1e3;
    let voltages = &optimum.motion.voltages;
    let squares: f64 = voltages.iter().map(|row| motor(row).powi(2)).sum();
    let exact = squares * 1.2 / voltages.len() as f64;
    let wind = 0.05_f64.powi(2) * 1.2;
    let found = optimum.solution.objective;
    println!("{found} of the motor {exact}, wind {wind}");
    assert!(voltages.iter().all(|row| (row[1] - 0.05).abs() < 1e-12));
    assert!(wind > 1e-3 * exact && (found - exact).abs() < 1e-9 * exact);
}

#[test]
fn a_wind_that_the_intervals_miss_is_found_by_the_verification() {
    // In the middle of each interval of 20 ms it is zero.
    let fast = r#"{"sine": {"amplitude": "5 N", "period": "20 ms"}}"#;
    for (wind, is_missed) in [(fast, true), ("\"0 N\"", false)] {
        let (system, control) = blown(wind, &["control.intervals=60"]);
        let optimum = solved(&system, &control);
        let verified = optimum.resimulation.as_ref().unwrap();
        let error = verified.error.unwrap_or(f64::INFINITY);
        println!("{wind}: error {error}, {:?}", verified.cause);
        assert_eq!(error > 0.01, is_missed, "{error}");
    }
}

#[test]
fn nothing_is_held_or_repeated_under_a_function_that_goes_on() {
    let goal = r#"control.goal={"joint_angles": {"shoulder": "30 deg"}, "hold": "find"}"#;
    let sine = r#"{"sine": {"amplitude": "0.05 N", "period": "0.4 s"}}"#;
    let ramp = |time: &str| format!(r#"{{"ramp": {{"to": "0.05 N", "duration": "{time}"}}}}"#);
    for (wind, is_held) in [
        (sine.to_owned(), false),
        (ramp("2 s"), false),
        (ramp("1 s"), true),
    ] {
        let (system, control) = blown(&wind, &[goal]);
        let found = refusal(&system, &control);
        let told = found
            .as_ref()
            .is_some_and(|e| e.contains("constant from the end on"));
        assert_eq!((found.is_none(), told), (is_held, !is_held), "{found:?}");
    }
    for (wind, repeats) in [
        (sine.to_owned(), true),
        (sine.replace("0.4 s", "0.5 s"), false),
        (ramp("1 s"), false),
        ("\"0.05 N\"".to_owned(), true),
    ] {
        let (system, mut control) = blown(&wind, &[]);
        control.goal = BoundaryState::Periodic;
        let found = refusal(&system, &control);
        let told = found
            .as_ref()
            .is_some_and(|e| e.contains("does not repeat"));
        assert_eq!((found.is_none(), told), (repeats, !repeats), "{found:?}");
    }
    // Nor does it repeat in a time that is sought.
    let free = r#"control.duration={"min": "0.8 s", "max": "2 s", "guess": "1.2 s"}"#;
    let (system, mut control) = blown(sine, &[free]);
    control.goal = BoundaryState::Periodic;
    assert!(refusal(&system, &control).is_some_and(|e| e.contains("does not repeat")));
}
