//! Terms of joint springs: on the coordinate of the joint, which in redundant coordinates is an internal one.

use crate::energy::CoordinateSpring;
use crate::functional::Element;
use crate::kinematics::MaterialVector;
use crate::model::analysis::Coordinates;
use crate::model::internal::{Internal, Internals};
use crate::model::presolved::Presolved;
use crate::model::system::JointKind;
use crate::model::terms::{Terms, mid};
use crate::model::variables::Size;

const ELASTICITY: &str = "joint elasticity";

/// Springs of the joints that are solved for.
pub(super) fn build(
    condensed: &Presolved,
    coordinates: Coordinates,
    internals: &mut Internals,
    terms: &mut Terms<'_>,
) {
    let system = &condensed.system;
    let joints = system.joints.iter().zip(system.joint_coordinates());
    for (index, (joint, coordinate)) in joints.enumerate() {
        let (Some(spring), Some(coordinate)) = (joint.spring, coordinate) else {
            continue;
        };
        let vector = match coordinates {
            Coordinates::Reduced => MaterialVector::coordinate(coordinate),
            Coordinates::Redundant => internals.add(Internal {
                name: format!("coordinate of {}", joint.name),
                size: match joint.kind {
                    JointKind::Prismatic { .. } => Size::Length,
                    _ => Size::One,
                },
                joint: index,
            }),
        };
        let element = Element {
            energy: CoordinateSpring {
                stiffness: spring.stiffness,
                rest: spring.rest,
            },
            vectors: [mid(terms.vector(vector))],
            scalars: [],
        };
        terms.add::<_, 3, 1, 0>(ELASTICITY, "stiffness of", &joint.name, element);
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
}
