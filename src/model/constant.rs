//! Constants of components that may be sought, and parameters that they follow.

/// Law by which a relative permittivity enters the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DielectricLaw {
    /// As in [`first_order`](crate::model::system::ElectricConstants::first_order).
    FirstOrder,
    /// As in [`ideal`](crate::model::system::ElectricConstants::ideal).
    Ideal,
}

/// A constant of a component, by the index of the component in the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// Shear modulus of a muscle in MPa.
    ShearModulus(usize),
    /// Relative permittivity of a muscle.
    Permittivity(usize, DielectricLaw),
    /// Viscosity of a muscle in MPa ms.
    Viscosity(usize),
    /// A side, 0 or 1, of the cross-section of a muscle in mm.
    Side(usize, usize),
    /// Thickness of a layer of a muscle in mm.
    Layer(usize),
    /// A component, 0 to 2, of the place of an end of a muscle, 0 for `from` and 1 for `to`, in mm.
    End(usize, usize, usize),
    /// Stiffness of a spring in N/mm.
    SpringStiffness(usize),
    /// Damping of a spring in N ms/mm.
    SpringDamping(usize),
    /// Length of a spring without force in mm.
    SpringLength(usize),
    /// Damping of a joint in N mm ms or N ms/mm.
    JointDamping(usize),
    /// No constant of a component: the largest voltage in V of sources that are sought, which quantities read.
    PeakVoltage,
}

/// A unit of the International System: its symbol, and the factor from the unit of a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiUnit {
    /// Symbol, empty for a ratio.
    pub symbol: &'static str,
    /// Factor.
    pub factor: f64,
}

/// A constant that follows a parameter π: `offset + factor · π`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// The constant.
    pub constant: Constant,
    /// Factor.
    pub factor: f64,
    /// Offset, in the unit of the constant.
    pub offset: f64,
}

impl From<Constant> for Follower {
    /// The constant that the parameter is.
    fn from(constant: Constant) -> Self {
        Self {
            constant,
            factor: 1.0,
            offset: 0.0,
        }
    }
}

/// A sought parameter: one variable that all its constants follow.
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

/// Most parameters that move the ends of one muscle.
pub const MOST_MOVES: usize = 2;

impl Constant {
    /// The muscle that it is of.
    pub fn muscle(self) -> Option<usize> {
        match self {
            Self::ShearModulus(m)
            | Self::Permittivity(m, _)
            | Self::Viscosity(m)
            | Self::Side(m, _)
            | Self::Layer(m)
            | Self::End(m, ..) => Some(m),
            _ => None,
        }
    }

    /// Returns true if it is a length of the geometry of a muscle at rest, on which its mass and stretch depend.
    pub fn is_shape(self) -> bool {
        matches!(self, Self::Side(..) | Self::End(..))
    }

    /// Returns true if it must be positive to have a meaning.
    pub fn is_positive(self) -> bool {
        !matches!(self, Self::End(..) | Self::PeakVoltage)
    }
}

impl Parameter {
    /// Typical size of its value: its guess, or the distance of its bounds where that is zero.
    pub fn size(&self) -> f64 {
        let sizes = [self.guess.abs(), self.upper - self.lower];
        let found = sizes.into_iter().find(|s| *s > 0.0 && s.is_finite());
        found.unwrap_or(1.0)
    }

    /// Returns true if it moves an end of a muscle.
    pub fn moves(&self, muscle: usize) -> bool {
        let is_end = |c: Constant| matches!(c, Constant::End(m, ..) if m == muscle);
        self.constants.iter().any(|c| is_end(c.constant))
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
