//! Free parameters as a problem names them, and its mistakes.

use crate::scene::{Case, check, control, folder, mistake};
use proboscis::control::problem::{Control, Task};
use proboscis::files::read_problem;
use proboscis::model::{Constant, Follower, MaterialConstant, with_parameters};

/// A chain without masses of muscles, and its own names beside.
const CHAIN: &str = r#"{
  "name": "chain",
  "materials": {
    "soft": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "viscosity": "1000 Pa s", "dielectric": "ideal" },
    "spare": { "shear_modulus": "100 kPa", "density": 1000 }
  },
  "chain": {
    "segments": 2, "length": "50 mm", "radius": "20 mm", "mass": "30 g", "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
    "muscles": { "material": "soft", "arm": "15 mm", "rest_length": "40 mm", "cross_section": ["10 mm", "8 mm"], "layer_thickness": "50 um" }
  },
  "springs": [ { "name": "stay", "from": { "body": "ground", "at": ["30 mm", 0, 0] }, "to": { "body": "segment1", "at": ["30 mm", "40 mm", 0] },
    "stiffness": "20 N/m" } ]
}"#;

fn problem(free: &str) -> String {
    format!(
        r#"{{ "scene": "scene.json", "control": {{ "duration": "0.2 s", "intervals": 4, "start": {{ "joint_angles": {{}} }},
        "goal": {{ "joint_angles": {{ "joint1": 0.1 }} }}, "voltage_bounds": [0, "3 kV"], "objective": {{ "effort": 1 }},
        "free": {free} }} }}"#
    )
}

fn read(free: &str) -> Control {
    control(CHAIN, &problem(free))
}

fn follower(constant: Constant, factor: f64, offset: f64) -> Follower {
    Follower {
        constant,
        factor,
        offset,
        higher: [0.0; 2],
    }
}

#[test]
fn constants_are_named_by_their_paths() {
    let free = r#"{
        "materials.soft.shear_modulus": { "min": "50 kPa", "max": 2e5, "guess": "120 kPa" },
        "materials.soft.relative_permittivity": { "min": 2, "max": 4 },
        "chain.muscles.arm": { "min": "5 mm", "max": "30 mm" },
        "springs.stay.stiffness": { "min": "1 N/m", "max": "30 N/m" },
        "muscles[3].layer_thickness": { "min": "10 um", "max": "90 um", "also": { "muscles.muscle1.layer_thickness": 2 } } }"#;
    let found = read(free).parameters;
    let by_name = |name: &str| found.iter().find(|p| p.name == name).expect("a parameter");
    let modulus = by_name("materials.soft.shear_modulus");
    assert!((modulus.lower - 0.05).abs() < 1e-15 && (modulus.upper - 0.2).abs() < 1e-15);
    assert!((modulus.guess - 0.12).abs() < 1e-15);
    let modulus_of = |m| MaterialConstant::ShearModulus.of_muscle(m);
    let all: Vec<Follower> = (0..4).map(|m| modulus_of(m).into()).collect();
    assert_eq!(modulus.constants, all);
    let ratio = by_name("materials.soft.relative_permittivity");
    assert_eq!([ratio.lower, ratio.guess, ratio.upper], [2.0, 3.0, 4.0]);
    let third = ratio.constants[2];
    assert_eq!(third.constant, MaterialConstant::Permittivity.of_muscle(2));
    assert!((third.factor / 8.854187817e-12 - 1.0).abs() < 1e-12 && third.offset == 0.0);
    let arm = by_name("chain.muscles.arm");
    assert_eq!([arm.lower, arm.guess, arm.upper], [5.0, 15.0, 30.0]);
    // Muscles of the first joint stand off along x, those of the second along z, two and two; both ends of each.
    let expected = (0..4).flat_map(|m| [0, 1].map(|end| (m, end)));
    let sides = [1.0, -1.0, 1.0, -1.0];
    let expected: Vec<Follower> = expected
        .map(|(m, end)| {
            follower(
                Constant::End(m, end, if m < 2 { 0 } else { 2 }),
                sides[m],
                0.0,
            )
        })
        .collect();
    let signs = |list: &[Follower]| -> Vec<(Constant, bool)> {
        list.iter()
            .map(|f| (f.constant, f.factor.abs() == 1.0 && f.offset == 0.0))
            .collect()
    };
    assert_eq!(signs(&arm.constants), signs(&expected));
    for (a, b) in [(0, 2), (4, 6)] {
        assert_eq!(arm.constants[a].factor, -arm.constants[b].factor);
    }
    let stay = by_name("springs.stay.stiffness");
    assert_eq!(stay.constants, [Constant::SpringStiffness(0).into()]);
    assert!((stay.guess - 0.02).abs() < 1e-15);
    let layer = by_name("muscles[3].layer_thickness");
    let both = [
        Constant::Layer(3).into(),
        follower(Constant::Layer(0), 2.0, 0.0),
    ];
    assert_eq!(layer.constants, both);
}

/// Joints, bodies, muscles and moments of inertia follow the length of the segments, as in a scene with that length.
#[test]
fn a_length_is_that_of_the_scene_with_it() {
    let free = r#"{ "chain.length": { "min": "40 mm", "max": "65 mm" } }"#;
    let of = |length: &str| {
        let scene = CHAIN.replace("\"50 mm\"", length);
        let (_folder, path) = folder(&scene, &problem(free));
        let read = read_problem(&path, &[]).expect("a problem");
        match read.task {
            Task::Control(control) => (read.system, control.parameters),
            other => panic!("{other:?}"),
        }
    };
    let ((system, parameters), (other, _)) = (of("\"50 mm\""), of("\"58 mm\""));
    assert_eq!(parameters[0].guess, 50.0);
    assert_eq!(parameters[0].unit(&system).symbol, "m");
    let found = &mut with_parameters(&system, &parameters, &[58.0]);
    let (mut system, mut other) = (system, other);
    let mut changed = 0;
    for constant in Constant::all(&other) {
        let values = [&mut system, &mut *found, &mut other].map(|one| constant.value(one));
        let [Some(before), Some(value), Some(expected)] = values else {
            continue;
        };
        let name = format!("{constant:?}: {value} {expected}");
        assert!((value - expected).abs() <= 1e-10 * expected.abs(), "{name}");
        changed += usize::from(before != expected);
        constant.set(expected, found);
    }
    // Two lengths, two places of bodies, one of a joint, four ends of muscles, and two moments of each body.
    assert_eq!(changed, 2 + 2 + 1 + 4 + 4);
    assert!(*found == other);
}

#[test]
fn what_cannot_be_sought_is_refused() {
    const FREE: &str = r#"{ "materials.soft.viscosity": { "min": "500 Pa s", "max": "2000 Pa s", "guess": "900 Pa s" } }"#;
    let base = problem(FREE);
    let at = "control.free.materials.soft.viscosity";
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("materials.soft.viscosity", "materials.hard.viscosity", "control.free.materials.hard.viscosity", "\"hard\", which is no material", "the name of a material", "{"),
        ("materials.soft.viscosity", "materials.soft.density", "control.free.materials.soft.density.min", "which is a viscosity", "a density", "500 Pa s"),
        ("materials.soft.viscosity", "gravity[0]", "control.free.gravity[0]", "the index 0", "gravity is no list", "{"),
        ("materials.soft.viscosity", "", "control.free.", "no number of the scene that can be sought", "joints.NAME.damping", "{"),
        ("materials.soft.viscosity", "materials.spare.shear_modulus", "control.free.materials.spare.shear_modulus.min", "which is a viscosity", "a stress", "500 Pa s"),
        ("materials.soft.viscosity", "joints.joint1.damping", "control.free.joints.joint1.damping.min", "which is a viscosity", "a rotational damping", "500 Pa s"),
        ("materials.soft.viscosity", "muscles.nerve.layer_thickness", "control.free.muscles.nerve.layer_thickness", "the name \"nerve\"", "muscle1", "{"),
        ("materials.soft.viscosity", "muscles[4].layer_thickness", "control.free.muscles[4].layer_thickness", "the index 4", "an index below 4", "{"),
        ("materials.soft.viscosity", "springs.stay.damping", "control.free.springs.stay.damping.min", "which is a viscosity", "a damping", "500 Pa s"),
        ("\"500 Pa s\"", "\"500 mm\"", "control.free.materials.soft.viscosity.min", "which is a length", "a viscosity", "500 mm"),
        ("\"500 Pa s\"", "true", "control.free.materials.soft.viscosity.min", "true", "a viscosity", "true"),
        ("\"500 Pa s\"", "\"-5 Pa s\"", "control.free.materials.soft.viscosity.min", "-5 Pa s", "positive", "-5 Pa s"),
        ("\"500 Pa s\"", "\"3000 Pa s\"", "control.free.materials.soft.viscosity.max", "2000 Pa s", "larger than", "2000 Pa s"),
        ("\"900 Pa s\"", "\"9000 Pa s\"", "control.free.materials.soft.viscosity.guess", "9000 Pa s", "from \"500 Pa s\" to \"2000 Pa s\"", "9000 Pa s"),
        ("\"guess\": \"900 Pa s\"", "\"also\": { \"chain.muscles.arm\": 1 }", "control.free.materials.soft.viscosity.also.chain.muscles.arm", "\"m\"", "\"Pa s\"", "1"),
        ("\"guess\": \"900 Pa s\"", "\"also\": { \"materials.soft.viscosity\": 1 }", "control.free.materials.soft.viscosity", "the same constant", "a constant that can be sought", "{"),
        ("\"guess\"", "\"gues\"", "control.free.materials.soft.viscosity.gues", "the key \"gues\"", "\"guess\"", "\"gues\""),
    ];
    check(cases, &base, |problem| mistake(CHAIN, problem, &[]));
    // An end of a spring without a rest length of its own changes that too, which is not linear: also where a bound is the value of the scene.
    let ends = r#"{ "springs.stay.to.at[0]": { "min": "30 mm", "max": "50 mm" } }"#;
    let error = mistake(CHAIN, &problem(ends), &[]);
    assert!(error.found().contains("no polynomial"), "{error}");
    // A value of the scene outside the bounds is no guess.
    let text = base
        .replace(", \"guess\": \"900 Pa s\"", "")
        .replace("500 Pa s", "1500 Pa s");
    let error = mistake(CHAIN, &text, &[]);
    assert_eq!(error.path(), at);
    assert!(error.found().contains("outside the bounds"), "{error}");
}
