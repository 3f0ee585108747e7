//! Constants of lumped muscles as laws read them: given, or following from free parameters.

use crate::energy::{ElasticLaw, NeoHooke, Polynomial};
use crate::functional::{LawElement, VectorArg};
use crate::kinematics::MaterialVector;
use crate::model::components::measured_laws::{Field, Stretch};
use crate::model::components::muscle_laws::{
    BranchDamper, BranchSpring, Driven, Elastic, OfCapacitance, PointMass, RestVolume, Section,
    Shape, UnrelaxedSpring, Viscous, Weight,
};
use crate::model::constant::{Constant, MaterialConstant};
use crate::model::free_parameters::{MovedPoint, Read};
use crate::model::maxwell::MaxwellBranch;
use crate::model::system::{ElectricConstants, Muscle};
use crate::model::terms::Terms;

/// A muscle whose constants are read: given, or following from free parameters, which are noted.
#[derive(Clone)]
pub(in crate::model) struct MuscleConstants<'a> {
    muscle: &'a Muscle,
    index: usize,
    read: Read,
    shape: Shape,
}

impl<'a> MuscleConstants<'a> {
    /// Those of a muscle that are given.
    pub(in crate::model) fn given(muscle: &'a Muscle) -> Self {
        Self::new(
            (muscle, 0),
            (Read::nothing(), [-1.0, 1.0]),
            [None; 2],
            |_| 0,
        )
    }

    /// Those of the muscle of an index, of whose elements the first vector is the sum of its ends by their parts, the span by −1 and 1;
    /// `bodies` of the presolved system carry the ends, and `vector` gives a material vector its place.
    pub(in crate::model) fn new(
        (muscle, index): (&'a Muscle, usize),
        (mut read, parts): (Read, [f64; 2]),
        bodies: [Option<usize>; 2],
        vector: impl FnMut(MaterialVector) -> usize,
    ) -> Self {
        let at_rest = muscle.to.at - muscle.from.at;
        let mut span = [at_rest.x, at_rest.y, at_rest.z].map(Polynomial::from);
        let from = |axis| Constant::End(index, 0, axis);
        let to = |axis| Constant::End(index, 1, axis);
        let point = |end: usize, place| MovedPoint {
            weight: parts[end],
            body: bodies[end],
            place: Some(place),
        };
        let ends = [point(0, &from as &dyn Fn(usize) -> Constant), point(1, &to)];
        for (place, at, [from, to]) in read.moves(0, ends, vector) {
            for (component, &slope) in span.iter_mut().zip((to - from).iter()) {
                if slope != 0.0 {
                    component.value -= slope * at;
                    component.slopes.push((place, slope));
                }
            }
        }
        let sides = [0, 1].map(|side| {
            let value = muscle.cross_section[side];
            read.constant(Constant::Side(index, side), value)
        });
        let shape = Shape {
            span,
            prestretch: muscle
                .prestretch
                .map(|stretch| read.constant(Constant::Prestretch(index), stretch)),
            sides,
        };
        Self {
            muscle,
            index,
            read,
            shape,
        }
    }

    /// The muscle.
    pub(in crate::model) fn muscle(&self) -> &'a Muscle {
        self.muscle
    }

    /// The same for an element that does not read the span.
    pub(in crate::model) fn still(mut self) -> Self {
        self.read.stand_still();
        self
    }

    /// Returns true if all that was read is given.
    pub(in crate::model) fn are_given(&self) -> bool {
        self.read.is_empty()
    }

    /// The element of a law that reads them.
    pub(in crate::model) fn element<L, const NV: usize, const NS: usize>(
        self,
        law: L,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> LawElement<L, NV, NS> {
        self.read.element(law, vectors, scalars)
    }

    /// Elasticity by a law.
    pub(in crate::model) fn elastic<L>(&mut self, law: L) -> Elastic<L> {
        let value = self.muscle.material.shear_modulus;
        Elastic {
            shape: self.shape.clone(),
            shear_modulus: self.material(MaterialConstant::ShearModulus, value),
            law,
        }
    }

    /// The law of elasticity other than the neo-Hookean one.
    pub(in crate::model) fn law(&mut self, law: ElasticLaw) -> ElasticLaw<Polynomial> {
        law.map(|name, &value| self.material(MaterialConstant::Law(name), value))
    }

    /// A constant of its material.
    fn material(&mut self, constant: MaterialConstant, value: f64) -> Polynomial {
        self.read.constant(constant.of_muscle(self.index), value)
    }

    /// Elasticity by a law, with a voltage.
    pub(in crate::model) fn driven<L>(&mut self, electric: ElectricConstants, law: L) -> Driven<L> {
        Driven {
            elastic: self.elastic(law),
            electric: self.electric(electric),
            layer: self.layer(),
        }
    }

    fn layer(&mut self) -> Polynomial {
        let layer = Constant::Layer(self.index);
        self.read.constant(layer, self.muscle.layer_thickness)
    }

    fn electric(&mut self, electric: ElectricConstants) -> [Polynomial; 3] {
        [
            self.material(MaterialConstant::C1, electric.c1),
            self.material(MaterialConstant::C2, electric.c2),
            self.material(MaterialConstant::Permittivity, electric.permittivity),
        ]
    }

    /// Capacitance, where the muscle has electric constants.
    pub(in crate::model) fn capacitance(&mut self) -> Option<OfCapacitance> {
        let electric = self.muscle.material.electric?;
        Some(OfCapacitance(self.driven(electric, NeoHooke)))
    }

    /// Squared stretch.
    pub(in crate::model) fn stretch(&self) -> Stretch {
        Stretch(self.shape.clone())
    }

    /// Squared ratio of the field of a voltage to a limit in V/mm.
    pub(in crate::model) fn field(&mut self, limit: f64) -> Field {
        Field {
            shape: self.shape.clone(),
            layer: self.layer(),
            limit,
        }
    }

    /// Resistance in Ω of its circuit, in series.
    pub(in crate::model) fn resistance(&mut self) -> Option<Polynomial> {
        let value = self.muscle.circuit?.resistance?;
        Some(self.read.constant(Constant::Resistance(self.index), value))
    }

    /// Viscosity of a value.
    pub(in crate::model) fn viscous(&mut self, viscosity: f64) -> Viscous {
        Viscous {
            shape: self.shape.clone(),
            viscosity: self.material(MaterialConstant::Viscosity, viscosity),
        }
    }

    /// Spring of a Maxwell branch.
    pub(in crate::model) fn branch_spring(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> BranchSpring {
        let constant = MaterialConstant::BranchModulus(branch);
        BranchSpring {
            shape: self.shape.clone(),
            shear_modulus: self.material(constant, of.shear_modulus),
        }
    }

    /// Spring of a Maxwell branch that has not relaxed.
    pub(in crate::model) fn unrelaxed_spring(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> UnrelaxedSpring {
        UnrelaxedSpring(self.branch_spring(branch, of))
    }

    /// Damper of a Maxwell branch.
    pub(in crate::model) fn branch_damper(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> BranchDamper {
        let constant = MaterialConstant::RelaxationTime(branch);
        BranchDamper {
            spring: self.branch_spring(branch, of),
            relaxation_time: self.material(constant, of.relaxation_time),
        }
    }

    /// A part of the mass of the muscle, where it has a density.
    pub(in crate::model) fn mass(&mut self, factor: f64) -> Option<PointMass> {
        let density = self.muscle.material.density?;
        Some(PointMass {
            shape: self.shape.clone(),
            density: self.material(MaterialConstant::Density, density),
            factor,
        })
    }

    /// Volume at rest.
    pub(in crate::model) fn volume(&self) -> RestVolume {
        RestVolume(self.shape.clone())
    }

    /// Weight under the gravity of terms, where the muscle has a density.
    pub(in crate::model) fn weight(&mut self, terms: &Terms<'_>) -> Option<Weight> {
        let mass = self.mass(1.0)?;
        let gravity = terms.gravity(&mut self.read)?;
        Some(Weight { mass, gravity })
    }

    /// Inertia of the changing cross-section, where the muscle has a density.
    pub(in crate::model) fn section(&mut self) -> Option<Section> {
        self.mass(1.0).map(Section)
    }
}
