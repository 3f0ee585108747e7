//! Slender muscles of finite elements are lumped muscles.

use crate::common::solid::system;
use crate::physics::silicone;
use nalgebra::{Matrix3, Rotation3, Vector3};
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
            first_side: None,
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

/// A turned scene is the same robot: with the direction of the first side every node turns along, and without it the section follows the
/// axes of the ground.
#[test]
fn the_section_of_a_muscle_turns_with_its_first_side() {
    let nodes = |turn: Rotation3<f64>, first_side: Option<Vector3<f64>>| {
        let fidelity = Fidelity::FiniteElements(Discretisation {
            first_side: first_side.map(|side| turn * side),
            elements: [2, 1, 4],
            layers: 4,
            element: ElementKind::Hex8Q1P0,
        });
        let mut system = sledge(3, fidelity);
        system.muscles[0].cross_section = [10.0, 6.0];
        let muscle = &mut system.muscles[0];
        muscle.to.at = turn * muscle.to.at;
        let end = muscle.to.at;
        system.bodies[0].centre = end;
        system.joints[0].at = end;
        system.joints[0].kind = JointKind::Prismatic {
            axis: turn * Vector3::z(),
        };
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        model.solids[0].solid.mesh.nodes.clone()
    };
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let apart = |first_side: Option<Vector3<f64>>| {
        let straight = nodes(Rotation3::identity(), first_side);
        let turned = nodes(turn, first_side);
        let pairs = straight.iter().zip(&turned);
        pairs
            .map(|(a, b)| (turn * a - b).norm())
            .fold(0.0, f64::max)
    };
    assert!(apart(None) > 1.0, "{}", apart(None));
    // A part along the span does not count.
    for side in [Vector3::x(), Vector3::new(3.0, -1.0, 7.0)] {
        assert!(apart(Some(side)) < 1e-12, "{}", apart(Some(side)));
    }
    let along_x = nodes(Rotation3::identity(), Some(Vector3::new(2.0, 0.0, 5.0)));
    let extent = |axis: usize| along_x.iter().map(|node| node[axis]).fold(0.0, f64::max);
    assert!((extent(0) - 5.0).abs() < 1e-12 && (extent(1) - 3.0).abs() < 1e-12);
    for wrong in [Vector3::z(), Vector3::zeros(), Vector3::x() * f64::NAN] {
        let fidelity = Fidelity::FiniteElements(Discretisation {
            first_side: Some(wrong),
            elements: [1, 1, 2],
            layers: 2,
            element: ElementKind::Hex8,
        });
        let refused = sledge(1, fidelity).check().unwrap_err().to_string();
        assert!(refused.contains(", along the span"), "{refused}");
    }
}
