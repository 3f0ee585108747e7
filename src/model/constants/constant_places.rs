//! Places of constants in a system, and their units.

use crate::model::components::{Spring, Tendon};
use crate::model::constants::constant::{Constant, MaterialConstant, MaterialOf, SiUnit, table};
use crate::model::system::circuit::Circuit;
use crate::model::system::{Attachment, JointKind, Material, Potential, System};
use nalgebra::Vector3;

/// Symbol of a unit, and the factor from the unit inside.
type Unit = (&'static str, f64);
const LENGTH: Unit = ("m", 1e-3);
const RATIO: Unit = ("", 1.0);
const OHM: Unit = ("Ohm", 1.0);
const PASCAL: Unit = ("Pa", 1e6);

/// Signs that a constant may have.
const POSITIVE: bool = true;
const ANY: bool = false;

/// Reasons of parts that do not have a constant.
const NONE: &str = "there is no such constant";
const NO_SPRING: &str = "the spring has no stiffness";
const NO_JOINT_SPRING: &str = "the joint has no stiffness";

impl MaterialConstant {
    /// Its place in a material; none where the material does not have it, or has it in another form.
    fn place(self, material: &mut Material) -> Option<&mut f64> {
        match self {
            Self::Density => material.density.as_mut(),
            Self::ShearModulus => Some(&mut material.shear_modulus),
            Self::LameLambda => material.lame_lambda.as_mut(),
            Self::Viscosity => material.viscosity.as_mut(),
            Self::Law(name) => material.law.as_mut()?.get_mut(name),
            Self::BranchModulus(b) => Some(&mut material.maxwell.get_mut(b)?.shear_modulus),
            Self::RelaxationTime(b) => Some(&mut material.maxwell.get_mut(b)?.relaxation_time),
            Self::C1 => Some(&mut material.electric.as_mut()?.c1),
            Self::C2 => Some(&mut material.electric.as_mut()?.c2),
            Self::Permittivity => Some(&mut material.electric.as_mut()?.permittivity),
        }
    }

    /// All constants that a material may have.
    fn all(material: &Material) -> impl Iterator<Item = Self> {
        let mut names = Vec::new();
        if let Some(law) = material.law {
            law.map(|name, _| names.push(Self::Law(name)));
        }
        let branches = 0..material.maxwell.list().len();
        let branches = branches.flat_map(|b| [Self::BranchModulus(b), Self::RelaxationTime(b)]);
        let plain = [
            Self::ShearModulus,
            Self::LameLambda,
            Self::Viscosity,
            Self::Density,
            Self::C1,
            Self::C2,
            Self::Permittivity,
        ];
        plain.into_iter().chain(names).chain(branches)
    }

    /// Its unit, its sign, and the reason of a material that does not have it.
    fn description(self) -> (Unit, bool, &'static str) {
        let no_branch = "the material has no such Maxwell branch";
        match self {
            Self::Density => (("kg/m^3", 1e6), POSITIVE, "the material has no density"),
            Self::ShearModulus => (PASCAL, POSITIVE, "the material has no shear modulus"),
            Self::LameLambda => (PASCAL, ANY, "the material has no first Lamé constant"),
            Self::C1 | Self::C2 | Self::Permittivity => {
                (("F/m", 1.0), ANY, "the material has no electric constants")
            }
            Self::Viscosity => (("Pa s", 1e3), POSITIVE, "the material has no viscosity"),
            Self::Law(name) => {
                let unit = if matches!(name, "c2" | "c3") {
                    PASCAL
                } else {
                    RATIO
                };
                (unit, ANY, "the material has no such law of elasticity")
            }
            Self::BranchModulus(_) => (PASCAL, POSITIVE, no_branch),
            Self::RelaxationTime(_) => (("s", 1e-3), POSITIVE, no_branch),
        }
    }
}

impl MaterialOf {
    fn material(self, system: &mut System) -> Option<&mut Material> {
        match self {
            Self::Muscle(m) => system.muscles.get_mut(m).map(|muscle| &mut muscle.material),
            Self::Block(b, material) => system.solids.get_mut(b)?.materials.get_mut(material),
        }
    }

    /// All constants that materials of a system may have.
    fn constants(system: &System) -> Vec<Constant> {
        let muscles = system.muscles.iter().enumerate();
        let of_muscles = muscles.map(|(m, muscle)| (Self::Muscle(m), &muscle.material));
        let of_blocks = system.solids.iter().enumerate().flat_map(|(b, solid)| {
            let materials = solid.materials.iter().enumerate();
            materials.map(move |(k, material)| (Self::Block(b, k), material))
        });
        let all = of_muscles.chain(of_blocks).flat_map(|(of, material)| {
            MaterialConstant::all(material).map(move |c| Constant::Material(of, c))
        });
        all.collect()
    }
}

/// The circuit between a source and its electrodes, of a muscle or of a block.
fn circuit(system: &mut System, source: usize) -> Option<&mut Circuit> {
    let muscles = system.muscles.len();
    if source < muscles {
        return system.muscles[source].circuit.as_mut();
    }
    let electrodes = system
        .solids
        .iter_mut()
        .flat_map(|solid| &mut solid.electrodes);
    let mut own = electrodes.filter(|electrode| {
        matches!(electrode.potential, Potential::Driven { source: s, .. } if s == source)
    });
    own.find_map(|electrode| electrode.circuit.as_mut())
}

fn spring(system: &mut System, index: usize) -> Option<&mut Spring> {
    system.components.springs.get_mut(index)
}

fn tendon(system: &mut System, index: usize) -> Option<&mut Tendon> {
    system.components.tendons.get_mut(index)
}

/// Number of the points of a tendon.
fn points(system: &System, tendon: usize) -> usize {
    let tendon = system.components.tendons.get(tendon);
    tendon.map_or(usize::MAX, |tendon| tendon.through.len())
}

/// Place of one of two ends.
fn at_end(ends: [&mut Attachment; 2], end: usize) -> Option<&mut Vector3<f64>> {
    ends.into_iter().nth(end).map(|end| &mut end.at)
}

/// The unit of an angle or of a displacement.
fn of_joint(system: &System, joint: usize, [angle, displacement]: [Unit; 2]) -> Unit {
    match system.joints[joint].kind {
        JointKind::Revolute { .. } => angle,
        _ => displacement,
    }
}

/// Makes what the table says of the constants.
macro_rules! implement {
    (@all $all:ident $name:ident($($known:ident),*)) => {
        $all.push(Self::$name($($known),*));
    };
    (@all $all:ident $name:ident($($known:ident),*) $index:ident $most:expr $(, $next:ident $more:expr)*) => {
        for $index in 0..$most {
            implement!(@all $all $name($($known,)* $index) $($next $more),*);
        }
    };
    ($system:ident; $($part:ident $word:literal in $count:expr => {
        $($(#[$about:meta])* $name:ident($($index:ident $what:literal of $most:expr),*) =
            $unit:expr, $sign:expr, $lacking:expr, $place:expr;)*
    })*) => {
        #[expect(unused_variables, reason = "few units and places need all indices")]
        impl Constant {
            /// Its place in the system; `None` if the part does not define the constant.
            fn place(self, $system: &mut System) -> Option<&mut f64> {
                match self {
                    Self::Material(of, constant) => constant.place(of.material($system)?),
                    Self::PeakVoltage => None,
                    $($(Self::$name($part $(, $index)*) => $place,)*)*
                }
            }

            /// All constants that parts of a system may have.
            pub fn all($system: &System) -> Vec<Self> {
                let mut all = MaterialOf::constants($system);
                $(for $part in 0..$count {
                    $(implement!(@all all $name($part) $($index $most),*);)*
                })*
                all.retain(|constant| !matches!(constant, Self::Gain(_) | Self::Delay(_)));
                all
            }

            /// Its unit in the International System.
            pub fn unit(self, $system: &System) -> SiUnit {
                let (symbol, factor) = match self {
                    Self::Material(_, constant) => constant.description().0,
                    Self::PeakVoltage => ("V", 1.0),
                    $($(Self::$name($part $(, $index)*) => $unit,)*)*
                };
                SiUnit { symbol, factor }
            }

            /// Returns true if it must be positive to have a meaning.
            pub fn is_positive(self) -> bool {
                match self {
                    Self::Material(_, constant) => constant.description().1,
                    Self::PeakVoltage => ANY,
                    $($(Self::$name(..) => $sign,)*)*
                }
            }

            /// The component, side, end or axis that the system does not have.
            pub(crate) fn missing(self, $system: &System) -> Option<String> {
                let indices = match self {
                    Self::Material(MaterialOf::Block(b, _), _) => vec![("block", b, $system.solids.len())],
                    Self::Material(MaterialOf::Muscle(m), _) => vec![("muscle", m, $system.muscles.len())],
                    Self::PeakVoltage => Vec::new(),
                    $($(Self::$name($part $(, $index)*) => {
                        vec![$(($what, $index, $most),)* ($word, $part, $count)]
                    })*)*
                };
                let missing = indices.into_iter().find(|(_, index, count)| index >= count);
                missing.map(|(what, index, count)| format!("there is no {what} {index}, only {count}"))
            }

            /// The reason of a part that does not have it.
            pub(crate) fn lacking(self) -> &'static str {
                match self {
                    Self::Material(_, constant) => constant.description().2,
                    Self::PeakVoltage => NONE,
                    $($(Self::$name(..) => $lacking,)*)*
                }
            }
        }
    };
}
table!(implement);

impl Constant {
    /// Its value in a system; `None` if the part does not define the constant.
    pub fn value(self, system: &mut System) -> Option<f64> {
        self.place(system).map(|place| *place)
    }

    /// Puts a value in its place, where there is one.
    pub fn set(self, value: f64, system: &mut System) {
        if let Some(place) = self.place(system) {
            *place = value;
        }
    }

    /// Returns true if the part that it is of names it.
    pub(crate) fn is_named(self, system: &mut System) -> bool {
        match self {
            // A length is named with the stiffness of its spring.
            Self::SpringLength(s) => system.components.springs[s].stiffness.is_some(),
            Self::PeakVoltage | Self::Gain(_) | Self::Delay(_) => true,
            other => other.value(system).is_some(),
        }
    }
}
