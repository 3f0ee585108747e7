//! Formulas of lumped muscles, whose constants follow from geometry and material: given, or functions of free parameters.

use crate::energy::{
    Capacitance, Coefficient, Constants, CoordinateDamper, DielectricCell, ElasticCell, ElasticLaw,
    FlowingCharge, GivenChargeField, MaxwellCell, NeoHooke, SectionInertia, SquaredDistance,
    SquaredField, ViscousCell,
};
use crate::functional::{LawElement, VectorArg};
use crate::kinematics::MaterialVector;
use crate::math::Vector;
use crate::model::constants::constant::{Constant, MaterialConstant};
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::system::maxwell::MaxwellBranch;
use crate::model::system::{ElectricConstants, Fidelity, Muscle};

/// A muscle whose constants are read: given, or following from free parameters, which are noted.
#[derive(Clone)]
pub(in crate::model) struct MuscleConstants<'a> {
    muscle: &'a Muscle,
    index: usize,
    read: Read,
    /// Distance of the ends in the reference configuration in mm.
    distance: Coefficient,
    /// Rest length L₀ in mm.
    length: Coefficient,
    /// Sides of the cross-section in mm.
    sides: [Coefficient; 2],
    /// Rest volume V₀ in mm³.
    volume: Coefficient,
}

impl<'a> MuscleConstants<'a> {
    /// Those of a muscle that are given.
    pub(in crate::model) fn given(muscle: &'a Muscle) -> Self {
        Self::new(muscle, 0, Read::nothing(), [-1.0, 1.0], [None; 2], |_| 0)
    }

    /// Those of the muscle of an index, of whose elements the first vector is the sum of its ends by their `parts`, the span by −1 and 1;
    /// `bodies` of the presolved system carry the ends, and `vector` gives a material vector its place.
    pub(in crate::model) fn new(
        muscle: &'a Muscle,
        index: usize,
        mut read: Read,
        parts: [f64; 2],
        bodies: [Option<usize>; 2],
        vector: impl FnMut(MaterialVector) -> usize,
    ) -> Self {
        let at_rest = muscle.to.at - muscle.from.at;
        let mut span = [at_rest.x, at_rest.y, at_rest.z].map(Coefficient::from);
        let ends = MovedPoints {
            parts,
            bodies,
            places: Some(&|end, axis| Constant::End(index, end, axis)),
        };
        for (place, at, [from, to]) in read.moves(0, ends, vector) {
            for (component, &slope) in span.iter_mut().zip((to - from).iter()) {
                if slope != 0.0 {
                    let moved = Coefficient::Parameter(place, [-slope * at, slope, 0.0, 0.0]);
                    *component = &*component + &moved;
                }
            }
        }
        let sides = [0, 1].map(|side| {
            let value = muscle.cross_section[side];
            read.constant(Constant::Side(index, side), value)
        });
        let distance = norm(&span);
        let length = match muscle.prestretch {
            None => distance.clone(),
            Some(stretch) => &distance / &read.constant(Constant::Prestretch(index), stretch),
        };
        Self {
            muscle,
            index,
            read,
            volume: &(&sides[0] * &sides[1]) * &length,
            distance,
            length,
            sides,
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

    /// The parameters and moves that were read.
    pub(in crate::model) fn read(self) -> Read {
        self.read
    }

    /// The element of a law that reads them.
    pub(in crate::model) fn element<L, const M: usize, const NV: usize, const NS: usize>(
        self,
        law: L,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> LawElement<L, M, NV, NS> {
        self.read.element(law, vectors, scalars)
    }

    /// The element of a law of what is read of them.
    pub(in crate::model) fn with<L, const M: usize, const NV: usize, const NS: usize>(
        &self,
        law: impl FnOnce(&mut Self) -> L,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> LawElement<L, M, NV, NS> {
        let mut own = self.clone();
        let law = law(&mut own);
        own.element(law, vectors, scalars)
    }

    /// Elasticity by a law.
    pub(in crate::model) fn elastic<L>(&mut self, law: L) -> ElasticCell<L, Coefficient> {
        let value = self.muscle.material.shear_modulus;
        ElasticCell {
            length: self.length.clone(),
            volume: self.volume.clone(),
            shear_modulus: self.material(MaterialConstant::ShearModulus, value),
            law,
        }
    }

    /// The law of elasticity other than the neo-Hookean one.
    pub(in crate::model) fn law(&mut self, law: ElasticLaw) -> ElasticLaw<Coefficient> {
        law.map(|name, &value| self.material(MaterialConstant::Law(name), value))
    }

    /// A constant of its material.
    fn material(&mut self, constant: MaterialConstant, value: f64) -> Coefficient {
        self.read.constant(constant.of_muscle(self.index), value)
    }

    /// Elasticity by a law, with a voltage.
    pub(in crate::model) fn driven<L>(
        &mut self,
        electric: ElectricConstants,
        law: L,
    ) -> DielectricCell<L, Coefficient> {
        DielectricCell {
            elastic: self.elastic(law),
            c1: self.material(MaterialConstant::C1, electric.c1),
            c2: self.material(MaterialConstant::C2, electric.c2),
            permittivity: self.material(MaterialConstant::Permittivity, electric.permittivity),
            layer: self.layer(),
        }
    }

    /// Thickness of a layer in mm.
    fn layer(&mut self) -> Coefficient {
        let layer = Constant::Layer(self.index);
        self.read.constant(layer, self.muscle.layer_thickness)
    }

    /// Capacitance, where the muscle has electric constants.
    pub(in crate::model) fn capacitance(&mut self) -> Option<Capacitance<Coefficient>> {
        let electric = self.muscle.material.electric?;
        let cell = self.driven(electric, NeoHooke);
        Some(Capacitance { cell })
    }

    /// Electric energy of a charge in its unit, where a lumped muscle has electric constants.
    pub(in crate::model) fn flowing_charge(&mut self) -> Option<FlowingCharge<Coefficient>> {
        let unit = capacitance(self.muscle)?.unit_of_charge();
        Some(FlowingCharge {
            capacitance: self.capacitance()?,
            unit: unit.into(),
        })
    }

    /// Squared stretch.
    pub(in crate::model) fn stretch(&self) -> SquaredDistance<Coefficient> {
        SquaredDistance {
            centre: Vector::zeros(),
            scale: self.length.clone(),
        }
    }

    /// Squared ratio of the field of a voltage to a limit in V/mm.
    pub(in crate::model) fn field(&mut self, limit: f64) -> SquaredField<Coefficient> {
        SquaredField {
            length: self.length.clone(),
            voltage: self.layer().scaled(limit),
        }
    }

    /// Resistance in Ω of its circuit, in series.
    pub(in crate::model) fn resistance(&mut self) -> Option<Coefficient> {
        let value = self.muscle.circuit?.resistance?;
        Some(self.read.constant(Constant::Resistance(self.index), value))
    }

    /// Viscosity of a value.
    pub(in crate::model) fn viscous(&mut self, viscosity: f64) -> ViscousCell<Coefficient> {
        let viscosity = self.material(MaterialConstant::Viscosity, viscosity);
        ViscousCell {
            coefficient: &viscosity.scaled(1.5) * &self.volume,
        }
    }

    /// Spring of a Maxwell branch.
    pub(in crate::model) fn branch_spring(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> MaxwellCell<Coefficient> {
        let constant = MaterialConstant::BranchModulus(branch);
        MaxwellCell {
            length: self.length.clone(),
            volume: self.volume.clone(),
            shear_modulus: self.material(constant, of.shear_modulus),
        }
    }

    /// Spring of a Maxwell branch that has not relaxed from the reference configuration.
    pub(in crate::model) fn unrelaxed_spring(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> ElasticCell<NeoHooke, Coefficient> {
        let constant = MaterialConstant::BranchModulus(branch);
        ElasticCell {
            length: self.distance.clone(),
            volume: self.volume.clone(),
            shear_modulus: self.material(constant, of.shear_modulus),
            law: NeoHooke,
        }
    }

    /// Damper of a Maxwell branch.
    pub(in crate::model) fn branch_damper(
        &mut self,
        branch: usize,
        of: &MaxwellBranch,
    ) -> CoordinateDamper<Coefficient> {
        let spring = self.branch_spring(branch, of);
        let constant = MaterialConstant::RelaxationTime(branch);
        let time = self.material(constant, of.relaxation_time);
        CoordinateDamper {
            coefficient: &(&time.scaled(3.0) * &spring.shear_modulus) * &spring.volume,
        }
    }

    /// The mass of the muscle in g times a factor, where it has a density.
    pub(in crate::model) fn mass(&mut self, factor: f64) -> Option<Coefficient> {
        let density = self.muscle.material.density?;
        let density = self.material(MaterialConstant::Density, density);
        Some((&density * &self.volume).scaled(factor))
    }

    /// Rest volume in mm³.
    pub(in crate::model) fn volume(&self) -> Coefficient {
        self.volume.clone()
    }

    /// Inertia of the changing cross-section, where the muscle has a density.
    pub(in crate::model) fn section(&mut self) -> Option<SectionInertia<Coefficient>> {
        let [x, y] = &self.sides;
        let square = &(x * x) + &(y * y);
        let moment = &self.mass(1.0)? * &square;
        Some(SectionInertia {
            length: self.length.clone(),
            moment: &moment / &192.0.into(),
        })
    }
}

/// Capacitance of a lumped muscle; none of a muscle of finite elements, or without electric constants.
pub fn capacitance(muscle: &Muscle) -> Option<Capacitance> {
    let law = MuscleConstants::given(muscle).capacitance()?;
    (muscle.fidelity == Fidelity::Lumped).then(|| law.with(&[]))
}

/// Length of a vector.
fn norm([x, y, z]: &[Coefficient; 3]) -> Coefficient {
    (&(&(x * x) + &(y * y)) + &(z * z)).sqrt()
}

/// Squared ratio of the field of a given charge to a limit in V/mm.
pub(in crate::model) fn charge_field(
    capacitance: Capacitance<Coefficient>,
    limit: f64,
) -> GivenChargeField<Coefficient> {
    GivenChargeField {
        voltage: capacitance.cell.layer.scaled(limit),
        capacitance,
    }
}
