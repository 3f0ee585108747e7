//! Numbers by which an optimum is differentiated, as a problem names them, and its mistakes.

use crate::scene::{Case, check, control, mistake};
use proboscis::control::problem::{Control, VariedOf, WeightOf};

const CHAIN: &str = r#"{
  "name": "chain",
  "materials": {
    "soft": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "viscosity": "1000 Pa s", "dielectric": "ideal" },
    "spare": { "shear_modulus": "100 kPa", "density": 1000 }
  },
  "chain": {
    "segments": 2, "length": "50 mm", "radius": "20 mm", "mass": "30 g", "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
    "muscles": { "material": "soft", "arm": "15 mm", "rest_length": "40 mm", "cross_section": ["10 mm", "8 mm"], "layer_thickness": "50 um" }
  }
}"#;

/// Place of the tolerance of the base problem.
const TOLERANCE: &str = "control.sensitivity.materials.soft.shear_modulus.tolerance";

fn problem(asked: &str) -> String {
    format!(
        r#"{{ "scene": "scene.json", "control": {{ "duration": "0.2 s", "intervals": 4,
        "start": {{ "joint_angles": {{ "joint2": 0.1 }}, "joint_rates": {{ "joint1": 2 }} }},
        "goal": {{ "joint_angles": {{ "joint1": 0.1 }} }}, "voltage_bounds": [0, "3 kV"], "objective": {{ "effort": 1 }},
        "sensitivity": {asked} }} }}"#
    )
}

fn read(asked: &str) -> Control {
    control(CHAIN, &problem(asked))
}

#[test]
fn numbers_are_named_by_their_paths() {
    let asked = r#"{
        "materials.soft.shear_modulus": { "tolerance": "5 %" },
        "chain.muscles.arm": { "tolerance": "0.3 mm" },
        "muscles[3].layer_thickness": { "also": { "muscles.muscle1.layer_thickness": 1 } },
        "goal.joint_angles.joint1": { "tolerance": "1 deg" },
        "start.joint_rates.joint1": {}, "start.joint_angles.joint2": {},
        "duration": { "tolerance": "1 ms" }, "voltage_bounds[1]": { "tolerance": "1 %" }, "objective.effort": {} }"#;
    let found = read(asked).varied;
    assert_eq!(found.len(), 9);
    let of = |name: &str| found.iter().find(|one| one.name == name).expect("a number");
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * b.abs();
    let modulus = of("materials.soft.shear_modulus");
    // Inside moduli are in MPa, lengths in mm, rates in rad/ms.
    assert!(close(modulus.value, 0.1) && close(modulus.tolerance.unwrap(), 0.005));
    assert_eq!((modulus.unit.symbol, modulus.unit.factor), ("Pa", 1e6));
    assert_eq!(modulus.parameter().unwrap().constants.len(), 4);
    assert!(close(of("chain.muscles.arm").tolerance.unwrap(), 0.3));
    let layers = of("muscles[3].layer_thickness").parameter().unwrap();
    assert_eq!(layers.constants.len(), 2);
    let goal = of("goal.joint_angles.joint1");
    assert_eq!((&goal.of, goal.value), (&VariedOf::GoalJoint(0), 0.1));
    assert!(close(goal.tolerance.unwrap(), 1_f64.to_radians()));
    let rate = of("start.joint_rates.joint1");
    assert_eq!(
        (&rate.of, rate.unit.symbol),
        (&VariedOf::StartRate(0), "rad/s")
    );
    assert!(close(rate.value * rate.unit.factor, 2.0));
    assert_eq!(of("start.joint_angles.joint2").of, VariedOf::StartJoint(1));
    assert_eq!(
        (of("duration").value, of("duration").tolerance),
        (200.0, Some(1.0))
    );
    let bound = of("voltage_bounds[1]");
    assert_eq!(
        (&bound.of, bound.tolerance),
        (&VariedOf::VoltageBound(1), Some(30.0))
    );
    assert_eq!(
        of("objective.effort").of,
        VariedOf::Weight(WeightOf::Effort)
    );
}

#[test]
fn mistakes_are_told_with_their_places() {
    let base = problem(r#"{ "materials.soft.shear_modulus": { "tolerance": "5 %" } }"#);
    let whole = r#""materials.soft.shear_modulus": { "tolerance": "5 %" }"#;
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("materials.soft.shear_modulus", "materials.soft.shear_modlus", "control.sensitivity.materials.soft.shear_modlus", "no number of the scene", "the path of a number", "{"),
        ("materials.soft.shear_modulus", "materials.spare.shear_modulus", "control.sensitivity.materials.spare.shear_modulus", "nothing depends", "the path of a number", "{"),
        ("5 %", "0 %", TOLERANCE, "not positive", "a positive part such as \"5 %\"", "0 %"),
        ("5 %", "-1 %", TOLERANCE, "not positive", "a positive part", "-1 %"),
        ("5 %", "1 mm", TOLERANCE, "which is a length", "a stress", "1 mm"),
        ("5 %", "five %", TOLERANCE, "five %", "a positive part", "five %"),
        ("materials.soft.shear_modulus", "goal.joint_angles.joint7", "control.sensitivity.goal.joint_angles.joint7", "joint7", "the name of a joint", "{"),
        ("materials.soft.shear_modulus", "goal.markers.tip[0]", "control.sensitivity.goal.markers.tip[0]", "no number of the problem", "voltage_bounds[1]", "{"),
        ("materials.soft.shear_modulus", "voltage_bounds[2]", "control.sensitivity.voltage_bounds[2]", "no number of the problem", "voltage_bounds[1]", "{"),
        (whole, r#""duration": { "tolerance": "1 kV" }"#, "control.sensitivity.duration.tolerance", "which is a voltage", "a time", "1 kV"),
        (whole, r#""duration": {}, "duration": {}"#, "control.sensitivity.duration", "twice", "each key once", "duration"),
        (whole, r#""duration": { "also": { "chain.mass": 2 } }"#, "control.sensitivity.duration.also", "other constants", "a number of the scene", "chain.mass"),
        (whole, r#""muscles.muscle1.layer_thickness": {}, "muscles[0].layer_thickness": {}"#, "control.sensitivity.muscles[0].layer_thickness", "changes the same constant", "a constant that can be differentiated by", "{"),
    ];
    check(cases, &base, |text| mistake(CHAIN, text, &[]));
}
