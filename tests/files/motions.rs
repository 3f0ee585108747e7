//! Several motions of a control problem: each is the problem with its own keys in place, and its mistakes have their places.

use crate::scene::{Case, check, folder, mistake};
use proboscis::control::Motions;
use proboscis::control::problem::Task;
use proboscis::files::read_problem;

/// A pair of muscles.
const PAIR: &str = r#"{
  "name": "pair",
  "materials": { "soft": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "viscosity": "1000 Pa s" } },
  "chain": {
    "segments": 1, "length": "50 mm", "radius": "20 mm", "mass": "30 g", "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
    "muscles": { "material": "soft", "arm": "15 mm", "rest_length": "40 mm", "cross_section": ["10 mm", "8 mm"], "layer_thickness": "50 um" }
  }
}"#;

/// Two motions with inputs in common.
const TWO: &str = r#"{ "scene": "scene.json", "control": { "duration": "0.2 s", "intervals": 4, "start": { "joint_angles": {} },
  "goal": { "joint_angles": { "joint1": 0.1 } }, "voltage_bounds": [0, "3 kV"], "objective": { "effort": 1 },
  "motions": [
    { "name": "near", "goal": { "joint_angles": { "joint1": 0.05 } } },
    { "name": "soft", "set": { "scene.materials.soft.shear_modulus": "80 kPa" }, "hold": "reported" }
  ],
  "shared_inputs": ["muscle1"] } }"#;

fn motions(problem: &str, overrides: &[&str]) -> Motions {
    let (_folder, path) = folder(PAIR, problem);
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    match read_problem(&path, &overrides).expect("a problem").task {
        Task::Motions(motions) => *motions,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_motion_is_the_problem_with_its_keys_in_place() {
    let found = motions(TWO, &[]);
    assert_eq!(found.shared_inputs, ["muscle1"]);
    let names: Vec<&str> = found.list.iter().map(|one| &*one.name).collect();
    assert_eq!(names, ["near", "soft"]);
    let start = TWO.find(r#""motions""#).unwrap();
    let single = format!("{} }} }}", TWO[..start].trim_end().trim_end_matches(','));
    let as_one = |text: &str| {
        let (_folder, path) = folder(PAIR, text);
        let loaded = read_problem(&path, &[]).expect("a problem");
        match loaded.task {
            Task::Control(control) => (loaded.system, *control),
            other => panic!("{other:?}"),
        }
    };
    let (system, control) = as_one(&single.replace("0.1", "0.05"));
    assert_eq!(
        (&found.list[0].system, &found.list[0].control),
        (&system, &control)
    );
    let (system, control) = as_one(&single);
    assert_eq!(found.list[1].control, control);
    let moduli = |system: &proboscis::System| -> Vec<f64> {
        system
            .muscles
            .iter()
            .map(|muscle| muscle.material.shear_modulus)
            .collect()
    };
    assert_eq!(moduli(&system), [0.1, 0.1]);
    assert_eq!(moduli(&found.list[1].system), [0.08, 0.08]);
}

#[test]
fn overrides_reach_all_motions_or_one_by_its_name() {
    let set = [
        "control.intervals=6",
        "control.motions.soft.hold=required",
        "scene.materials.soft.viscosity=500 Pa s",
    ];
    let found = motions(TWO, &set);
    let intervals: Vec<usize> = found.list.iter().map(|one| one.control.intervals).collect();
    assert_eq!(intervals, [6, 6]);
    assert_ne!(found.list[0].control.hold, found.list[1].control.hold);
    for one in &found.list {
        assert_eq!(one.system.muscles[0].material.viscosity, Some(0.5));
    }
    let unnamed = TWO
        .replace(r#""name": "near", "#, "")
        .replace(r#""name": "soft", "#, "");
    let names: Vec<String> = motions(&unnamed, &[])
        .list
        .into_iter()
        .map(|one| one.name)
        .collect();
    assert_eq!(names, ["motion1", "motion2"]);
}

/// What is wrong, and where.
const MISTAKES: &[Case] = &[
    (
        r#""name": "soft""#,
        r#""name": "near""#,
        "control.motions[1].name",
        "second time",
        "another name",
        r#""near""#,
    ),
    (
        r#""name": "soft""#,
        r#""name": "a/b""#,
        "control.motions[1].name",
        "a/b",
        "letters",
        r#""a/b""#,
    ),
    (
        r#""name": "soft""#,
        r#""name": 3"#,
        "control.motions[1].name",
        "3",
        "a name",
        "3",
    ),
    (
        r#""hold": "reported""#,
        r#""hald": 1"#,
        "control.motions[1].hald",
        "hald",
        "hold",
        r#""hald""#,
    ),
    (
        r#""joint1": 0.05"#,
        r#""joint2": 0.05"#,
        "control.motions[0].goal.joint_angles.joint2",
        "joint2",
        "a joint",
        r#""joint2""#,
    ),
    (
        r#""joint1": 0.1 "#,
        r#""joint2": 0.1 "#,
        "control.goal.joint_angles.joint2",
        "joint2",
        "a joint",
        r#""joint2""#,
    ),
    (
        r#""hold": "reported""#,
        r#""free": {}"#,
        "control.motions[1].free",
        "free",
        "in common",
        "{}",
    ),
    (
        r#""hold": "reported""#,
        r#""solver": {}"#,
        "control.motions[1].solver",
        "solver",
        "in common",
        "{}",
    ),
    (
        r#""hold": "reported""#,
        r#""intervals": 5"#,
        "control.shared_inputs",
        "soft",
        "one number",
        r#"["muscle1"]"#,
    ),
    (
        r#""hold": "reported""#,
        r#""voltages": { "muscle1": 0 }"#,
        "control.shared_inputs[0]",
        "not sought",
        "sought in all",
        r#""muscle1""#,
    ),
    (
        r#"["muscle1"]"#,
        r#"["muscle3"]"#,
        "control.shared_inputs[0]",
        "muscle3",
        "a muscle",
        r#""muscle3""#,
    ),
    (
        r#"["muscle1"]"#,
        r#"["muscle1", "muscle1"]"#,
        "control.shared_inputs[1]",
        "second time",
        "not taken",
        r#""muscle1""#,
    ),
    (
        r#"["muscle1"]"#,
        r#""muscle1""#,
        "control.shared_inputs",
        "muscle1",
        "a list",
        r#""muscle1""#,
    ),
    (
        r#""80 kPa""#,
        r#""-80 kPa""#,
        "control.motions[1].set.scene.materials.soft.shear_modulus",
        "-80 kPa",
        "positive",
        r#""-80 kPa""#,
    ),
    (
        r#""scene.materials.soft.shear_modulus""#,
        r#""control.duration""#,
        "control.motions[1].set.control.duration",
        "control.duration",
        "in the scene",
        r#""80 kPa""#,
    ),
];

#[test]
fn mistakes_of_motions_have_their_places() {
    check(MISTAKES, TWO, |text| mistake(PAIR, text, &[]));
}

#[test]
fn what_is_no_list_of_motions_is_refused() {
    let cases = [
        ("[]", "control.motions", "one motion or more"),
        ("3", "control.motions", "a list"),
        ("[4]", "control.motions[0]", "an object"),
    ];
    for (value, place, expected) in cases {
        let error = mistake(PAIR, TWO, &[&format!("control.motions={value}")]);
        assert_eq!(error.path(), place);
        assert!(error.expected().contains(expected), "{error}");
    }
    let start = TWO.find(r#""motions""#).unwrap();
    let end = TWO.find(r#""shared_inputs""#).unwrap();
    let none = format!("{}{}", &TWO[..start], &TWO[end..]);
    let error = mistake(PAIR, &none, &[]);
    assert_eq!(error.path(), "control.shared_inputs");
}
