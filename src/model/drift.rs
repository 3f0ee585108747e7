//! Drifts: directions along which sought places of joints, bodies and markers move points.

use crate::kinematics::{MaterialVector, Pose, VectorTerm};
use crate::math::Vector;
use crate::model::constant::{Constant, Parameter};

/// Parts of a direction that are rounding, in mm over the unit of the parameter.
const ROUNDING: f64 = 1e-12;

/// Drifts of the bodies of a presolved system.
#[derive(Clone, Debug, Default)]
pub(super) struct Drifts {
    /// D of each body by each parameter; empty where no parameter moves a joint or a body that floats.
    pub(super) of: Vec<Vec<MaterialVector>>,
    /// Poses of the bodies in the reference configuration.
    pub(super) reference: Vec<Pose>,
}

impl Parameter {
    /// Directions by which it moves a place, of which it has the constants `at` as components.
    pub(super) fn moves(&self, at: impl Fn(usize) -> Constant) -> Vector {
        let mut moved = Vector::zeros();
        for axis in 0..3 {
            let constant = at(axis);
            let own = self.constants.iter().filter(|one| one.constant == constant);
            moved[axis] = own.map(|one| one.factor).sum();
        }
        moved
    }
}

impl Drifts {
    /// Drift of a point of a body, or of the ground, by a parameter that moves its own place by `own`.
    pub(super) fn of_point(
        &self,
        parameter: usize,
        body: Option<usize>,
        own: &Vector,
    ) -> MaterialVector {
        let own = MaterialVector::direction(body, own, &self.reference);
        let of_bodies = self.of.get(parameter);
        match of_bodies.zip(body) {
            None => own,
            Some((of_bodies, body)) => MaterialVector::combine(1.0, &of_bodies[body], 1.0, &own),
        }
    }
}

/// A vector without the parts that are rounding; none where nothing is left.
pub(super) fn pruned(vector: &MaterialVector) -> Option<MaterialVector> {
    let is_left = |term: &&VectorTerm| term.directors.amax() > ROUNDING;
    let terms: Vec<VectorTerm> = vector.terms.iter().filter(is_left).copied().collect();
    (!terms.is_empty()).then_some(MaterialVector { terms })
}
