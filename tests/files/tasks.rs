//! Tasks of problem files: methods, tables, solutions, given voltages.

use crate::scene::{Case, PROBLEM, SCENE, check, folder, mistake};
use proboscis::control::problem::{Afterwards, BoundaryState, TableEnd, Task, Voltages};
use proboscis::dynamics::Integrator;
use proboscis::files::{driven_voltages, each_once, read_problem};
use proboscis::math::Signal;
use proboscis::model::Response;
use std::fs;
use std::path::{Path, PathBuf};

/// Voltages of two sources in intervals of 500 ms, and afterwards.
fn in_steps(rows: [[f64; 3]; 2], afterwards: Afterwards, solution: Option<PathBuf>) -> Voltages {
    let steps = |values: [f64; 3]| Signal::Steps {
        ends: vec![500.0, 1000.0],
        values: values.to_vec(),
    };
    Voltages {
        signals: rows.map(steps).to_vec(),
        table: Some(TableEnd {
            time: 1000.0,
            afterwards,
            solution,
        }),
    }
}

#[test]
fn the_method_of_a_simulation_is_read_and_checked() {
    const SIMULATE: &str = r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "10 ms", "integrator": "midpoint" } }"#;
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"midpoint\"", "\"midpont\"", "simulate.integrator", "\"midpont\"", "\"midpoint\"", "midpont"),
        ("\"midpoint\"", "{ \"galerkin\": 0 }", "simulate.integrator.galerkin", "0", "a degree from 1 to 8", "0"),
        ("\"midpoint\"", "{ \"galerkin\": 9 }", "simulate.integrator.galerkin", "9", "a degree from 1 to 8", "9"),
        ("\"midpoint\"", "{ \"generalised_alpha\": 1.5 }", "simulate.integrator.generalised_alpha", "1.5", "from 0 to 1", "1.5"),
        ("\"midpoint\"", "{}", "simulate.integrator", "none of them", "exactly one of", "{}"),
        ("\"midpoint\"", "{ \"runge_kutta\": 4 }", "simulate.integrator.runge_kutta", "the key \"runge_kutta\"", "\"galerkin\"", "runge_kutta"),
    ];
    check(cases, SIMULATE, |problem| mistake(SCENE, problem, &[]));
    let method = |text: &str| {
        let (_folder, path) = folder(SCENE, &SIMULATE.replace("\"midpoint\"", text));
        let Task::Simulate(task) = read_problem(&path, &[]).expect("a problem").task else {
            panic!("a simulation")
        };
        task.solving.integrator
    };
    let alpha = |spectral_radius| Integrator::GeneralisedAlpha { spectral_radius };
    for (text, expected) in [
        ("\"midpoint\"", Integrator::Midpoint),
        ("\"implicit_euler\"", Integrator::ImplicitEuler),
        ("\"generalised_alpha\"", alpha(0.8)),
        ("{ \"generalised_alpha\": 0.5 }", alpha(0.5)),
        ("{ \"galerkin\": 3 }", Integrator::Galerkin { degree: 3 }),
    ] {
        assert_eq!(method(text), expected, "{text}");
    }
}

#[test]
fn simulation_and_solution_are_checked() {
    let simulate = r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "2 s" } }"#;
    let error = mistake(SCENE, simulate, &[]);
    assert_eq!(error.path(), "simulate.step");
    assert!(
        error.expected().contains("no longer than the duration"),
        "{error}"
    );

    let (folder, path) = folder(
        SCENE,
        r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "10 ms", "voltages": { "solution": "solution.json" }, "start": { "joint_rates": { "joint1": "2 rad/s", "joint2": "3 m/s" } } } }"#,
    );
    fs::write(
        folder.path().join("solution.json"),
        r#"{ "time": [0, 0.5, 1], "voltages": { "muscle1": [100, 200] }, "status": "solved" }"#,
    )
    .expect("a solution");
    let Task::Simulate(simulation) = read_problem(&path, &[]).expect("a simulation").task else {
        panic!("a simulation")
    };
    let rows = [[100.0, 200.0, 200.0], [0.0; 3]];
    assert_eq!(
        simulation.voltages,
        in_steps(
            rows,
            Afterwards::OfLastInterval,
            Some(folder.path().join("solution.json"))
        )
    );
    let BoundaryState::JointAngles { angles, rates, .. } = simulation.start else {
        panic!("joint angles")
    };
    assert!(angles.is_empty());
    assert_eq!((rates[&0], rates[&1]), (0.002, 3.0));
}

/// The voltages of a simulation with a table in place of them.
fn with_table(table: &str) -> Result<Voltages, String> {
    let problem = r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "10 ms", "voltages": TABLE } }"#;
    let (_folder, path) = folder(SCENE, &problem.replace("TABLE", table));
    voltages_of(&path)
}

/// The voltages of a simulation, or the message why it cannot be read.
fn voltages_of(simulation: &Path) -> Result<Voltages, String> {
    match read_problem(simulation, &[]) {
        Ok(loaded) => match loaded.task {
            Task::Simulate(simulation) => Ok(simulation.voltages),
            _ => panic!("a simulation"),
        },
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn voltages_may_be_functions_of_time() {
    let signals =
        r#"{ "muscle1": { "ramp": { "to": "2 kV", "start": "0.1 s", "duration": "0.2 s" } } }"#;
    let voltages = with_table(signals).unwrap();
    let at = |time| voltages.at(time).to_vec();
    assert_eq!(at(50.0), [0.0, 0.0]);
    assert!((at(150.0)[0] - 500.0).abs() < 1e-9);
    assert_eq!(at(900.0), [2000.0, 0.0]);
    assert_eq!(voltages.switches().to_vec(), [100.0, 100.0 + 200.0]);
    assert!(voltages.drive(0) && !voltages.drive(1));
    let sine = r#"{ "muscle1": { "sine": { "mean": 1000, "amplitude": "500 V", "period": "0.4 s", "phase": "90 deg" } } }"#;
    let voltages = with_table(sine).unwrap();
    assert!((voltages.at(0.0)[0] - 1500.0).abs() < 1e-9);
    assert!((voltages.at(200.0)[0] - 500.0).abs() < 1e-9);
    let table = r#"{ "muscle1": { "table": { "time": [0.2, 0.4], "values": [100, "0.3 kV"] } } }"#;
    let voltages = with_table(table).unwrap();
    assert!((voltages.at(250.0)[0] - 150.0).abs() < 1e-9);
    assert_eq!(
        with_table(r#"{ "muscle1": "1 kV" }"#).unwrap(),
        Voltages::constant(&[1000.0, 0.0])
    );
    for (wrong, told) in [
        (r#"{ "muscle1": {} }"#, "ramp"),
        (
            r#"{ "muscle1": { "ramp": { "to": 1, "duration": 0 } } }"#,
            "duration",
        ),
        (
            r#"{ "muscle1": { "ramp": { "to": 1, "duration": 1 }, "sine": { "amplitude": 1, "period": 1 } } }"#,
            "ramp",
        ),
        (
            r#"{ "muscle1": { "sine": { "amplitude": "1 kV", "period": "-1 s" } } }"#,
            "period",
        ),
        (
            r#"{ "muscle1": { "table": { "time": [1, 1], "values": [0, 0] } } }"#,
            "increasing times",
        ),
        (
            r#"{ "muscle1": { "table": { "time": [1, 2], "values": [0] } } }"#,
            "2, one for each time",
        ),
        (
            r#"{ "muscle1": { "table": { "time": [], "values": [] } } }"#,
            "one or more",
        ),
        (
            r#"{ "muscle1": { "ramp": { "to": "1 m", "duration": 1 } } }"#,
            "voltages.muscle1.ramp.to",
        ),
        (r#"{ "muscle1": { "rise": 1 } }"#, "rise"),
        (
            r#"{ "muscle9": { "ramp": { "to": 1, "duration": 1 } } }"#,
            "muscle9",
        ),
    ] {
        let error = with_table(wrong).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
}

/// The voltages of a simulation beside a file `voltages.csv` of this text.
fn with_csv(text: &[u8], csv: &str) -> Result<Voltages, String> {
    let problem = r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "10 ms", "voltages": { "muscle1": { "csv": CSV } } } }"#;
    let (folder, path) = folder(SCENE, &problem.replace("CSV", csv));
    fs::write(folder.path().join("voltages.csv"), text).unwrap();
    voltages_of(&path)
}

#[test]
fn voltages_may_come_from_a_csv_file() {
    let text = b"# measured\ntime [ms], left [kV], right\n0, 1, 100\n100, 2, 300\n";
    let columns = r#"{ "file": "voltages.csv", "values": "left" }"#;
    let voltages = with_csv(text, columns).unwrap();
    assert!((voltages.at(25.0)[0] - 1250.0).abs() < 1e-9);
    assert_eq!(voltages.at(500.0)[0], 2000.0);
    let columns = r#"{ "file": "voltages.csv", "time": "time [ms]", "values": "right" }"#;
    assert!((with_csv(text, columns).unwrap().at(50.0)[0] - 200.0).abs() < 1e-9);
    let left = r#"{ "file": "voltages.csv", "values": "left" }"#;
    for (text, csv, told) in [
        (
            &text[..],
            r#"{ "file": "none.csv", "values": "left" }"#,
            "none.csv",
        ),
        (
            &text[..],
            r#"{ "file": "voltages.csv", "values": "lift" }"#,
            "time [ms], left [kV], right",
        ),
        (&text[..], r#"{ "file": "voltages.csv" }"#, "values"),
        (b"time,left [kV]\n0,1\n0,2\n", left, "increasing times"),
        (b"time,left [kV]\n0,1\n1,x\n", left, "in line 3 of"),
        (b"time,left [kg]\n0,1\n", left, "a mass"),
        (b"time,left [furlong]\n0,1\n", left, "furlong"),
        (b"time,left\n0,x\n", left, "which is no number"),
        (b"time,left\n0,\n", left, "an empty cell"),
        (b"time,left [kV]\n0,\n", left, "an empty cell"),
        (b"time;left [kV]\n0;1\n", left, "with semicolons between"),
        (b"time,left\n0,inf\n", left, "not finite"),
        (b"time,left\n0,1,2\n", left, "cannot be read"),
        (b"time,left\n\xff\xfe,1\n", left, "cannot be read"),
        (b"time,left\n", left, "one or more"),
        (b"", left, "which is empty"),
        (b"time,left,left\n0,1,2\n", left, "2 columns \"left\""),
        (
            b"time,left [V],left [kV]\n0,1,2\n",
            left,
            "one column of this name",
        ),
    ] {
        let error = with_csv(text, csv).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn a_voltage_that_is_typed_twice_is_refused() {
    let (_folder, path) = folder(SCENE, PROBLEM);
    let system = read_problem(&path, &[]).unwrap().system;
    let words = ["muscle1=1kV", "muscle1=2kV"].map(str::to_owned);
    assert_eq!(driven_voltages(&words[1..], &system).unwrap()[0], 2000.0);
    let error = driven_voltages(&words, &system).unwrap_err();
    assert!(
        error.to_string().contains("one voltage of \"muscle1\""),
        "{error}"
    );
}

#[test]
fn a_place_that_is_set_twice_is_refused() {
    let words = ["control.intervals=7", "control.intervals = 8"].map(str::to_owned);
    each_once(&words[..1]).unwrap();
    let error = each_once(&words).unwrap_err().to_string();
    for told in ["control.intervals", "=7", "= 8", "expected one value"] {
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn voltages_may_be_a_table() {
    let table = r#"{ "time": [0, "500 ms", 1], "voltages": { "muscle1": [100, "0.2 kV"] }, "hold": { "muscle1": 50 } }"#;
    let voltages = with_table(table).unwrap();
    let rows = [[100.0, 200.0, 50.0], [0.0; 3]];
    assert_eq!(voltages, in_steps(rows, Afterwards::Held, None));
    let at = |time| voltages.at(time)[0];
    assert_eq!([at(499.0), at(501.0), at(1500.0)], [100.0, 200.0, 50.0]);
    for (wrong, told) in [
        (r#"{ "time": [0, 1] }"#, "a table without \"voltages\""),
        (r#"{ "voltages": {} }"#, "a table without \"time\""),
        (
            r#"{ "muscle1": 1, "time": [0, 1], "voltages": {} }"#,
            "a table beside voltages by name",
        ),
        (
            r#"{ "time": [0.1, 1], "voltages": {} }"#,
            "found 0.1 s, expected 0",
        ),
        (
            r#"{ "time": [0, 1, 1], "voltages": {} }"#,
            "increasing times",
        ),
        (r#"{ "time": [0], "voltages": {} }"#, "2 instants or more"),
        (
            r#"{ "time": [0, 1], "voltages": { "muscle1": [1, 2] } }"#,
            "found 2 voltages, expected 1",
        ),
        (
            r#"{ "time": [0, 1], "voltages": { "muscle7": [1] } }"#,
            "muscle7",
        ),
    ] {
        let message = with_table(wrong).unwrap_err();
        assert!(message.contains(told), "{wrong}: {message}");
    }
}

#[test]
fn voltages_of_a_control_problem_may_be_given() {
    let second = "\"muscle2\", \"material\": \"silicone\"";
    let scene = SCENE.replace("\"muscle2\", \"material\": \"rubber\"", second);
    let given = "\"intervals\": 20, \"voltages\": { \"muscle2\": \"4 kV\" },";
    let problem = PROBLEM.replace("\"intervals\": 20,", given);
    // What is given is not bound, at rest neither.
    let rest = "{ \"muscle1\": \"1.7 kV\", \"muscle2\": \"4 kV\" }";
    let problem = problem.replace("{ \"muscle1\": \"1.7 kV\" }", rest);
    let (_folder, path) = folder(&scene, &problem);
    let Task::Control(control) = read_problem(&path, &[]).expect("a problem").task else {
        panic!("a control problem")
    };
    assert_eq!(control.given, [(1, Signal::Constant(4000.0))].into());
}

#[test]
fn the_response_of_an_equilibrium_is_read_and_checked() {
    const REST: &str = r#"{ "scene": "scene.json", "equilibrium": { "response": "relaxed" } }"#;
    let branch = r#"[{ "shear_modulus": "20 kPa", "relaxation_time": "1 s" }]"#;
    let creeping = SCENE.replacen(
        "\"shear_modulus\"",
        &format!("\"maxwell\": {branch}, \"shear_modulus\""),
        2,
    );
    assert_ne!(creeping, SCENE);
    let at_once = REST.replace("relaxed", "instantaneous");
    for (scene, problem, expected) in [
        (SCENE, REST, Response::Relaxed),
        (&creeping, REST, Response::Relaxed),
        (&creeping, &at_once, Response::Instantaneous),
    ] {
        let (_folder, path) = folder(scene, problem);
        let Task::Equilibrium(task) = read_problem(&path, &[]).expect("a problem").task else {
            panic!("an equilibrium")
        };
        assert_eq!(task.response, expected);
    }
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"relaxed\"", "\"instantaneous\"", "equilibrium.response", "\"instantaneous\"", "a scene with Maxwell branches", "instantaneous"),
        ("\"relaxed\"", "\"slow\"", "equilibrium.response", "\"slow\"", "\"instantaneous\"", "slow"),
    ];
    check(cases, REST, |problem| mistake(SCENE, problem, &[]));
}
