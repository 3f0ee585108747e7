//! Constants of a system that are sought: names for them, and a parameter that they follow.

use crate::interface::handle::Handle;
use crate::model::components::{Spring, Tendon};
use crate::model::system::{Body, ElectricConstants, Joint, Muscle};
use crate::model::{Constant, Follower, MaterialConstant, Parameter};
use std::ops::RangeInclusive;

impl Handle<Muscle> {
    /// A constant of its material.
    pub fn material(self, constant: MaterialConstant) -> Constant {
        constant.of_muscle(self.index())
    }

    /// Its shear modulus in MPa.
    pub fn shear_modulus(self) -> Constant {
        self.material(MaterialConstant::ShearModulus)
    }

    /// Its viscosity in MPa ms.
    pub fn viscosity(self) -> Constant {
        self.material(MaterialConstant::Viscosity)
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

    /// A component, 0 to 2, of the place in mm where it starts.
    pub fn start(self, axis: usize) -> Constant {
        Constant::SpringEnd(self.index(), 0, axis)
    }

    /// A component, 0 to 2, of the place in mm where it ends.
    pub fn end(self, axis: usize) -> Constant {
        Constant::SpringEnd(self.index(), 1, axis)
    }
}

impl Handle<Tendon> {
    /// Its stiffness in N/mm.
    pub fn stiffness(self) -> Constant {
        Constant::TendonStiffness(self.index())
    }

    /// The length in mm up to which it is slack.
    pub fn rest_length(self) -> Constant {
        Constant::TendonLength(self.index())
    }

    /// A component, 0 to 2, of the place in mm of one of its points, by its number along it.
    pub fn point(self, number: usize, axis: usize) -> Constant {
        Constant::TendonPoint(self.index(), number, axis)
    }
}

impl Handle<Joint> {
    /// Its damping in N mm ms, or N ms/mm of a prismatic joint.
    pub fn damping(self) -> Constant {
        Constant::JointDamping(self.index())
    }

    /// Its stiffness in N mm/rad, or N/mm of a prismatic joint.
    pub fn stiffness(self) -> Constant {
        Constant::JointStiffness(self.index())
    }

    /// A component, 0 to 2, of its place in mm.
    pub fn place(self, axis: usize) -> Constant {
        Constant::JointPlace(self.index(), axis)
    }

    /// Its coordinate without force of its spring in rad or mm.
    pub fn rest(self) -> Constant {
        Constant::JointRest(self.index())
    }
}

impl Handle<Body> {
    /// Its mass in g.
    pub fn mass(self) -> Constant {
        Constant::Mass(self.index())
    }

    /// A principal moment of inertia, 0 to 2, in g mm².
    pub fn inertia(self, axis: usize) -> Constant {
        Constant::Inertia(self.index(), axis)
    }

    /// A component, 0 to 2, of its place in mm.
    pub fn place(self, axis: usize) -> Constant {
        Constant::BodyPlace(self.index(), axis)
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

    /// The electric constants of a muscle, where the parameter is a relative permittivity: `of` are the constants of one, such as
    /// [`ElectricConstants::ideal`].
    #[must_use]
    pub fn is_permittivity(
        mut self,
        muscle: Handle<Muscle>,
        of: fn(f64) -> ElectricConstants,
    ) -> Self {
        use MaterialConstant::{C1, C2, Permittivity};
        let [none, one] = [of(0.0), of(1.0)].map(|e| [e.c1, e.c2, e.permittivity]);
        for (i, constant) in [C1, C2, Permittivity].into_iter().enumerate() {
            if one[i] != none[i] {
                self = self.follows(muscle.material(constant), one[i] - none[i], none[i]);
            }
        }
        self
    }

    /// A constant that is `offset` plus `factor` times the parameter.
    #[must_use]
    pub fn follows(mut self, constant: Constant, factor: f64, offset: f64) -> Self {
        self.constants.push(Follower {
            constant,
            factor,
            offset,
            higher: [0.0; 2],
        });
        self
    }
}
