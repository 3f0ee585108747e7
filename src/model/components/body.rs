//! Terms of rigid bodies, and the dampers, springs and stops of their joints.

use crate::energy::{
    AngularDamper, Coefficient, CoordinateDamper, CoordinateSpring, Law, LinearDamper,
};
use crate::functional::{Element, Mass, VectorArg};
use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::construction::Construction;
use crate::model::system::joints::JointCoordinate;
use crate::model::system::{Attachment, Body, Joint};
use crate::model::terms::{Call, Terms, mid, rate};

const INERTIA: &str = "body inertia";

/// Inertia and weight of the bodies that are solved for: the mass at the centre, and on each director dᵢ the Euler inertia
/// E_i = ½ (J_j + J_k − J_i).
pub(in crate::model) fn build(bodies: &[Body], reference: &[Pose], terms: &mut Terms<'_>) {
    for (b, body) in bodies.iter().enumerate() {
        let centre = MaterialVector::point(Some(b), &body.centre, reference);
        terms.weigh(&centre, &body.mass.into(), terms.sought().read());
        if terms.is_of_motion() {
            let centre = terms.vector(centre);
            terms.collect(
                INERTIA,
                "mass of",
                &body.name,
                Mass::point(centre, body.mass),
            );
            let [j1, j2, j3] = body.inertia;
            let euler = [j2 + j3 - j1, j3 + j1 - j2, j1 + j2 - j3];
            for (i, euler) in euler.into_iter().enumerate().filter(|(_, e)| *e != 0.0) {
                let axis: Vector = body.directors.column(i).into();
                let director = MaterialVector::direction(Some(b), &axis, reference);
                let mass = Mass::point(terms.vector(director), 0.5 * euler);
                terms.collect(INERTIA, "mass of", &body.name, mass);
            }
        } else {
            terms.without(INERTIA, "a state of rest has no inertia");
        }
    }
}

/// Inertia and weight by which bodies of the scene whose masses or places are free differ from what they are given as: sums over them, so
/// that bodies that are welded to others need no other treatment.
pub(in crate::model) fn build_sought(bodies: &[Body], terms: &mut Terms<'_>) {
    for (b, body) in bodies.iter().enumerate() {
        let place = Attachment {
            body: Some(b),
            at: body.centre,
        };
        if terms.is_immobile(&[place]) {
            continue;
        }
        let mut moved = terms.sought().read();
        let centre = MovedPoints {
            parts: [1.0],
            bodies: [terms.carrier(&place)],
            places: Some(&|_, axis| Constant::BodyPlace(b, axis)),
        };
        moved.moves(0, centre, |vector| terms.vector(vector));
        let is_moved = !moved.is_empty();
        let Sought { mass: more, .. } = Sought::new(b, body, &mut moved);
        if is_moved {
            let still = terms.sought().read();
            point_mass(body, &place, (-body.mass).into(), still, terms);
            point_mass(body, &place, &more + &body.mass.into(), moved, terms);
        } else if !more.is_given() {
            point_mass(body, &place, more, moved, terms);
        }
        if terms.is_of_motion() {
            turning(b, body, &place, terms);
        }
    }
}

/// Weight and kinetic energy of a mass at the centre of a body.
fn point_mass(
    body: &Body,
    place: &Attachment,
    mass: Coefficient,
    read: Read,
    terms: &mut Terms<'_>,
) {
    let centre = terms.vector(terms.point(place));
    terms.weigh_vector(centre, &mass, read.clone());
    if terms.is_of_motion() {
        let call = Call(INERTIA, "mass of", &body.name);
        terms.add_mass(call, centre, mass, read);
    }
}

/// Kinetic energies of the directors of a body whose moments of inertia are free.
fn turning(b: usize, body: &Body, place: &Attachment, terms: &mut Terms<'_>) {
    for i in 0..3 {
        let mut read = terms.sought().read();
        let Sought { euler, .. } = Sought::new(b, body, &mut read);
        if euler[i].is_given() {
            continue;
        }
        let axis: Vector = body.directors.column(i).into();
        let director = terms.vector(terms.direction(place, &axis));
        let call = Call(INERTIA, "mass of", &body.name);
        terms.add_mass(call, director, euler[i].clone(), read);
    }
}

/// Differences of the mass of a body in g, and of half the Euler inertias of its directors in g mm², from what they are given as.
struct Sought {
    mass: Coefficient,
    euler: [Coefficient; 3],
}

impl Sought {
    fn new(b: usize, body: &Body, read: &mut Read) -> Self {
        let mut from_given = |constant, given: f64| &read.constant(constant, given) - &given.into();
        let mass = from_given(Constant::Mass(b), body.mass);
        let moments =
            [0, 1, 2].map(|axis| from_given(Constant::Inertia(b, axis), body.inertia[axis]));
        let euler = [0, 1, 2].map(|i| {
            let [own, second, third] = [i, (i + 1) % 3, (i + 2) % 3].map(|axis| &moments[axis]);
            (&(second + third) - own).scaled(0.5)
        });
        Self { mass, euler }
    }
}

/// Term of the dampers of joints.
pub const DAMPING: &str = "joint damping";
const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Dampers of the joints that are solved for.
pub(in crate::model) fn build_dampers(of: &Construction<'_>, terms: &mut Terms<'_>) {
    if !terms.is_of_motion() {
        return terms.without(DAMPING, "a state of rest dissipates nothing");
    }
    let system = &of.presolved.system;
    let joints = system.joints.iter().enumerate();
    for ((kept, joint), &index) in joints.zip(&of.presolved.joints) {
        let Some(coefficient) = joint.damping else {
            continue;
        };
        let damper = Damper {
            joint,
            index,
            coefficient,
        };
        match of.internals.in_tree(kept) {
            Some(coordinate) => damper.on_coordinate(coordinate, terms),
            None => damper.on_vectors(of.reference, terms),
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
        match JointCoordinate::new(self.joint, reference) {
            Some(JointCoordinate::Angle { vectors }) => {
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
            Some(JointCoordinate::Displacement { axis, span }) => {
                let [n, r] = [axis, span].map(|v| terms.vector(v));
                let vectors = [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)];
                self.add(|coefficient| LinearDamper { coefficient }, vectors, terms);
            }
            None => {}
        }
    }
}

/// Springs and stops of the joints of a presolved system.
pub(in crate::model) fn build_springs(of: &Construction<'_>, terms: &mut Terms<'_>) {
    let presolved = of.presolved;
    let joints = presolved.system.joints.iter().zip(&presolved.joints);
    for (index, (joint, &of_scene)) in joints.enumerate() {
        if let (Some(spring), Some(coordinate)) = (joint.spring, of.internals.joint(index)) {
            let mut read = terms.sought().read();
            let law = CoordinateSpring {
                stiffness: read.constant(Constant::JointStiffness(of_scene), spring.stiffness),
                rest: read.constant(Constant::JointRest(of_scene), spring.rest),
            };
            let coordinate = terms.vector(coordinate);
            let element = read.element(law, [mid(coordinate)], []);
            terms.add_law(ELASTICITY, "stiffness of", &joint.name, element);
        }
        if let (Some(stops), Some(coordinate)) = (joint.stops, of.internals.joint(index)) {
            let element = Element {
                energy: stops,
                vectors: [mid(terms.vector(coordinate))],
                scalars: [],
            };
            terms.add(STOPS, "stops of", &joint.name, element);
        }
    }
}
