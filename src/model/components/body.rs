//! Terms of rigid bodies.

use crate::energy::Affine;
use crate::functional::Mass;
use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::constant::Constant;
use crate::model::plan::GRAVITY;
use crate::model::sought::Read;
use crate::model::system::{Attachment, Body};
use crate::model::terms::{Terms, mid, rate};
use crate::model::weight::{Moving, Weight};

const INERTIA: &str = "body inertia";

/// Inertia and weight of the bodies that are solved for: the mass at the centre, and on each director dᵢ the Euler inertia
/// E_i = ½ (J_j + J_k − J_i).
pub(in crate::model) fn build(bodies: &[Body], reference: &[Pose], terms: &mut Terms<'_>) {
    if bodies.is_empty() {
        terms.without(INERTIA, "no body that moves");
    }
    for (b, body) in bodies.iter().enumerate() {
        let centre = MaterialVector::point(Some(b), &body.centre, reference);
        terms.weigh(&centre, body.mass);
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

/// Inertia and weight by which bodies of the scene whose masses are sought differ from what they are given as: linear in the masses, so that
/// bodies that are welded to others need no other treatment.
pub(in crate::model) fn build_sought(bodies: &[Body], terms: &mut Terms<'_>) {
    for (b, body) in bodies.iter().enumerate() {
        let place = Attachment {
            body: Some(b),
            at: body.centre,
        };
        let is_given = Sought::new(b, body, &mut terms.sought().read()).is_given();
        if is_given || terms.is_immobile(&[place]) {
            continue;
        }
        let centre = terms.vector(terms.point(&place));
        let mut read = terms.sought().read();
        let Sought { mass, .. } = Sought::new(b, body, &mut read);
        let is_heavier = !mass.slopes.is_empty();
        if let Some(gravity) = terms.gravity(&mut read).filter(|_| is_heavier) {
            let weight = Weight {
                mass: mass.clone(),
                gravity,
            };
            let element = read.element(weight, [mid(centre)], []);
            terms.add_law((GRAVITY, "gravity of"), "the scene", element);
        }
        if !terms.is_of_motion() {
            continue;
        }
        let named = (INERTIA, "mass of");
        let mut read = terms.sought().read();
        let Sought { mass, .. } = Sought::new(b, body, &mut read);
        if is_heavier {
            let element = read.element(Moving(mass), [rate(centre)], []);
            terms.add_kinetic_law(named, &body.name, element);
        }
        for i in 0..3 {
            let mut read = terms.sought().read();
            let Sought { euler, .. } = Sought::new(b, body, &mut read);
            if euler[i].slopes.is_empty() {
                continue;
            }
            let axis: Vector = body.directors.column(i).into();
            let director = terms.direction(&place, &axis);
            let law = Moving(euler[i].clone());
            let element = read.element(law, [rate(terms.vector(director))], []);
            terms.add_kinetic_law(named, &body.name, element);
        }
    }
}

/// Differences of the mass of a body in g, and of half the Euler inertias of its directors in g mm², from what they are given as.
struct Sought {
    mass: Affine,
    euler: [Affine; 3],
}

impl Sought {
    fn new(b: usize, body: &Body, read: &mut Read) -> Self {
        let mut from_given =
            |constant, given: f64| read.constant(constant, given).scaled(1.0, -given);
        let mass = from_given(Constant::Mass(b), body.mass);
        let moments =
            [0, 1, 2].map(|axis| from_given(Constant::Inertia(b, axis), body.inertia[axis]));
        let euler = [0, 1, 2].map(|i| {
            let [own, second, third] = [i, (i + 1) % 3, (i + 2) % 3].map(|axis| &moments[axis]);
            let sum = second.clone().plus(1.0, third).plus(-1.0, own);
            sum.scaled(0.5, 0.0)
        });
        Self { mass, euler }
    }

    fn is_given(&self) -> bool {
        let [a, b, c] = &self.euler;
        [&self.mass, a, b, c]
            .into_iter()
            .all(|one| one.slopes.is_empty())
    }
}
