//! Systems of scene files, chains written out included.

use crate::scene::{Case, PROBLEM, SCENE, check, folder, mistake};
use proboscis::control::problem::{BoundaryState, Limit, Rest, Task};
use proboscis::files::{expand, read_problem, read_scene};
use proboscis::model::system::{JointKind, Shape, System, VACUUM_PERMITTIVITY};
use proboscis::model::{FieldPlace, What};
use std::fs;
use std::path::Path;

#[test]
fn a_scene_means_what_is_written() {
    let (_folder, path) = folder(SCENE, PROBLEM);
    let loaded = read_problem(&path, &[]).expect("a problem");
    let System {
        bodies,
        joints,
        muscles,
        gravity,
        ..
    } = &loaded.system;
    let transverse = 30.0 * (3.0 * 400.0 + 2500.0) / 12.0;
    assert_eq!(bodies[0].inertia, [transverse, transverse, 6000.0]);
    assert_eq!(
        bodies[0].shape,
        Shape::Cylinder {
            length: 50.0,
            radius: 20.0
        }
    );
    assert_eq!(bodies[0].directors.column(2).as_slice(), [0.0, 1.0, 0.0]);
    assert_eq!(bodies[0].directors.determinant(), 1.0);
    assert_eq!(
        bodies[1].inertia,
        [
            30.0 * 1300.0 / 12.0,
            30.0 * 1000.0 / 12.0,
            30.0 * 500.0 / 12.0
        ]
    );
    assert!(
        matches!(joints[0].kind, JointKind::Revolute { axis } if axis.as_slice() == [0.0, 0.0, 1.0])
    );
    assert_eq!(gravity.map(|g| g.y), Some(-9.81 / 1e3));
    let material = muscles[0].material;
    assert_eq!(
        (material.density, material.shear_modulus, material.viscosity),
        (Some(1e-3), 0.1, Some(1.0))
    );
    let electric = material.electric.expect("an electric term");
    assert_eq!(
        (electric.c1, electric.c2, electric.permittivity),
        (
            -2.0 * VACUUM_PERMITTIVITY,
            VACUUM_PERMITTIVITY,
            VACUUM_PERMITTIVITY
        )
    );
    assert_eq!(muscles[1].material.electric, None);
    assert_eq!(muscles[0].layer_thickness, 0.05);
    let Task::Control(control) = &loaded.task else {
        panic!("a control problem")
    };
    assert_eq!(
        control.goal,
        BoundaryState::RestAtVoltages(vec![1700.0, 0.0], Rest::Attainable)
    );
    assert_eq!(
        control.limits[1..],
        [Limit::below(What::Field(FieldPlace::Muscle(0)), 80_000.0)]
    );

    let explicit = SCENE.replacen(
        "\"axis\": [0, 1, 0] }",
        "\"axis\": [0, 1, 0] }, \"inertia\": [1e-6, 2e-6, 2.5e-6]",
        1,
    );
    fs::write(path.with_file_name("scene.json"), explicit).expect("a written scene");
    let inertia = read_scene(&path.with_file_name("scene.json"))
        .expect("a scene")
        .bodies[0]
        .inertia;
    assert_eq!(
        inertia,
        [2.5e-6, 1e-6, 2e-6].map(|moment: f64| moment * 1e9)
    );
}

#[test]
fn a_locked_joint_is_fixed() {
    let key = "\"at\": [0, \"50 mm\", 0] }";
    let locked = "\"at\": [0, \"50 mm\", 0], \"damping\": \"3 N s/m\", \"locked\": true }";
    assert!(SCENE.contains(key));
    let (folder, _) = folder(&SCENE.replace(key, locked), PROBLEM);
    let system = read_scene(&folder.path().join("scene.json")).expect("a scene");
    assert_eq!(system.joints[1].kind, JointKind::Fixed);
    assert_eq!(system.joints[1].damping, None);
    let goal = "{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }";
    let moved = PROBLEM.replace(goal, "{ \"joint_angles\": { \"joint2\": \"1 mm\" } }");
    let error = mistake(&SCENE.replace(key, locked), &moved, &[]);
    assert_eq!(error.path(), "control.goal.joint_angles.joint2");
    assert!(error.found().contains("locked"), "{error}");
}

#[test]
fn a_free_body_says_so() {
    let scene = r#"{ "name": "x", "bodies": [ { "name": "stone", "mass": 1, "sphere": { "radius": 1 }, "position": [0, 0, 0], "free": true } ] }"#;
    let (folder, _) = folder(scene, "{}");
    let path = folder.path().join("scene.json");
    assert_eq!(read_scene(&path).expect("a free body").bodies.len(), 1);
    let floating = r#", "joints": [ { "name": "base", "floating": {}, "parent": "ground", "child": "stone", "at": [0, 0, 0] } ] }"#;
    let joined = scene.replace(", \"free\": true", "");
    fs::write(&path, format!("{}{floating}", &joined[..joined.len() - 2]))
        .expect("a written scene");
    let system = read_scene(&path).expect("a body that floats");
    assert_eq!(system.joints[0].kind, JointKind::Floating);
    fs::write(&path, scene.replace(", \"free\": true", "")).expect("a written scene");
    let error = read_scene(&path).expect_err("a floating body");
    assert_eq!(error.path(), "bodies[0]");
    assert!(error.found().contains("\"stone\""), "{error}");
}

/// The trunk written out by hand, after the description in the reference solution.
fn explicit_trunk(segments: usize) -> String {
    let (mut bodies, mut joints, mut muscles) = (Vec::new(), Vec::new(), Vec::new());
    for i in 1..=segments {
        let y = 50.0 * (i - 1) as f64;
        let parent = if i == 1 {
            "ground".to_owned()
        } else {
            format!("segment{}", i - 1)
        };
        bodies.push(format!(r#"{{ "name": "segment{i}", "mass": 0.03, "cylinder": {{ "length": "50 mm", "radius": "20 mm", "axis": [0, 1, 0] }}, "position": [0, "{} mm", 0] }}"#, 50 * i - 25));
        let axis = if i % 2 == 1 { "[0, 0, 1]" } else { "[1, 0, 0]" };
        joints.push(format!(r#"{{ "name": "joint{i}", "revolute": {{ "axis": {axis} }}, "parent": "{parent}", "child": "segment{i}", "at": [0, "{} mm", 0] }}"#, 50 * (i - 1)));
        for (number, arm) in [(2 * i - 1, 15.0), (2 * i, -15.0)] {
            let (x, z) = if i % 2 == 1 { (arm, 0.0) } else { (0.0, arm) };
            let (below, above) = (y - 20.0, y + 20.0);
            muscles.push(format!(r#"{{ "name": "muscle{number}", "material": "silicone", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um", "from": {{ "body": "{parent}", "at": ["{x} mm", "{below} mm", "{z} mm"] }}, "to": {{ "body": "segment{i}", "at": ["{x} mm", "{above} mm", "{z} mm"] }} }}"#));
        }
    }
    format!(
        r#"{{ "name": "elephant trunk", "materials": {{ "silicone": {{ "density": 1000, "shear_modulus": 1e5, "lame_lambda": 4e5, "relative_permittivity": 3, "viscosity": 1000 }} }},
        "bodies": [{}], "joints": [{}], "muscles": [{}], "markers": [{{ "name": "tip", "body": "segment{segments}", "at": [0, "{} mm", 0] }}] }}"#,
        bodies.join(","),
        joints.join(","),
        muscles.join(","),
        50 * segments
    )
}

#[test]
fn chain_expanded_and_explicit_scene_are_one_system() {
    let path = Path::new("problems/scenes/elephant_trunk.json");
    let chain = read_scene(path).expect("the chain");
    let (folder, _) = folder(&explicit_trunk(6), "{}");
    let file = folder.path().join("scene.json");
    assert_eq!(chain, read_scene(&file).expect("the explicit scene"));
    fs::write(&file, expand(path).expect("an expansion")).expect("a written scene");
    assert_eq!(chain, read_scene(&file).expect("the expanded scene"));
}

#[test]
fn mistakes_of_a_chain_point_at_the_chain() {
    let text = fs::read_to_string("problems/scenes/pair.json").expect("the scene");
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"material\": \"silicone\"", "\"material\": \"silicon\"", "chain.muscles.material", "\"silicon\"", "the name of a material", "silicon"),
        ("[0, 0, 1]", "[0, 1, 1]", "chain.first_joint_axis", "[0.0, 1.0, 1.0]", "at right angles", "[0, 1, 1]"),
        ("\"segments\": 1", "\"segments\": 0", "chain.segments", "0", "a whole number from 1", "0"),
        ("\"material\": \"silicone\"", "\"material\": \"silicone\", \"layers\": 2", "chain.muscles.layers", "\"layers\" of a lumped muscle", "\"finite_elements\"", "2"),
        ("\"material\": \"silicone\"", "\"material\": \"silicone\", \"model\": \"finite_elements\", \"elements\": [1, 1, 4], \"layers\": 3", "chain.muscles.layers", "3", "a divisor of the 4 elements", "3"),
        ("\"length\": \"50 mm\"", "\"length\": \"-50 mm\"", "chain.length", "-50 mm", "positive", "-50 mm"),
        ("\"chain\"", "\"markers\": [ { \"name\": \"tip\", \"body\": \"segment1\", \"at\": [0, 0, 0] } ], \"chain\"", "chain", "\"tip\" a second time", "not taken", "segments"),
    ];
    check(cases, &text, |scene| {
        let (folder, _) = folder(scene, "{}");
        read_scene(&folder.path().join("scene.json")).expect_err("a mistake")
    });
}

#[test]
fn a_list_stands_on_one_line_where_it_fits() {
    let problems = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/scenes");
    let (mut broken, mut whole) = (0, 0);
    for entry in fs::read_dir(problems).expect("a folder") {
        let path = entry.expect("a file").path();
        if path.extension().is_none_or(|end| end != "json") {
            continue;
        }
        let text = expand(&path).expect("an expansion");
        let lines: Vec<&str> = text.lines().collect();
        let indent = |line: &str| line.len() - line.trim_start().len();
        whole += lines
            .iter()
            .filter(|line| line.contains("[ ") || line.contains("{ "))
            .count();
        for (i, line) in lines.iter().enumerate().skip(1) {
            let Some(open) = line.chars().last().filter(|c| "[{".contains(*c)) else {
                continue;
            };
            let rest = lines[i + 1..].iter();
            let items: Vec<&str> = rest
                .take_while(|inner| indent(inner) > indent(line))
                .map(|inner| inner.trim())
                .collect();
            let close = lines[i + 1 + items.len()].trim().trim_end_matches(',');
            let space = if open == '{' { " " } else { "" };
            let joined = format!("{line}{space}{}{space}{close}", items.join(" "));
            assert!(joined.chars().count() > 110, "{joined}");
            broken += 1;
        }
        let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert!(value["bodies"].is_array() || value["solids"].is_array());
    }
    assert!(broken > 20 && whole > 20, "{broken} {whole}");
}
