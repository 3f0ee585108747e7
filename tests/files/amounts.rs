//! Limits and costs of volumes and masses of muscles as they are written, and their mistakes.

use crate::scene::{Case, check, folder, mistake};
use proboscis::control::problem::{Control, CostFunction, Limit, Task};
use proboscis::files::read_problem;
use proboscis::model::{Amount, Quantity, What};

/// A pair of muscles, of which one has no density.
const PAIR: &str = r#"{
  "name": "pair",
  "materials": {
    "soft": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "viscosity": "1000 Pa s", "density": 1000 },
    "light": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "viscosity": "1000 Pa s" }
  },
  "bodies": [ { "name": "arm", "mass": "30 g", "position": [0, "25 mm", 0], "cylinder": { "length": "50 mm", "radius": "20 mm", "axis": [0, 1, 0] } } ],
  "joints": [ { "name": "joint1", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "arm", "at": [0, 0, 0] } ],
  "muscles": [
    { "name": "right", "material": "soft", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
      "from": { "body": "ground", "at": ["15 mm", "-20 mm", 0] }, "to": { "body": "arm", "at": ["15 mm", "20 mm", 0] } },
    { "name": "left", "material": "light", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
      "from": { "body": "ground", "at": ["-15 mm", "-20 mm", 0] }, "to": { "body": "arm", "at": ["-15 mm", "20 mm", 0] } }
  ]
}"#;

const PROBLEM: &str = r#"{ "scene": "scene.json", "control": { "duration": "0.2 s", "intervals": 4, "start": { "joint_angles": {} },
  "goal": { "joint_angles": { "joint1": 0.1 } }, "voltage_bounds": [0, "3 kV"], "objective": { "effort": 1, "muscle_volume": 0.5 },
  "free": { "muscles.right.cross_section[0]": { "min": "5 mm", "max": "20 mm" } },
  "limits": [
    { "muscle_volume": { "max": "7 cm^3" } },
    { "muscle_mass": { "muscles": ["right"], "min": "3 g", "max": "4.5 g" } }
  ] } }"#;

fn read(problem: &str) -> Control {
    let (_folder, path) = folder(PAIR, problem);
    match read_problem(&path, &[]).expect("a problem").task {
        Task::Control(control) => *control,
        other => panic!("{other:?}"),
    }
}

#[test]
fn amounts_are_read_in_their_units() {
    let control = read(PROBLEM);
    let limit = |muscles: &[usize], amount, min, max| {
        Limit::new(
            What::Amount {
                muscles: muscles.into(),
                amount,
            },
            [min, max],
        )
    };
    let max = control.limits[0].max;
    assert!((max / 7e3 - 1.0).abs() < 1e-14, "{max}");
    let volume = limit(&[0, 1], Amount::Volume, f64::NEG_INFINITY, max);
    let [min, max] = control.limits[1].bounds();
    assert!((min / 3.0 - 1.0).abs() < 1e-14 && (max / 4.5 - 1.0).abs() < 1e-14);
    assert_eq!(
        control.limits,
        [volume, limit(&[0], Amount::Mass, min, max)]
    );
    let [cost] = &control.objective.quantities[..] else {
        panic!("one cost");
    };
    let quantity = Quantity::of(What::Amount {
        muscles: [0, 1].into(),
        amount: Amount::Volume,
    })
    .in_unit(1e3);
    assert_eq!((&cost.quantity, cost.weight), (&quantity, 0.5));
    assert_eq!(cost.function, CostFunction::Itself);
}

#[test]
fn mistakes_have_their_places() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"7 cm^3\"", "\"7 g\"", "control.limits[0].muscle_volume.max", "which is a mass", "a volume", "7 g"),
        ("\"7 cm^3\"", "\"-7 cm^3\"", "control.limits[0].muscle_volume.max", "no more than zero", "a positive bound", "-7 cm^3"),
        ("\"max\": \"7 cm^3\"", "", "control.limits[0].muscle_volume", "no bound", "\"min\", \"max\" or both", "{"),
        ("\"max\": \"7 cm^3\"", "\"muscles\": [], \"max\": 1", "control.limits[0].muscle_volume.muscles", "no muscle", "a lumped muscle", "[]"),
        ("\"max\": \"7 cm^3\"", "\"muscles\": \"all\", \"max\": 1", "control.limits[0].muscle_volume.muscles", "\"all\"", "a list", "\"all\""),
        ("\"max\": \"7 cm^3\" }", "\"max\": \"7 cm^3\" }, \"part\": 1", "control.limits[0].part", "1", "no part", "1"),
        ("\"4.5 g\"", "\"2 g\"", "control.limits[1].muscle_mass.max", "below", "not crossed", "2 g"),
        ("[\"right\"]", "[\"right\", \"right\"]", "control.limits[1].muscle_mass.muscles[1]", "\"right\"", "", "\"right\""),
        ("[\"right\"]", "[\"rigth\"]", "control.limits[1].muscle_mass.muscles[0]", "\"rigth\"", "the name of a muscle", "\"rigth\""),
        ("[\"right\"]", "[\"left\"]", "control.limits[1].muscle_mass.muscles[0]", "no density", "a \"density\"", "\"left\""),
        ("\"muscle_volume\": 0.5", "\"muscle_volume\": -0.5", "control.objective.muscle_volume", "-0.5", "", "-0.5"),
    ];
    check(cases, PROBLEM, |problem| mistake(PAIR, problem, &[]));
    let without = PAIR.replace(", \"density\": 1000", "");
    let weighted = PROBLEM.replace("\"muscle_volume\": 0.5", "\"muscle_mass\": 0.5");
    let error = mistake(&without, &weighted, &[]);
    assert_eq!(error.path(), "control.objective.muscle_mass");
    assert!(
        error.found().contains("muscles without a density"),
        "{error}"
    );
}
