//! Voltages by which pictures colour muscles.

use proboscis::dynamics::trajectory::{Column, Observations, Trajectory};
use proboscis::math::Vector;
use proboscis::model::System;
use proboscis::model::system::{Attachment, Circuit, Fidelity, Material, Muscle};
use proboscis::report::solids::coloured;
use std::borrow::Cow;

#[test]
fn only_muscles_with_a_charge_have_another_voltage_than_their_source() {
    let end = |x: f64| Attachment {
        body: None,
        at: Vector::x() * x,
    };
    let muscle = |name: &str, circuit| Muscle {
        name: name.to_owned(),
        from: end(0.0),
        to: end(10.0),
        cross_section: [1.0; 2],
        layer_thickness: 0.1,
        material: Material::default(),
        prestretch: None,
        section_inertia: false,
        circuit,
        fidelity: Fidelity::Lumped,
    };
    let mut system = System {
        muscles: vec![muscle("direct", None), muscle("behind", None)],
        ..System::new("two muscles")
    };
    let motion = Trajectory {
        voltages: vec![vec![100.0, 200.0]; 2],
        ..Trajectory::default()
    };
    let column = Column {
        name: "behind_voltage".to_owned(),
        unit: "V",
        values: vec![0.0, 150.0, 190.0],
    };
    let observed = Observations {
        columns: vec![column],
    };
    let same = coloured(&system, &motion, &observed);
    assert!(matches!(same, Cow::Borrowed(_)));
    system.muscles[1].circuit = Some(Circuit {
        resistance: Some(1e6),
        leakage: None,
    });
    let found = coloured(&system, &motion, &observed);
    assert_eq!(found.voltages, [[100.0, 150.0], [100.0, 190.0]]);
}
