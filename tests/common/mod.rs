//! Systems and reference solutions that several tests share.
#![allow(dead_code, reason = "each test binary uses a part")]
#![allow(unreachable_pub, reason = "a module of several test binaries")]

pub mod cases;
pub mod random;

use nalgebra::{Matrix3, Vector3};
use proboscis::model::system::{
    Attachment, Body, Electric, Joint, JointKind, Marker, Material, Muscle, Shape, System,
    VACUUM_PERMITTIVITY,
};
use serde_json::Value;

/// A reference solution from `tests/reference`.
pub fn reference(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect()
}

/// The elephant trunk of the reference solutions with any number of segments, written out by hand.
pub fn trunk(segments: usize) -> System {
    let (length, radius, mass) = (50.0, 20.0, 30.0);
    let transverse = mass * (3.0 * radius * radius + length * length) / 12.0;
    let axial = mass * radius * radius / 2.0;
    let silicone = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: None,
        electric: Some(Electric {
            c1: -2.0 * VACUUM_PERMITTIVITY,
            c2: VACUUM_PERMITTIVITY,
            permittivity: VACUUM_PERMITTIVITY,
        }),
        viscosity: Some(1.0),
    };
    let mut system = System {
        name: "trunk".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        muscles: Vec::new(),
        markers: Vec::new(),
        gravity: None,
    };
    for i in 0..segments {
        let base = i as f64 * length;
        // d3 is the long axis.
        let directors = Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()]);
        system.bodies.push(Body {
            name: format!("segment{}", i + 1),
            mass,
            inertia: [transverse, transverse, axial],
            centre: Vector3::new(0.0, base + 0.5 * length, 0.0),
            directors,
            shape: Shape::Cylinder { length, radius },
        });
        let parent = i.checked_sub(1);
        let (axis, side) = if i % 2 == 0 {
            (Vector3::z(), Vector3::x())
        } else {
            (Vector3::x(), Vector3::z())
        };
        let at = Vector3::new(0.0, base, 0.0);
        system.joints.push(Joint {
            name: format!("joint{}", i + 1),
            kind: JointKind::Revolute { axis },
            parent,
            child: i,
            at,
            damping: None,
        });
        for (m, sign) in [(1, 1.0), (2, -1.0)] {
            let offset = side * (15.0 * sign);
            let end = |y: f64| at + offset + Vector3::new(0.0, y, 0.0);
            system.muscles.push(Muscle {
                name: format!("muscle{}", 2 * i + m),
                from: Attachment {
                    body: parent,
                    at: end(-20.0),
                },
                to: Attachment {
                    body: Some(i),
                    at: end(20.0),
                },
                cross_section: [10.0, 10.0],
                layer_thickness: 0.05,
                material: silicone,
                section_inertia: false,
            });
        }
    }
    let tip = Vector3::new(0.0, segments as f64 * length, 0.0);
    system.markers.push(Marker {
        name: "tip".into(),
        point: Attachment {
            body: Some(segments - 1),
            at: tip,
        },
    });
    system
}
