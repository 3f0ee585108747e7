//! Laws of elasticity of lumped muscles: rest, vibration and pull-in against closed forms, the limit of Gent's law, files.

use crate::common::{motion, placed};
use crate::component_files::read;
use crate::components::column;
use crate::maxwell::{BOTH, LENGTH, MODULUS, SECTION, model, slider};
use num_dual::{Dual64, DualNum};
use proboscis::control::BoundaryConditions;
use proboscis::control::problem::Task;
use proboscis::dynamics::{EquilibriumError, Start, simulate, stable_equilibrium};
use proboscis::files::read_problem;
use proboscis::model::system::{ElasticLaw, MaxwellBranches, System, VACUUM_PERMITTIVITY};
use proboscis::model::{Analysis, Coordinates, Model};
use proboscis::workflow::integrate;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

const PERMITTIVITY: f64 = 3.0 * VACUUM_PERMITTIVITY;
const MASS: f64 = 20.0;
/// mm.
const LAYER: f64 = 0.05;

const LAWS: [ElasticLaw; 4] = [
    ElasticLaw::Gent { limit: 0.9 },
    ElasticLaw::MooneyRivlin { share: 0.4 },
    ElasticLaw::Yeoh {
        c2: -0.004,
        c3: 0.001,
    },
    ElasticLaw::Ogden {
        exponents: [1.2, 8.0],
        share: 0.3,
    },
];

fn system(law: ElasticLaw) -> System {
    let mut system = slider(MASS, MaxwellBranches::default());
    system.muscles[0].material.law = Some(law);
    system
}

/// Nominal stress of the law along the span in MPa, by its published form.
fn stress<D: DualNum<f64> + Copy>(law: ElasticLaw, stretch: D) -> D {
    let strain = stretch.powi(2) + stretch.recip() * 2.0 - 3.0;
    let (of_i1, of_i2) = (stretch - stretch.powi(-2), -stretch.powi(-3) + 1.0);
    match law {
        ElasticLaw::Gent { limit } => of_i1 * (MODULUS * limit) / (-strain + limit),
        ElasticLaw::MooneyRivlin { share } => (of_i1 * (1.0 - share) + of_i2 * share) * MODULUS,
        ElasticLaw::Yeoh { c2, c3 } => {
            of_i1 * (strain * (4.0 * c2) + strain.powi(2) * (6.0 * c3) + MODULUS)
        }
        ElasticLaw::Ogden { exponents, share } => {
            let of = |a: f64, modulus: f64| {
                (stretch.powf(a - 1.0) - stretch.powf(-0.5 * a - 1.0)) * modulus
            };
            let [a, b] = exponents;
            of(a, 2.0 * MODULUS * (1.0 - share) / a) + of(b, 2.0 * MODULUS * share / b)
        }
    }
}

/// Square of the voltage that holds the muscle of an ideal dielectric at a stretch: P + ε E²/Λ³ = 0.
fn squared_voltage(law: ElasticLaw, stretch: f64) -> f64 {
    -stress(law, stretch) * stretch.powi(3) * LAYER * LAYER / PERMITTIVITY
}

fn at_rest(system: &System, coordinates: Coordinates) -> Model {
    let analysis = Analysis {
        coordinates: Some(coordinates),
        ..Analysis::of_motion(1.0)
    };
    Model::for_analysis(system.clone(), analysis).unwrap()
}

#[test]
fn rest_and_small_vibrations_are_those_of_closed_forms() {
    for law in LAWS {
        let system = system(law);
        let stretch = 0.75;
        let square = squared_voltage(law, stretch);
        let neo_hooke = MODULUS * (stretch - stretch.powi(-2));
        assert!(
            (stress(law, stretch) / neo_hooke - 1.0).abs() > 0.01,
            "{law:?}"
        );
        for coordinates in BOTH {
            let model = at_rest(&system, coordinates);
            let rest = stable_equilibrium(&model, &model.coordinates_at(&[0.0]), &[square.sqrt()])
                .unwrap();
            let found = model.joints(&placed(&model, &rest.z), &[0.0])[0];
            let expected = (stretch - 1.0) * LENGTH;
            assert!(
                (found - expected).abs() < 1e-10 * LENGTH,
                "{law:?}: {found}"
            );
            // m ω² = A/L₀ d/dΛ (P + ε E²/Λ³).
            let elastic = stress(law, Dual64::new(stretch, 1.0)).eps;
            let electric = -3.0 * PERMITTIVITY * square / (LAYER * LAYER) / stretch.powi(4);
            let stiffness = (elastic + electric) * SECTION / LENGTH;
            let period = rest.slowest_period(&model).unwrap();
            let exact = TAU / (stiffness / MASS).sqrt();
            assert!(
                (period / exact - 1.0).abs() < 1e-10,
                "{law:?}: {period} for {exact}"
            );
        }
    }
}

/// The greatest squared voltage between two stretches, by golden sections.
fn pull_in(law: ElasticLaw) -> f64 {
    let (mut low, mut high) = (0.45, 0.99);
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let [a, b] = [high - part * (high - low), low + part * (high - low)];
        match squared_voltage(law, a) > squared_voltage(law, b) {
            true => high = b,
            false => low = a,
        }
    }
    assert!(
        low > 0.46 && high < 0.98,
        "{law:?}: the greatest voltage is inside, {low}"
    );
    squared_voltage(law, low).sqrt()
}

#[test]
fn a_muscle_pulls_in_at_the_greatest_voltage_of_its_law() {
    let exponents = [1.3, 2.6];
    let share = 0.4;
    for law in [LAWS[1], ElasticLaw::Ogden { exponents, share }] {
        let greatest = pull_in(law);
        for coordinates in BOTH {
            let model = at_rest(&system(law), coordinates);
            let refused =
                stable_equilibrium(&model, &model.coordinates_at(&[0.0]), &[1.1 * greatest]);
            let Err(EquilibriumError::LimitPoint { loss, .. }) = refused else {
                panic!("{law:?}: {refused:?}");
            };
            let fraction = loss.fraction;
            assert!((1.1 * fraction - 1.0).abs() < 1e-5, "{law:?}: {fraction}");
        }
    }
}

/// A start at the reference configuration with a velocity in mm/ms.
fn moving(model: &Model, velocity: f64) -> Start {
    let rates = model.rates_at(&[0.0], &[velocity], &BTreeMap::new());
    let rates = model.rates_of_all(&rates.unwrap(), &[velocity]);
    Start::with_rates(model, model.coordinates_at(&[0.0]), &rates)
}

#[test]
fn gents_limit_stops_a_motion_and_refuses_a_start() {
    let law = ElasticLaw::Gent { limit: 0.9 };
    let [low, high] = law.stretches().unwrap();
    let system = system(law);
    for coordinates in BOTH {
        let model = model(&system, coordinates, 0.1);
        // A mass this fast would stretch a neo-Hookean muscle beyond the limit.
        let start = moving(&model, 4.6);
        let discrete = motion(&model, &start, 0.1, 800, &[0.0]);
        let stretch = column(&model, &discrete, "muscle_stretch");
        let [least, most] = [f64::min, f64::max].map(|of| stretch.iter().copied().fold(1.0, of));
        assert!(
            low < least && most < high && most > 1.0 + 0.6 * (high - 1.0),
            "{least} {most}"
        );
        let energy = column(&model, &discrete, "total_energy");
        let kinetic = 0.5 * MASS * 4.6 * 4.6;
        let off = energy
            .iter()
            .map(|e| (e - kinetic).abs())
            .fold(0.0, f64::max);
        assert!(off < 0.05 * kinetic, "{off} of {kinetic}");
    }
    // One step that leads beyond the limit is halved, and at last refused by name.
    let model = model(&system, Coordinates::Reduced, 10.0);
    let start = moving(&model, 1e5);
    let (_, failure) = simulate(
        &model,
        &start,
        10.0,
        1,
        |_, _| vec![0.0],
        |_| ControlFlow::Continue(()),
    );
    let failure = failure.unwrap();
    assert!(failure.to_string().contains("Gent's limit"), "{failure}");
}

const SCENE: &str = r#"{
  "name": "hung", "materials": { "rubber": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "law": { "gent": { "limit": 0.9 } } } },
  "bodies": [ { "name": "b", "mass": "20 g", "sphere": { "radius": "5 mm" }, "position": ["40 mm", 0, 0] } ],
  "joints": [ { "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": ["40 mm", 0, 0] } ],
  "muscles": [ { "name": "m", "material": "rubber", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
    "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "b", "at": ["40 mm", 0, 0] } } ]
}"#;

const GENT: &str = r#"{ "gent": { "limit": 0.9 } }"#;

#[test]
fn files_say_laws() {
    let read_law = |written: &str| {
        let scene = read(&SCENE.replace(GENT, written));
        scene.map(|system| system.muscles[0].material.law)
    };
    for (written, law) in [
        (GENT, ElasticLaw::Gent { limit: 0.9 }),
        (
            r#"{ "mooney_rivlin": { "share": 0.2 } }"#,
            ElasticLaw::MooneyRivlin { share: 0.2 },
        ),
        (
            r#"{ "yeoh": { "c2": "-2 kPa", "c3": 100 } }"#,
            ElasticLaw::Yeoh {
                c2: -2e-3,
                c3: 1e-4,
            },
        ),
        (
            r#"{ "ogden": { "exponents": [1.3, -2], "share": 0.1 } }"#,
            ElasticLaw::Ogden {
                exponents: [1.3, -2.0],
                share: 0.1,
            },
        ),
    ] {
        assert_eq!(read_law(written).unwrap(), Some(law), "{written}");
    }
    for (written, told) in [
        (
            r#"{}"#,
            vec!["materials.rubber.law", "exactly one of \"gent\""],
        ),
        (
            r#"{ "gent": { "limit": 3 }, "mooney_rivlin": { "share": 0 } }"#,
            vec!["law", "exactly one"],
        ),
        (
            r#"{ "gent": { "limit": 0 } }"#,
            vec!["law.gent.limit", "a positive number"],
        ),
        (r#"{ "gent": {} }"#, vec!["law.gent", "limit"]),
        (
            r#"{ "mooney_rivlin": { "share": 1.2 } }"#,
            vec!["mooney_rivlin.share", "1.2", "from 0 to 1"],
        ),
        (
            r#"{ "yeoh": { "c2": "1 kPa", "c3": "-1 kPa" } }"#,
            vec!["yeoh.c3", "grows without bound"],
        ),
        (
            r#"{ "yeoh": { "c2": "1 mm", "c3": "1 kPa" } }"#,
            vec!["yeoh.c2", "a stress"],
        ),
        (
            r#"{ "ogden": { "exponents": [0, 2], "share": 0.5 } }"#,
            vec!["ogden.exponents", "not zero"],
        ),
        (
            r#"{ "neo_hooke": {} }"#,
            vec!["neo_hooke", "expected one of"],
        ),
    ] {
        let message = read_law(written).unwrap_err();
        assert!(
            told.iter().all(|word| message.contains(word)),
            "{written}: {message}"
        );
    }
    // Finite elements follow laws of invariants.
    let elements = |law: &str| {
        let scene = SCENE.replace(
            "\"cross_section\"",
            "\"model\": \"finite_elements\", \"elements\": [1, 1, 2], \"cross_section\"",
        );
        let scene = scene.replace(GENT, &format!("{law}, \"poisson_ratio\": 0.45"));
        read(&scene)
    };
    assert!(elements(GENT).unwrap().muscles[0].material.law.is_some());
    let message = elements(r#"{ "ogden": { "exponents": [2, 3], "share": 0.5 } }"#).unwrap_err();
    assert!(
        message.contains("Ogden's law") && message.contains("\"rubber\""),
        "{message}"
    );
}

/// The message of a problem with this task, or nothing.
fn refusal(task: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.json");
    std::fs::write(&path, format!("{{ \"scene\": {SCENE}, {task} }}")).unwrap();
    let loaded = read_problem(&path, &[]).unwrap();
    match &loaded.task {
        Task::Simulate(task) => {
            let run = integrate(&loaded.system, task, |_, _| ControlFlow::Continue(()));
            run.err().map(|error| error.to_string())
        }
        Task::Control(control) => {
            let resolved = BoundaryConditions::resolve(&loaded.system, control, 1.0);
            resolved.err().map(|error| error.to_string())
        }
        Task::Motions(_) | Task::Equilibrium(_) | Task::Identify(_) => panic!("a motion"),
    }
}

#[test]
fn what_lies_beyond_gents_limit_is_refused_by_its_name() {
    let [low, high] = ElasticLaw::Gent { limit: 0.9 }.stretches().unwrap();
    let simulate = |stretch: f64| {
        let displacement = 40.0 * (stretch - 1.0);
        format!(
            r#""simulate": {{ "duration": "5 ms", "step": "1 ms", "start": {{ "joint_angles": {{ "j": "{displacement} mm" }} }} }}"#
        )
    };
    let control = |goal: f64, most: f64| {
        let displacement = 40.0 * (goal - 1.0);
        format!(
            r#""control": {{ "duration": "50 ms", "intervals": 10, "start": {{ "rest_at_voltages": {{}} }}, "goal": {{ "joint_angles": {{ "j": "{displacement} mm" }} }},
            "voltage_bounds": [0, "3 kV"], "objective": {{ "effort": 1 }}, "limits": [ {{ "stretch": {{ "muscle": "m", "max": {most} }} }} ] }}"#
        )
    };
    let inside = 1.0 + 0.9 * (high - 1.0);
    for task in [simulate(inside), control(0.95, inside)] {
        assert_eq!(refusal(&task), None, "{task}");
    }
    for (task, place) in [
        (simulate(high + 0.01), "start"),
        (simulate(low - 0.01), "start"),
        (control(low - 0.01, inside), "goal"),
        (control(0.95, high + 0.01), "limits"),
    ] {
        let message = refusal(&task).unwrap_or_else(|| panic!("{task}"));
        let words = [place, "muscle \"m\"", "Gent's limit"];
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
