//! Names of parts, of folders and of files, whatever they are: in overrides, in tables for spreadsheets, on a terminal, as names of results.

use crate::runs::{proboscis, read, run, workshop};
use serde_json::json;
use std::fs;
use std::path::Path;

/// Writes the kept problem of a pair for a few intervals under another name.
fn write(folder: &Path, file: &str) {
    let mut problem = read(folder.join("problems/pair.json"));
    problem["control"]["intervals"] = json!(8);
    problem["scene"] = json!(folder.join("problems/scenes/pair.json"));
    problem.as_object_mut().unwrap().remove("$schema");
    let path = folder.join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, problem.to_string()).unwrap();
}

#[test]
fn an_override_names_an_entry_of_a_list() {
    let folder = workshop();
    let folder = folder.path();
    let motion = |set: &str, to: &str| {
        let problem = "problems/tendon_finger.json";
        let words = [
            "simulate",
            problem,
            "--set",
            set,
            "--set",
            "simulate.duration=0.1 s",
        ];
        let (status, out, err) = run(folder, &[&words[..], &["-o", to, "--no-report"]].concat());
        assert_eq!(status, 0, "{out}{err}");
        let table = fs::read_to_string(folder.join(to).join("trajectory.csv")).unwrap();
        table.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let [named, indexed, other] = [
        motion("scene.springs.return2.stiffness=500 N/m", "named"),
        motion("scene.springs[1].stiffness=500 N/m", "indexed"),
        motion("scene.springs.return1.stiffness=500 N/m", "other"),
    ];
    assert!(named == indexed && named != other);
    let wrong = ["inspect", "problems/tendon_finger.json", "--set"];
    let told = |set: &str| {
        let (status, _, err) = run(folder, &[&wrong[..], &[set]].concat());
        assert_eq!(status, 2, "{err}");
        err
    };
    let err = told("scene.springs.retrun2.stiffness=500 N/m");
    assert!(
        err.contains("\"retrun2\"") && err.contains("\"return2\""),
        "{err}"
    );
    let err = told("scene.springs.return2.stiffness=-1 N/m");
    assert!(
        err.contains("springs[1].stiffness") && err.contains("command line"),
        "{err}"
    );
    let err = told("scene.springs[9].stiffness=1 N/m");
    assert!(err.contains("an index below"), "{err}");
}

#[test]
fn a_sweep_names_an_entry_of_a_list_and_is_told_its_mistakes() {
    let folder = workshop();
    let folder = folder.path();
    let place = "scene.springs.return2.stiffness";
    let sweep = |values: serde_json::Value| {
        let sweep = json!({ "problem": "problems/tendon_finger.json", "set": { "simulate.duration": "0.1 s" }, "vary": { place: values } });
        fs::write(folder.join("springs.json"), sweep.to_string()).unwrap();
        run(folder, &["sweep", "springs.json"])
    };
    let (status, out, err) = sweep(json!(["500 N/m", "0.6 N/mm"]));
    assert!(
        status == 0 && out.contains("2 variants: 2 simulated"),
        "{out}{err}"
    );
    let table = fs::read_to_string(folder.join("results/sweeps/springs/sweep.csv")).unwrap();
    let lines: Vec<&str> = table.lines().skip(1).collect();
    assert!(lines[0].contains(&format!("{place} [N/m]")), "{table}");
    assert!(
        lines[1].contains(",500.0,") && lines[2].contains(",600.0,"),
        "{table}"
    );
    let (status, _, err) = sweep(json!(["-500 N/m"]));
    assert!(
        status == 2 && err.contains("springs.json: vary.scene.springs.return2"),
        "{err}"
    );
}

#[test]
fn no_heading_is_a_formula_of_a_spreadsheet() {
    let folder = workshop();
    let folder = folder.path();
    let (_, scene, _) = run(folder, &["expand", "problems/scenes/pair.json"]);
    assert!(scene.contains("\"muscle2\""), "{scene}");
    let name = "=1+1";
    fs::write(
        folder.join("problems/scenes/pair.json"),
        scene.replace("\"muscle2\"", "\"=1+1\""),
    )
    .unwrap();
    write(folder, "formula.json");
    let text = fs::read_to_string(folder.join("formula.json")).unwrap();
    fs::write(folder.join("formula.json"), text.replace("muscle2", name)).unwrap();
    let (status, out, err) = run(folder, &["solve", "formula.json", "-o", "first"]);
    assert_eq!(status, 0, "{out}{err}");
    for table in ["controls.csv", "trajectory.csv"] {
        let table = fs::read_to_string(folder.join("first").join(table)).unwrap();
        let head = table.lines().nth(1).unwrap();
        assert!(head.contains("\"'=1+1"), "{head}");
        assert!(
            !head
                .split(',')
                .any(|cell| cell.starts_with(['=', '+', '-', '@'])),
            "{head}"
        );
    }
    // What reads a table takes the name.
    let mut motion = read(folder.join("problems/pair_constant.json"));
    let column =
        json!({ "csv": { "file": "first/controls.csv", "time": "start", "values": name } });
    motion["simulate"]["voltages"] = json!({ name: column });
    motion["scene"] = json!("problems/scenes/pair.json");
    fs::write(folder.join("motion.json"), motion.to_string()).unwrap();
    let (status, out, err) = run(folder, &["simulate", "motion.json"]);
    assert_eq!(status, 0, "{out}{err}");
}

#[test]
fn names_of_folders_command_no_terminal() {
    let folder = workshop();
    let folder = folder.path();
    let evil = "a\u{1b}[31mb\u{7}";
    write(folder, "short.json");
    let (status, out, err) = run(folder, &["solve", "short.json", "-o", evil]);
    assert_eq!(status, 0, "{out}{err}");
    let (_, json, more) = run(folder, &["solve", "short.json", "-o", evil, "--json"]);
    let _: serde_json::Value = serde_json::from_str(&json).unwrap();
    let (_, out2, err2) = run(folder, &["solve", &format!("{evil}.json")]);
    let (_, out3, err3) = run(folder, &["solve", "short.json", "--starts", evil]);
    let told = [out, err, json, more, out2, err2, out3, err3].concat();
    assert!(told.contains("\\u{1b}[31mb"), "{told}");
    assert!(!told.contains(['\u{1b}', '\u{7}']), "{told:?}");
}

#[test]
fn messages_are_short() {
    let folder = workshop();
    let folder = folder.path();
    let long = "x".repeat(50_000);
    let end = format!("{long}end");
    for words in [
        vec!["solve", "problems/pair.json", "--set", &end],
        vec!["equilibrium", "problems/pair.json", "--voltages", &end],
    ] {
        let (status, out, err) = run(folder, &words);
        assert_eq!(status, 2);
        assert!(
            out.is_empty() && err.len() < 5000 && err.contains('…'),
            "{}",
            err.len()
        );
    }
    let key = format!("control.{end}=1");
    let (_, _, err) = run(folder, &["inspect", "problems/pair.json", "--set", &key]);
    // The beginning and the end are told.
    assert!(
        err.len() < 5000 && err.contains("control.xxx") && err.contains("xend"),
        "{err}"
    );
}

#[test]
fn a_trunk_has_not_too_many_segments() {
    let folder = workshop();
    let folder = folder.path();
    for segments in ["0", "1001", "100000000"] {
        let (status, _, err) = run(folder, &["new", "trunk", "far", "--segments", segments]);
        assert!(
            status == 2 && err.contains(segments) && err.contains("1 to 1000"),
            "{err}"
        );
    }
    assert!(!folder.join("far").exists());
}

#[test]
fn results_have_the_name_of_the_folder_of_a_problem() {
    let folder = workshop();
    let folder = folder.path();
    for file in ["one/problem.json", "two/problem.json", "other/one.json"] {
        write(folder, file);
    }
    let solve = |words: &[&str]| run(folder, &[&["solve"], words].concat());
    for (file, name) in [("one/problem.json", "one"), ("two/problem.json", "two")] {
        let (status, out, err) = solve(&[file]);
        assert!(
            status == 0 && out.contains(&format!("results/{name}")),
            "{out}{err}"
        );
        assert_eq!(
            read(folder.join("results").join(name).join("summary.json"))["input"],
            file
        );
    }
    // The same again, also as it is called in another folder.
    let (status, _, err) = solve(&["./one/../one/problem.json"]);
    assert!(status == 0 && !err.contains("replace"), "{err}");
    let output = proboscis(&folder.join("one"))
        .args(["solve", "problem.json", "-o", "../results/one"])
        .output()
        .unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && !err.contains("replace"), "{err}");
    let (status, _, err) = solve(&["one/problem.json"]);
    assert!(status == 0 && !err.contains("replace"), "{err}");

    // Those of another problem are not replaced, unless their folder is named.
    let before = fs::read(folder.join("results/one/summary.json")).unwrap();
    let (status, _, err) = solve(&["other/one.json"]);
    assert!(
        status == 2 && err.contains("results/one has results of one/problem.json"),
        "{err}"
    );
    assert!(fs::read(folder.join("results/one/summary.json")).unwrap() == before);
    let (status, _, err) = solve(&["other/one.json", "-o", "results/one"]);
    assert!(
        status == 0 && err.contains("which this run replaces"),
        "{err}"
    );
}
