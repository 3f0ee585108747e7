//! Terms of joint dampers: on the coordinate of the joint where it is one, on vectors of its bodies otherwise.

use crate::energy::{AngularDamper, CoordinateDamper, Energy, LinearDamper, SoughtDamper};
use crate::functional::{Element, VectorArg};
use crate::kinematics::{MaterialVector, Pose};
use crate::model::analysis::Coordinates;
use crate::model::constant::{Constant, Follower};
use crate::model::joints::{JointCoordinate, JointReading};
use crate::model::presolved::Presolved;
use crate::model::system::Joint;
use crate::model::terms::{Terms, mid, rate};

/// Term of the dampers of joints.
pub const DAMPING: &str = "joint damping";

/// Dampers of the joints that are solved for.
pub(super) fn build(
    presolved: &Presolved,
    reference: &[Pose],
    coordinates: Coordinates,
    terms: &mut Terms<'_>,
) {
    if !terms.is_of_motion() {
        return terms.without(DAMPING, "a state of rest dissipates nothing");
    }
    let system = &presolved.system;
    let joints = system.joints.iter().zip(system.joint_coordinates());
    for ((joint, coordinate), &index) in joints.zip(&presolved.joints) {
        let Some(coefficient) = joint.damping else {
            continue;
        };
        let damper = Damper {
            joint,
            coefficient,
            sought: terms.sought().find(Constant::JointDamping(index)),
        };
        match (coordinates, coordinate) {
            (Coordinates::Reduced, Some(coordinate)) => damper.on_coordinate(coordinate, terms),
            (Coordinates::Reduced, None) => {}
            (Coordinates::Redundant, _) => damper.on_vectors(reference, terms),
        }
    }
    terms.without(DAMPING, "no joint that moves names a damping");
}

/// The damper of a joint.
struct Damper<'a> {
    joint: &'a Joint,
    coefficient: f64,
    /// The parameter that the coefficient is, where it is sought.
    sought: Option<(usize, Follower)>,
}

impl Damper<'_> {
    /// Adds the term of a formula with a coefficient.
    fn add<E, const M: usize, const WITH: usize, const NV: usize>(
        &self,
        of_coefficient: impl Fn(f64) -> E,
        vectors: [VectorArg; NV],
        terms: &mut Terms<'_>,
    ) where
        E: Energy<M> + 'static,
        SoughtDamper<E>: Energy<WITH> + 'static,
    {
        let (why, name) = ("damping of", &self.joint.name);
        let Some((parameter, follower)) = self.sought else {
            let element = Element {
                energy: of_coefficient(self.coefficient),
                vectors,
                scalars: [],
            };
            return terms.add::<E, M, NV, 0>(DAMPING, why, name, element);
        };
        let element = Element {
            energy: SoughtDamper(of_coefficient(follower.factor)),
            vectors,
            scalars: [terms.sought().scalar(parameter)],
        };
        terms.add::<SoughtDamper<E>, WITH, NV, 1>(DAMPING, why, name, element);
    }

    fn on_coordinate(&self, coordinate: usize, terms: &mut Terms<'_>) {
        let vector = terms.vector(MaterialVector::coordinate(coordinate));
        let damper = |coefficient| CoordinateDamper { coefficient };
        self.add::<_, 6, 7, 2>(damper, [mid(vector), rate(vector)], terms);
    }

    fn on_vectors(&self, reference: &[Pose], terms: &mut Terms<'_>) {
        match JointReading::new(self.joint, None, reference).measure {
            JointCoordinate::Angle { vectors } => {
                let [a, b, x] = vectors.map(|v| terms.vector(v));
                let vectors = [
                    mid(a),
                    mid(b),
                    mid(x),
                    mid(a),
                    mid(b),
                    mid(x),
                    rate(a),
                    rate(b),
                    rate(x),
                ];
                let damper = |coefficient| AngularDamper { coefficient };
                self.add::<_, 27, 28, 9>(damper, vectors, terms);
            }
            JointCoordinate::Displacement { axis, span } => {
                let [n, r] = [axis, span].map(|v| terms.vector(v));
                let vectors = [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)];
                let damper = |coefficient| LinearDamper { coefficient };
                self.add::<_, 18, 19, 6>(damper, vectors, terms);
            }
            JointCoordinate::None => {}
        }
    }
}
