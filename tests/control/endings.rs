//! Messages about the end of a motion: goals that nothing holds, final costs that are missed, objectives above their least value.

use crate::verdicts::{kept, output_of, read};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

/// A table of results as names without units and rows.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',');
    let names = names.map(|name| name.split(" [").next().unwrap().to_owned());
    let rows = lines.map(|line| {
        let cells = line.split(',');
        cells.map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
    });
    (names.collect(), rows.collect())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_leg_that_nothing_holds_at_its_goal_falls_and_the_warning_says_how_far() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("leg");
    let leg = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trust/leg_swing.json");
    let ended = output_of(&leg, &[r#"control.goal.hold="none""#], &out);
    assert!(ended.is_solved);
    let summary = read(&out.join("summary.json"));
    let after = &summary["afterwards"];
    assert_eq!(after["is_held"], false);
    let foot = &after["goal"][0];
    assert_eq!(
        (&foot["name"], &foot["unit"]),
        (&"foot".into(), &"m".into())
    );
    assert!(number(&foot["deviation"]) > 0.02, "{foot}");
    let warning = ended
        .notes
        .iter()
        .find(|n| n.contains("nothing holds the goal"));
    assert!(warning.unwrap().contains("mm from its goal"), "{warning:?}");

    // At rest at the end there is no motion left: the row of the last instant says so, and weight is no momentum.
    let (names, rows) = table(&out.join("trajectory.csv"));
    let column = |name: &str| names.iter().position(|n| n == name).unwrap();
    let last = rows.last().unwrap();
    let most = |c: usize| rows.iter().fold(0.0_f64, |m, row| m.max(row[c].abs()));
    for name in ["kinetic_energy", "linear_momentum_y", "angular_momentum_z"] {
        let c = column(name);
        assert!(
            most(c) > 1e-3 && last[c].abs() < 1e-7 * most(c),
            "{name}: {}",
            last[c]
        );
        assert!(rows[0][c].abs() < 1e-7 * most(c), "{name}: {}", rows[0][c]);
    }

    // The voltages of the last interval, simulated on by the command for simulations.
    let continued = folder.path().join("continued.json");
    let (controls, voltages) = table(&out.join("controls.csv"));
    let held: serde_json::Map<String, Value> = (controls.iter().zip(voltages.last().unwrap()))
        .filter(|(name, _)| name.starts_with("hip_") || name.starts_with("knee_"))
        .map(|(name, volts)| (name.clone(), (*volts).into()))
        .collect();
    assert_eq!(held.len(), 4);
    let text = serde_json::json!({
        "scene": leg.with_file_name("leg_scene.json"),
        "simulate": {
            "duration": 2.0, "step": 0.4 / 60.0, "start": { "end_of": out }, "voltages": held,
        }
    });
    std::fs::write(&continued, text.to_string()).unwrap();
    let after = folder.path().join("after");
    output_of(&continued, &[], &after);
    let (names, rows) = table(&after.join("trajectory.csv"));
    let [x, y] = ["foot_x", "foot_y"].map(|name| names.iter().position(|n| n == name).unwrap());
    let far = rows.iter().map(|row| (row[x] - 40.0).hypot(row[y] + 150.0));
    let far = far.fold(0.0, f64::max) / 1e3;
    let told = number(&foot["deviation"]);
    assert!((far - told).abs() < 1e-3 * told, "{far} against {told}");
}

#[test]
fn a_goal_of_joint_angles_is_left_in_degrees() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("leg");
    let leg = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trust/leg_swing.json");
    let goal = r#"control.goal={"joint_angles":{"hip":"20 deg","knee":"10 deg"},"hold":"none"}"#;
    let ended = output_of(&leg, &[goal], &out);
    assert!(ended.is_solved);
    let warning = ended
        .notes
        .iter()
        .find(|n| n.contains("nothing holds the goal"));
    assert!(warning.unwrap().contains("° from its goal"), "{warning:?}");
    // Voltages that hold it are found, if this is not forbidden, and what voltages hold gets no such warning.
    let ended = output_of(&leg, &[&goal.replace(r#","hold":"none""#, "")], &out);
    assert!(ended.is_solved && !ended.notes.iter().any(|n| n.contains("nothing holds")));
    let found = |n: &String| n.contains("held by inputs that were found");
    assert!(ended.notes.iter().any(found), "{ended:?}");
    let goal = r#"control.goal={"rest_at_voltages":{"hip_front":"1.5 kV"}}"#;
    let ended = output_of(&leg, &[goal], &folder.path().join("held"));
    assert!(ended.is_solved);
    assert!(!ended.notes.iter().any(|n| n.contains("holds the goal")));
}

#[test]
fn final_costs_tell_where_they_end() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("leg");
    let leg = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trust/leg_swing.json");
    let objective = r#"control.objective={"effort":1.0,"final":[
        {"joint":{"joint":"hip","at":"90 deg","weight":1}},{"joint":{"joint":"knee","at":"-90 deg","weight":1}}]}"#;
    let ended = output_of(&leg, &[r#"control.goal="free""#, objective], &out);
    assert!(ended.is_solved);
    let summary = read(&out.join("summary.json"));
    let (names, rows) = table(&out.join("trajectory.csv"));
    let values = summary["final_values"].as_array().unwrap();
    assert_eq!(values.len(), 2);
    for (value, asked) in values.iter().zip([90.0_f64, -90.0]) {
        let name = value["name"].as_str().unwrap();
        let column = names.iter().position(|n| n == name).unwrap();
        let end = rows.last().unwrap()[column];
        let (deviation, unit) = (number(&value["deviation"]), &value["unit"]);
        assert_eq!(unit, "rad");
        assert!((number(&value["asked"]) - asked.to_radians()).abs() < 1e-12);
        // The muscles are too weak for it.
        assert!(deviation > 0.1 && (deviation - (end - asked.to_radians()).abs()).abs() < 1e-5);
        let line = ended
            .notes
            .iter()
            .find(|n| n.starts_with(&format!("note: {name} ends at")));
        assert!(line.unwrap().contains('°'), "{line:?}");
    }
}

#[test]
fn an_objective_that_falls_far_below_its_first_size_is_found_at_a_coarse_tolerance() {
    let folder = tempdir().unwrap();
    let leg = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trust/leg_swing.json");
    let objective = r#"control.objective={"final":[{"joint":{"joint":"hip","at":"10 deg","weight":1}}],"effort":1e-6}"#;
    let of = |tolerance: &str, name: &str| {
        let out = folder.path().join(name);
        let tolerance = format!("control.solver.tolerance={tolerance}");
        let set = [r#"control.goal="free""#, objective, &tolerance];
        let ended = output_of(&leg, &set, &out);
        assert!(ended.is_solved);
        let summary = read(&out.join("summary.json"));
        (number(&summary["objective"]), number(&summary["gap"]))
    };
    let [(coarse, gap), (fine, _)] = [of("1e-6", "coarse"), of("1e-12", "fine")];
    assert!(fine > 0.0);
    assert!(
        coarse - fine <= 2.0 * gap + 1e-6 * fine,
        "{coarse} {fine} {gap}"
    );
    assert!(coarse < 1.02 * fine, "{coarse} against {fine}");
}

#[test]
fn the_finger_with_a_tendon_that_grows_taut_is_steered() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("finger");
    let ended = output_of(&kept("tendon_finger_control"), &[], &out);
    assert!(ended.is_solved, "{:?}", ended.notes);
    // The slack part is passed on the way: the tension is zero somewhere or grows from little.
    let (names, rows) = table(&out.join("trajectory.csv"));
    let column = names.iter().position(|n| n == "flexor_tension").unwrap();
    let tension: Vec<f64> = rows.iter().map(|row| row[column]).collect();
    assert!(tension.iter().all(|&t| t >= 0.0));
    assert!(tension.last().unwrap() > &tension[0]);
}

#[test]
fn a_kink_and_a_limit_of_iterations_are_explained() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("finger");
    let scene = std::fs::read_to_string(kept("scenes/tendon_finger")).unwrap();
    let hard = scene.replace(r#""smoothing": "2 mm","#, "");
    assert_ne!(scene, hard);
    let file = folder.path().join("scene.json");
    std::fs::write(&file, hard).unwrap();
    let change = format!("scene={}", serde_json::json!(file));
    let ended = output_of(
        &kept("tendon_finger_control"),
        &[
            &change,
            "control.intervals=60",
            "control.solver.max_iterations=55",
        ],
        &out,
    );
    assert!(!ended.is_solved);
    let summary = read(&out.join("summary.json"));
    let told = ended.notes.join("\n");
    assert!(told.contains("\"smoothing\""), "{told}");
    for violation in summary["violations"].as_array().unwrap() {
        let unit = violation["unit"].as_str();
        assert!(matches!(unit, Some("N ms" | "N mm ms")), "{violation}");
    }
}
