//! Terms of springs and stops of joints: on the coordinate of the joint, which in redundant coordinates is an internal one.

use crate::energy::{CoordinateSpring, CoordinateStops};
use crate::functional::Element;
use crate::model::internal::Internals;
use crate::model::system::System;
use crate::model::terms::{Terms, mid};

const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Springs and stops of the joints of a presolved system.
pub(super) fn build(system: &System, internals: &Internals, terms: &mut Terms<'_>) {
    for (index, joint) in system.joints.iter().enumerate() {
        let Some(coordinate) = internals.joint(index) else {
            continue;
        };
        let vectors = [mid(terms.vector(coordinate))];
        if let Some(spring) = joint.spring {
            let energy = CoordinateSpring {
                stiffness: spring.stiffness,
                rest: spring.rest,
            };
            let element = Element {
                energy,
                vectors,
                scalars: [],
            };
            terms.add::<_, 3, 1, 0>(ELASTICITY, "stiffness of", &joint.name, element);
        }
        if let Some(stops) = joint.stops {
            let energy = CoordinateStops {
                stiffness: stops.stiffness,
                at: stops.at,
                smoothing: stops.smoothing,
            };
            let element = Element {
                energy,
                vectors,
                scalars: [],
            };
            terms.add::<_, 3, 1, 0>(STOPS, "stops of", &joint.name, element);
        }
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
    terms.without(STOPS, "no joint that moves names stops");
}
