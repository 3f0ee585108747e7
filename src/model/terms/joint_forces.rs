//! Dampers, springs and stops of joints.

use crate::energy::{
    AngularDamper, Coefficient, CoordinateDamper, CoordinateSpring, CoordinateStops, Law,
    LinearDamper,
};
use crate::functional::{Element, VectorArg};
use crate::kinematics::{MaterialVector, Pose};
use crate::model::analysis::Coordinates;
use crate::model::constants::constant::Constant;
use crate::model::construction::Construction;
use crate::model::system::joints::{JointCoordinate, JointReading};
use crate::model::system::{Joint, JointSpring, JointStops};
use crate::model::terms::{Terms, mid, rate};

/// Term of the dampers of joints.
pub const DAMPING: &str = "joint damping";
const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Dampers of the joints that are solved for.
pub(crate) fn build_dampers(of: &Construction<'_>, terms: &mut Terms<'_>) {
    if !terms.is_of_motion() {
        return terms.without(DAMPING, "a state of rest dissipates nothing");
    }
    let system = &of.presolved.system;
    let joints = system.joints.iter().zip(system.joint_coordinates());
    for ((joint, coordinate), &index) in joints.zip(&of.presolved.joints) {
        let Some(coefficient) = joint.damping else {
            continue;
        };
        let damper = Damper {
            joint,
            index,
            coefficient,
        };
        match (of.coordinates, coordinate) {
            (Coordinates::Reduced, Some(coordinate)) => damper.on_coordinate(coordinate, terms),
            (Coordinates::Reduced, None) => {}
            (Coordinates::Redundant, _) => damper.on_vectors(of.reference, terms),
        }
    }
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
        law: impl Fn(Coefficient) -> L,
        vectors: [VectorArg; NV],
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let constant = Constant::JointDamping(self.index);
        let law = law(read.constant(constant, self.coefficient));
        let element = read.element(law, vectors, []);
        terms.add_law(DAMPING, "damping of", &self.joint.name, element);
    }

    fn on_coordinate(&self, coordinate: usize, terms: &mut Terms<'_>) {
        let vector = terms.vector(MaterialVector::coordinate(coordinate));
        let law = |coefficient| CoordinateDamper { coefficient };
        self.add(law, [mid(vector), rate(vector)], terms);
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
                self.add(|coefficient| AngularDamper { coefficient }, vectors, terms);
            }
            JointCoordinate::Displacement { axis, span } => {
                let [n, r] = [axis, span].map(|v| terms.vector(v));
                let vectors = [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)];
                self.add(|coefficient| LinearDamper { coefficient }, vectors, terms);
            }
            JointCoordinate::None => {}
        }
    }
}

/// Springs and stops of the joints of a presolved system.
pub(crate) fn build_springs(of: &Construction<'_>, terms: &mut Terms<'_>) {
    let presolved = of.presolved;
    let joints = presolved.system.joints.iter().zip(&presolved.joints);
    for (index, (joint, &of_scene)) in joints.enumerate() {
        if let (Some(spring), Some(coordinate)) = (joint.spring, of.internals.joint(index)) {
            let JointSpring { stiffness, rest } = spring;
            let mut read = terms.sought().read();
            let law = CoordinateSpring {
                stiffness: read.constant(Constant::JointStiffness(of_scene), stiffness),
                rest: read.constant(Constant::JointRest(of_scene), rest),
            };
            let coordinate = terms.vector(coordinate);
            let element = read.element(law, [mid(coordinate)], []);
            terms.add_law(ELASTICITY, "stiffness of", &joint.name, element);
        }
        if let (Some(stops), Some(coordinate)) = (joint.stops, of.internals.joint(index)) {
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
            terms.add(STOPS, "stops of", &joint.name, element);
        }
    }
}
