//! Terms of springs and stops of joints: on the coordinate of the joint, which in redundant coordinates is an internal one.

use crate::energy::{CoordinateSpring, CoordinateStops};
use crate::functional::Element;
use crate::kinematics::MaterialVector;
use crate::model::internal::Internals;
use crate::model::system::{JointSpring, JointStops, System};
use crate::model::terms::{Terms, mid};

const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Springs and stops of the joints of a presolved system.
pub(super) fn build(system: &System, internals: &Internals, terms: &mut Terms<'_>) {
    for (index, joint) in system.joints.iter().enumerate() {
        if let (Some(spring), Some(coordinate)) = (joint.spring, internals.joint(index)) {
            let JointSpring { stiffness, rest } = spring;
            let element = on(coordinate, CoordinateSpring { stiffness, rest }, terms);
            terms.add::<_, 3, 1, 0>(ELASTICITY, "stiffness of", &joint.name, element);
        }
        if let (Some(stops), Some(coordinate)) = (joint.stops, internals.joint(index)) {
            let JointStops {
                stiffness,
                at,
                smoothing,
            } = stops;
            let energy = CoordinateStops {
                stiffness,
                at,
                smoothing,
            };
            let element = on(coordinate, energy, terms);
            terms.add::<_, 3, 1, 0>(STOPS, "stops of", &joint.name, element);
        }
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
    terms.without(STOPS, "no joint that moves names stops");
}

/// The element of a formula on a joint coordinate.
fn on<E>(coordinate: MaterialVector, energy: E, terms: &mut Terms<'_>) -> Element<E, 1, 0> {
    Element {
        energy,
        vectors: [mid(terms.vector(coordinate))],
        scalars: [],
    }
}
