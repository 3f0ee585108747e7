//! Terms of joint dampers: on the coordinate of the joint where it is one, on vectors of its bodies otherwise.

use crate::energy::{AngularDamper, CoordinateDamper, LinearDamper, Polynomial};
use crate::functional::{Law, VectorArg};
use crate::kinematics::{MaterialVector, Pose};
use crate::math::Number;
use crate::model::analysis::Coordinates;
use crate::model::constant::Constant;
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
            index,
            coefficient,
        };
        match (coordinates, coordinate) {
            (Coordinates::Reduced, Some(coordinate)) => damper.on_coordinate(coordinate, terms),
            (Coordinates::Reduced, None) => {}
            (Coordinates::Redundant, _) => damper.on_vectors(reference, terms),
        }
    }
    terms.without(DAMPING, "no joint that moves names a damping");
}

/// Laws of dampers: formulas of one coefficient.
macro_rules! laws {
    ($($law:ident: $formula:ident of $arguments:literal;)*) => { $(
        #[derive(Clone)]
        struct $law(Polynomial);

        impl Law<$arguments> for $law {
            type Formula<T: Number> = $formula<T>;

            fn formula<T: Number>(&self, parameters: &[T]) -> $formula<T> {
                $formula {
                    coefficient: self.0.at(parameters),
                }
            }
        }
    )* };
}

laws! {
    OnCoordinate: CoordinateDamper of 6;
    OnAngle: AngularDamper of 27;
    OnDisplacement: LinearDamper of 18;
}

/// The damper of a joint.
struct Damper<'a> {
    joint: &'a Joint,
    /// Index of the joint in the scene.
    index: usize,
    coefficient: f64,
}

impl Damper<'_> {
    /// Adds the term of a law of the coefficient.
    fn add<L: Law<M>, const M: usize, const NV: usize>(
        &self,
        law: fn(Polynomial) -> L,
        vectors: [VectorArg; NV],
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let constant = Constant::JointDamping(self.index);
        let law = law(read.constant(constant, self.coefficient));
        let element = read.element(law, vectors, []);
        terms.add_law((DAMPING, "damping of"), &self.joint.name, element);
    }

    fn on_coordinate(&self, coordinate: usize, terms: &mut Terms<'_>) {
        let vector = terms.vector(MaterialVector::coordinate(coordinate));
        self.add(OnCoordinate, [mid(vector), rate(vector)], terms);
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
                self.add(OnAngle, vectors, terms);
            }
            JointCoordinate::Displacement { axis, span } => {
                let [n, r] = [axis, span].map(|v| terms.vector(v));
                let vectors = [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)];
                self.add(OnDisplacement, vectors, terms);
            }
            JointCoordinate::None => {}
        }
    }
}
