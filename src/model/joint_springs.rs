//! Terms of joint springs: on the coordinate of the joint, which in redundant coordinates is an internal one.

use crate::energy::CoordinateSpring;
use crate::functional::Element;
use crate::model::internal::Internals;
use crate::model::system::System;
use crate::model::terms::{Terms, mid};

const ELASTICITY: &str = "joint elasticity";

/// Springs of the joints of a presolved system.
pub(super) fn build(system: &System, internals: &Internals, terms: &mut Terms<'_>) {
    for (index, joint) in system.joints.iter().enumerate() {
        let (Some(spring), Some(coordinate)) = (joint.spring, internals.joint(index)) else {
            continue;
        };
        let element = Element {
            energy: CoordinateSpring {
                stiffness: spring.stiffness,
                rest: spring.rest,
            },
            vectors: [mid(terms.vector(coordinate))],
            scalars: [],
        };
        terms.add::<_, 3, 1, 0>(ELASTICITY, "stiffness of", &joint.name, element);
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
}
