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

/// The table of all constants of parts of a system, for a macro: the parts with their number in a `system`, and of each constant its further
/// indices, its unit with the factor from the unit inside, whether it must be positive to have a meaning, the reason of a part that does not
/// have it, and its place.
macro_rules! table {
    ($to:ident) => { $to! { system;
        axis "axis" in 3 => {
            /// A component, 0 to 2, of gravity in mm/ms².
            Gravity() = ("m/s^2", 1e3), ANY, "the scene has no gravity", system.gravity.as_mut()?.get_mut(axis);
        }
        m "muscle" in system.muscles.len() => {
            /// A side, 0 or 1, of the cross-section of a muscle in mm.
            Side(side "side" of 2) = LENGTH, POSITIVE, NONE, system.muscles.get_mut(m)?.cross_section.get_mut(side);
            /// Thickness of a layer of a muscle in mm.
            Layer() = LENGTH, POSITIVE, NONE, Some(&mut system.muscles.get_mut(m)?.layer_thickness);
            /// Stretch before a muscle was glued between its ends.
            Prestretch() = RATIO, POSITIVE, "the muscle has no prestretch", system.muscles.get_mut(m)?.prestretch.as_mut();
            /// A component, 0 to 2, of the place of an end of a muscle, 0 for `from` and 1 for `to`, in mm.
            End(end "end" of 2, axis "axis" of 3) = LENGTH, ANY, NONE, {
                let muscle = system.muscles.get_mut(m)?;
                at_end([&mut muscle.from, &mut muscle.to], end)?.get_mut(axis)
            };
        }
        s "source" in system.sources().len() => {
            /// Resistance in series with the electrodes of a source in Ω.
            Resistance() = OHM, POSITIVE, "the source has no resistor", circuit(system, s)?.resistance.as_mut();
            /// Resistance parallel to the electrodes of a source in Ω.
            Leakage() = OHM, POSITIVE, "the source has no leak", circuit(system, s)?.leakage.as_mut();
            /// No constant of a component: the factor between the input that a recording says of a source and that which acts.
            Gain() = RATIO, POSITIVE, NONE, None;
            /// No constant of a component: the time in ms by which the input of a source acts later than a recording says.
            Delay() = ("s", 1e-3), ANY, NONE, None;
        }
        s "spring" in system.components.springs.len() => {
            /// Stiffness of a spring in N/mm.
            SpringStiffness() = ("N/m", 1e3), POSITIVE, NO_SPRING, spring(system, s)?.stiffness.as_mut();
            /// Damping of a spring in N ms/mm.
            SpringDamping() = ("N s/m", 1.0), POSITIVE, "the spring has no damping", spring(system, s)?.damping.as_mut();
            /// Length of a spring without force in mm.
            SpringLength() = LENGTH, POSITIVE, NO_SPRING, Some(&mut spring(system, s)?.rest_length);
            /// A component of the place of an end of a spring in mm, as of a muscle.
            SpringEnd(end "end" of 2, axis "axis" of 3) = LENGTH, ANY, NO_SPRING, {
                let spring = spring(system, s)?;
                at_end([&mut spring.from, &mut spring.to], end)?.get_mut(axis)
            };
        }
        t "tendon" in system.components.tendons.len() => {
            /// Stiffness of a tendon in N/mm.
            TendonStiffness() = ("N/m", 1e3), POSITIVE, NONE, Some(&mut tendon(system, t)?.stiffness);
            /// Length in mm up to which a tendon is slack.
            TendonLength() = LENGTH, POSITIVE, NONE, Some(&mut tendon(system, t)?.rest_length);
            /// A component, 0 to 2, of the place of a point of a tendon, by its number along it, in mm.
            TendonPoint(point "point" of points(system, t), axis "axis" of 3) = LENGTH, ANY, NONE,
                tendon(system, t)?.through.get_mut(point)?.at.get_mut(axis);
        }
        j "joint" in system.joints.len() => {
            /// Damping of a joint in N mm ms or N ms/mm.
            JointDamping() = of_joint(system, j, [("N m s/rad", 1e-6), ("N s/m", 1.0)]), POSITIVE, "the joint has no damping",
                system.joints.get_mut(j)?.damping.as_mut();
            /// Stiffness of a joint in N mm/rad or N/mm.
            JointStiffness() = of_joint(system, j, [("N m/rad", 1e-3), ("N/m", 1e3)]), POSITIVE, NO_JOINT_SPRING,
                Some(&mut system.joints.get_mut(j)?.spring.as_mut()?.stiffness);
            /// Coordinate of a joint without force of its spring in rad or mm.
            JointRest() = of_joint(system, j, [("rad", 1.0), LENGTH]), ANY, NO_JOINT_SPRING,
                Some(&mut system.joints.get_mut(j)?.spring.as_mut()?.rest);
            /// A component, 0 to 2, of the place of a joint in mm.
            JointPlace(axis "axis" of 3) = LENGTH, ANY, NONE, system.joints.get_mut(j)?.at.get_mut(axis);
        }
        b "body" in system.bodies.len() => {
            /// Mass of a body in g.
            Mass() = ("kg", 1e-3), POSITIVE, NONE, Some(&mut system.bodies.get_mut(b)?.mass);
            /// A principal moment of inertia, 0 to 2, of a body in g mm².
            Inertia(axis "axis" of 3) = ("kg m^2", 1e-9), ANY, NONE, system.bodies.get_mut(b)?.inertia.get_mut(axis);
            /// A size of the shape of a body in mm, which is drawn: length and radius of a cylinder, edges of a box, radius of a sphere.
            BodySize(size "size" of 3) = LENGTH, POSITIVE, NONE, system.bodies.get_mut(b)?.shape.size_mut(size);
            /// A component, 0 to 2, of the place of a body in mm.
            BodyPlace(axis "axis" of 3) = LENGTH, ANY, NONE, system.bodies.get_mut(b)?.centre.get_mut(axis);
        }
        m "marker" in system.markers.len() => {
            /// A component, 0 to 2, of the place of a marker in mm.
            MarkerPlace(axis "axis" of 3) = LENGTH, ANY, NONE, system.markers.get_mut(m)?.point.at.get_mut(axis);
        }
    } };
}
pub(crate) use table;

/// Declares the constants of the table, and those of materials and of quantities.
macro_rules! declare {
    (@number $index:ident) => { usize };
    ($system:ident; $($part:ident $word:literal in $count:expr => {
        $($(#[$about:meta])* $name:ident($($index:ident $what:literal of $most:expr),*) =
            $unit:expr, $sign:expr, $lacking:expr, $place:expr;)*
    })*) => {
        /// A constant of a component, by the index of the component in the system.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Constant {
            $($($(#[$about])* $name(usize $(, declare!(@number $index))*),)*)*
            /// A constant of a material.
            Material(MaterialOf, MaterialConstant),
            /// No constant of a component: the largest voltage in V of sources that are free, which quantities read.
            PeakVoltage,
        }
    };
}
table!(declare);

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
pub(crate) struct Drifts {
    /// D of each body by each parameter; empty where no parameter moves a joint or a body that floats.
    pub(crate) of: Vec<Vec<MaterialVector>>,
    /// Poses of the bodies in the reference configuration.
    pub(crate) reference: Vec<Pose>,
}

impl Parameter {
    /// Directions by which it moves a place, of which it has the constants `at` as components.
    pub(crate) fn moves(&self, at: impl Fn(usize) -> Constant) -> Vector {
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
    pub(crate) fn of_point(
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
pub(crate) fn pruned(vector: &MaterialVector) -> Option<MaterialVector> {
    let is_left = |term: &&VectorTerm| term.directors.amax() > ROUNDING;
    let terms: Vec<VectorTerm> = vector.terms.iter().filter(is_left).copied().collect();
    (!terms.is_empty()).then_some(MaterialVector { terms })
}
