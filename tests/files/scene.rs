//! Scene and problem files: every mistake is answered with its place, what was found and what is expected.

use proboscis::control::problem::{Afterwards, Duration, Limit, State, Task, Voltages};
use proboscis::dynamics::Integrator;
use proboscis::model::system::{
    Discretisation, ElementKind, Fidelity, JointKind, Potential, Shape, System, VACUUM_PERMITTIVITY,
};
use proboscis::scene::quantity::{
    Angle, Density, ElectricField, Length, Measure, Quantity, RotationalDamping, Time, Viscosity,
    Voltage,
};
use proboscis::scene::{SceneError, expand, new_trunk, read_problem, read_scene, schema};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SCENE: &str = r#"{
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

const PROBLEM: &str = r#"{
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
fn folder(scene: &str, problem: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("scene.json"), scene).expect("a written scene");
    let path = folder.path().join("problem.json");
    fs::write(&path, problem).expect("a written problem");
    (folder, path)
}

fn mistake(scene: &str, problem: &str, overrides: &[&str]) -> SceneError {
    let (_folder, path) = folder(scene, problem);
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    read_problem(&path, &overrides).expect_err("a mistake")
}

/// Old text, new text, then path, found and expected of the message, then the text under the span.
type Case = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
);

fn check(cases: &[Case], base: &str, answer: impl Fn(&str) -> SceneError) {
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
        ("\"mass\": \"30 g\", ", "", "bodies[0]", "no key \"mass\"", "the key \"mass\"", "segment1"),
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
        ("\"revolute\": { \"axis\": [0, 0, 2] }", "\"spherical\": {}, \"fixed\": {}", "joints[0]", "\"spherical\", \"fixed\"", "exactly one of", "joint1"),
        ("\"position\": [0, \"75 mm\", 0]", "\"position\": [0, \"75 mm\", 0], \"inertia\": [1e-6, 1e-6, 3e-6]", "bodies[1].inertia", "3", "none is larger than the sum", "3e-6"),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"model\": \"finite_elements\", \"elements\": [2, 2, 8]", "muscles[1].material", "\"rubber\", which has neither \"lame_lambda\" nor \"poisson_ratio\"", "a material with one of them", "\"rubber\""),
        ("\"name\": \"muscle2\"", "\"name\": \"muscle2\", \"elements\": [2, 2, 8]", "muscles[1].elements", "\"elements\" of a lumped muscle", "\"model\": \"finite_elements\"", "[2, 2, 8]"),
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
fn elastic_scene() -> String {
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
    let expected = Limit::BlockField {
        block: 0,
        region: None,
        max: 80_000.0,
    };
    assert_eq!(control.limits[1..], [expected]);
    let of_stretch = "control.limits=[{\"stretch\": {\"muscle\": \"muscle1\", \"min\": 0.5}}]";
    let (_folder, path) = folder(&elastic_scene(), PROBLEM);
    let loaded = read_problem(&path, &[of_stretch.to_owned()]).expect("a stretch limit");
    let expected = Discretisation {
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
        ("{ \"effort\": 1.0 }", "{ \"tracking\": 1.0 }", "control.objective.tracking", "not available in this version", "\"effort\"", "\"tracking\""),
        ("{ \"effort\": 1.0 }", "{ \"efort\": 1.0 }", "control.objective.efort", "the key \"efort\"", "\"effort\"", "\"efort\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"voltages\": { \"muscle2\": 0 },", "control.voltages.muscle2", "no electric term", "relative_permittivity", "0"),
        ("\"intervals\": 20,", "\"intervals\": 20, \"voltages\": { \"muscle1\": 0 },", "control.voltages", "all voltages", "not given, to be looked for", "{ \"muscle1\": 0 }"),
        ("{ \"effort\": 1.0 }", "{}", "control.objective", "no weight", "a positive weight", "{}"),
        ("\"joint\": \"joint1\"", "\"joint\": \"joint\"", "control.limits[0].joint_angle.joint", "\"joint\"", "the name of a joint", "\"joint\""),
        ("\"max\": \"0.3 rad\"", "\"max\": \"-40 deg\"", "control.limits[0].joint_angle.max", "below", "not crossed", "-40 deg"),
        ("\"max\": \"0.3 rad\"", "\"max\": \"0.3\"", "control.limits[0].joint_angle.max", "no unit", "an angle", "\"0.3\""),
        ("\"80 V/um\"", "\"80 V\"", "control.limits[1].electric_field.max", "which is a voltage", "an electric field", "80 V"),
        ("\"scene.json\"", "\"missing.json\"", "scene", "\"missing.json\", where there is no file", "the path of a scene file", "missing"),
        ("\"scene.json\"", "{ \"name\": \"x\", \"bodys\": [] }", "scene.bodys", "the key \"bodys\"", "\"bodies\"", "\"bodys\""),
        ("\"intervals\": 20,", "\"intervals\": 20, \"solver\": { \"ipopt\": { \"x\": [] } },", "control.solver.ipopt.x", "another kind", "a whole number, a number or a text", "[]"),
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
    let rows = vec![vec![100.0, 0.0], vec![200.0, 0.0], vec![200.0, 0.0]];
    assert_eq!(
        simulation.voltages,
        Voltages::Sampled {
            ends: vec![500.0, 1000.0],
            rows,
            afterwards: Afterwards::OfLastInterval,
            solution: Some(folder.path().join("solution.json")),
        }
    );
    let State::JointAngles { angles, rates, .. } = simulation.start else {
        panic!("joint angles")
    };
    assert!(angles.is_empty());
    assert_eq!((rates[&0], rates[&1]), (0.002, 3.0));
}

/// The voltages of a simulation with a table in place of them.
fn with_table(table: &str) -> Result<Voltages, String> {
    let problem = r#"{ "scene": "scene.json", "simulate": { "duration": "1 s", "step": "10 ms", "voltages": TABLE } }"#;
    let (_folder, path) = folder(SCENE, &problem.replace("TABLE", table));
    match read_problem(&path, &[]) {
        Ok(loaded) => match loaded.task {
            Task::Simulate(simulation) => Ok(simulation.voltages),
            _ => panic!("a simulation"),
        },
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn voltages_may_be_a_table() {
    let table = r#"{ "time": [0, "500 ms", 1], "voltages": { "muscle1": [100, "0.2 kV"] }, "hold": { "muscle1": 50 } }"#;
    let voltages = with_table(table).unwrap();
    let rows = vec![vec![100.0, 0.0], vec![200.0, 0.0], vec![50.0, 0.0]];
    assert_eq!(
        voltages,
        Voltages::Sampled {
            ends: vec![500.0, 1000.0],
            rows,
            afterwards: Afterwards::Held,
            solution: None,
        }
    );
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
    assert_eq!(control.goal, State::RestAtVoltages(vec![1700.0, 0.0]));
    assert_eq!(
        control.limits[1..],
        [Limit::ElectricField {
            muscle: 0,
            max: 80_000.0
        }]
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
    assert_eq!(control.given, [(1, 4000.0)].into());
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

const BLOCK: &str = r#"{
  "name": "block",
  "materials": {
    "silicone": { "shear_modulus": "100 kPa", "poisson_ratio": 0.4, "relative_permittivity": 3.0 },
    "rubber": { "shear_modulus": "100 kPa", "lame_lambda": "400 kPa" },
    "jelly": { "shear_modulus": "100 kPa", "relative_permittivity": 3.0 }
  },
  "bodies": [
    { "name": "left", "mass": 1, "sphere": { "radius": 1 }, "position": [0, 0, 0], "free": true },
    { "name": "right", "mass": 1, "sphere": { "radius": 1 }, "position": [0, 0, 0], "free": true }
  ],
  "solids": [
    {
      "name": "beam", "materials": { "lower": "silicone", "upper": "silicone" },
      "box": { "corner": [0, 0, "5 mm"], "size": ["6 mm", "4 mm", "4 mm"],
        "elements": [3, 2, [{ "thickness": "1 mm", "elements": 2, "region": "lower" }, { "thickness": "3 mm", "elements": 2, "region": "upper" }]] },
      "electrodes": [
        { "name": "ends", "face": "z_min", "potential": "driven" },
        { "name": "middle", "plane": { "z": "6 mm" }, "potential": "grounded" },
        { "name": "ends", "face": "z_max", "potential": "driven" }
      ],
      "fixed": ["x_min", { "face": "y_min", "directions": ["y"] }],
      "glued": { "x_max": "right" },
      "velocity": { "linear": ["1 m/s", 0, 0], "angular": [0, 0, "2 rad/s"], "stretch_rate": [0, 0, "10 1/s"] }
    },
    {
      "name": "pile", "material": "silicone", "element": "hex8_q1p0",
      "box": { "size": ["1 mm", "1 mm", "4 mm"], "elements": [1, 1, 8] },
      "stack": { "axis": "z", "layers": 4, "name": "stack" }
    }
  ],
  "markers": [ { "name": "tip", "solid": "beam", "at": ["6 mm", "2 mm", "9.5 mm"] } ]
}"#;

#[test]
fn a_block_means_what_is_written() {
    let (folder, _) = folder(BLOCK, "{}");
    let system = read_scene(&folder.path().join("scene.json")).expect("blocks");
    let [beam, pile] = &system.solids[..] else {
        panic!("two blocks")
    };
    assert_eq!((beam.mesh.nodes.len(), beam.mesh.hexahedra.len()), (60, 24));
    assert_eq!(beam.mesh.region_names, ["lower", "upper"]);
    for (corners, &region) in beam.mesh.hexahedra.iter().zip(&beam.mesh.regions) {
        let is_upper = beam.mesh.nodes[corners[0]].z >= 6.0;
        assert_eq!(region, usize::from(is_upper));
    }
    // λ = 2 μ ν/(1 − 2 ν) to rounding.
    let lambda = beam.materials[0]
        .lame_lambda
        .expect("a compressible material");
    assert!((lambda - 0.4).abs() < 1e-15, "{lambda}");
    // Driven electrodes of one name are connected.
    let driven = |source| Potential::Driven {
        source,
        factor: 1.0,
    };
    let electrodes = |i: usize| -> Vec<_> {
        let all = system.solids[i].electrodes.iter();
        all.map(|e| (e.name.as_str(), e.nodes.len(), e.potential))
            .collect()
    };
    let grounded = Potential::Given(0.0);
    assert_eq!(
        electrodes(0),
        [("ends", 24, driven(0)), ("middle", 12, grounded)]
    );
    assert_eq!(
        electrodes(1),
        [("stack_ground", 12, grounded), ("stack", 8, driven(1))]
    );
    let heights: Vec<f64> = pile.electrodes[1]
        .nodes
        .iter()
        .map(|&n| pile.mesh.nodes[n].z)
        .collect();
    assert_eq!(heights, [1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    let names: Vec<_> = system
        .sources()
        .into_iter()
        .map(|source| source.name)
        .collect();
    assert_eq!(names, ["beam.ends", "pile.stack"]);
    assert_eq!(
        (beam.element, pile.element),
        (ElementKind::Hex8, ElementKind::Hex8Q1P0)
    );
    // A glued node is not held as well: the edge of y_min at x_max.
    let held: Vec<_> = beam
        .supports
        .iter()
        .map(|s| (s.nodes.len(), s.held))
        .collect();
    assert_eq!(held, [(15, [true; 3]), (15, [false, true, false])]);
    assert_eq!(
        (beam.glued[0].nodes.len(), beam.glued[0].body),
        (15, Some(1))
    );
    for (node, velocity) in beam.mesh.nodes.iter().zip(&beam.velocities) {
        let expected = [
            1.0 - 2e-3 * (node.y - 2.0),
            2e-3 * (node.x - 3.0),
            1e-2 * (node.z - 7.0),
        ];
        for (ours, theirs) in velocity.iter().zip(expected) {
            assert!((ours - theirs).abs() < 1e-15, "{velocity} {expected:?}");
        }
    }
    assert!(pile.velocities.is_empty());
    let tip = &system.markers[0];
    assert_eq!((tip.solid, tip.point.body), (Some(0), None));
    let file = folder.path().join("scene.json");
    let again = expand(&file).expect("an expansion");
    fs::write(&file, again).expect("a written scene");
    assert_eq!(read_scene(&file).expect("the same blocks"), system);
}

#[test]
fn mistakes_in_a_block_name_place_found_and_expected() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"name\": \"pile\"", "\"name\": \"beam\"", "solids[1].name", "\"beam\" a second time", "not taken", "\"beam\""),
        ("\"material\": \"silicone\"", "\"material\": \"silicon\"", "solids[1].material", "\"silicon\"", "the name of a material", "silicon"),
        ("\"material\": \"silicone\"", "\"material\": \"jelly\"", "solids[1].material", "\"jelly\", which has neither", "a material with one of them", "jelly"),
        ("\"material\": \"silicone\"", "\"material\": \"rubber\"", "solids[1].material", "\"rubber\", which has no electric term, in a block with electrodes", "relative_permittivity", "rubber"),
        ("\"upper\": \"silicone\"", "\"upper\": \"rubber\"", "solids[0].materials.upper", "no electric term", "relative_permittivity", "rubber"),
        ("\"upper\": \"silicone\"", "\"uper\": \"silicone\"", "solids[0].materials.uper", "\"uper\"", "one of \"lower\", \"upper\"", "uper"),
        (", \"upper\": \"silicone\"", "", "solids[0].materials", "no material of the region \"upper\"", "one", "lower"),
        ("\"name\": \"beam\", \"materials\"", "\"name\": \"beam\", \"material\": \"silicone\", \"materials\"", "solids[0]", "\"material\", \"materials\"", "exactly one of", "beam"),
        (", \"region\": \"upper\"", "", "solids[0].box.elements[2][1]", "a layer without a region", "a region for each layer", "3 mm"),
        ("\"elements\": [3, ", "\"elements\": [[{ \"thickness\": \"6 mm\", \"elements\": 3, \"region\": \"all\" }], ", "solids[0].box.elements[2][0].region", "second direction", "one direction only", "lower"),
        ("\"thickness\": \"3 mm\"", "\"thickness\": \"2 mm\"", "solids[0].box.elements[2]", "thicknesses that sum to 3 mm", "4 mm, the size of the box", "2 mm"),
        ("\"thickness\": \"3 mm\"", "\"thickness\": \"-3 mm\"", "solids[0].box.elements[2][1].thickness", "-3 mm", "a positive value", "-3 mm"),
        ("\"thickness\": \"3 mm\", \"elements\": 2", "\"thickness\": \"3 mm\", \"elements\": 0", "solids[0].box.elements[2][1].elements", "0", "1 element or more", "0"),
        ("\"elements\": [3, ", "\"elements\": [0, ", "solids[0].box.elements[0]", "0", "1 element or more", "0"),
        ("\"elements\": [3, ", "\"elements\": [\"3\", ", "solids[0].box.elements[0]", "\"3\"", "a whole number of elements or a list of layers", "3"),
        ("\"elements\": [3, ", "\"elements\": [3000000, ", "solids[0].box.elements", "3000000", "no more than", "3000000"),
        ("[\"6 mm\", \"4 mm\", \"4 mm\"]", "[\"6 mm\", \"-4 mm\", \"4 mm\"]", "solids[0].box.size[1]", "-4 mm", "a positive value", "-4 mm"),
        ("\"face\": \"z_min\"", "\"face\": \"z_mn\"", "solids[0].electrodes[0].face", "\"z_mn\"", "one of \"x_max\", \"x_min\"", "z_mn"),
        ("\"z\": \"6 mm\"", "\"z\": \"6.2 mm\"", "solids[0].electrodes[1].plane.z", "electrode \"middle\" in the plane z = 6.2 mm, which holds no node", "z = 5, 5.5, 6, 7.5, 9 mm", "6.2 mm"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"plane\": {}", "solids[0].electrodes[1].plane", "none of them", "exactly one of", "{}"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"box\": { \"min\": [0, 0, 0], \"max\": [1, 1, \"2 mm\"] }", "solids[0].electrodes[1].box", "electrode \"middle\" in a box that holds no node", "from (0, 0, 5) mm to (6, 4, 9) mm", "2 mm"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"face\": \"x_max\"", "solids[0].electrodes[1]", "electrode \"ends\" lays claim too", "do not meet", "middle"),
        ("\"name\": \"middle\"", "\"name\": \"ends\"", "solids[0].electrodes[1].name", "\"ends\" a second time", "only driven electrodes share one", "ends"),
        ("\"grounded\"", "\"ground\"", "solids[0].electrodes[1].potential", "\"ground\"", "\"grounded\"", "ground"),
        ("\"grounded\"", "{ \"given\": \"5 mm\" }", "solids[0].electrodes[1].potential.given", "a length", "a voltage", "5 mm"),
        ("\"grounded\"", "\"given\"", "solids[0].electrodes[1].potential.given", "a word alone", "an object with this key", "given"),
        ("\"layers\": 4", "\"layers\": 3", "solids[1].stack.layers", "3", "a divisor of the 8 elements along z", "3"),
        ("\"layers\": 4", "\"layers\": 0", "solids[1].stack.layers", "0", "a divisor of the 8 elements along z", "0"),
        ("\"stack\": { \"axis\": \"z\", \"layers\": 4, \"name\": \"stack\" }", "\"electrodes\": [ { \"name\": \"a\", \"face\": \"x_min\", \"potential\": \"floating\" } ]", "solids[1].electrodes", "floating electrodes only", "grounded, driven or given", "floating"),
        ("\"fixed\": [\"x_min\"", "\"fixed\": [\"x_mi\"", "solids[0].fixed[0]", "\"x_mi\"", "the name of a face", "x_mi"),
        ("\"directions\": [\"y\"]", "\"directions\": []", "solids[0].fixed[1].directions", "no direction", "\"x\", \"y\", \"z\"", "[]"),
        ("\"directions\": [\"y\"]", "\"directions\": [\"w\"]", "solids[0].fixed[1].directions[0]", "\"w\"", "\"x\"", "w"),
        ("\"glued\": { \"x_max\"", "\"glued\": { \"x_mx\"", "solids[0].glued.x_mx", "\"x_mx\"", "the name of a face", "x_mx"),
        ("\"x_max\": \"right\"", "\"x_max\": \"rihgt\"", "solids[0].glued.x_max", "\"rihgt\"", "the name of a body or \"ground\"", "rihgt"),
        ("\"x_max\": \"right\"", "\"x_max\": \"right\", \"y_max\": \"left\"", "solids[0].glued.y_max", "\"left\", though \"right\" holds the node", "do not meet", "left"),
        ("\"10 1/s\"", "\"10 mm\"", "solids[0].velocity.stretch_rate[2]", "a length", "a rate", "10 mm"),
        ("\"solid\": \"beam\"", "\"solid\": \"bem\"", "markers[0].solid", "\"bem\"", "the name of a block", "bem"),
        ("\"solid\": \"beam\"", "\"solid\": \"beam\", \"body\": \"left\"", "markers[0]", "\"body\", \"solid\"", "exactly one of", "beam"),
        ("\"9.5 mm\"", "\"19 mm\"", "markers[0].at", "10.000 mm away from the nearest node, at (6, 2, 9) mm", "no farther from the block than the size of an element", "19 mm"),
        ("\"box\": { \"size\": [\"1 mm\", \"1 mm\", \"4 mm\"], \"elements\": [1, 1, 8] }", "\"mesh\": \"nowhere.msh\"", "solids[1].mesh", "\"nowhere.msh\", where there is no file", "the path of a Gmsh file", "nowhere"),
        ("\"element\": \"hex8_q1p0\"", "\"unit\": \"1 mm\"", "solids[1].unit", "\"1 mm\"", "no such key", "1 mm"),
        ("\"element\": \"hex8_q1p0\"", "\"mesh\": \"x.msh\"", "solids[1]", "\"box\", \"mesh\"", "exactly one of", "pile"),
    ];
    check(cases, BLOCK, |scene| {
        let (folder, _) = folder(scene, "{}");
        read_scene(&folder.path().join("scene.json")).expect_err("a mistake")
    });
}

/// Two cubes of 1 unit side by side along z, the upper one in a volume of its own.
const MESH: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 \"bottom\"
2 2 \"top\"
3 3 \"soft\"
3 4 \"stiff\"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
9 0 0 2
10 1 0 2
11 1 1 2
12 0 1 2
$EndNodes
$Elements
4
1 3 2 1 1 1 2 3 4
2 3 2 2 2 9 10 11 12
3 5 2 3 3 1 2 3 4 5 6 7 8
4 5 2 4 4 5 6 7 8 9 10 11 12
$EndElements
";

#[test]
fn a_mesh_file_is_read_beside_the_scene_and_answers_for_mistakes() {
    let scene = r#"{ "name": "x",
      "materials": { "a": { "shear_modulus": 1, "lame_lambda": 1 }, "b": { "shear_modulus": 2, "lame_lambda": 1, "relative_permittivity": 2 } },
      "solids": [ { "name": "cubes", "mesh": "cubes.msh", "unit": "2 mm", "materials": { "soft": "a", "stiff": "b" },
        "fixed": ["bottom"], "glued": { "top": "ground" } } ] }"#;
    let (folder, _) = folder(scene, "{}");
    let (file, mesh) = (
        folder.path().join("scene.json"),
        folder.path().join("cubes.msh"),
    );
    fs::write(&mesh, MESH).expect("a written mesh");
    let solid = &read_scene(&file).expect("two cubes").solids[0];
    assert_eq!(solid.mesh.nodes[11].as_slice(), [0.0, 2.0, 4.0]);
    let moduli: Vec<_> = solid.materials.iter().map(|m| m.shear_modulus).collect();
    assert_eq!(moduli, [1e-6, 2e-6]);
    let held: Vec<_> = solid
        .supports
        .iter()
        .map(|s| (&s.nodes[..], s.held))
        .collect();
    assert_eq!(
        held,
        [
            (&[0, 1, 2, 3][..], [true; 3]),
            (&[8, 9, 10, 11][..], [true; 3])
        ]
    );
    assert!(solid.glued.is_empty());

    for (old, new, words) in [
        ("2.2 0 8", "7.7 0 8", "cubes.msh:2"),
        ("3 1 1 0\n", "3 1 one 0\n", "cubes.msh:15"),
        (
            "5 6 7 8 9 10 11 12\n",
            "9 10 11 12 5 6 7 8\n",
            "cubes.msh:31",
        ),
    ] {
        fs::write(&mesh, MESH.replacen(old, new, 1)).expect("a written mesh");
        let error = read_scene(&file).expect_err("a broken mesh");
        assert_eq!(error.path(), "solids[0].mesh");
        assert!(error.found().contains(words), "{words} in {error}");
    }
    fs::write(&mesh, MESH).expect("a written mesh");
    for (old, new, path, words) in [
        (
            "[\"bottom\"]",
            "[\"floor\"]",
            "solids[0].fixed[0]",
            "one of \"bottom\", \"top\"",
        ),
        (
            "\"soft\"",
            "\"sft\"",
            "solids[0].materials.sft",
            "one of \"soft\", \"stiff\"",
        ),
        ("\"2 mm\"", "\"0 mm\"", "solids[0].unit", "a positive value"),
        (
            "\"fixed\"",
            "\"stack\": { \"axis\": \"z\", \"layers\": 3, \"name\": \"s\" }, \"fixed\"",
            "solids[0].stack",
            "z = 0, 2, 4 mm",
        ),
    ] {
        fs::write(&file, scene.replacen(old, new, 1)).expect("a written scene");
        let error = read_scene(&file).expect_err("a mistake");
        assert_eq!(error.path(), path, "{error}");
        assert!(error.expected().contains(words), "{words} in {error}");
    }
}

#[test]
fn voltages_are_named_for_driven_electrodes() {
    let problem =
        r#"{ "scene": "scene.json", "equilibrium": { "voltages": { "pile.stack": "2 kV" } } }"#;
    let (_folder, path) = folder(BLOCK, problem);
    let task = read_problem(&path, &[]).expect("an equilibrium").task;
    assert!(matches!(task, Task::Equilibrium(task) if task.voltages == [0.0, 2000.0]));
    let wrong = problem.replace("pile.stack", "pile.stak");
    let error = mistake(BLOCK, &wrong, &[]);
    assert_eq!(error.path(), "equilibrium.voltages.pile.stak");
    assert_eq!(error.nearest(), Some("pile.stack"));
    let expected = "the name of a muscle or of a driven electrode (block.electrode)";
    assert_eq!(error.expected(), expected);
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
    let study = proboscis::scene::study_schema();
    for (name, schema) in [("scene", scene), ("problem", problem), ("study", study)] {
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

fn value<M: Measure>(text: &str) -> f64 {
    Quantity::<M>::try_from_text(text)
        .unwrap_or_else(|found| panic!("found {found}"))
        .value()
}

fn refused<M: Measure>(text: &str) {
    assert!(
        Quantity::<M>::try_from_text(text).is_err(),
        "{text} was read"
    );
}

#[test]
fn units_are_read_in_all_spellings() {
    assert_eq!(value::<Length>("50 mm"), 50.0);
    assert_eq!(value::<Length>("50um"), 0.05);
    assert_eq!(value::<Length>("50 µm"), 0.05);
    assert_eq!(value::<Voltage>("1.7 kV"), 1700.0);
    assert_eq!(value::<Time>("2 min"), 120_000.0);
    assert_eq!(value::<ElectricField>("80 V/um"), 80_000.0);
    assert_eq!(value::<ElectricField>("80 MV/m"), 80_000.0);
    for text in [
        "1000 kg/m^3",
        "1000 kg/m³",
        "1000 kg m^-3",
        "1000 kg·m⁻³",
        "1 g/cm^3",
        "1 t/m3",
    ] {
        assert_eq!(value::<Density>(text), 1e-3, "{text}");
    }
    for text in [
        "1000 Pa s",
        "1000 Pa · s",
        "1000 Pa*s",
        "1 kPa s",
        "1 MPa ms",
        "1000 N s/m^2",
        "1000 kg/m/s",
    ] {
        assert_eq!(value::<Viscosity>(text), 1.0, "{text}");
    }
    assert_eq!(value::<RotationalDamping>("1e-6 N m s/rad"), 1.0);
    assert_eq!(value::<RotationalDamping>("1 N mm ms"), 1.0);
    assert!((value::<Angle>("180 deg") - std::f64::consts::PI).abs() <= 2.0 * f64::EPSILON * 4.0);
    for text in [
        "", "mm", "50", "50 mm mm", "50 mm/", "50 / mm", "50 m^", "50 m^999", "50 rad", "5 kkm",
        "nan m", "inf m", "1e999 m", "50 mm ?",
    ] {
        refused::<Length>(text);
    }
    refused::<Angle>("1 m/m");
    refused::<Angle>("1 1");
    refused::<Length>("5 m rad");
}

#[test]
fn conversions_agree_with_uom() {
    use uom::si::{angle, electric_field, electric_potential, f64 as si, mass_density};
    let voltage = si::ElectricPotential::new::<electric_potential::kilovolt>(1.7);
    let field = si::ElectricField::new::<electric_field::volt_per_millimeter>(80.0);
    let density = si::MassDensity::new::<mass_density::gram_per_cubic_centimeter>(1.2);
    let turn = si::Angle::new::<angle::degree>(17.0);
    for (ours, theirs) in [
        (value::<Voltage>("1.7 kV"), voltage.value),
        (value::<ElectricField>("80 V/mm"), field.value / 1e3),
        (value::<Density>("1.2 g/cm^3"), density.value / 1e6),
        (value::<Angle>("17 deg"), turn.value),
    ] {
        // One rounding on either side of each of two steps.
        assert!(
            (ours - theirs).abs() <= 4.0 * f64::EPSILON * theirs,
            "{ours} {theirs}"
        );
    }
}

proptest! {
    #[test]
    fn a_quantity_is_the_same_in_every_prefix(number in -1e6..1e6_f64, index in 0..7_usize) {
        let (prefix, factor) = [("", 1.0), ("k", 1e-3), ("m", 1e3), ("u", 1e6), ("n", 1e9), ("M", 1e-6), ("c", 1e2)][index];
        let scaled = number * factor;
        for (si, prefixed) in [
            (value::<Length>(&format!("{number} m")), value::<Length>(&format!("{scaled} {prefix}m"))),
            (value::<Voltage>(&format!("{number} V")), value::<Voltage>(&format!("{scaled} {prefix}V"))),
            (value::<ElectricField>(&format!("{number} V/m")), value::<ElectricField>(&format!("{scaled} {prefix}V/m"))),
        ] {
            // Three roundings: of the factor, of the product, of the conversion.
            prop_assert!((si - prefixed).abs() <= 3.0 * f64::EPSILON * si.abs());
        }
    }

    #[test]
    fn arbitrary_text_never_panics(text in "\\PC{0,40}") {
        let _ = Quantity::<Length>::try_from_text(&text);
        let _ = Quantity::<Angle>::try_from_text(&format!("1 {text}"));
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let (folder, path) = folder(SCENE, PROBLEM);
        fs::write(folder.path().join("scene.json"), &bytes).expect("a written scene");
        let _ = read_problem(&path, &[]);
        fs::write(&path, &bytes).expect("a written problem");
        let _ = read_problem(&path, &[]);
    }

    #[test]
    fn mutated_files_never_panic(position in any::<proptest::sample::Index>(), length in 0..30_usize,
        insert in prop_oneof!["\\PC{0,6}".boxed(), "[\\[\\]{}\",:0-9e.-]{0,6}".boxed(), "null|true|\\{\\}|1e999|-1|\"x\"".boxed()], in_scene in any::<bool>()) {
        let base = if in_scene { SCENE } else { PROBLEM };
        let start = position.index(base.len());
        let end = (start + length).min(base.len());
        let text = format!("{}{insert}{}", &base[..start], &base[end..]);
        let (_folder, path) = if in_scene { folder(&text, PROBLEM) } else { folder(SCENE, &text) };
        if let Err(error) = read_problem(&path, &[]) {
            let length = text.len().max(SCENE.len());
            prop_assert!(error.span().is_none_or(|span| span.start <= span.end && span.end <= length));
            prop_assert!(!error.found().is_empty() && !error.expected().is_empty(), "{error}");
            // The marked excerpt is drawn too.
            let _ = error.excerpt();
        }
    }

    #[test]
    fn arbitrary_overrides_never_panic(text in "(control|scene|x)?[.\\[\\]a-z0-9]{0,12}=?\\PC{0,8}") {
        let (_folder, path) = folder(SCENE, PROBLEM);
        let _ = read_problem(&path, &[text]);
    }
}
