//! Terms of joint dampers: on the coordinate of the joint where it is one, on vectors of its bodies otherwise.

use crate::energy::{AngularDamper, CoordinateDamper, LinearDamper};
use crate::functional::Element;
use crate::kinematics::{MaterialVector, Pose};
use crate::model::analysis::Coordinates;
use crate::model::joints::{JointCoordinate, JointReading};
use crate::model::system::{Joint, System};
use crate::model::terms::{Terms, mid, rate};

const DAMPING: &str = "joint damping";

/// Dampers of the joints that are solved for.
pub(super) fn build(
    system: &System,
    reference: &[Pose],
    coordinates: Coordinates,
    terms: &mut Terms<'_>,
) {
    if !terms.is_of_motion() {
        return terms.without(DAMPING, "a state of rest dissipates nothing");
    }
    let joints = system.joints.iter().zip(system.joint_coordinates());
    match coordinates {
        Coordinates::Reduced => {
            for (joint, coordinate) in joints {
                if let (Some(coefficient), Some(coordinate)) = (joint.damping, coordinate) {
                    on_coordinate(&joint.name, coefficient, coordinate, terms);
                }
            }
        }
        Coordinates::Redundant => {
            for (joint, _) in joints {
                if let Some(coefficient) = joint.damping {
                    on_vectors(joint, coefficient, reference, terms);
                }
            }
        }
    }
    terms.without(DAMPING, "no joint that moves names a damping");
}

fn on_coordinate(joint: &str, coefficient: f64, coordinate: usize, terms: &mut Terms<'_>) {
    let vector = terms.vector(MaterialVector::joint(coordinate));
    let element = Element {
        energy: CoordinateDamper { coefficient },
        vectors: [mid(vector), rate(vector)],
        scalars: [],
    };
    terms.add(DAMPING, "damping of", joint, element);
}

fn on_vectors(joint: &Joint, coefficient: f64, reference: &[Pose], terms: &mut Terms<'_>) {
    match JointReading::new(joint, None, reference).measure {
        JointCoordinate::Angle { vectors } => {
            let [a, b, x] = vectors.map(|v| terms.vector(v));
            let element = Element {
                energy: AngularDamper { coefficient },
                vectors: [
                    mid(a),
                    mid(b),
                    mid(x),
                    mid(a),
                    mid(b),
                    mid(x),
                    rate(a),
                    rate(b),
                    rate(x),
                ],
                scalars: [],
            };
            terms.add(DAMPING, "damping of", &joint.name, element);
        }
        JointCoordinate::Displacement { axis, span } => {
            let [n, r] = [axis, span].map(|v| terms.vector(v));
            let element = Element {
                energy: LinearDamper { coefficient },
                vectors: [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)],
                scalars: [],
            };
            terms.add(DAMPING, "damping of", &joint.name, element);
        }
        JointCoordinate::None => {}
    }
}
