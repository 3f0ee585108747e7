//! Sensitivities as the command and the library give them.

use proboscis::app::{CommandInput, ProgressDisplay, run};
use proboscis::prelude::*;
use proboscis::{MaterialConstant, OutcomeOf, Varied};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Solves the kept problem with changes into a folder; its summary.
fn solved(folder: &Path, changes: &[&str]) -> Value {
    solved_from("problems/pair_sensitivity.json", folder, changes)
}

fn solved_from(problem: &str, folder: &Path, changes: &[&str]) -> Value {
    let input = CommandInput {
        command: "solve".to_owned(),
        input: Path::new(env!("CARGO_MANIFEST_DIR")).join(problem),
        set: changes.iter().map(|&change| change.to_owned()).collect(),
        output: Some(PathBuf::from(folder)),
        max_seconds: None,
        max_iterations: None,
        from: None,
        wanted: None,
        figures: Default::default(),
        progress: ProgressDisplay::Never,
        page: Default::default(),
        once: false,
    };
    run(&input).expect("a run");
    let text = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn the_command_writes_derivatives_changes_and_ranges() {
    let folder = tempfile::tempdir().unwrap();
    let summary = solved(folder.path(), &[]);
    let list = summary["sensitivities"].as_array().expect("a list");
    assert_eq!(list.len(), 8);
    let of = |name: &str| {
        list.iter()
            .find(|one| one["name"] == name)
            .expect("a number")
    };
    let modulus = of("materials.silicone.shear_modulus");
    assert_eq!(
        (&modulus["unit"], &modulus["value"]),
        (&"Pa".into(), &1e5.into())
    );
    // A change of 1 % of the modulus, found anew, is the derivative to second order.
    let stiff = tempfile::tempdir().unwrap();
    let change = ["scene.materials.silicone.shear_modulus=1.01e5"];
    let other = solved(stiff.path(), &change);
    let number = |value: &Value| value.as_f64().expect("a number");
    let found = (number(&other["objective"]) - number(&summary["objective"])) / 1e3;
    let derivative = number(&modulus["objective"]);
    assert!(
        (found - derivative).abs() < 0.03 * derivative.abs() && derivative != 0.0,
        "{found} {derivative}"
    );
    let effect = number(&modulus["objective_change"]);
    assert!((effect - 5e3 * derivative.abs()).abs() < 1e-9 * effect);
    assert!(number(&modulus["valid"]["from"]) < 1e5 && number(&modulus["valid"]["to"]) > 1e5);
    let bound = modulus["valid"]["bound_below"].as_str().expect("a bound");
    assert!(bound.contains("voltage of muscle"), "{bound}");
    assert!(
        modulus["inputs"]
            .as_array()
            .is_some_and(|inputs| !inputs.is_empty())
    );
    // A muscle at its upper bound moves with it.
    assert_eq!(of("voltage_bounds[1]")["inputs"][0]["derivative"], 1.0);
    let table = fs::read_to_string(folder.path().join("sensitivities.csv")).unwrap();
    let header = table.lines().nth(1).unwrap();
    assert!(
        header.contains("d muscle2 / d materials.silicone.shear_modulus [V/(Pa)]"),
        "{header}"
    );
    assert_eq!(table.lines().count(), 2 + 41);
    for file in ["sensitivities.svg", "voltages_tolerances.svg"] {
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        assert!(text.contains("<svg"), "{file}");
    }
}

#[test]
fn a_tolerance_beyond_the_range_is_a_warning_and_no_optimum_has_no_derivatives() {
    let folder = tempfile::tempdir().unwrap();
    let wide =
        [r#"control.sensitivity={"materials.silicone.shear_modulus": {"tolerance": "60 %"}}"#];
    let summary = solved(folder.path(), &wide);
    let notes = summary["notes"].to_string();
    assert!(notes.contains("reaches beyond"), "{notes}");
    let short = ["control.duration=0.005"];
    let summary = solved(folder.path(), &short);
    assert!(summary["sensitivities"].is_null(), "{summary}");
    assert!(
        summary["notes"]
            .to_string()
            .contains("no sensitivities: no optimum was found")
    );
    assert!(!folder.path().join("sensitivities.csv").exists());
}

#[test]
fn the_library_differentiates_too() {
    let silicone = Material::elastomer(kpa(100.0)).density(kg_per_m3(1000.0));
    let silicone = silicone.relative_permittivity(3.0).viscosity(pa_s(1000.0));
    let of = |modulus: f64, outcomes: &[OutcomeOf]| {
        let mut arm = System::new("arm");
        let link = Body::cylinder(mm(50.0), mm(20.0))
            .mass(g(30.0))
            .at(Y * mm(25.0))
            .along(Y);
        let link = arm.add(link);
        arm.add(Joint::revolute(Z).between(GROUND, link));
        let right = [X, -X].map(|side| {
            let end = |y: f64| side * mm(15.0) + Y * mm(y);
            let silicone = Material {
                shear_modulus: modulus,
                ..silicone
            };
            let muscle = Muscle::of(&silicone)
                .section(mm(10.0), mm(10.0))
                .layer(um(50.0));
            arm.add(muscle.from(GROUND, end(-20.0)).to(link, end(20.0)))
        });
        let control = Control::over(s(0.3), 20).goal(State::rest_at([(right[0], kv(1.5))]));
        let control = control.voltage_bounds(0.0, kv(3.0)).effort(1.0);
        let parameter = Parameter {
            name: "modulus".to_owned(),
            constants: (0..2)
                .map(|m| MaterialConstant::ShearModulus.of_muscle(m).into())
                .collect(),
            lower: 0.9 * modulus,
            upper: 1.1 * modulus,
            guess: modulus,
        };
        let varied = Varied::constants(parameter, None, &arm);
        let control = control.sensitivity(varied);
        let control = outcomes.iter().fold(control, |to, one| to.outcome(*one));
        control.solve(&arm).unwrap()
    };
    let found = of(kpa(100.0), &[]);
    assert!(found.is_solved());
    let step = kpa(0.1);
    let [before, after] = [-step, step].map(|change| of(kpa(100.0) + change, &[]).objective);
    let expected = (after - before) / (2.0 * step);
    let derivative = found.sensitivities[0].objective;
    assert!(
        expected != 0.0 && (derivative - expected).abs() < 1e-4 * expected.abs(),
        "{derivative} {expected}"
    );
    // One outcome alone: the joint on its way.
    let joints = &found.sensitivities[0].joints;
    let (k, _) = greatest(joints.iter().map(|row| row[0].abs()));
    let time = found.motion.times()[k];
    let one = of(kpa(100.0), &[OutcomeOf::Joint { joint: 0, time }]);
    let gradients = one.gradients.unwrap();
    assert!(one.sensitivities.is_empty() && found.gradients.is_none());
    let expected = joints[k][0];
    assert!(expected != 0.0);
    assert_eq!(gradients.outcomes, [[expected]]);
    assert_eq!(gradients.objective, [derivative]);
}

fn greatest(list: impl Iterator<Item = f64>) -> (usize, f64) {
    let all = list.enumerate();
    all.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap()
}

/// The muscle rests: its resistor has no effect, whatever rounding leaves of its charge.
#[test]
fn a_number_without_effect_has_the_derivative_zero_beside_others() {
    let folder = tempfile::tempdir().unwrap();
    let both =
        "control.sensitivity={\"muscles.u01.circuit.resistance\": {}, \"bodies.b0.mass\": {}}";
    let problem = "tests/trust/62_sensitivity_of_a_muscle_at_rest.json";
    let summary = solved_from(problem, folder.path(), &[both]);
    let list = summary["sensitivities"].as_array().expect("a list");
    let elasticity = |name: &str| {
        let one = list.iter().find(|one| one["name"] == name).expect(name);
        let [by, value] = ["objective", "value"].map(|key| one[key].as_f64().unwrap());
        by * value / summary["objective"].as_f64().unwrap()
    };
    assert!(elasticity("muscles.u01.circuit.resistance").abs() < 1e-12);
    assert!(elasticity("bodies.b0.mass").abs() > 1e-3);
}
