//! A tree with every kind of joint and muscle.

use crate::common::{bare, body, joint, trunk};
use nalgebra::{Rotation3, Vector3};
use proboscis::model::system::{Attachment, Body, Joint, JointKind, Marker, Muscle, System};

/// A tree that branches: revolute and prismatic joints with dampers, off-axis bodies, muscles of every kind, gravity.
pub(crate) fn tree() -> System {
    let turned = |a: f64, b: f64, c: f64| *Rotation3::from_euler_angles(a, b, c).matrix();
    let at = Vector3::new;
    let bodies: Vec<Body> = vec![
        body(
            "base",
            40.0,
            [9e3, 1.1e4, 7e3],
            at(5.0, 30.0, 2.0),
            turned(0.2, 0.4, -0.3),
        ),
        body(
            "slide",
            15.0,
            [2e3, 1.5e3, 3e3],
            at(20.0, 70.0, -5.0),
            turned(-0.7, 0.1, 0.5),
        ),
        body(
            "left",
            12.0,
            [1e3, 2e3, 1.2e3],
            at(-25.0, 75.0, 10.0),
            turned(1.0, -0.4, 0.2),
        ),
        body(
            "hand",
            6.0,
            [4e2, 5e2, 3e2],
            at(50.0, 95.0, 0.0),
            turned(0.0, 0.9, 0.1),
        ),
        body(
            "plate",
            8.0,
            [7e2, 7e2, 9e2],
            at(-30.0, 110.0, 20.0),
            turned(0.3, 0.3, 0.3),
        ),
    ];
    let revolute = |x: f64, y: f64, z: f64| JointKind::Revolute {
        axis: at(x, y, z).normalize(),
    };
    let prismatic = |x: f64, y: f64, z: f64| JointKind::Prismatic {
        axis: at(x, y, z).normalize(),
    };
    let damped = |joint: Joint, damping: f64| Joint {
        damping: Some(damping),
        ..joint
    };
    let joints = vec![
        damped(
            joint("root", revolute(0.1, 0.2, 1.0), None, 0, at(0.0, 0.0, 0.0)),
            400.0,
        ),
        damped(
            joint(
                "rail",
                prismatic(1.0, 0.5, 0.2),
                Some(0),
                1,
                at(10.0, 55.0, 0.0),
            ),
            0.5,
        ),
        joint(
            "elbow",
            revolute(1.0, 0.0, 0.3),
            Some(0),
            2,
            at(-10.0, 55.0, 5.0),
        ),
        damped(
            joint(
                "wrist",
                revolute(0.0, 1.0, 0.4),
                Some(1),
                3,
                at(35.0, 85.0, -2.0),
            ),
            100.0,
        ),
        joint("weld", JointKind::Fixed, Some(2), 4, at(-28.0, 90.0, 15.0)),
    ];
    let material = trunk(1).muscles[0].material;
    let muscle = |name: &str,
                  from: (Option<usize>, Vector3<f64>),
                  to: (Option<usize>, Vector3<f64>)| Muscle {
        name: name.into(),
        from: Attachment {
            body: from.0,
            at: from.1,
        },
        to: Attachment {
            body: to.0,
            at: to.1,
        },
        cross_section: [10.0, 12.0],
        layer_thickness: 0.05,
        material,
        prestretch: None,
        section_inertia: true,
        circuit: None,
        fidelity: Default::default(),
    };
    let mut muscles = vec![
        muscle(
            "anchor",
            (None, at(30.0, -5.0, 8.0)),
            (Some(0), at(20.0, 40.0, 0.0)),
        ),
        muscle(
            "stay",
            (None, at(-30.0, 0.0, -8.0)),
            (Some(0), at(-15.0, 40.0, 4.0)),
        ),
        muscle(
            "rail",
            (Some(0), at(0.0, 45.0, 3.0)),
            (Some(1), at(30.0, 72.0, -3.0)),
        ),
        muscle(
            "lift",
            (Some(0), at(0.0, 40.0, -20.0)),
            (Some(4), at(-25.0, 100.0, 12.0)),
        ),
        muscle(
            "turn",
            (Some(1), at(20.0, 75.0, 12.0)),
            (Some(3), at(52.0, 96.0, 9.0)),
        ),
    ];
    // One without voltage, one without mass and viscosity, one without inertia of its section.
    muscles[1].material.electric = None;
    muscles[2].material.density = None;
    muscles[2].material.viscosity = None;
    muscles[3].section_inertia = false;
    let mut system = bare(bodies, joints, Some(at(0.0, -9.81e-3, 0.0)));
    system.muscles = muscles;
    system.markers = vec![Marker {
        name: "tip".into(),
        point: Attachment {
            body: Some(3),
            at: at(60.0, 100.0, 5.0),
        },
        solid: None,
    }];
    system
}

pub(crate) const JOINTS: [f64; 5] = [0.1, 2.0, -0.2, 0.3, 0.0];

pub(crate) const RATES: [f64; 5] = [2e-3, 0.05, -3e-3, 6e-3, 0.0];

pub(crate) const VOLTAGES: [f64; 5] = [1500.0, 0.0, 1000.0, 2000.0, 500.0];

/// The tree without joint dampers.
pub(crate) fn undamped() -> System {
    let mut system = tree();
    system.joints.iter_mut().for_each(|j| j.damping = None);
    system
}
