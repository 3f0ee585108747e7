//! Maxwell branches of lumped muscles: published relaxation, a motion by another method, memory, and files.

use crate::common::{bare, motion, placed, runge_kutta};
use crate::component_files::read;
use crate::components::{body, column};
use nalgebra::{Vector3, Vector4};
use proboscis::dynamics::{
    DiscreteTrajectory, Integrator, Solving, Start, simulate_by, stable_equilibrium,
};
use proboscis::model::system::{
    Attachment, ElectricConstants, Joint, JointKind, Material, MaxwellBranch, MaxwellBranches,
    Muscle, System,
};
use proboscis::model::{Analysis, Coordinates, Model, Role};
use std::ops::ControlFlow;

pub(crate) const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];
/// mm, mm², MPa.
pub(crate) const LENGTH: f64 = 40.0;
pub(crate) const SECTION: f64 = 100.0;
pub(crate) const MODULUS: f64 = 0.1;

pub(crate) fn branches(list: &[[f64; 2]]) -> MaxwellBranches {
    let of = |&[shear_modulus, relaxation_time]: &[f64; 2]| MaxwellBranch {
        shear_modulus,
        relaxation_time,
    };
    MaxwellBranches::new(&list.iter().map(of).collect::<Vec<_>>()).unwrap()
}

/// A mass on a slide along x that a muscle holds; no other force.
pub(crate) fn slider(mass: f64, maxwell: MaxwellBranches) -> System {
    let mut body = body("mass", LENGTH);
    body.mass = mass;
    let slide = Joint {
        name: "slide".into(),
        kind: JointKind::Prismatic { axis: Vector3::x() },
        at: Vector3::new(LENGTH, 0.0, 0.0),
        ..Joint::default()
    };
    let mut system = bare(vec![body], vec![slide], None);
    let end = |body, x| Attachment {
        body,
        at: Vector3::new(x, 0.0, 0.0),
    };
    system.muscles.push(Muscle {
        name: "muscle".into(),
        from: end(None, 0.0),
        to: end(Some(0), LENGTH),
        cross_section: [10.0, 10.0],
        layer_thickness: 0.05,
        material: Material {
            shear_modulus: MODULUS,
            electric: Some(ElectricConstants::ideal(3.0)),
            maxwell,
            ..Material::default()
        },
        prestretch: None,
        section_inertia: false,
        circuit: None,
        fidelity: Default::default(),
    });
    system
}

pub(crate) fn model(system: &System, coordinates: Coordinates, h: f64) -> Model {
    Model::new(system.clone(), Some(coordinates), h, &[]).unwrap()
}

/// Places of the internal coordinates.
pub(crate) fn internal(model: &Model) -> std::ops::Range<usize> {
    model.action.map.internal()
}

/// A start at rest at a displacement, with branches that have not felt it yet.
pub(crate) fn suddenly(model: &Model, displacement: f64) -> Start {
    let mut z = model.coordinates_at(&[displacement]);
    z[internal(model)].fill(0.0);
    Start::at_rest(model, z)
}

/// Nominal stress of the elasticity and of one branch with c = e^(2z), in MPa.
pub(crate) fn stress(stretch: f64, modulus: f64, z: f64) -> f64 {
    let c = (2.0 * z).exp();
    let elastic = MODULUS * (stretch - stretch.powi(-2));
    elastic + modulus * (stretch / c - c.sqrt() / stretch.powi(2))
}

#[test]
fn stress_relaxes_as_the_published_law_says() {
    // μ₁ = 50 kPa, τ = 0.1 s, a step to Λ = 0.8, which a mass of a million tonnes keeps.
    let expected = [
        -0.1143750,
        -0.1009831352878,
        -0.0919727479142,
        -0.0785351251941,
    ];
    let system = slider(1e12, branches(&[[0.05, 100.0]]));
    for coordinates in BOTH {
        let errors = [2.0, 1.0].map(|h| {
            let model = model(&system, coordinates, h);
            let start = suddenly(&model, -0.2 * LENGTH);
            let steps = (300.0 / h) as usize;
            let discrete = motion(&model, &start, h, steps, &[0.0]);
            let stretch = column(&model, &discrete, "muscle_stretch");
            assert!((stretch[steps] - 0.8).abs() < 1e-7, "{}", stretch[steps]);
            let viscous = column(&model, &discrete, "muscle_viscous_stretch1");
            let at = |time: f64| stress(0.8, 0.05, viscous[(time / h).round() as usize].ln());
            let found = [0.0, 50.0, 100.0, 300.0].map(at);
            let errors = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            let lost = column(&model, &discrete, "dissipated_energy");
            assert!(
                lost.windows(2).all(|pair| pair[1] > pair[0]),
                "it dissipates"
            );
            errors.fold(0.0, f64::max)
        });
        assert!(errors[1] < 2e-6, "{errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((3.6..4.4).contains(&ratio), "{coordinates:?}: {errors:?}");
    }
}

/// Displacement, velocity and logarithms of the viscous stretches of the slider by Runge and Kutta.
pub(crate) fn swing(mass: f64, list: &[[f64; 2]; 2], from: [f64; 4], time: f64) -> [f64; 4] {
    let rate = |y: &Vector4<f64>| {
        let stretch = 1.0 + y[0] / LENGTH;
        let mut force = SECTION * MODULUS * (stretch - stretch.powi(-2));
        let mut out = Vector4::new(y[1], 0.0, 0.0, 0.0);
        for (b, [modulus, tau]) in list.iter().enumerate() {
            let elastic = stretch * (-y[2 + b]).exp();
            force += SECTION * modulus * (elastic.powi(2) - 1.0 / elastic) / stretch;
            out[2 + b] = (elastic.powi(2) - 1.0 / elastic) / (3.0 * tau);
        }
        out[1] = -force / mass;
        out
    };
    let steps = 40_000;
    let end = (0..steps).fold(Vector4::from(from), |y, _| {
        runge_kutta(&rate, &y, time / f64::from(steps))
    });
    end.into()
}

pub(crate) fn end(model: &Model, discrete: &DiscreteTrajectory) -> Vec<f64> {
    let z = discrete.z.last().unwrap();
    let instant = placed(model, z);
    let joint = model.joints(&instant, &[0.0]);
    joint
        .into_iter()
        .chain(z[internal(model)].iter().copied())
        .collect()
}

#[test]
fn a_swing_with_two_branches_is_that_of_another_method() {
    let list = [[0.05, 8.0], [0.03, 60.0]];
    let system = slider(20.0, branches(&list));
    let exact = swing(20.0, &list, [6.0, 0.0, 0.0, 0.0], 40.0);
    assert!(exact[2].abs() > 1e-3 && exact[3].abs() > 1e-4, "{exact:?}");
    let exact = [exact[0], exact[2], exact[3]];
    for coordinates in BOTH {
        let errors = [0.2, 0.1].map(|h| {
            let model = model(&system, coordinates, h);
            let start = suddenly(&model, 6.0);
            let discrete = motion(&model, &start, h, (40.0 / h).round() as usize, &[0.0]);
            let total = column(&model, &discrete, "total_energy");
            let lost = column(&model, &discrete, "dissipated_energy");
            let balance = total[total.len() - 1] + lost[lost.len() - 1];
            assert!(lost[lost.len() - 1] > 0.1 * total[0], "little is lost");
            assert!(
                (balance / total[0] - 1.0).abs() < 0.01,
                "{balance} of {}",
                total[0]
            );
            let found = end(&model, &discrete);
            let errors = found.iter().zip(exact).map(|(a, b)| (a - b).abs());
            errors.fold(0.0, f64::max)
        });
        assert!(errors[0] < 0.05, "{errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((3.6..4.4).contains(&ratio), "{coordinates:?}: {errors:?}");
    }
}

#[test]
fn what_is_held_for_long_and_what_rests_is_relaxed() {
    let with = slider(20.0, branches(&[[0.05, 8.0], [0.03, 60.0]]));
    let without = slider(20.0, MaxwellBranches::default());
    for coordinates in BOTH {
        let model = model(&with, coordinates, 1.0);
        // A start at a stretch has been there for long.
        let z = model.coordinates_at(&[6.0]);
        let z = &z[internal(&model)];
        assert_eq!(z.len(), 2);
        assert!(
            z.iter()
                .all(|z| (z - (1.0 + 6.0 / LENGTH).ln()).abs() < 1e-14)
        );
        // Equilibria are those without branches, of the model of a motion and of one of rest.
        let zero = |model: &Model| model.coordinates_at(&[0.0]);
        let found = stable_equilibrium(&model, &zero(&model), &[2000.0]).unwrap();
        let analysis = Analysis {
            coordinates: Some(coordinates),
            ..Analysis::of_rest()
        };
        let resting = Model::for_analysis(with.clone(), analysis.clone()).unwrap();
        assert_eq!(resting.action.map.of_internal, 0);
        let plain = Model::for_analysis(without.clone(), analysis).unwrap();
        let place = |model: &Model, z: &[f64]| model.joints(&placed(model, z), &[0.0])[0];
        let expected = stable_equilibrium(&plain, &zero(&plain), &[2000.0]).unwrap();
        let expected = place(&plain, &expected.z);
        assert!(expected < -0.5, "{expected}");
        let other = stable_equilibrium(&resting, &zero(&resting), &[2000.0]).unwrap();
        for found in [place(&model, &found.z), place(&resting, &other.z)] {
            assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
        }
        let stretch = 1.0 + expected / LENGTH;
        let z = &found.z[internal(&model)];
        assert!(z.iter().all(|z| (z - stretch.ln()).abs() < 1e-9), "{z:?}");
    }
}

#[test]
fn a_muscle_without_branches_has_no_unknown_and_no_term_of_them() {
    let [with, without] = [branches(&[[0.05, 8.0]]), MaxwellBranches::default()]
        .map(|list| model(&slider(20.0, list), Coordinates::Reduced, 1.0));
    assert_eq!(with.coordinate_count(), without.coordinate_count() + 1);
    let names = with.variables.with(Role::Coordinate);
    let name = "logarithm of viscous stretch 1 of muscle";
    assert_eq!(names[1].to_string(), name);
    for term in ["maxwell elasticity", "maxwell viscosity"] {
        let has = |model: &Model| model.present.iter().any(|p| p.term == term);
        assert!(has(&with) && !has(&without), "{term}");
    }
}

const SCENE: &str = r#"{ "name": "creep",
  "materials": { "rubber": { "shear_modulus": "100 kPa", "relative_permittivity": 3, "maxwell": LIST } },
  "bodies": [{ "name": "b", "mass": "10 g", "sphere": { "radius": "5 mm" }, "position": ["40 mm", 0, 0] }],
  "joints": [{ "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": ["40 mm", 0, 0] }],
  "muscles": [{ "name": "m", "material": "rubber", "from": { "body": "ground", "at": [0, 0, 0] },
                "to": { "body": "b", "at": ["40 mm", 0, 0] }, "cross_section": ["10 mm", "10 mm"],
                "layer_thickness": "50 um" }] }"#;

#[test]
fn files_list_branches() {
    let branch = r#"{ "shear_modulus": "50 kPa", "relaxation_time": "0.1 s" }"#;
    let list = |count: usize| format!("[{}]", vec![branch; count].join(", "));
    let system = read(&SCENE.replace("LIST", &list(3))).unwrap();
    let found = system.muscles[0].material.maxwell;
    assert_eq!(found.list().len(), 3);
    let MaxwellBranch {
        shear_modulus,
        relaxation_time,
    } = found.list()[2];
    assert!((shear_modulus - 0.05).abs() < 1e-15 && (relaxation_time - 100.0).abs() < 1e-12);
    let negative = list(1).replace("0.1 s", "-0.1 s");
    for (text, words) in [
        (SCENE.replace("LIST", &list(6)), "5 branches at most"),
        (
            SCENE.replace("LIST", &negative),
            "maxwell[0].relaxation_time",
        ),
    ] {
        let refused = read(&text).expect_err(words);
        assert!(refused.contains(words), "{refused}");
    }
}

/// Places and what the muscle remembers, which has no mass, have the order 2s of Galerkin's method of degree s.
#[test]
fn galerkin_methods_have_their_order() {
    let list = [[0.05, 8.0], [0.03, 60.0]];
    let system = slider(20.0, branches(&list));
    let exact = swing(20.0, &list, [6.0, 0.0, 0.0, 0.0], 40.0);
    let exact = [exact[0], exact[2], exact[3]];
    for degree in [2, 3] {
        let errors = [2.0, 1.0].map(|h| {
            let model = model(&system, Coordinates::Reduced, h);
            let start = suddenly(&model, 6.0);
            let solving = Solving {
                integrator: Integrator::Galerkin { degree },
                ..Solving::default()
            };
            let (steps, zero) = ((40.0 / h) as usize, model.scalars(&[0.0]));
            let drive = |_: f64, _: f64| zero.clone();
            let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
            let (discrete, failure) = simulate_by(solving, &model, &start, h, steps, drive, go_on);
            assert_eq!(failure, None);
            let found = end(&model, &discrete);
            let errors = found.iter().zip(exact).map(|(a, b)| (a - b).abs());
            errors.collect::<Vec<f64>>()
        });
        let order = |i: usize| (errors[0][i] / errors[1][i]).log2();
        for i in 0..3 {
            let is_rounding = errors[1][i] < 1e-11;
            let is_of_order = (order(i) - (2 * degree) as f64).abs() < 0.3;
            assert!(is_rounding || is_of_order, "{errors:?}");
        }
    }
}

/// Over many relaxation times, in steps of half of one and of five: what grew from step to step did so by e^(t/3τ).
#[test]
fn every_method_forgets_what_a_short_branch_remembers() {
    let system = slider(20.0, branches(&[[0.05, 0.2]]));
    let mut plain = slider(20.0, MaxwellBranches::default());
    // The branch is viscosity η = 2 μ₁ τ but for its lag.
    plain.muscles[0].material.viscosity = Some(2.0 * 0.05 * 0.2);
    for integrator in [
        Integrator::Galerkin { degree: 1 },
        Integrator::Galerkin { degree: 2 },
        Integrator::Galerkin { degree: 3 },
        Integrator::GeneralisedAlpha {
            spectral_radius: 0.8,
        },
        Integrator::ImplicitEuler,
    ] {
        let places = [&system, &plain].map(|system| {
            [0.1, 1.0].map(|h| {
                let model = model(system, Coordinates::Reduced, h);
                let start = Start::at_rest(&model, model.coordinates_at(&[6.0]));
                let solving = Solving {
                    integrator,
                    ..Solving::default()
                };
                let (steps, zero) = ((40.0 / h) as usize, model.scalars(&[0.0]));
                let drive = |_: f64, _: f64| zero.clone();
                let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
                let (discrete, failure) =
                    simulate_by(solving, &model, &start, h, steps, drive, go_on);
                assert_eq!(failure, None, "{integrator:?} {h}");
                end(&model, &discrete)[0]
            })
        });
        for (branch, plain) in places[0].iter().zip(&places[1]) {
            assert!((branch - plain).abs() < 0.15, "{integrator:?}: {places:?}");
        }
    }
}
