//! Constants of components that may be free, and parameters that they follow.

use crate::kinematics::{MaterialVector, Pose, VectorTerm};
use crate::math::Vector;

/// Part of a system that is made of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialOf {
    /// A muscle, by its index.
    Muscle(usize),
    /// A material of a block, by the index of the block and its own in the list of the block.
    Block(usize, usize),
}

/// A constant of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialConstant {
    /// Density in g/mm³.
    Density,
    /// Shear modulus in MPa.
    ShearModulus,
    /// First Lamé constant in MPa, which finite elements read.
    LameLambda,
    /// Constant c₁ of the electric energy in N/V².
    C1,
    /// Constant c₂ of the electric energy in N/V².
    C2,
    /// Permittivity ε of the electric energy in N/V².
    Permittivity,
    /// Viscosity in MPa ms.
    Viscosity,
    /// A constant of the law of elasticity other than the neo-Hookean one, by its name in files.
    Law(&'static str),
    /// Shear modulus of a Maxwell branch in MPa.
    BranchModulus(usize),
    /// Relaxation time of a Maxwell branch in ms.
    RelaxationTime(usize),
}

/// A constant of a component, by the index of the component in the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// A constant of a material.
    Material(MaterialOf, MaterialConstant),
    /// A side, 0 or 1, of the cross-section of a muscle in mm.
    Side(usize, usize),
    /// Thickness of a layer of a muscle in mm.
    Layer(usize),
    /// A component, 0 to 2, of the place of an end of a muscle, 0 for `from` and 1 for `to`, in mm.
    End(usize, usize, usize),
    /// Stretch before a muscle was glued between its ends.
    Prestretch(usize),
    /// Resistance in series with the electrodes of a source in Ω.
    Resistance(usize),
    /// Resistance parallel to the electrodes of a source in Ω.
    Leakage(usize),
    /// Stiffness of a spring in N/mm.
    SpringStiffness(usize),
    /// Damping of a spring in N ms/mm.
    SpringDamping(usize),
    /// Length of a spring without force in mm.
    SpringLength(usize),
    /// A component of the place of an end of a spring in mm, as of a muscle.
    SpringEnd(usize, usize, usize),
    /// Stiffness of a tendon in N/mm.
    TendonStiffness(usize),
    /// Length in mm up to which a tendon is slack.
    TendonLength(usize),
    /// A component, 0 to 2, of the place of a point of a tendon, by its number along it, in mm.
    TendonPoint(usize, usize, usize),
    /// Damping of a joint in N mm ms or N ms/mm.
    JointDamping(usize),
    /// Stiffness of a joint in N mm/rad or N/mm.
    JointStiffness(usize),
    /// Coordinate of a joint without force of its spring in rad or mm.
    JointRest(usize),
    /// Mass of a body in g.
    Mass(usize),
    /// A principal moment of inertia, 0 to 2, of a body in g mm².
    Inertia(usize, usize),
    /// A component, 0 to 2, of the place of a body in mm.
    BodyPlace(usize, usize),
    /// A size of the shape of a body in mm, which is drawn: length and radius of a cylinder, edges of a box, radius of a sphere.
    BodySize(usize, usize),
    /// A component, 0 to 2, of the place of a joint in mm.
    JointPlace(usize, usize),
    /// A component, 0 to 2, of the place of a marker in mm.
    MarkerPlace(usize, usize),
    /// A component, 0 to 2, of gravity in mm/ms².
    Gravity(usize),
    /// No constant of a component: the largest voltage in V of sources that are free, which quantities read.
    PeakVoltage,
    /// No constant of a component: the factor between the input that a recording says of a source and that which acts.
    Gain(usize),
    /// No constant of a component: the time in ms by which the input of a source acts later than a recording says.
    Delay(usize),
}

/// A unit of the International System: its symbol, and the factor from the unit of a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiUnit {
    /// Symbol, empty for a ratio.
    pub symbol: &'static str,
    /// Factor.
    pub factor: f64,
}

/// A constant that follows a parameter π: `offset + factor · π + a π² + b π³`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// The constant.
    pub constant: Constant,
    /// Factor.
    pub factor: f64,
    /// Offset, in the unit of the constant.
    pub offset: f64,
    /// Factors a and b of the square and of the cube.
    pub higher: [f64; 2],
}

impl From<Constant> for Follower {
    /// The constant that the parameter is.
    fn from(constant: Constant) -> Self {
        Self {
            constant,
            factor: 1.0,
            offset: 0.0,
            higher: [0.0; 2],
        }
    }
}

/// A free parameter: one variable that all its constants follow.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name for messages and files: the path of the constant in the scene.
    pub name: String,
    /// The constants.
    pub constants: Vec<Follower>,
    /// Lower bound, in the unit of the constants.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// Value at which the solver starts.
    pub guess: f64,
}

impl MaterialConstant {
    /// Returns true if the elastic energy of small and large strains at rest depends on it.
    pub fn is_elastic(self) -> bool {
        matches!(self, Self::ShearModulus | Self::LameLambda | Self::Law(_))
    }

    /// The constant of a muscle.
    pub fn of_muscle(self, muscle: usize) -> Constant {
        Constant::Material(MaterialOf::Muscle(muscle), self)
    }

    /// The constant of a material of a block.
    pub fn of_block(self, block: usize, material: usize) -> Constant {
        Constant::Material(MaterialOf::Block(block, material), self)
    }
}

impl Constant {
    /// The muscle that it is of.
    pub fn muscle(self) -> Option<usize> {
        match self {
            Self::Material(MaterialOf::Muscle(m), _)
            | Self::Side(m, _)
            | Self::Layer(m)
            | Self::Prestretch(m)
            | Self::End(m, ..) => Some(m),
            _ => None,
        }
    }

    /// Returns true if it is a length of the geometry of a muscle at rest, on which its mass and stretch depend.
    pub fn is_shape(self) -> bool {
        matches!(self, Self::Side(..) | Self::End(..) | Self::Prestretch(_))
    }

    /// Returns true if it must be positive to have a meaning.
    pub fn is_positive(self) -> bool {
        use MaterialConstant::{C1, C2, LameLambda, Law, Permittivity};
        !matches!(
            self,
            Self::End(..)
                | Self::SpringEnd(..)
                | Self::TendonPoint(..)
                | Self::JointRest(_)
                | Self::BodyPlace(..)
                | Self::JointPlace(..)
                | Self::MarkerPlace(..)
                | Self::Inertia(..)
                | Self::Gravity(_)
                | Self::PeakVoltage
                | Self::Delay(_)
                | Self::Material(_, Law(_) | LameLambda | C1 | C2 | Permittivity)
        )
    }
}

impl Follower {
    /// The constant at a value of the parameter.
    pub fn at(&self, value: f64) -> f64 {
        let [a, b] = self.higher;
        self.offset + self.factor * value + value * value * (a + b * value)
    }

    /// Returns true if it is a straight line.
    pub fn is_linear(&self) -> bool {
        self.higher == [0.0; 2]
    }

    /// The same of a parameter of which the old one is `c` times the value.
    #[must_use]
    pub fn of_multiple(self, c: f64) -> Self {
        let [a, b] = self.higher;
        Self {
            factor: c * self.factor,
            higher: [c * c * a, c * c * c * b],
            ..self
        }
    }
}

impl Constant {
    /// Returns true if it is a place of which others in the tree of joints follow, or a place that they move.
    pub fn is_place(self) -> bool {
        matches!(
            self,
            Self::BodyPlace(..) | Self::JointPlace(..) | Self::MarkerPlace(..)
        )
    }

    /// Returns true if formulas read it as a vector alone, which moves along a straight line.
    pub fn is_point(self) -> bool {
        self.is_place()
            || matches!(
                self,
                Self::End(..) | Self::SpringEnd(..) | Self::TendonPoint(..)
            )
    }
}

impl Parameter {
    /// Typical size of its value: its guess, or the distance of its bounds where that is zero.
    pub fn size(&self) -> f64 {
        let sizes = [self.guess.abs(), self.upper - self.lower];
        let found = sizes.into_iter().find(|s| *s > 0.0 && s.is_finite());
        found.unwrap_or(1.0)
    }
}

/// The value of a parameter that was sought.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundParameter {
    /// Name.
    pub name: String,
    /// Value in the unit of its constants.
    pub value: f64,
    /// Unit of the International System.
    pub unit: SiUnit,
    /// True if it lies at a bound, where the solver would have gone on.
    pub is_at_bound: bool,
}

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
