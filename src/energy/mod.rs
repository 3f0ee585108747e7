//! Energies and virtual works: pure formulas, without index, mesh or time.

mod along_span;
mod charge;
mod closest;
mod coefficient;
mod constraint;
mod contact;
mod cored;
mod cored_friction;
mod dot_products;
mod elastic_law;
mod friction;
mod kinetic;
mod law;
mod limit;
mod maxwell_damper;
mod membrane;
mod muscle;
mod of_square;
mod one_sided;
mod spring;
mod viscosity;

pub use along_span::AlongSpan;
pub use charge::{
    Capacitance, FlowingCharge, FlowingChargeField, GivenCharge, GivenChargeField, MeanCharge,
    PotentialDrop, SourceCurrent, SourcePower, StoredEnergy, VoltageAcross,
};
pub use closest::Cores;
pub use coefficient::Coefficient;
pub use constraint::{Coincidence, Orthogonality};
pub use contact::{
    ContactDamping, ContactElasticity, ContactForce, ContactGap, ContactLaw, OfForm, Surface, Touch,
};
pub use cored::{CoreForce, FormVariation, OfClosest, OfCores, Times};
pub use cored_friction::{AtFeet, CoreFriction};
pub use dot_products::OfDotProducts;
pub use elastic_law::{ElasticConstants, ElasticLaw, Elasticity, NeoHooke, OfPlane};
pub use friction::{ContactFriction, FrictionLocal, StickingFriction};
pub use kinetic::{
    DeadLoad, FollowingForce, Gravity, KineticCoupling, KineticEnergy, SurfaceCharge,
};
pub(crate) use law::law;
pub use law::{Constants, Law};
pub use limit::{
    Angle, AngleStep, Multiple, OutsideBox, PeakExcess, PositionComponent, Projection,
    ProjectionStep, SquaredDistance, SquaredField,
};
pub use maxwell_damper::{DamperDerivatives, MaxwellCell, MaxwellDamper};
pub use membrane::{
    ChargedMembrane, DielectricMembrane, ElasticMembrane, MaxwellMembrane, ViscousMembrane,
};
pub use muscle::{DielectricCell, ElasticCell, SectionInertia};
pub use of_square::OfSquare;
pub use one_sided::{Cable, CoordinateStops};
pub use spring::{CoordinateSpring, JointAngle, JointDisplacement, LinearSpring, SpanDamper};
pub use viscosity::{AngularDamper, CoordinateDamper, LinearDamper, ViscousCell};

use crate::math::{Derivatives, Local, Number};
use nalgebra::{Matrix3, SVector, Vector3};

/// A scalar of `M` arguments, differentiated exactly: vectors first, three arguments each, then scalars. Its constants and arguments are
/// numbers `T`, so that derivatives by constants ride along.
pub trait Energy<const M: usize, T: Number = f64>: Clone + Send + Sync {
    /// Polynomial degree: derivatives above it vanish and are never emitted.
    const DEGREE: usize = usize::MAX;

    /// Number of leading vectors that are virtual displacements: 0 for a potential; otherwise the scalar is a virtual work
    /// δx·f, linear in them, whose scalar arguments are inputs or free parameters.
    const VIRTUAL: usize = 0;

    /// True if a virtual work is that of loads, which supply energy; otherwise its forces dissipate.
    const APPLIED: bool = false;

    /// True if it is a kinetic energy.
    const KINETIC: bool = false;

    /// Number of arguments that read each of its n vectors: argument i reads vector i mod n.
    const READINGS: usize = 1;

    /// True if second derivatives between two vectors are multiples of the identity.
    const ISOTROPIC: bool = false;

    /// True if it is a sum of functions of the vectors alone, each times a constant or the square of one scalar.
    const OF_SQUARES: bool = false;

    /// Returns true if the vector arguments `i` and `j` have mixed second derivatives; a virtual work is linear in virtual ones.
    fn couples(i: usize, j: usize) -> bool {
        i >= Self::VIRTUAL || j >= Self::VIRTUAL
    }

    /// Storage of its derivatives up to an order: a [`Jet`](crate::math::Jet), or fewer numbers.
    type Local<const ORDER: usize>: Local<T>;

    /// Its derivatives at `p` up to `ORDER`, with rates along `w` when that is 3.
    fn at<const ORDER: usize>(&self, p: &SVector<T, M>, w: &SVector<T, M>) -> Self::Local<ORDER>;
}

/// A scalar with its derivatives and no rates of them: a virtual work, or what is only measured.
pub trait WithDerivatives: Derivatives {
    /// Its value.
    fn scalar(&self) -> f64;
}

impl<W: WithDerivatives> Local for W {
    #[inline(always)]
    fn value(&self) -> f64 {
        self.scalar()
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives {
        self
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives {
        self
    }
}

impl<T: Number, D: Derivatives<T>> Derivatives<T> for &D {
    const HAS_SECOND: bool = D::HAS_SECOND;

    #[inline(always)]
    fn force(&self, i: usize) -> Vector3<T> {
        (**self).force(i)
    }

    #[inline(always)]
    fn row(&self, s: usize) -> T {
        (**self).row(s)
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix3<T> {
        (**self).block(i, j)
    }

    #[inline(always)]
    fn column(&self, i: usize, s: usize) -> Vector3<T> {
        (**self).column(i, s)
    }

    #[inline(always)]
    fn entry(&self, s: usize, t: usize) -> T {
        (**self).entry(s, t)
    }
}
