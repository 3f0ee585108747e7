//! Objectives of problem files, and their errors.

use crate::scene::{Case, PROBLEM, SCENE, check, elastic_scene, folder, mistake};
use proboscis::control::problem::{
    BoundaryState, Control, CostFunction, During, EnergyCost, Orientation, Place, QuantityCost,
    Rest, SourceEnergy, Task,
};
use proboscis::files::read_problem;
use proboscis::math::Signal;
use proboscis::model::Quantity;
use std::fs;

/// The problem with another objective.
pub(crate) fn with(objective: &str) -> String {
    PROBLEM.replace("{ \"effort\": 1.0 }", objective)
}

pub(crate) fn read(objective: &str) -> Control {
    let (folder, path) = folder(SCENE, &with(objective));
    let solution = r#"{ "time": [0, 0.1, 0.2], "voltages": {},
        "configuration": { "joints": { "joint1": [0, 0.1, 0.2], "joint2": [0, 0.002, 0.003] } } }"#;
    fs::write(folder.path().join("solution.json"), solution).expect("a solution");
    match read_problem(&path, &[]).expect("a problem").task {
        Task::Control(control) => *control,
        other => panic!("{other:?}"),
    }
}

pub(crate) fn square(quantity: Quantity, weight: f64, reference: Signal) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during: During::Motion,
    }
}

#[test]
fn markers_and_joints_may_follow_functions_of_time() {
    let objective = r#"{ "track": [
        { "marker": { "marker": "tip", "weight": 2.5, "along": {
            "z": "50 mm", "x": { "sine": { "mean": "-1 mm", "amplitude": 0.02, "period": "0.4 s", "phase": "90 deg" } } } } },
        { "joint": { "joint": "joint2", "along": { "ramp": { "to": "3 mm", "duration": "0.1 s" } } } },
        { "joint": { "joint": "joint1", "along": { "table": { "time": [0, 1], "values": [0, "9 deg"] } } } },
        { "joints": { "solution": "solution.json", "weight": 10 } } ] }"#;
    let found = read(objective).objective;
    assert_eq!([found.effort, found.rate, found.duration], [0.0; 3]);
    let axis = |axis| Quantity::marker_place(0, axis);
    let joint = |joint| Quantity::joint(joint, 0.0);
    let right = std::f64::consts::FRAC_PI_2;
    let table = |times: &[f64], values: &[f64]| Signal::Table {
        times: times.to_vec(),
        values: values.to_vec(),
    };
    let sine = Signal::Sine {
        mean: -1.0,
        amplitude: 20.0,
        frequency: 400.0_f64.recip(),
        phase: right,
    };
    let expected = [
        square(axis(0), 2.5, sine),
        square(axis(2), 2.5, Signal::Constant(50.0)),
        square(joint(1), 1.0, Signal::ramp(0.0, 3.0, 100.0)),
        square(joint(0), 1.0, table(&[0.0, 1000.0], &[0.0, 0.1 * right])),
        square(
            joint(0),
            10.0,
            table(&[0.0, 100.0, 200.0], &[0.0, 0.1, 0.2]),
        ),
        square(
            joint(1),
            10.0,
            table(&[0.0, 100.0, 200.0], &[0.0, 2.0, 3.0]),
        ),
    ];
    assert_eq!(found.quantities, expected);
}

#[test]
fn what_cannot_be_followed_is_refused() {
    const TRACK: &str =
        r#"{ "track": [ { "marker": { "marker": "tip", "along": { "x": 0 } } } ] }"#;
    let problem = with(TRACK);
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"tip\"", "\"tipp\"", "control.objective.track[0].marker.marker", "\"tipp\"", "the name of a marker", "\"tipp\""),
        ("{ \"x\": 0 }", "{}", "control.objective.track[0].marker.along", "no direction", "\"x\", \"y\" or \"z\"", "{}"),
        ("{ \"x\": 0 }", "{ \"w\": 0 }", "control.objective.track[0].marker.along.w", "the key \"w\"", "\"x\"", "\"w\""),
        ("\"x\": 0", "\"x\": \"1 V\"", "control.objective.track[0].marker.along.x", "which is a voltage", "a length", "1 V"),
        ("\"x\": 0", "\"x\": true", "control.objective.track[0].marker.along.x", "true", "a length such as", "true"),
        ("\"x\": 0", "\"x\": { \"ramp\": { \"to\": 1, \"duration\": 0 } }", "control.objective.track[0].marker.along.x.ramp.duration", "0", "positive", "0"),
        ("\"x\": 0", "\"x\": { \"table\": { \"time\": [0, 1], \"values\": [0] } }", "control.objective.track[0].marker.along.x.table.values", "1 values", "2, one for each time", "[0]"),
        ("\"along\": { \"x\": 0 }", "\"along\": { \"x\": 0 }, \"weight\": 0", "control.objective.track[0].marker.weight", "0", "a positive weight", "0"),
        ("\"along\": { \"x\": 0 }", "\"along\": { \"x\": 0 }, \"weight\": -1", "control.objective.track[0].marker.weight", "-1", "a positive weight", "-1"),
        ("\"marker\": { \"marker\": \"tip\", \"along\": { \"x\": 0 } }", "", "control.objective.track[0]", "none of them", "exactly one of \"marker\", \"joint\", \"joints\"", "{  }"),
        ("\"marker\": { \"marker\": \"tip\", \"along\": { \"x\": 0 } }", "\"joint\": { \"joint\": \"joint2\", \"along\": \"3 deg\" }", "control.objective.track[0].joint.along", "which is an angle", "a length", "3 deg"),
        ("\"marker\": { \"marker\": \"tip\", \"along\": { \"x\": 0 } }", "\"joint\": { \"joint\": \"joint1\", \"along\": { \"sine\": { \"amplitude\": \"3 mm\", \"period\": 1 } } }", "control.objective.track[0].joint.along.sine.amplitude", "which is a length", "an angle", "3 mm"),
        ("\"marker\": { \"marker\": \"tip\", \"along\": { \"x\": 0 } }", "\"joints\": { \"solution\": \"none.json\" }", "control.objective.track[0].joints.solution", "\"none.json\", where there is no solution.json", "the path of a solution.json, or of the folder that holds it", "none.json"),
        ("\"track\": [ {", "\"effort\": 1, \"track\": [ 3, {", "control.objective.track[0]", "3", "", "3"),
    ];
    check(cases, &problem, |problem| mistake(SCENE, problem, &[]));
}

#[test]
fn energies_are_of_all_sources_or_of_named_ones() {
    let cost = |energy, weight| EnergyCost {
        source: 0,
        energy,
        weight,
    };
    let named = r#"{ "weight": 3, "sources": ["muscle1"] }"#;
    let both = format!(r#"{{ "electrical_energy": 2.5, "mechanical_work": {named} }}"#);
    let expected = [
        cost(SourceEnergy::Electrical, 2.5),
        cost(SourceEnergy::Mechanical, 3.0),
    ];
    // The second muscle takes no voltage.
    assert_eq!(read(&both).objective.energies, expected);
    let one = format!(r#"{{ "effort": 1, "electrical_energy": {named}, "mechanical_work": 0 }}"#);
    let expected = [cost(SourceEnergy::Electrical, 3.0)];
    assert_eq!(read(&one).objective.energies, expected);
    assert!(read(r#"{ "effort": 1 }"#).objective.energies.is_empty());
}

#[test]
fn energies_that_make_no_sense_are_refused() {
    const BOTH: &str = r#"{ "electrical_energy": 1.5, "mechanical_work": { "weight": 7, "sources": ["muscle1"] } }"#;
    let problem = with(BOTH);
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("1.5", "-1.5", "control.objective.electrical_energy", "-1.5", "a weight that is not negative", "-1.5"),
        ("1.5", "\"much\"", "control.objective.electrical_energy", "\"much\"", "a number", "\"much\""),
        ("1.5", "true", "control.objective.electrical_energy", "true", "a weight, or an object with \"weight\"", "true"),
        ("\"weight\": 7", "\"weight\": -7", "control.objective.mechanical_work.weight", "-7", "a weight that is not negative", "-7"),
        ("\"weight\": 7, ", "", "control.objective.mechanical_work", "no key \"weight\"", "the key \"weight\"", "{ \"sources\": [\"muscle1\"] }"),
        ("[\"muscle1\"]", "[]", "control.objective.mechanical_work.sources", "no source", "one source or more", "[]"),
        ("[\"muscle1\"]", "[\"muscl1\"]", "control.objective.mechanical_work.sources[0]", "\"muscl1\"", "the name of a muscle", "\"muscl1\""),
        ("[\"muscle1\"]", "[\"muscle2\"]", "control.objective.mechanical_work.sources[0]", "no electric term", "relative_permittivity", "\"muscle2\""),
        ("[\"muscle1\"]", "[\"muscle1\", \"muscle1\"]", "control.objective.mechanical_work.sources[1]", "\"muscle1\" again", "each source once", "\"muscle1\""),
    ];
    check(cases, &problem, |problem| mistake(SCENE, problem, &[]));
    // One weight of zero is none.
    let error = mistake(SCENE, &with(r#"{ "electrical_energy": 0 }"#), &[]);
    assert_eq!(
        (error.path(), error.found()),
        ("control.objective", "no weight")
    );
}

#[test]
fn energies_of_finite_elements_are_refused() {
    let scene = elastic_scene();
    for (objective, place) in [
        (r#"{ "electrical_energy": 1 }"#, "electrical_energy"),
        (
            r#"{ "mechanical_work": { "weight": 1, "sources": ["muscle1"] } }"#,
            "mechanical_work.sources[0]",
        ),
    ] {
        let error = mistake(&scene, &with(objective), &[]);
        assert_eq!(error.path(), format!("control.objective.{place}"));
        assert!(
            error
                .found()
                .contains("\"muscle1\", which drives finite elements")
        );
        assert!(error.expected().contains("lumped muscles"));
    }
}

#[test]
fn a_solution_to_follow_is_checked() {
    let objective = r#"{ "track": [ { "joints": { "solution": "solution.json" } } ] }"#;
    let (folder, path) = folder(SCENE, &with(objective));
    for (solution, place, found) in [
        (r#"{ "time": [0, 1] }"#, "", "neither of them"),
        (r#"{ "time": [], "joints": {} }"#, "time", "no instant"),
        (r#"{ "time": [0, 0], "joints": {} }"#, "time[1]", "0 s"),
        (
            r#"{ "time": [0, 1], "joints": { "joint1": [0] } }"#,
            "joints.joint1",
            "1 values",
        ),
        (
            r#"{ "time": [0, 1], "joints": { "elbow": [0, 1] } }"#,
            "joints.elbow",
            "\"elbow\"",
        ),
    ] {
        fs::write(folder.path().join("solution.json"), solution).expect("a solution");
        let error = read_problem(&path, &[]).expect_err(solution);
        assert_eq!(error.path(), place, "{error}");
        assert!(error.found().contains(found), "{error}");
    }
}

#[test]
fn an_end_may_be_drawn_near_and_free() {
    let objective = r#"{ "effort": 1, "final": [
        { "marker": { "marker": "tip", "at": [null, "90 mm", null], "weight": 3 } },
        { "joint": { "joint": "joint2", "at": "2 mm" } } ] }"#;
    let cost = |quantity, weight, at: f64| QuantityCost {
        during: During::End,
        ..square(quantity, weight, Signal::Constant(at))
    };
    let place = Quantity::marker_place(0, 1);
    let joint = Quantity::joint(1, 0.0);
    let expected = [cost(place, 3.0, 90.0), cost(joint, 1.0, 2.0)];
    assert_eq!(read(objective).objective.quantities, expected);

    // Without a goal the end is free; the word says so too.
    let goal = "\"goal\": { \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } },";
    for (new, objective) in [
        ("", objective),
        ("\"goal\": \"free\",", "{ \"effort\": 1.0 }"),
    ] {
        let problem = with(objective).replace(goal, new);
        let (_folder, path) = folder(SCENE, &problem);
        let Task::Control(control) = read_problem(&path, &[]).expect("a problem").task else {
            panic!("a control problem")
        };
        assert_eq!(control.goal, BoundaryState::Free);
    }
    let error = mistake(SCENE, &PROBLEM.replace(goal, ""), &[]);
    assert_eq!(error.path(), "control");
    assert!(error.found().contains("no key \"goal\""), "{error}");
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"at\": [null, \"90 mm\", null]", "\"at\": [null, null, null]", "control.objective.final[0].marker.at", "no coordinate", "not null", "null"),
        ("\"weight\": 3", "\"weight\": -3", "control.objective.final[0].marker.weight", "-3", "a positive weight", "-3"),
        ("\"2 mm\"", "\"2 rad\"", "control.objective.final[1].joint.at", "which is an angle", "a length", "2 rad"),
    ];
    check(cases, &with(objective), |problem| {
        mistake(SCENE, problem, &[])
    });
}

#[test]
fn a_goal_may_be_a_part_of_a_place_and_an_orientation() {
    const GOAL: &str = r#"{ "markers": { "tip": [null, "90 mm", null] }, "rest": "markers", "orientations": {
        "segment1": { "axis": [0, 2, 0], "towards": [3, 4, 0] }, "segment2": { "axis": [1, 0, 0], "angle": "90 deg" } } }"#;
    let problem = PROBLEM.replace(
        "{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }",
        GOAL,
    );
    let (_folder, path) = folder(SCENE, &problem);
    let Task::Control(control) = read_problem(&path, &[]).expect("a problem").task else {
        panic!("a control problem")
    };
    let direction = |x, y, z| nalgebra::Vector3::new(x, y, z);
    let towards = Orientation::Towards {
        axis: direction(0.0, 1.0, 0.0),
        towards: direction(0.6, 0.8, 0.0),
    };
    let turned = Orientation::Turned {
        axis: direction(1.0, 0.0, 0.0),
        angle: std::f64::consts::FRAC_PI_2,
    };
    let expected = BoundaryState::Markers {
        places: [(0, Place([None, Some(90.0), None]))].into(),
        orientations: [(0, towards), (1, turned)].into(),
        rest: Rest::Bodies,
        hold: None,
    };
    assert_eq!(control.goal, expected);
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("[null, \"90 mm\", null]", "[null, null, null]", "control.goal.markers.tip", "no coordinate", "not null", "null"),
        ("\"segment1\":", "\"segment\":", "control.goal.orientations.segment", "\"segment\"", "the name of a body", "segment"),
        ("[0, 2, 0]", "[0, 0, 0]", "control.goal.orientations.segment1.axis", "[0.0, 0.0, 0.0]", "a direction", "0, 0, 0"),
        ("\"angle\": \"90 deg\"", "\"angle\": \"90 mm\"", "control.goal.orientations.segment2.angle", "which is a length", "an angle", "90 mm"),
        (", \"angle\": \"90 deg\"", "", "control.goal.orientations.segment2", "none of them", "exactly one of \"towards\", \"angle\"", "axis"),
        ("\"rest\": \"markers\"", "\"joint_angles\": { \"joint1\": 0 }", "control.goal", "\"joint_angles\", \"markers\"", "exactly one of", "tip"),
        (GOAL, "\"fre\"", "control.goal", "\"fre\"", "\"free\"", "fre"),
    ];
    check(cases, &problem, |problem| mistake(SCENE, problem, &[]));
}

#[test]
fn a_goal_may_be_the_equilibrium_of_bodies_alone() {
    const GOAL: &str = r#"{ "rest_at_voltages": { "muscle1": "1.7 kV" }, "rest": "bodies" }"#;
    const ALL: &str = "{ \"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" } }";
    let problem = PROBLEM.replace(ALL, GOAL);
    let goal = |problem: &str| {
        let (_folder, path) = folder(SCENE, problem);
        let Task::Control(control) = read_problem(&path, &[]).expect("a problem").task else {
            panic!("a control problem")
        };
        control.goal
    };
    let row = vec![1700.0, 0.0];
    assert_eq!(
        goal(&problem),
        BoundaryState::RestAtVoltages(row.clone(), Rest::Bodies)
    );
    assert_eq!(
        goal(PROBLEM),
        BoundaryState::RestAtVoltages(row, Rest::Attainable)
    );
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"rest\": \"bodies\"", "\"rest\": \"body\"", "control.goal.rest", "body", "bodies", "body"),
        ("\"rest_at_voltages\": { \"muscle1\": \"1.7 kV\" }", "\"joint_angles\": { \"joint1\": 0 }", "control.goal.rest", "\"rest\" beside \"joint_angles\"", "beside \"rest_at_voltages\"", "bodies"),
        ("\"rest\": \"bodies\"", "\"hold\": {}", "control.goal.hold", "\"hold\" beside \"rest_at_voltages\"", "beside \"markers\"", "{}"),
    ];
    check(cases, &problem, |problem| mistake(SCENE, problem, &[]));
}

/// Each term alone, then some beside each other.
#[test]
fn an_objective_has_the_units_of_its_terms() {
    let marker = r#"{ "marker": { "marker": "tip", "along": { "x": "1 mm" } } }"#;
    let angle = r#"{ "joint": { "joint": "joint1", "along": "1 deg" } }"#;
    let slide = r#"{ "joint": { "joint": "joint2", "along": "1 mm" } }"#;
    let place = r#"{ "marker": { "marker": "tip", "at": ["1 mm", null, null] } }"#;
    let cases = [
        (r#"{ "effort": 2 }"#.to_owned(), vec!["kV² s"]),
        (r#"{ "rate": 2 }"#.to_owned(), vec!["kV²/s"]),
        (r#"{ "duration": 2 }"#.to_owned(), vec!["s"]),
        (r#"{ "effort": 0, "duration": 1 }"#.to_owned(), vec!["s"]),
        (r#"{ "electrical_energy": 2 }"#.to_owned(), vec!["J"]),
        (format!(r#"{{ "track": [{marker}] }}"#), vec!["mm² s"]),
        (format!(r#"{{ "track": [{angle}] }}"#), vec!["rad² s"]),
        (format!(r#"{{ "final": [{place}] }}"#), vec!["mm²"]),
        (
            format!(
                r#"{{ "effort": 1, "mechanical_work": 3, "track": [{slide}, {marker}, {angle}] }}"#
            ),
            vec!["kV² s", "mm² s", "rad² s", "J"],
        ),
    ];
    for (objective, expected) in cases {
        let (folder, path) = folder(SCENE, &with(&objective));
        let loaded = read_problem(&path, &[]).expect("a problem");
        let Task::Control(control) = loaded.task else {
            panic!("a control problem");
        };
        let found = control.objective_units(&loaded.system);
        assert_eq!(found, expected, "{objective}");
        drop(folder);
    }
}
