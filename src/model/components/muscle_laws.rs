//! Laws of lumped muscles: formulas whose constants follow from geometry and material, and with them from free parameters.

use crate::energy::{
    Capacitance, CoordinateDamper, DielectricCell, ElasticCell, ElasticLaw, Elasticity,
    FlowingCharge, GivenCharge, Gravity, KineticEnergy, MaxwellCell, NeoHooke, Polynomial,
    SectionInertia, ViscousCell,
};
use crate::functional::Law;
use crate::math::Number;
use nalgebra::Vector3;

/// A law of elasticity whose constants follow from parameters.
pub(in crate::model) trait ElasticConstants:
    Clone + Send + Sync + 'static
{
    /// The law over numbers.
    type Over<T: Number>: Elasticity<T>;

    /// The law at parameters.
    fn over<T: Number>(&self, parameters: &[T]) -> Self::Over<T>;
}

impl ElasticConstants for NeoHooke {
    type Over<T: Number> = Self;

    fn over<T: Number>(&self, _: &[T]) -> Self {
        Self
    }
}

impl ElasticConstants for ElasticLaw<Polynomial> {
    type Over<T: Number> = ElasticLaw<T>;

    fn over<T: Number>(&self, parameters: &[T]) -> ElasticLaw<T> {
        self.map(|_, constant| constant.at(parameters))
    }
}

/// Geometry of a muscle at rest.
#[derive(Clone)]
pub(in crate::model) struct Shape {
    /// Components of the span in the reference configuration in mm.
    pub(super) span: [Polynomial; 3],
    /// Stretch of the span.
    pub(super) prestretch: Option<Polynomial>,
    /// Sides of the cross-section in mm.
    pub(super) sides: [Polynomial; 2],
}

impl Shape {
    /// Distance of the ends in the reference configuration in mm.
    fn distance<T: Number>(&self, parameters: &[T]) -> T {
        let [x, y, z] = self.span.each_ref().map(|l| l.at(parameters));
        (x * x + y * y + z * z).sqrt()
    }

    /// Rest length L₀ in mm.
    pub(super) fn length<T: Number>(&self, parameters: &[T]) -> T {
        let distance = self.distance(parameters);
        match &self.prestretch {
            None => distance,
            Some(stretch) => distance.over(stretch.at(parameters)),
        }
    }

    /// Rest volume V₀ in mm³.
    fn volume<T: Number>(&self, parameters: &[T]) -> T {
        let [x, y] = self.sides.each_ref().map(|side| side.at(parameters));
        x * y * self.length(parameters)
    }
}

/// Volume at rest.
#[derive(Clone)]
pub(in crate::model) struct RestVolume(pub(super) Shape);

impl RestVolume {
    /// Volume in mm³.
    pub(in crate::model) fn volume<T: Number>(&self, parameters: &[T]) -> T {
        self.0.volume(parameters)
    }
}

/// Elasticity.
#[derive(Clone)]
pub(in crate::model) struct Elastic<L> {
    pub(super) shape: Shape,
    pub(super) shear_modulus: Polynomial,
    pub(super) law: L,
}

impl<L: ElasticConstants> Law<3> for Elastic<L> {
    type Formula<T: Number> = ElasticCell<L::Over<T>, T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Self::Formula<T> {
        ElasticCell {
            length: self.shape.length(parameters),
            volume: self.shape.volume(parameters),
            shear_modulus: self.shear_modulus.at(parameters),
            law: self.law.over(parameters),
        }
    }
}

/// Elasticity with a voltage.
#[derive(Clone)]
pub(in crate::model) struct Driven<L> {
    pub(super) elastic: Elastic<L>,
    /// c₁, c₂ and ε in N/V².
    pub(super) electric: [Polynomial; 3],
    /// Thickness of a layer in mm.
    pub(super) layer: Polynomial,
}

impl<L: ElasticConstants> Law<4> for Driven<L> {
    type Formula<T: Number> = DielectricCell<L::Over<T>, T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Self::Formula<T> {
        let [c1, c2, permittivity] = self.electric.each_ref().map(|c| c.at(parameters));
        DielectricCell {
            elastic: self.elastic.formula(parameters),
            c1,
            c2,
            permittivity,
            layer: self.layer.at(parameters),
        }
    }
}

/// Capacitance.
#[derive(Clone)]
pub(in crate::model) struct OfCapacitance(pub(super) Driven<NeoHooke>);

impl Law<3> for OfCapacitance {
    type Formula<T: Number> = Capacitance<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Capacitance<T> {
        Capacitance {
            cell: self.0.formula(parameters),
        }
    }
}

/// Electric energy of a charge that flows through a resistor, and the unit of the charge in mC.
#[derive(Clone)]
pub(in crate::model) struct Flowing {
    pub(in crate::model) capacitance: OfCapacitance,
    pub(in crate::model) unit: f64,
}

impl Law<6> for Flowing {
    type Formula<T: Number> = FlowingCharge<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> FlowingCharge<T> {
        FlowingCharge {
            capacitance: self.capacitance.formula(parameters),
            unit: T::of(self.unit),
        }
    }
}

/// Electric energy of a given charge.
#[derive(Clone)]
pub(in crate::model) struct Given(pub(in crate::model) OfCapacitance);

impl Law<4> for Given {
    type Formula<T: Number> = GivenCharge<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> GivenCharge<T> {
        GivenCharge {
            capacitance: self.0.formula(parameters),
        }
    }
}

/// Viscosity.
#[derive(Clone)]
pub(in crate::model) struct Viscous {
    pub(super) shape: Shape,
    pub(super) viscosity: Polynomial,
}

impl Law<9> for Viscous {
    type Formula<T: Number> = ViscousCell<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> ViscousCell<T> {
        let viscosity = self.viscosity.at(parameters);
        ViscousCell {
            coefficient: viscosity.scaled(1.5) * self.shape.volume(parameters),
        }
    }
}

/// Spring of a Maxwell branch.
#[derive(Clone)]
pub(in crate::model) struct BranchSpring {
    pub(super) shape: Shape,
    pub(super) shear_modulus: Polynomial,
}

impl Law<6> for BranchSpring {
    type Formula<T: Number> = MaxwellCell<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> MaxwellCell<T> {
        MaxwellCell {
            length: self.shape.length(parameters),
            volume: self.shape.volume(parameters),
            shear_modulus: self.shear_modulus.at(parameters),
        }
    }
}

/// Spring of a Maxwell branch that has not relaxed from the reference configuration.
#[derive(Clone)]
pub(in crate::model) struct UnrelaxedSpring(pub(super) BranchSpring);

impl Law<3> for UnrelaxedSpring {
    type Formula<T: Number> = ElasticCell<NeoHooke, T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> ElasticCell<NeoHooke, T> {
        let MaxwellCell {
            volume,
            shear_modulus,
            ..
        } = self.0.formula(parameters);
        ElasticCell {
            length: self.0.shape.distance(parameters),
            volume,
            shear_modulus,
            law: NeoHooke,
        }
    }
}

/// Damper of a Maxwell branch.
#[derive(Clone)]
pub(in crate::model) struct BranchDamper {
    pub(super) spring: BranchSpring,
    pub(super) relaxation_time: Polynomial,
}

impl Law<6> for BranchDamper {
    type Formula<T: Number> = CoordinateDamper<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> CoordinateDamper<T> {
        let spring = self.spring.formula(parameters);
        let time = self.relaxation_time.at(parameters);
        CoordinateDamper {
            coefficient: time.scaled(3.0) * spring.shear_modulus * spring.volume,
        }
    }
}

/// Mass of a muscle with a density, times a factor, at a point.
#[derive(Clone)]
pub(in crate::model) struct PointMass {
    pub(super) shape: Shape,
    pub(super) density: Polynomial,
    pub(super) factor: f64,
}

impl PointMass {
    /// Mass in g.
    pub(in crate::model) fn mass<T: Number>(&self, parameters: &[T]) -> T {
        let mass = self.density.at(parameters) * self.shape.volume(parameters);
        mass.scaled(self.factor)
    }
}

impl Law<3> for PointMass {
    type Formula<T: Number> = KineticEnergy<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> KineticEnergy<T> {
        KineticEnergy {
            mass: self.mass(parameters),
        }
    }
}

/// Weight of a muscle with a density under gravity in mm/ms².
#[derive(Clone)]
pub(in crate::model) struct Weight {
    pub(super) mass: PointMass,
    pub(super) gravity: [Polynomial; 3],
}

impl Law<3> for Weight {
    type Formula<T: Number> = Gravity<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Gravity<T> {
        let mass = self.mass.mass(parameters);
        let [x, y, z] = self.gravity.each_ref().map(|g| g.at(parameters) * mass);
        Gravity {
            weight: Vector3::new(x, y, z),
        }
    }
}

/// Inertia of the changing cross-section of a muscle with a density.
#[derive(Clone)]
pub(in crate::model) struct Section(pub(super) PointMass);

impl Law<6> for Section {
    type Formula<T: Number> = SectionInertia<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> SectionInertia<T> {
        let shape = &self.0.shape;
        let [x, y] = shape.sides.each_ref().map(|side| side.at(parameters));
        SectionInertia {
            length: shape.length(parameters),
            moment: (self.0.mass(parameters) * (x * x + y * y)).over(T::of(192.0)),
        }
    }
}
