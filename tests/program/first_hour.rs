//! The first hour: files to begin with, the right command for a problem, notes of what was understood otherwise.

use crate::refusals::refused_run;
use crate::runs::{problem, read, run, workshop};
use std::fs;
use std::path::Path;

#[test]
fn new_files_name_their_schemas_and_the_next_command() {
    let folder = workshop();
    let path = folder.path();
    for (robot, command) in [("arm", "solve"), ("satellite", "simulate")] {
        let place = format!("my robots/{robot}");
        let (status, out, err) = run(path, &["new", robot, &place]);
        assert_eq!(status, 0, "{err}");
        let next = format!("next: proboscis {command} 'my robots/{robot}/problem.json'");
        assert_eq!(out.lines().last(), Some(&*next), "{out}");
        assert_eq!(out.lines().count(), 5, "{out}");
        for file in ["scene", "problem"] {
            let written = read(path.join(&place).join(format!("{file}.json")));
            let name = written["$schema"].as_str().unwrap();
            let schema = read(path.join(&place).join(name));
            assert_eq!(schema["$id"], format!("urn:proboscis:{file}"));
            assert!(schema["properties"].is_object());
        }
    }
    let (_, out, _) = run(path, &["new", "trunk", "--segments", "2"]);
    assert_eq!(
        out.lines().last(),
        Some("next: proboscis solve problem.json")
    );
    let (status, out, err) = run(path, &["simulate", "my robots/satellite/problem.json"]);
    assert!(status == 0 && err.is_empty(), "{out}{err}");
}

#[test]
fn a_robot_from_urdf_names_what_is_left_out_and_moves() {
    let folder = workshop();
    let path = folder.path();
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/urdf/two_links.urdf");
    let text = fs::read_to_string(urdf).unwrap();
    let two = r#"<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual><visual><geometry><sphere radius="0.1"/></geometry></visual>"#;
    let text = text.replacen("</inertial>", &format!("</inertial>{two}<collision/>"), 1);
    fs::write(path.join("arm.urdf"), &text).unwrap();
    let arm = text;
    let (status, out, err) = run(path, &["new", "urdf", "arm.urdf", "arm"]);
    assert_eq!(status, 0, "{err}");
    assert_eq!(
        out.lines().collect::<Vec<_>>(),
        [
            "arm/meshes/upper.stl",
            "arm/scene.json",
            "arm/problem.json",
            "arm/scene.schema.json",
            "arm/problem.schema.json",
            "next: proboscis simulate arm/problem.json"
        ]
    );
    let left_out = "note: left out: <collision> of the link \"upper\"";
    assert!(err.lines().any(|line| line == left_out), "{err}");
    // The folder may be moved.
    fs::rename(path.join("arm"), path.join("moved")).unwrap();
    let set = "simulate.duration=0.05 s";
    let (status, _, err) = run(
        path,
        &["simulate", "moved/problem.json", "--set", set, "-o", "out"],
    );
    assert!(status == 0 && err.is_empty(), "{err}");
    refused_run(
        path,
        &["new", "urdf", "arm.urdf", "moved"],
        &["moved/meshes/upper.stl exists already"],
    );
    refused_run(
        path,
        &["new", "urdf", "nothing.urdf", "other"],
        &[
            "nothing.urdf: found no readable file",
            "expected a URDF file",
        ],
    );
    // Two joints of one name are no scene: nothing is written.
    let twice = arm.replace("joint name=\"elbow\"", "joint name=\"shoulder\"");
    assert_ne!(twice, arm);
    fs::write(path.join("twice.urdf"), twice).unwrap();
    refused_run(path, &["new", "urdf", "twice.urdf", "other"], &["shoulder"]);
    assert!(!path.join("other").exists());
}

#[test]
fn another_command_than_the_right_one_names_it() {
    let folder = workshop();
    let path = folder.path();
    let set = "control.intervals=10";
    refused_run(
        path,
        &["simulate", "problems/pair.json", "--set", set, "-o", "out"],
        &[
            "problems/pair.json: control: ",
            "`proboscis solve problems/pair.json --set control.intervals=10 -o out`",
            "\"simulate\" in place of \"control\"",
        ],
    );
    refused_run(
        path,
        &["simulate", "problems/clamped_stack.json"],
        &[
            "equilibrium: ",
            "`proboscis equilibrium problems/clamped_stack.json`",
        ],
    );
    for (name, key, command) in [
        ("pair", "control", "solve"),
        ("pair_constant", "simulate", "simulate"),
    ] {
        let file = format!("problems/{name}.json");
        let right = format!("`proboscis {command} {file}`");
        refused_run(path, &["equilibrium", &file], &[key, &right, "--voltages"]);
    }
    assert!(!path.join("out").exists());
}

#[test]
fn a_run_without_an_equilibrium_leaves_its_summary() {
    let folder = workshop();
    let path = folder.path();
    fs::create_dir(path.join("out")).unwrap();
    fs::write(path.join("out/solution.json"), "{}").unwrap();
    let goal = "control.goal={\"rest_at_voltages\":{\"muscle2\":\"9 kV\"}}";
    let bounds = "control.voltage_bounds=[\"0 V\",\"20 kV\"]";
    let words = [
        "solve",
        "problems/pair.json",
        "--set",
        goal,
        "--set",
        bounds,
        "-o",
        "out",
    ];
    let (status, _, err) = run(path, &words);
    assert!(status == 1 && err.contains("no equilibrium"), "{err}");
    let summary = read(path.join("out/summary.json"));
    assert_eq!(summary["status"], "no_equilibrium");
    let message = summary["message"].as_str().unwrap();
    assert!(
        message.starts_with("control.goal: ") && message.contains("pull-in"),
        "{message}"
    );
    // What was there is no file of this run.
    assert_eq!(fs::read_dir(path.join("out")).unwrap().count(), 1);
    let (status, out, _) = run(path, &[&words[..], &["--json"]].concat());
    assert!(status == 1 && out.contains("\"no_equilibrium\""), "{out}");
}

#[test]
fn a_step_that_does_not_divide_the_duration_is_told() {
    let folder = workshop();
    let pair = "problems/pair_constant.json";
    let duration = "simulate.duration=0.1 s";
    let words = [
        "simulate",
        pair,
        "--set",
        duration,
        "--set",
        "simulate.step=7 ms",
        "-o",
        "out",
    ];
    let (status, out, err) = run(folder.path(), &words);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        err.contains("the step is 6.66667 ms, the duration in 15 equal steps: steps of 7 ms"),
        "{err}"
    );
    let words = [
        "simulate",
        pair,
        "--set",
        duration,
        "--set",
        "simulate.step=5 ms",
        "-o",
        "out",
    ];
    let (_, _, err) = run(folder.path(), &words);
    assert!(!err.contains("equal steps"), "{err}");
}

#[test]
fn a_voltage_beyond_numbers_inverts_no_element() {
    let folder = workshop();
    let voltages = "simulate.voltages={\"muscle1\":1e308}";
    let words = [
        "simulate",
        "problems/pair_constant.json",
        "--set",
        voltages,
        "--set",
        "simulate.step=10 ms",
    ];
    let (status, out, err) = run(folder.path(), &words);
    assert_eq!(status, 1, "{out}{err}");
    assert!(
        err.contains("beyond the range of numbers: the greatest voltage is 1.000e308 V"),
        "{err}"
    );
    assert!(!err.contains("element"), "{err}");
}

/// The gripper of two fingers of finite elements, one of them from a Gmsh file, as a user writes it.
fn gripper(folder: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gripper");
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
    }
}

#[test]
fn an_overdetermined_goal_is_told_part_by_part() {
    let folder = tempfile::tempdir().unwrap();
    gripper(folder.path());
    let rest = "control.goal.rest=everything";
    refused_run(
        folder.path(),
        &["inspect", "grip.json", "--set", rest],
        &[
            "overdetermined: 6050 equations for 5840 unknowns",
            "rest at the end is 288 equations, goal z of marker lower_tip is 1, goal z of marker upper_tip is 1; 80 voltages are sought in 20 intervals",
            "\"rest\": \"bodies\"",
            "\"hold\"",
        ],
    );
}

#[test]
fn what_cannot_rest_is_not_asked_to_and_moved_markers_are_told() {
    let folder = tempfile::tempdir().unwrap();
    gripper(folder.path());
    let goal = r#"control.goal={ "markers": { "upper_tip": [null, null, "3 mm"], "lower_tip": [null, null, "-3 mm"] } }"#;
    let (status, out, err) = run(folder.path(), &["inspect", "grip.json", "--set", goal]);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("80 voltages cannot bring all 288 coordinates")
            && out.contains("bodies and its markers rest"),
        "{out}"
    );
    for (marker, z) in [("upper_tip", "5"), ("lower_tip", "-5")] {
        let words = format!("note: marker {marker} is the node at [30 mm, ");
        let line = err
            .lines()
            .find(|line| line.starts_with(&words))
            .unwrap_or_else(|| panic!("{err}"));
        assert!(line.contains(&format!(", {z} mm], ")), "{line}");
    }
    let (_, _, err) = run(folder.path(), &["inspect", &problem("fe_finger_control")]);
    assert!(!err.contains("is the node at"), "{err}");
}

/// It moves by rounding alone, of which no step is to blame.
#[test]
fn a_robot_at_rest_is_simulated_without_a_warning() {
    let folder = workshop();
    let path = folder.path();
    for more in [
        &[][..],
        &["--set", "simulate.integrator={\"galerkin\":2}"],
        &[
            "--set",
            "simulate.step=auto",
            "--set",
            "simulate.tolerance=1e-6",
        ],
    ] {
        let pair = problem("pair_constant");
        let rest = [
            "simulate",
            &pair,
            "--set",
            "simulate.start={\"rest_at_voltages\":{\"muscle2\":\"1.7 kV\"}}",
            "--set",
            "scene.gravity=[\"9.81 m/s^2\",0,0]",
            "-o",
            "out",
        ];
        let (status, out, err) = run(path, &[&rest, more].concat());
        assert!(status == 0 && err.is_empty(), "{more:?}: {out}{err}");
        let last = fs::read_to_string(path.join("out/trajectory.csv")).unwrap();
        let last: Vec<&str> = last.lines().last().unwrap().split(',').collect();
        let angle: f64 = last[1].parse().unwrap();
        assert!(angle.abs() > 0.01, "{angle}");
        let summary = read(path.join("out/summary.json"));
        assert_eq!(summary["local_error"]["sum"], 0.0, "{more:?}");
    }
}

#[test]
fn a_refused_run_tells_nothing_of_results_that_it_would_replace() {
    let folder = workshop();
    let path = folder.path();
    let rest = problem("bending_actuator");
    let [pair, moved] = ["pair", "pair_constant"].map(problem);
    let (status, _, err) = run(path, &["simulate", &moved, "-o", "out"]);
    assert_eq!(status, 0, "{err}");
    for words in [
        &["equilibrium", &pair][..],
        &["equilibrium", &pair, "--voltages", "muscle7=3"],
        &["solve", &pair, "--from", "nowhere"],
        &[
            "solve",
            &pair,
            "--set",
            "control.goal={\"joint_angles\":{\"joint7\":1}}",
        ],
    ] {
        let (status, _, err) = run(path, &[words, &["-o", "out"]].concat());
        assert!(status == 2 && !err.contains("replaces"), "{words:?}: {err}");
        assert_eq!(
            err.lines()
                .filter(|line| line.starts_with("error: "))
                .count(),
            1
        );
    }
    for words in [["equilibrium", &rest], ["solve", &pair]] {
        let (status, _, err) = run(path, &[&words[..], &["-o", "out"]].concat());
        assert!(
            status == 0 && err.matches("which this run replaces").count() == 1,
            "{err}"
        );
    }
}

#[test]
fn an_entry_of_the_parts_of_a_chain_is_told_where_it_stands() {
    let folder = workshop();
    let path = folder.path();
    for entry in [
        "muscles.muscle1.layer_thickness",
        "muscles[0].layer_thickness",
        "bodies.segment1.mass",
    ] {
        let set = format!("scene.{entry}=1");
        let trunk = problem("elephant_trunk");
        let (status, _, err) = run(path, &["solve", &trunk, "--set", &set, "-o", "out"]);
        assert!(
            status == 2
                && err.contains("scene.chain.muscles.arm")
                && err.contains("`proboscis expand`"),
            "{err}"
        );
    }
}

#[test]
fn a_byte_order_mark_is_no_part_of_the_text() {
    let folder = workshop();
    let path = folder.path();
    let text = fs::read_to_string(problem("pair_constant")).unwrap();
    let scene = problem("scenes/pair");
    let text = text.replace("scenes/pair.json", &scene);
    fs::write(path.join("marked.json"), format!("\u{feff}{text}")).unwrap();
    let (status, _, err) = run(path, &["simulate", "marked.json", "-o", "out"]);
    assert_eq!(status, 0, "{err}");
    let digits = "3".repeat(300);
    let long = ["--set", &format!("simulate.duration=0.{digits}")].map(str::to_owned);
    let long: Vec<&str> = long.iter().map(String::as_str).collect();
    let (status, out, err) = run(
        path,
        &[&["simulate", "marked.json", "-o", "out"], &long[..]].concat(),
    );
    assert!(status == 0 && out.contains(" 0.333333333"), "{out}{err}");
    for number in [
        "9".repeat(400),
        format!("0.{digits} parsec"),
        format!("-{digits}"),
    ] {
        let set = format!("simulate.duration={number}");
        let (status, _, err) = run(
            path,
            &["simulate", "marked.json", "-o", "out", "--set", &set],
        );
        assert!(status == 2 && err.contains("simulate.duration: "), "{err}");
        assert!(err.chars().count() < 1000, "{err}");
    }
}
