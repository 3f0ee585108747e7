//! One muscle between the ground and a sliding body: equilibria under voltage have closed forms (docs/theory.md, 12.1 and 12.3).
//!
//! Without load `W_Λ = 0`: μ(Λ − Λ⁻²) + 2c₂ΛE² + ε₀E²Λ⁻³ = 0.

use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{EquilibriumError, equilibrium};
use proboscis::model::system::{
    Attachment, Body, ElectricConstants, Joint, JointKind, Material, Muscle, Shape, System,
};
use proboscis::model::{Coordinates, Model};

/// Permittivity of vacuum of the tables in N/V².
const EPS: f64 = 8.854e-12;
/// Rest length in mm.
const LENGTH: f64 = 30.0;
/// Layer thickness in mm.
const LAYER: f64 = 0.05;

fn single(shear_modulus: f64, electric: ElectricConstants) -> System {
    let axis = Vector3::z();
    let end = |z: f64, body| Attachment { body, at: axis * z };
    System {
        components: Default::default(),
        name: "single muscle".into(),
        bodies: vec![Body {
            name: "weight".into(),
            mass: 10.0,
            inertia: [100.0; 3],
            centre: axis * (LENGTH + 5.0),
            directors: Matrix3::identity(),
            shape: Shape::None,
        }],
        joints: vec![Joint {
            name: "slide".into(),
            kind: JointKind::Prismatic { axis },
            parent: None,
            child: 0,
            at: axis * LENGTH,
            ..Joint::default()
        }],
        muscles: vec![Muscle {
            name: "muscle".into(),
            from: end(0.0, None),
            to: end(LENGTH, Some(0)),
            cross_section: [4.0, 5.0],
            layer_thickness: LAYER,
            material: Material {
                density: Some(1e-3),
                shear_modulus,
                lame_lambda: None,
                electric: Some(electric),
                viscosity: Some(1.0),
                ..Material::default()
            },
            prestretch: None,
            section_inertia: false,
            circuit: None,
            fidelity: Default::default(),
        }],
        solids: Vec::new(),
        markers: Vec::new(),
        gravity: None,
    }
}

/// The stretch at rest under a nominal field E = V/t in V/mm.
fn stretch(system: &System, coordinates: Coordinates, field: f64) -> Result<f64, EquilibriumError> {
    let model = Model::new(system.clone(), Some(coordinates), 5.0, &[]).unwrap();
    let rest = equilibrium(&model, &model.coordinates_at(&[0.0]), &[field * LAYER])?;
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(&rest.z);
    model.action.map.place(&mut instant);
    Ok(1.0 + model.joints(&instant, &[0.0])[0] / LENGTH)
}

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

fn agrees(system: &System, field: f64, expected: f64) {
    assert!((expected - 1.0).abs() > 1e-4);
    for coordinates in BOTH {
        let found = stretch(system, coordinates, field).unwrap();
        assert!(
            (found - expected).abs() < 1e-9,
            "{coordinates:?}: {found} against {expected} at {field}"
        );
    }
}

/// First-order ideal dielectric of relative permittivity ε_r.
fn default_signs(relative: f64) -> ElectricConstants {
    ElectricConstants {
        c1: -(relative - 1.0) * EPS,
        c2: 0.5 * (relative - 1.0) * EPS,
        permittivity: EPS,
    }
}

#[test]
fn published_material_contracts_as_tabulated() {
    // docs/theory.md, 12.1, set of THREAD-3-2/elec_mech_beam: μ = 233 MPa, c2 = 1e-9 N/V².
    let system = single(
        233.0,
        ElectricConstants {
            c1: 5e-8,
            c2: 1e-9,
            permittivity: EPS,
        },
    );
    for (field, expected) in [
        (2.0e4, 0.9988530539),
        (5.0e4, 0.9929159105),
        (1.0e5, 0.9727962921),
        (1.5e5, 0.9425527488),
        (2.0e5, 0.9057897353),
        (3.0e5, 0.8251521538),
    ] {
        agrees(&system, field, expected);
    }
    // Without the vacuum term: Λ = (1 + 2c₂E²/μ)^(−1/3).
    let system = single(
        233.0,
        ElectricConstants {
            c1: 5e-8,
            c2: 1e-9,
            permittivity: 0.0,
        },
    );
    for field in [1e5, 3e5] {
        agrees(
            &system,
            field,
            (1.0 + 2e-9 * field * field / 233.0_f64).powf(-1.0 / 3.0),
        );
    }
}

#[test]
fn default_material_contracts_as_tabulated() {
    let shear_modulus = 0.3;
    let system = single(shear_modulus, default_signs(5.0));
    for (nominal, expected) in [
        (0.1, 0.9966799077),
        (0.2, 0.9868742027),
        (0.3, 0.9710158967),
        (0.4, 0.9497338368),
        (0.5, 0.9237414256),
        (0.6, 0.8937214747),
        (0.7, 0.8602220434),
    ] {
        agrees(
            &system,
            nominal * f64::sqrt(shear_modulus / (5.0 * EPS)),
            expected,
        );
    }
}

/// Λ and Ē = E √(ε_r ε₀/μ) at the limit, from docs/theory.md, 12.3.
#[test]
fn pull_in_is_refused_where_the_path_ends() {
    let shear_modulus = 0.3;
    let ideal = ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: 5.0 * EPS,
    };
    for (electric, at_limit, critical) in [
        (default_signs(5.0), 0.4698881379, 1.3274338089),
        (ideal, 0.6299605249, 0.6873648185),
    ] {
        let system = single(shear_modulus, electric);
        let unit = f64::sqrt(shear_modulus / (5.0 * EPS));
        for coordinates in BOTH {
            // Just below, the equilibrium exists near the limit: Λ − Λ_c goes with the root of the distance.
            let below = stretch(&system, coordinates, critical * (1.0 - 1e-6) * unit).unwrap();
            assert!(
                below > at_limit && below < at_limit + 3e-3,
                "{coordinates:?}: {below} against {at_limit}"
            );
            for beyond in [1.001, 1.1, 2.0] {
                let refused = stretch(&system, coordinates, critical * beyond * unit);
                let Err(EquilibriumError::LimitPoint { loss, .. }) = refused else {
                    panic!("{coordinates:?}: {refused:?} at {beyond} times the critical voltage");
                };
                let fraction = loss.fraction;
                // Increments of V² end at 1e-6 of the load.
                println!("{coordinates:?} {beyond}: {:e}", fraction * beyond - 1.0);
                assert!(
                    (fraction * beyond - 1.0).abs() < 1e-5,
                    "{coordinates:?} {beyond}: {}",
                    fraction * beyond
                );
            }
        }
    }
}
