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
}

/// Declares names of constants of a part, each by its arguments and the constant.
macro_rules! constants {
    ($part:ty: $($(#[$about:meta])* $name:ident($($given:ident),*) $constant:ident($($further:expr),*);)*) => {
        impl Handle<$part> {
            $($(#[$about])*
            pub fn $name(self, $($given: usize),*) -> Constant {
                Constant::$constant(self.index(), $($further),*)
            })*
        }
    };
}

constants! {
    Muscle:
    /// The thickness of its layers in mm.
    layer_thickness() Layer();
    /// A side, 0 or 1, of its cross-section in mm.
    side(side) Side(side);
    /// A component, 0 to 2, of the place in mm where it starts.
    start(axis) End(0, axis);
    /// A component, 0 to 2, of the place in mm where it ends.
    end(axis) End(1, axis);
}

constants! {
    Spring:
    /// Its stiffness in N/mm.
    stiffness() SpringStiffness();
    /// Its damping in N ms/mm.
    damping() SpringDamping();
    /// Its length without force in mm.
    rest_length() SpringLength();
    /// A component, 0 to 2, of the place in mm where it starts.
    start(axis) SpringEnd(0, axis);
    /// A component, 0 to 2, of the place in mm where it ends.
    end(axis) SpringEnd(1, axis);
}

constants! {
    Tendon:
    /// Its stiffness in N/mm.
    stiffness() TendonStiffness();
    /// The length in mm up to which it is slack.
    rest_length() TendonLength();
    /// A component, 0 to 2, of the place in mm of one of its points, by its number along it.
    point(number, axis) TendonPoint(number, axis);
}

constants! {
    Joint:
    /// Its damping in N mm ms, or N ms/mm of a prismatic joint.
    damping() JointDamping();
    /// Its stiffness in N mm/rad, or N/mm of a prismatic joint.
    stiffness() JointStiffness();
    /// A component, 0 to 2, of its place in mm.
    place(axis) JointPlace(axis);
    /// Its coordinate without force of its spring in rad or mm.
    rest() JointRest();
}

constants! {
    Body:
    /// Its mass in g.
    mass() Mass();
    /// A principal moment of inertia, 0 to 2, in g mm².
    inertia(axis) Inertia(axis);
    /// A component, 0 to 2, of its place in mm.
    place(axis) BodyPlace(axis);
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
