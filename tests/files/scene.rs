//! Scene and problem files: every mistake is answered with its place, what was found and what is expected.

use proboscis::control::problem::{Control, Duration, Limit, Task};
use proboscis::files::{SceneError, new_trunk, read_problem, schema};
use proboscis::ipopt::LinearSolver;
use proboscis::model::system::{Discretisation, ElementKind, Fidelity};
use proboscis::model::{FieldPlace, What};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

pub(crate) const SCENE: &str = r#"{
  "name": "two links",
  "materials": {
    "silicone": { "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "relative_permittivity": 3.0, "viscosity": "1000 Pa s" },
    "rubber": { "shear_modulus": "100 kPa" }
  },
  "bodies": [
    { "name": "segment1", "mass": "30 g", "cylinder": { "length": "50 mm", "radius": "20 mm", "axis": [0, 1, 0] }, "position": [0, "25 mm", 0] },
    { "name": "segment2", "mass": "30 g", "box": { "size": ["10 mm", "20 mm", "30 mm"] }, "position": [0, "75 mm", 0] }
  ],
  "joints": [
    { "name": "joint1", "revolute": { "axis": [0, 0, 2] }, "parent": "ground", "child": "segment1", "at": [0, 0, 0] },
    { "name": "joint2", "prismatic": { "axis": [0, 1, 0] }, "parent": "segment1", "child": "segment2", "at": [0, "50 mm", 0] }
  ],
  "muscles": [
    { "name": "muscle1", "material": "silicone", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
      "from": { "body": "ground", "at": ["15 mm", "-20 mm", 0] }, "to": { "body": "segment1", "at": ["15 mm", "20 mm", 0] } },
    { "name": "muscle2", "material": "rubber", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
      "from": { "body": "segment1", "at": ["15 mm", "30 mm", 0] }, "to": { "body": "segment2", "at": ["15 mm", "70 mm", 0] } }
  ],
  "markers": [ { "name": "tip", "body": "segment2", "at": [0, "100 mm", 0] } ],
  "gravity": [0, "-9.81 m/s^2", 0]
}"#;

pub(crate) const PROBLEM: &str = r#"{
  "scene": "scene.json",
  "control": {
    "duration": "0.2 s", "intervals": 20,
    "start": { "rest_at_voltages": {} },
    "goal": { "rest_at_voltages": { "muscle1": "1.7 kV" } },
    "voltage_bounds": ["0 V", "3 kV"],
    "objective": { "effort": 1.0 },
    "limits": [
      { "joint_angle": { "joint": "joint1", "min": "-17 deg", "max": "0.3 rad" } },
      { "electric_field": { "muscles": "all", "max": "80 V/um" } }
    ]
  }
}"#;

/// A folder with scene and problem.
pub(crate) fn folder(scene: &str, problem: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("scene.json"), scene).expect("a written scene");
    let path = folder.path().join("problem.json");
    fs::write(&path, problem).expect("a written problem");
    (folder, path)
}

/// The optimal control of a problem with a scene.
pub(crate) fn control(scene: &str, problem: &str) -> Control {
    let (_folder, path) = folder(scene, problem);
    match read_problem(&path, &[]).expect("a problem").task {
        Task::Control(control) => *control,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn mistake(scene: &str, problem: &str, overrides: &[&str]) -> SceneError {
    let (_folder, path) = folder(scene, problem);
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    read_problem(&path, &overrides).expect_err("a mistake")
}

/// Old text, new text, then path, found and expected of the message, then the text under the span.
pub(crate) type Case = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
);

pub(crate) fn check(cases: &[Case], base: &str, answer: impl Fn(&str) -> SceneError) {
    for &(old, new, path, found, expected, span) in cases {
        assert!(base.contains(old), "the base text has no {old}");
        let text = base.replacen(old, new, 1);
        let error = answer(&text);
        let message = error.to_string();
        assert_eq!(error.path(), path, "{message}");
        assert!(error.found().contains(found), "{found} in {message}");
        assert!(
            error.expected().contains(expected),
            "{expected} in {message}"
        );
        for part in [error.path(), error.found(), error.expected()] {
            assert!(message.contains(part), "{part} in {message}");
        }
        assert!(!message.contains('\n'), "{message}");
        let spanned = &text[error.span().expect("a span")];
        assert!(spanned.contains(span), "{span} in {spanned} of {message}");
    }
}

#[test]
fn mistakes_in_a_scene_name_place_found_and_expected() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"name\": \"two links\",", "\"name\": \"two links\"", "", "line 3 column 3", "JSON", "\""),
        ("\"gravity\"", "\"gravty\"", "gravty", "the key \"gravty\"", "\"gravity\"", "\"gravty\""),
        ("\"mass\": \"30 g\"", "\"mass\": \"30 mm\"", "bodies[0].mass", "\"30 mm\", which is a length", "a mass, such as \"30 g\"", "\"30 mm\""),
        ("\"mass\": \"30 g\"", "\"mass\": \"-30 g\"", "bodies[0].mass", "\"-30 g\"", "a positive value", "\"-30 g\""),
        ("\"mass\": \"30 g\"", "\"mass\": 0", "bodies[0].mass", "0", "a positive value", "0"),
        ("\"mass\": \"30 g\"", "\"mass\": 1e999", "bodies[0].mass", "1e999, which is not finite", "finite", "1e999"),
        ("\"mass\": \"30 g\"", "\"mass\": \"1e999 g\"", "bodies[0].mass", "not finite", "a mass", "1e999"),
        ("\"mass\": \"30 g\"", "\"mass\": 1e307", "bodies[0].mass", "not finite", "a mass", "1e307"),
        ("\"mass\": \"30 g\"", "\"mass\": true", "bodies[0].mass", "boolean true", "a mass", "true"),
        ("\"mass\": \"30 g\"", "\"mass\": \"30\"", "bodies[0].mass", "\"30\", which has no unit", "a mass", "30"),
        ("\"mass\": \"30 g\"", "\"mass\": \"30 flops\"", "bodies[0].mass", "\"flops\" is no known unit", "a mass", "flops"),
        ("\"mass\": \"30 g\", ", "", "bodies[0]", "none of them", "exactly one of \"mass\", \"density\"", "segment1"),
        ("\"name\": \"segment2\"", "\"name\": \"segment1\"", "bodies[1].name", "\"segment1\" a second time", "not taken", "\"segment1\""),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle1\"", "muscles[1].name", "\"muscle1\" a second time", "not taken", "\"muscle1\""),
        ("\"rubber\":", "\"silicone\":", "materials.silicone", "\"silicone\" twice", "each key once", "\"silicone\""),
        ("\"body\": \"segment1\", \"at\": [\"15 mm\", \"30", "\"body\": \"segmnt1\", \"at\": [\"15 mm\", \"30", "muscles[1].from.body", "\"segmnt1\"", "the name of a body or \"ground\"", "\"segmnt1\""),
        ("\"child\": \"segment2\"", "\"child\": \"ground\"", "joints[1].child", "\"ground\"", "the name of a body", "\"ground\""),
        ("\"child\": \"segment2\"", "\"child\": \"segment1\"", "joints[1].child", "the parent too", "another body", "\"segment1\""),
        ("\"parent\": \"segment1\", \"child\": \"segment2\"", "\"parent\": \"ground\", \"child\": \"segment1\"", "bodies[1]", "\"segment2\", which no chain of joints connects", "a joint", "segment2"),
        ("\"material\": \"rubber\"", "\"material\": \"ruber\"", "muscles[1].material", "\"ruber\"", "the name of a material", "\"ruber\""),
        ("[\"15 mm\", \"20 mm\", 0]", "[\"15 mm\", \"-20 mm\", 0]", "muscles[0].to.at", "length zero", "another place", "-20 mm"),
        ("\"axis\": [0, 0, 2]", "\"axis\": [0, 0, 0]", "joints[0].revolute.axis", "[0.0, 0.0, 0.0]", "a direction", "[0, 0, 0]"),
        ("\"axis\": [0, 0, 2]", "\"axis\": [0, 0]", "joints[0].revolute.axis", "a list of length 2", "a list of 3 values", "[0, 0]"),
        ("[\"10 mm\", \"10 mm\"]", "[1, 2, 3]", "muscles[0].cross_section", "a list of length 3", "a list of 2 values", "[1, 2, 3]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"revolute\": [[0, 0, 2]]", "joints[0].revolute", "a list", "an object", "[[0, 0, 2]]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"spherical\": {}, \"fixed\": {}", "joints[0]", "\"spherical\", \"fixed\"", "exactly one of", "joint1"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"universal\": { \"axes\": [[0, 0, 2], [0, 1, 1]] }", "joints[0].universal.axes", "axes at 45 deg", "at 90 deg", "[0, 1, 1]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"universal\": { \"axes\": [[0, 0, 2], [0, 0, 0]] }", "joints[0].universal.axes[1]", "[0.0, 0.0, 0.0]", "a direction", "[0, 0, 0]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"cylindrical\": { \"axis\": [0, 0, 0] }", "joints[0].cylindrical.axis", "[0.0, 0.0, 0.0]", "a direction", "[0, 0, 0]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"planar\": { \"normal\": [0, 0, 0] }", "joints[0].planar.normal", "[0.0, 0.0, 0.0]", "a direction", "[0, 0, 0]"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"planar\": { \"normal\": [0, 0, 2] }, \"stiffness\": \"1 N/m\"", "joints[0].stiffness", "1 N/m", "neither revolute nor prismatic", "1 N/m"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"cylindrical\": { \"axis\": [0, 0, 2] }, \"stops\": { \"max\": \"1 mm\", \"stiffness\": \"1 N/m\" }", "joints[0].stops.stiffness", "1 N/m", "neither revolute nor prismatic", "1 N/m"),
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"universal\": { \"axes\": [[0, 0, 2], [0, 1, 0]] }, \"motion\": \"1 deg\"", "joints[0].motion", "motion", "neither revolute nor prismatic", "1 deg"),
        ("\"position\": [0, \"75 mm\", 0]", "\"position\": [0, \"75 mm\", 0], \"inertia\": [1e-6, 1e-6, 3e-6]", "bodies[1].inertia", "3", "none is larger than the sum", "3e-6"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"model\": \"finite_elements\", \"elements\": [2, 2, 8]", "muscles[1].material", "\"rubber\", which has neither \"lame_lambda\" nor \"poisson_ratio\"", "a material with one of them", "\"rubber\""),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"elements\": [2, 2, 8]", "muscles[1].elements", "\"elements\" of a lumped muscle", "\"model\": \"finite_elements\"", "[2, 2, 8]"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"first_side\": [1, 0, 0]", "muscles[1].first_side", "\"first_side\" of a lumped muscle", "\"finite_elements\"", "[1, 0, 0]"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"layers\": 4", "muscles[1].layers", "\"layers\" of a lumped muscle", "\"finite_elements\"", "4"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"element\": \"hex8_q1p0\"", "muscles[1].element", "\"element\" of a lumped muscle", "\"finite_elements\"", "hex8"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"model\": \"lumpd\"", "muscles[1].model", "\"lumpd\"", "one of \"lumped\"", "lumpd"),
        ("\"relative_permittivity\": 3.0", "\"relative_permittivity\": 3.0, \"c1\": 1e-12", "materials.silicone", "\"relative_permittivity\" and \"c1\"", "either", "3.0"),
        ("\"shear_modulus\": \"100 kPa\" }", "\"shear_modulus\": \"100 kPa\", \"poisson_ratio\": 0.5 }", "materials.rubber.poisson_ratio", "0.5", "smaller than 0.5", "0.5"),
        ("\"at\": [0, \"50 mm\", 0]", "\"at\": [0, \"50 mm\", 0], \"damping\": \"1 N m s/rad\"", "joints[1].damping", "a rotational damping", "a damping", "rad"),
    ];
    check(cases, SCENE, |scene| mistake(scene, PROBLEM, &[]));
}

/// The scene with one muscle of finite elements.
pub(crate) fn elastic_scene() -> String {
    SCENE
        .replacen(
            "\"viscosity\"",
            "\"lame_lambda\": \"400 kPa\", \"viscosity\"",
            1,
        )
        .replacen(
            "\"name\": \"muscle1\"",
            "\"name\": \"muscle1\", \"model\": \"finite_elements\", \"elements\": [2, 3, 8]",
            1,
        )
}

#[test]
fn mistakes_in_a_muscle_of_finite_elements_name_place_found_and_expected() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        (", \"elements\": [2, 3, 8]", "", "muscles[0]", "finite elements without a number", "the key \"elements\"", "muscle1"),
        ("[2, 3, 8]", "[2, 0, 8]", "muscles[0].elements[1]", "0", "1 element or more", "0"),
        ("[2, 3, 8]", "[2, 8]", "muscles[0].elements", "a list of length 2", "a list of 3 values", "[2, 8]"),
        ("[2, 3, 8]", "[9999, 9999, 9999]", "muscles[0].elements", "9999", "no more than", "9999"),
        ("[2, 3, 8]", "[2, 3, 8], \"layers\": 3", "muscles[0].layers", "3", "a divisor of the 8 elements along the span", "3"),
        ("[2, 3, 8]", "[2, 3, 8], \"element\": \"hex20\"", "muscles[0].element", "\"hex20\"", "\"hex8\"", "hex20"),
        ("[2, 3, 8]", "[2, 3, 8], \"first_side\": [0, 2, 0]", "muscles[0].first_side", "along the span", "across the span", "[0, 2, 0]"),
        ("[2, 3, 8]", "[2, 3, 8], \"first_side\": [0, 0, 0]", "muscles[0].first_side", "0.0", "a direction", "[0, 0, 0]"),
        ("[2, 3, 8]", "[2, 3, 8], \"section_inertia\": true", "muscles[0].section_inertia", "finite elements", "no such key", "true"),
    ];
    check(cases, &elastic_scene(), |scene| {
        mistake(scene, PROBLEM, &[])
    });
    // A limit of all fields is one of its elements; the distance of its ends is that of a lumped muscle.
    let (_folder, path) = folder(&elastic_scene(), PROBLEM);
    let loaded = read_problem(&path, &[]).expect("a field limit");
    let Task::Control(control) = &loaded.task else {
        panic!("a control problem")
    };
    let expected = Limit::below(
        What::Field(FieldPlace::Block {
            block: 0,
            region: None,
        }),
        80_000.0,
    );
    assert_eq!(control.limits[1..], [expected]);
    let of_stretch = "control.limits=[{\"stretch\": {\"muscle\": \"muscle1\", \"min\": 0.5}}]";
    let (_folder, path) = folder(&elastic_scene(), PROBLEM);
    let loaded = read_problem(&path, &[of_stretch.to_owned()]).expect("a stretch limit");
    let expected = Discretisation {
        first_side: None,
        elements: [2, 3, 8],
        layers: 8,
        element: ElementKind::Hex8,
    };
    let fidelity = loaded.system.muscles[0].fidelity;
    assert_eq!(fidelity, Fidelity::FiniteElements(expected));
}

#[test]
fn mistakes_in_a_problem_name_place_found_and_expected() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"intervals\": 20", "\"intervalls\": 20", "control.intervalls", "the key \"intervalls\"", "\"intervals\"", "\"intervalls\""),
        ("\"intervals\": 20", "\"intervals\": 0", "control.intervals", "0", "1 interval or more", "0"),
        ("\"intervals\": 20", "\"intervals\": -3", "control.intervals", "-3", "a whole number", "-3"),
        ("\"0.2 s\"", "\"0.2 V\"", "control.duration", "\"0.2 V\", which is a voltage", "a time, such as", "0.2 V"),
        ("\"0.2 s\"", "{ \"min\": 2, \"max\": 1, \"guess\": 1 }", "control.duration.max", "1", "no shorter than", "1"),
        ("\"0.2 s\"", "{ \"min\": 1, \"max\": 2, \"guess\": 3 }", "control.duration.guess", "3", "from 1 to 2", "3"),
        ("\"1.7 kV\"", "\"3 mm\"", "control.goal.rest_at_voltages.muscle1", "\"3 mm\", which is a length", "a voltage, such as \"1.7 kV\"", "\"3 mm\""),
        ("\"1.7 kV\"", "\"3.5 kV\"", "control.goal.rest_at_voltages.muscle1", "3500 V", "within the bounds 0 V to 3000 V", "\"3.5 kV\""),
        ("\"muscle1\"", "\"muscl1\"", "control.goal.rest_at_voltages.muscl1", "\"muscl1\"", "the name of a muscle or of a driven electrode (block.electrode)", "\"muscl1\""),
        ("\"muscle1\"", "\"muscle2\"", "control.goal.rest_at_voltages.muscle2", "no electric term", "relative_permittivity", "1.7 kV"),
        ("[\"0 V\", \"3 kV\"]", "[\"3 kV\", \"1 V\"]", "control.voltage_bounds[1]", "\"1 V\"", "no less than the lower bound \"3 kV\"", "\"1 V\""),
        ("[\"0 V\", \"3 kV\"]", "[\"-1 V\", \"3 kV\"]", "control.voltage_bounds[0]", "\"-1 V\"", "not negative", "\"-1 V\""),
        ("{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }", "{ \"markers\": { \"tip\": [0, \"90 mm\", 0] } }", "control.goal.markers", "3 final conditions", "2 degrees of freedom", "tip"),
        ("{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }", "{ \"joint_angles\": { \"joint2\": \"0.3 rad\" } }", "control.goal.joint_angles.joint2", "which is an angle", "a length", "0.3 rad"),
        ("{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }", "{}", "control.goal", "none of them", "exactly one of", "{}"),
        ("{ \"effort\": 1.0 }", "{ \"tracking\": 1.0 }", "control.objective.tracking", "the key \"tracking\"", "\"track\"", "\"tracking\""),
        ("{ \"effort\": 1.0 }", "{ \"efort\": 1.0 }", "control.objective.efort", "the key \"efort\"", "\"effort\"", "\"efort\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"voltages\": { \"muscle2\": 0 },", "control.voltages.muscle2", "no electric term", "relative_permittivity", "0"),
        ("\"intervals\": 20,", "\"intervals\": 20, \"voltages\": { \"muscle1\": 0 },", "control.voltages", "all voltages", "at least one voltage that is not given", "{ \"muscle1\": 0 }"),
        ("{ \"effort\": 1.0 }", "{}", "control.objective", "no weight", "a positive weight", "{}"),
        ("\"joint\": \"joint1\"", "\"joint\": \"joint\"", "control.limits[0].joint_angle.joint", "\"joint\"", "the name of a joint", "\"joint\""),
        ("\"max\": \"0.3 rad\"", "\"max\": \"-40 deg\"", "control.limits[0].joint_angle.max", "below", "not crossed", "-40 deg"),
        ("\"max\": \"0.3 rad\"", "\"max\": \"0.3\"", "control.limits[0].joint_angle.max", "no unit", "an angle", "\"0.3\""),
        ("\"80 V/um\"", "\"80 V\"", "control.limits[1].electric_field.max", "which is a voltage", "an electric field", "80 V"),
        ("\"scene.json\"", "\"missing.json\"", "scene", "\"missing.json\", where there is no file", "the path of a scene file", "missing"),
        ("\"scene.json\"", "{ \"name\": \"x\", \"bodys\": [] }", "scene.bodys", "the key \"bodys\"", "\"bodies\"", "\"bodys\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"solver\": { \"ipopt\": { \"x\": [] } },", "control.solver.ipopt.x", "another kind", "a whole number, a number or a text", "[]"),
        ("\"intervals\": 20,", "\"intervals\": 20, \"solver\": { \"linear_solver\": \"pardiso\" },", "control.solver.linear_solver", "\"pardiso\"", "\"stages\"", "\"pardiso\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"solver\": { \"linear_solver\": \"stages\", \"ipopt\": { \"linear_solver\": \"mumps\" } },", "control.solver.ipopt.linear_solver", "\"mumps\"", "one linear solver", "\"mumps\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"guess\": \"interpolat\",", "control.guess", "\"interpolat\"", "\"interpolate\"", "\"interpolat\""),
    ];
    check(cases, PROBLEM, |problem| mistake(SCENE, problem, &[]));
}

#[test]
fn nearest_names_are_suggested() {
    let scene = SCENE.replacen(
        "\"body\": \"segment1\", \"at\": [\"15 mm\", \"30",
        "\"body\": \"segmnt1\", \"at\": [\"15 mm\", \"30",
        1,
    );
    let error = mistake(&scene, PROBLEM, &[]);
    let expected = "scene.json: muscles[1].from.body: found \"segmnt1\", expected the name of a body or \"ground\"; did you mean \"segment1\"?";
    assert!(error.to_string().ends_with(expected), "{error}");
    let problem = PROBLEM.replace("intervals", "intervalls");
    assert_eq!(mistake(SCENE, &problem, &[]).nearest(), Some("intervals"));
}

#[test]
fn overrides_change_problem_and_scene_and_answer_for_mistakes() {
    let (_folder, path) = folder(SCENE, PROBLEM);
    let overrides = [
        "control.intervals=80",
        "control.duration=0.4 s",
        "scene.bodies[0].mass=60 g",
        "control.solver.tolerance=1e-6",
        "control.solver.linear_solver=mumps",
    ];
    let loaded = read_problem(&path, &overrides.map(str::to_owned)).expect("overrides apply");
    let Task::Control(control) = loaded.task else {
        panic!("a control problem")
    };
    assert_eq!(
        (control.intervals, control.duration),
        (80, Duration::Given(400.0))
    );
    assert_eq!(
        (loaded.system.bodies[0].mass, control.solver.tolerance),
        (60.0, 1e-6)
    );
    assert_eq!(control.solver.linear_solver, LinearSolver::Mumps);

    for (text, path, part) in [
        (
            "control.intervals=0",
            "control.intervals",
            "found 0 (set on the command line), expected 1 interval",
        ),
        (
            "scene.muscles[1].from.body=segmnt1",
            "muscles[1].from.body",
            "did you mean \"segment1\"?",
        ),
        (
            "scene.muscles[7].material=silicone",
            "muscles[7].material",
            "below 2",
        ),
        ("control.intervals.x=1", "control.intervals.x", "no object"),
        (
            "control.intervalls=5",
            "control.intervalls",
            "did you mean \"intervals\"?",
        ),
        (
            "control.solvr.tolerance=5",
            "control.solvr",
            "did you mean \"solver\"?",
        ),
        ("control.duration=1e999 s", "control.duration", "not finite"),
        ("nothing", "", "path=value"),
    ] {
        let error = mistake(SCENE, PROBLEM, &[text]);
        assert_eq!(error.path(), path, "{error}");
        assert!(error.to_string().contains(part), "{part} in {error}");
        assert_eq!(error.span(), None);
    }
}

#[test]
fn every_kept_problem_is_right() {
    for entry in fs::read_dir("problems").expect("the problems") {
        let path = entry.expect("an entry").path();
        let name = path.to_string_lossy().into_owned();
        if name.ends_with(".json") && !name.ends_with(".schema.json") {
            read_problem(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        }
    }
    let (scene, problem) = new_trunk(6);
    let (_folder, path) = folder(&scene, &problem);
    let started = read_problem(&path, &[]).expect("a starting problem");
    let kept =
        read_problem(Path::new("problems/elephant_trunk_effort.json"), &[]).expect("the trunk");
    assert_eq!(started.task, kept.task);
}

/// Set `PROBOSCIS_WRITE_SCHEMA` to write the kept files anew.
#[test]
fn kept_schemas_are_current() {
    let (scene, problem) = schema();
    let study = proboscis::files::study_schema();
    let sweep = proboscis::files::sweep_schema();
    let all = [
        ("scene", scene),
        ("problem", problem),
        ("study", study),
        ("sweep", sweep),
    ];
    for (name, schema) in all {
        let path = format!("problems/{name}.schema.json");
        let text = serde_json::to_string_pretty(&schema).expect("a schema is JSON") + "\n";
        if std::env::var_os("PROBOSCIS_WRITE_SCHEMA").is_some() {
            fs::write(&path, &text).expect("a written schema");
        }
        assert!(
            fs::read_to_string(&path).is_ok_and(|kept| kept == text),
            "{path} is out of date"
        );
    }
}
