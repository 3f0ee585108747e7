//! Muscles and blocks of finite elements steered at full order.

use crate::runs::{problem, read, run};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A pair of muscles about one joint, 50 mm long.
fn scene(model: &Value) -> Value {
    let mut scene = read(problem("scenes/fe_trunk"));
    scene.as_object_mut().unwrap().remove("$schema");
    scene["chain"]["segments"] = json!(1);
    match model {
        Value::Null => {
            let muscles = scene["chain"]["muscles"].as_object_mut().unwrap();
            muscles.remove("model");
            muscles.remove("elements");
        }
        elements => scene["chain"]["muscles"]["elements"] = elements.clone(),
    }
    scene
}

/// A task in a folder of its own, run; the exit status and the first column of a name in a table of results, from its last row.
fn last(folder: &Path, command: &str, task: &Value, table: &str, column: &str) -> (i32, f64) {
    let name = folder.join("problem.json");
    fs::write(&name, task.to_string()).unwrap();
    let (status, _, told) = run(folder, &[command, "problem.json", "-o", command]);
    println!("{told}");
    let text = fs::read_to_string(folder.join(command).join(table)).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').collect())
        .collect();
    let at = rows[0]
        .iter()
        .position(|name| name.starts_with(column))
        .unwrap();
    (status, rows[rows.len() - 1][at].parse().unwrap())
}

#[test]
fn bodies_come_to_rest_where_their_finite_elements_are_in_equilibrium() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let hold = json!({ "muscle1": "1.5 kV" });
    let angle = |elements: &Value| {
        let task = json!({ "scene": scene(elements), "equilibrium": { "voltages": hold } });
        let (status, angle) = last(folder, "equilibrium", &task, "equilibrium.csv", "joint1");
        assert_eq!(status, 0);
        angle
    };
    let elements = json!([1, 1, 4]);
    let (goal, lumped) = (angle(&elements), angle(&Value::Null));
    assert!(
        goal.abs() > 0.01 && (goal - lumped).abs() > 1e-3 * goal.abs(),
        "{goal} {lumped}"
    );
    let task = json!({ "scene": scene(&elements), "control": {
        "duration": "0.3 s", "intervals": 20, "start": { "rest_at_voltages": {} },
        "goal": { "rest_at_voltages": hold, "rest": "bodies" },
        "voltage_bounds": ["0 V", "3 kV"], "objective": { "effort": 1, "rate": 0.0005 },
        "guess": { "simulate": { "voltages": hold } },
    } });
    let (status, end) = last(folder, "solve", &task, "trajectory.csv", "joint1");
    let summary = read(folder.join("solve/summary.json"));
    assert_eq!((status, &summary["status"]), (0, &json!("solved")));
    assert!((end - goal).abs() < 1e-9, "{end} {goal}");
    let solver = &summary["linear_solver"];
    if solver["name"] == "stages" {
        assert_eq!(solver["condensed"], solver["factorisations"]);
    }
    // Held, the bodies move by what the nodes still move.
    let resimulated = &summary["resimulation"];
    let drift = resimulated["drift"]["angle"].as_f64().unwrap();
    let path = resimulated["path_length"]["angle"].as_f64().unwrap();
    assert!(drift < 0.05 * path, "{drift} {path}");
}

#[test]
fn potentials_within_a_block_are_condensed_with_its_motion() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "solve",
        &problem("fe_bending_control"),
        "-o",
        "out",
        "--max-iterations",
        "3",
        "--set",
        "control.intervals=8",
        "--set",
        "scene.solids[0].box.elements=[6, 1, 4]",
    ];
    let (_, _, told) = run(folder.path(), &arguments);
    let summary = read(folder.path().join("out/summary.json"));
    assert!(summary["potentials"].as_f64().unwrap() > 10.0, "{told}");
    let solver = &summary["linear_solver"];
    if solver["name"] == "stages" {
        assert!(solver["factorisations"].as_f64().unwrap() > 2.0);
        assert_eq!(solver["condensed"], solver["factorisations"], "{told}");
    }
}
