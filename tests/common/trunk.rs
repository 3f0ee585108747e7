//! The elephant trunk with made-up motions: six cylinders on revolute joints, twelve muscles.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::kinematics::Pose;
use proboscis::model::system::{
    Attachment, Body, Joint, JointKind, Marker, Material, Muscle, Shape, System,
};

/// Length of a segment in mm.
const LENGTH: f64 = 50.0;

/// A trunk of `count` segments along y, joint axes alternating z, x.
pub(crate) fn system(count: usize) -> System {
    let upright = Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()]);
    let below = |i: usize| i.checked_sub(1);
    let material = Material {
        density: None,
        shear_modulus: 0.1,
        lame_lambda: None,
        electric: None,
        viscosity: None,
        ..Material::default()
    };
    let muscle = |i: usize| {
        let joint = i / 2;
        let side = if i.is_multiple_of(2) { 15.0 } else { -15.0 };
        let arm = side
            * if joint.is_multiple_of(2) {
                Vector3::x()
            } else {
                Vector3::z()
            };
        let at = |height: f64| arm + Vector3::y() * (LENGTH * joint as f64 + height);
        Muscle {
            name: format!("muscle{}", i + 1),
            from: Attachment {
                body: below(joint),
                at: at(-20.0),
            },
            to: Attachment {
                body: Some(joint),
                at: at(20.0),
            },
            cross_section: [10.0, 10.0],
            layer_thickness: 0.05,
            material,
            prestretch: None,
            section_inertia: false,
            circuit: None,
            fidelity: Default::default(),
        }
    };
    System {
        components: Default::default(),
        name: "elephant trunk".to_owned(),
        bodies: (0..count)
            .map(|i| Body {
                name: format!("segment{}", i + 1),
                mass: 30.0,
                inertia: [1.0; 3],
                centre: Vector3::y() * (LENGTH * (i as f64 + 0.5)),
                directors: upright,
                shape: Shape::Cylinder {
                    length: LENGTH,
                    radius: 20.0,
                },
            })
            .collect(),
        joints: (0..count)
            .map(|i| Joint {
                name: format!("joint{}", i + 1),
                kind: JointKind::Revolute { axis: axis(i) },
                parent: below(i),
                child: i,
                at: Vector3::y() * (LENGTH * i as f64),
                ..Joint::default()
            })
            .collect(),
        muscles: (0..2 * count).map(muscle).collect(),
        solids: Vec::new(),
        markers: vec![Marker {
            name: "tip".to_owned(),
            point: Attachment {
                body: Some(count - 1),
                at: Vector3::y() * (LENGTH * count as f64),
            },
            solid: None,
        }],
        gravity: None,
    }
}

fn axis(joint: usize) -> Vector3<f64> {
    if joint.is_multiple_of(2) {
        Vector3::z()
    } else {
        Vector3::x()
    }
}

/// Forward kinematics of joint angles in rad at instants in ms, with voltages in V.
pub(crate) fn trajectory(
    system: &System,
    times: Vec<f64>,
    joints: Vec<Vec<f64>>,
    voltages: Vec<Vec<f64>>,
) -> Trajectory {
    let poses = joints.iter().map(|angles| {
        let mut turn = Rotation3::identity();
        let mut foot = Vector3::zeros();
        let chain = angles.iter().zip(&system.bodies).enumerate();
        let poses = chain.map(|(i, (angle, body))| {
            turn *= Rotation3::from_axis_angle(&Unit::new_normalize(axis(i)), *angle);
            let along = turn * Vector3::y() * LENGTH;
            let centre = foot + along / 2.0;
            foot += along;
            Pose {
                centre,
                directors: turn * body.directors,
            }
        });
        poses.collect()
    });
    let mut trajectory = Trajectory {
        poses: poses.collect(),
        times,
        joints,
        voltages,
        ..Trajectory::default()
    };
    let marks = |k: usize| {
        let markers = system.markers.iter();
        markers
            .map(|m| trajectory.point(k, &m.point, system))
            .collect()
    };
    trajectory.marks = (0..trajectory.times.len()).map(marks).collect();
    trajectory
}

/// A damped swing over `intervals` of 15 ms towards a bend, each joint at its own pace.
pub(crate) fn swing(system: &System, intervals: usize) -> Trajectory {
    let count = system.joints.len();
    let times: Vec<_> = (0..=intervals).map(|k| 15.0 * k as f64).collect();
    let angle = |t: f64, i: usize| {
        let pace = if i.is_multiple_of(2) { 0.011 } else { 0.016 };
        0.15 * (1.0 - (-t / 450.0).exp() * (pace * t).cos())
    };
    let joints = times
        .iter()
        .map(|&t| (0..count).map(|i| angle(t, i)).collect())
        .collect();
    let voltage = |k: usize, i: usize| match i % 4 {
        1 => 1700.0 * (0.1 * k as f64 + i as f64).sin().abs(),
        2 => 1600.0 * (0.07 * k as f64).sin().abs() + 1.0 / 3.0,
        _ => 0.0,
    };
    let voltages = (0..intervals)
        .map(|k| (0..2 * count).map(|i| voltage(k, i)).collect())
        .collect();
    trajectory(system, times, joints, voltages)
}
