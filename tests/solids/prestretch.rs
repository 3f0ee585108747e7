//! Prestretched blocks: closed forms of their rest and vibration, and what files say of them.

use crate::common::solid::{DRIVEN, block, electrode, held, system};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{
    EquilibriumError, Instability, Start, StepError, equilibrium, simulate, stable_equilibrium,
};
use proboscis::energy::ElasticLaw;
use proboscis::files::read_system;
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{ElectricConstants, Material, Potential, Solid, System};
use std::ops::ControlFlow;
use std::path::Path;

/// MPa, g/mm³ and the sides in mm of a block as it is glued.
const SHEAR: f64 = 0.08;
const LAMBDA: f64 = 0.9;
const DENSITY: f64 = 1.1e-3;
const SIDES: [f64; 3] = [6.0, 5.0, 0.4];

/// Stretches along x, y and z.
fn stretch(stretches: [f64; 3]) -> Matrix3<f64> {
    Matrix3::from_diagonal(&stretches.into())
}

/// A membrane stretched by λ₁ and λ₂ whose nodes may move across alone, on a floor.
fn membrane(stretches: [f64; 2], law: Option<ElasticLaw>, elements: [usize; 3]) -> System {
    let mesh = Grid::uniform(Vector3::zeros(), Vector3::from(SIDES), elements).mesh();
    let material = Material {
        density: Some(DENSITY),
        shear_modulus: SHEAR,
        lame_lambda: Some(LAMBDA),
        law,
        ..Material::default()
    };
    let [a, b] = stretches;
    let all = |on: [bool; 3]| proboscis::model::system::Support {
        nodes: (0..mesh.nodes.len()).collect(),
        held: on,
    };
    let supports = vec![
        all([true, true, false]),
        held(&mesh, "z_min", [false, false, true]),
    ];
    let solid = Solid {
        supports,
        prestretch: Some(stretch([a, b, 1.0 / (a * b)])),
        ..block(mesh, material)
    };
    system(vec![solid])
}

/// Stretch across at which the energy W(λ) of stretches λ₁, λ₂, λ is least, and its second derivative there, by bisection and differences
/// of the first derivative.
fn at_rest(slope: impl Fn(f64) -> f64) -> (f64, f64) {
    let (mut low, mut high) = (1e-3, 10.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match slope(middle) < 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    let h = 1e-5 * low;
    (low, (slope(low + h) - slope(low - h)) / (2.0 * h))
}

/// dW/dλ of `μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J`.
fn neo_hookean([a, b]: [f64; 2]) -> impl Fn(f64) -> f64 {
    move |c: f64| SHEAR * (c - 1.0 / c) + LAMBDA * (a * b * c).ln() / c
}

#[test]
fn a_prestretched_membrane_rests_as_its_closed_form() {
    for stretches in [[3.0, 3.0], [1.8, 0.9], [1.0, 1.0]] {
        let (across, _) = at_rest(neo_hookean(stretches));
        let expected = SIDES[2] * across * stretches[0] * stretches[1];
        for elements in [[1, 1, 1], [2, 3, 2]] {
            let system = membrane(stretches, None, elements);
            let model = Model::new(system, None, 1.0, &[]).unwrap();
            let found = stable_equilibrium(&model, &model.reference_coordinates(), &[]).unwrap();
            let top = found.z[..model.coordinate_count()].iter();
            let top = top.fold(0.0_f64, |most, z| most.max(*z));
            assert!((top - expected).abs() < 1e-10, "{top} {expected}");
        }
        let moves = (expected - SIDES[2]).abs();
        assert_eq!(moves > 1e-3, stretches != [1.0, 1.0], "{moves}");
    }
}

#[test]
fn a_prestretched_element_vibrates_as_its_closed_form() {
    // All four nodes of the top together: the mass of a third of the element, ω² = V₀ W″ / (L₀² m/3).
    let stretches = [2.5, 1.7];
    let (across, stiffness) = at_rest(neo_hookean(stretches));
    let rest = SIDES[2] * stretches[0] * stretches[1];
    let volume = SIDES.iter().product::<f64>();
    let omega = (stiffness * volume / (rest * rest * DENSITY * volume / 3.0)).sqrt();
    let h = 0.3 / omega;
    let model = Model::new(membrane(stretches, None, [1; 3]), None, h, &[]).unwrap();
    let n = model.coordinate_count();
    assert_eq!(n, 4);
    let mut z = model.reference_coordinates();
    let amplitude = 1e-6 * rest;
    z[..n].fill(rest * across + amplitude);
    let start = Start::at_rest(&model, z);
    let discrete = crate::common::motion(&model, &start, h, 3, &[]);
    let at = |k: usize| discrete.z[k][0] - rest * across;
    // The midpoint rule turns by 2 atan(ω h/2) a step.
    let cosine = (at(0) + at(2)) / (2.0 * at(1));
    let found = 2.0 / h * (0.5 * cosine.acos()).tan();
    assert!((at(1) / amplitude - 1.0).abs() > 1e-2);
    assert!((found / omega - 1.0).abs() < 1e-5, "{found} {omega}");
}

#[test]
fn a_prestretch_beyond_gents_limit_is_refused_by_name() {
    let law = |limit| Some(ElasticLaw::Gent { limit });
    let new = |limit| Model::new(membrane([3.0, 3.0], law(limit), [1; 3]), None, 1.0, &[]);
    assert!(new(40.0).is_ok());
    let checked = membrane([3.0, 3.0], law(10.0), [1; 3]).check();
    let error = checked.unwrap_err().to_string();
    assert!(
        error.contains("Gent's limit") && error.contains("15.01"),
        "{error}"
    );
}

#[test]
fn a_membrane_on_a_frame_pulls_in_at_the_voltage_of_its_closed_form() {
    let electric = ElectricConstants::ideal(3.0);
    for p in [1.0, 2.0, 3.0] {
        // ∂/∂c of W(p, p, c) − ½ ε p² V²/(L₀² c) is zero: V² is greatest at a stretch c across.
        let thickness = SIDES[2] * p * p;
        let slope = neo_hookean([p, p]);
        let squared =
            |c: f64| -2.0 * (thickness * c / p).powi(2) * slope(c) / electric.permittivity;
        let (rest, _) = at_rest(neo_hookean([p, p]));
        let (mut low, mut high) = (0.01 * rest, rest);
        for _ in 0..200 {
            let [a, b] = [1.0 / 3.0, 2.0 / 3.0].map(|part| low + part * (high - low));
            match squared(a) < squared(b) {
                true => low = a,
                false => high = b,
            }
        }
        let expected = squared(low).sqrt();
        assert!(low < 0.8 * rest && expected > 1e4, "{low} {expected}");
        let mut system = membrane([p, p], None, [2, 1, 1]);
        let solid = &mut system.solids[0];
        solid.materials[0].electric = Some(electric);
        solid.electrodes = vec![
            electrode(&solid.mesh, "bottom", 0.0, Potential::Given(0.0)),
            electrode(&solid.mesh, "top", SIDES[2], DRIVEN),
        ];
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let asked = 2.0 * expected;
        let refused = equilibrium(&model, &model.coordinates_at(&[]), &[asked]).unwrap_err();
        let EquilibriumError::LimitPoint { loss, .. } = refused else {
            panic!("{refused}");
        };
        assert_eq!(loss.kind, Some(Instability::PullIn));
        let found = loss.fraction * asked;
        assert!(
            (found / expected - 1.0).abs() < 1e-7,
            "{p}: {found} {expected}"
        );
    }
}

#[test]
fn a_motion_that_reaches_gents_limit_names_the_block() {
    let law = Some(ElasticLaw::Gent { limit: 15.5 });
    let model = Model::new(membrane([3.0, 3.0], law, [1; 3]), None, 1e-3, &[]).unwrap();
    let z = model.reference_coordinates();
    let rates = vec![1e4; model.coordinate_count()];
    let start = Start::with_rates(&model, z, &rates);
    let (_, failure) = simulate(
        &model,
        &start,
        1e-3,
        20,
        |_, _| vec![],
        |_| ControlFlow::Continue(()),
    );
    let failure = failure.unwrap();
    let message = failure.to_string();
    assert!(
        message.contains("block \"block\" has I1 - 3") && message.contains("below 15.5"),
        "{message}"
    );
    assert!(
        matches!(
            failure,
            StepError::NoConvergence { .. } | StepError::BeyondLaw { .. }
        ),
        "{message}"
    );
}

#[test]
fn files_stretch_what_is_not_written_by_the_volume() {
    let read = |prestretch: &str| {
        let text = format!(
            r#"{{ "name": "frame", "materials": {{ "silicone": {{ "shear_modulus": "80 kPa", "lame_lambda": "1 MPa" }} }},
               "solids": [{{ "name": "membrane", "material": "silicone", "fixed": ["x_min", "x_max"],
               "box": {{ "size": ["6 mm", "5 mm", "0.4 mm"], "elements": [1, 1, 1] }}, "prestretch": {prestretch} }}] }}"#
        );
        let path = std::env::temp_dir().join(format!("prestretch{}.json", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let found = read_system(Path::new(&path), &[]);
        std::fs::remove_file(&path).unwrap();
        found
            .map(|system| system.solids[0].prestretch)
            .map_err(|e| e.to_string())
    };
    assert_eq!(
        read(r#"{ "x": 3, "y": 3 }"#),
        Ok(Some(stretch([3.0, 3.0, 1.0 / 9.0])))
    );
    assert_eq!(read(r#"{ "y": 4 }"#), Ok(Some(stretch([0.5, 4.0, 0.5]))));
    assert_eq!(
        read(r#"{ "x": 2, "y": 1, "z": 1 }"#),
        Ok(Some(stretch([2.0, 1.0, 1.0])))
    );
    for (written, words) in [
        ("{}", "no stretch"),
        (r#"{ "x": 0 }"#, "a positive stretch"),
        (r#"{ "x": -2 }"#, "a positive stretch"),
        (r#"{ "w": 2 }"#, "\"w\""),
    ] {
        let error = read(written).unwrap_err();
        assert!(
            error.contains("prestretch") && error.contains(words),
            "{error}"
        );
    }
}
