//! A robot on joints of several coordinates without a chart.

use super::trunk;
use nalgebra::Vector3;
use proboscis::model::system::{JointKind, System};

/// A trunk on a universal joint, then on a cylindrical and a planar one whose parents are the outer bodies.
pub fn pairs() -> System {
    let mut system = trunk(3);
    system.name = "pairs".into();
    let axes = [Vector3::x(), Vector3::new(0.0, 0.6, 0.8)];
    system.joints[0].kind = JointKind::Universal { axes };
    let axis = Vector3::new(0.6, 0.0, 0.8);
    system.joints[1].kind = JointKind::Cylindrical { axis };
    let normal = Vector3::new(0.0, 0.8, -0.6);
    system.joints[2].kind = JointKind::Planar { normal };
    for joint in &mut system.joints {
        (joint.damping, joint.spring, joint.stops) = (None, None, None);
    }
    for joint in &mut system.joints[1..] {
        let parent = joint.parent.replace(joint.child);
        joint.child = parent.expect("a joint between bodies");
    }
    system
}
