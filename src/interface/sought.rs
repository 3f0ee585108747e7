//! Constants of a system that are sought: names for them, and a parameter that they follow.

use crate::interface::handle::Handle;
use crate::model::components::Spring;
use crate::model::system::{Joint, Muscle};
use crate::model::{Constant, DielectricLaw, Follower, Parameter};
use std::ops::RangeInclusive;

impl Handle<Muscle> {
    /// Its shear modulus in MPa.
    pub fn shear_modulus(self) -> Constant {
        Constant::ShearModulus(self.index())
    }

    /// Its viscosity in MPa ms.
    pub fn viscosity(self) -> Constant {
        Constant::Viscosity(self.index())
    }

    /// Its relative permittivity.
    pub fn relative_permittivity(self, law: DielectricLaw) -> Constant {
        Constant::Permittivity(self.index(), law)
    }

    /// The thickness of its layers in mm.
    pub fn layer_thickness(self) -> Constant {
        Constant::Layer(self.index())
    }

    /// A side, 0 or 1, of its cross-section in mm.
    pub fn side(self, side: usize) -> Constant {
        Constant::Side(self.index(), side)
    }

    /// A component, 0 to 2, of the place in mm where it starts.
    pub fn start(self, axis: usize) -> Constant {
        Constant::End(self.index(), 0, axis)
    }

    /// A component, 0 to 2, of the place in mm where it ends.
    pub fn end(self, axis: usize) -> Constant {
        Constant::End(self.index(), 1, axis)
    }
}

impl Handle<Spring> {
    /// Its stiffness in N/mm.
    pub fn stiffness(self) -> Constant {
        Constant::SpringStiffness(self.index())
    }

    /// Its damping in N ms/mm.
    pub fn damping(self) -> Constant {
        Constant::SpringDamping(self.index())
    }

    /// Its length without force in mm.
    pub fn rest_length(self) -> Constant {
        Constant::SpringLength(self.index())
    }
}

impl Handle<Joint> {
    /// Its damping in N mm ms, or N ms/mm of a prismatic joint.
    pub fn damping(self) -> Constant {
        Constant::JointDamping(self.index())
    }
}

impl Parameter {
    /// A parameter within bounds, without constants yet; the solver starts from `guess`. All in the unit of its constants.
    pub fn new(name: impl Into<String>, bounds: RangeInclusive<f64>, guess: f64) -> Self {
        Self {
            name: name.into(),
            constants: Vec::new(),
            lower: *bounds.start(),
            upper: *bounds.end(),
            guess,
        }
    }

    /// A constant that the parameter is.
    #[must_use]
    pub fn is(self, constant: Constant) -> Self {
        self.follows(constant, 1.0, 0.0)
    }

    /// A constant that is `offset` plus `factor` times the parameter.
    #[must_use]
    pub fn follows(mut self, constant: Constant, factor: f64, offset: f64) -> Self {
        self.constants.push(Follower {
            constant,
            factor,
            offset,
        });
        self
    }
}
