//! Slender muscles of finite elements are lumped muscles.

use crate::common::solid::system;
use crate::physics::silicone;
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::equilibrium;
use proboscis::model::Model;
use proboscis::model::system::{
    Attachment, Body, Discretisation, ElementKind, Fidelity, Joint, JointKind, Muscle, Shape,
    System, VACUUM_PERMITTIVITY,
};

/// A muscle between the ground and a sledge, `slenderness` times as long as wide.
fn sledge(slenderness: usize, fidelity: Fidelity) -> System {
    let length = 10.0 * slenderness as f64;
    let end = Vector3::new(0.0, 0.0, length);
    let attachment = |body, at| Attachment { body, at };
    System {
        components: Default::default(),
        bodies: vec![Body {
            name: "sledge".into(),
            mass: 10.0,
            inertia: [100.0; 3],
            centre: end,
            directors: Matrix3::identity(),
            shape: Shape::None,
        }],
        joints: vec![Joint {
            name: "rail".into(),
            kind: JointKind::Prismatic { axis: Vector3::z() },
            parent: None,
            child: 0,
            at: end,
            ..Joint::default()
        }],
        muscles: vec![Muscle {
            name: "muscle".into(),
            from: attachment(None, Vector3::zeros()),
            to: attachment(Some(0), end),
            cross_section: [10.0; 2],
            layer_thickness: 0.05,
            material: silicone(100.0),
            prestretch: None,
            section_inertia: false,
            circuit: None,
            fidelity,
        }],
        ..system(Vec::new())
    }
}

/// Stretch at rest under a field of 0.4 √(μ/ε_r ε₀).
pub(crate) fn stretch(slenderness: usize, fidelity: Fidelity) -> f64 {
    let model = Model::new(sledge(slenderness, fidelity), None, 1.0, &[]).unwrap();
    let field = 0.4 * (0.1 / (3.0 * VACUUM_PERMITTIVITY)).sqrt();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[0.05 * field]).unwrap();
    1.0 + found.z[0] / (10.0 * slenderness as f64)
}

#[test]
fn slender_muscles_of_finite_elements_are_lumped_muscles() {
    let lumped = stretch(1, Fidelity::Lumped);
    let n = 4;
    let differences = [1, 2, 4, 8].map(|slenderness| {
        let fidelity = Fidelity::FiniteElements(Discretisation {
            elements: [n, n, n * slenderness],
            layers: n * slenderness,
            element: ElementKind::Hex8Q1P0,
        });
        stretch(slenderness, fidelity) - lumped
    });
    println!("lumped {lumped}, finite elements {differences:?}");
    assert!(lumped < 0.96);
    // The glued faces cannot widen: over a length of about the width less contracts, a part a/L of the muscle.
    for pair in differences.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.05, "{pair:?}");
    }
    assert!(differences[3] > 0.0 && differences[3] < 0.03 * (1.0 - lumped));
}
