//! Terms of springs and stops of joints: on the coordinate of the joint, which in redundant coordinates is an internal one.

use crate::energy::{CoordinateSpring, CoordinateStops, Polynomial};
use crate::functional::{Element, Law};
use crate::math::Number;
use crate::model::constant::Constant;
use crate::model::internal::Internals;
use crate::model::presolved::Presolved;
use crate::model::system::{JointSpring, JointStops};
use crate::model::terms::{Terms, mid};

const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Elasticity of a joint.
#[derive(Clone)]
struct Elasticity {
    stiffness: Polynomial,
    rest: Polynomial,
}

impl Law<3> for Elasticity {
    type Formula<T: Number> = CoordinateSpring<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> CoordinateSpring<T> {
        CoordinateSpring {
            stiffness: self.stiffness.at(parameters),
            rest: self.rest.at(parameters),
        }
    }
}

/// Springs and stops of the joints of a presolved system.
pub(super) fn build(presolved: &Presolved, internals: &Internals, terms: &mut Terms<'_>) {
    let joints = presolved.system.joints.iter().zip(&presolved.joints);
    for (index, (joint, &of_scene)) in joints.enumerate() {
        if let (Some(spring), Some(coordinate)) = (joint.spring, internals.joint(index)) {
            let JointSpring { stiffness, rest } = spring;
            let mut read = terms.sought().read();
            let law = Elasticity {
                stiffness: read.constant(Constant::JointStiffness(of_scene), stiffness),
                rest: read.constant(Constant::JointRest(of_scene), rest),
            };
            let coordinate = terms.vector(coordinate);
            let element = read.element(law, [mid(coordinate)], []);
            terms.add_law((ELASTICITY, "stiffness of"), &joint.name, element);
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
            let element = Element {
                energy,
                vectors: [mid(terms.vector(coordinate))],
                scalars: [],
            };
            terms.add::<_, 3, 1, 0>(STOPS, "stops of", &joint.name, element);
        }
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
    terms.without(STOPS, "no joint that moves names stops");
}
