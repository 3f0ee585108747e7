//! Places of constants in a system, and their units.

use crate::model::circuit::Circuit;
use crate::model::constant::{Constant, MaterialConstant, MaterialOf, SiUnit};
use crate::model::system::{JointKind, Material, Potential, System};

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

    fn unit(self) -> (&'static str, f64) {
        match self {
            Self::Density => ("kg/m^3", 1e6),
            Self::ShearModulus | Self::LameLambda | Self::BranchModulus(_) => ("Pa", 1e6),
            Self::Viscosity => ("Pa s", 1e3),
            Self::RelaxationTime(_) => ("s", 1e-3),
            Self::Law("c2" | "c3") => ("Pa", 1e6),
            Self::C1 | Self::C2 | Self::Permittivity => ("F/m", 1.0),
            Self::Law(_) => ("", 1.0),
        }
    }

    /// The reason of a material that does not have it.
    fn lacking(self) -> &'static str {
        match self {
            Self::Density => "the material has no density",
            Self::ShearModulus => "the material has no shear modulus",
            Self::LameLambda => "the material has no first Lamé constant",
            Self::C1 | Self::C2 | Self::Permittivity => "the material has no electric constants",
            Self::Viscosity => "the material has no viscosity",
            Self::Law(_) => "the material has no such law of elasticity",
            Self::BranchModulus(_) | Self::RelaxationTime(_) => {
                "the material has no such Maxwell branch"
            }
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

impl Constant {
    /// Its place in the system; `None` if the part does not define the constant.
    fn place(self, system: &mut System) -> Option<&mut f64> {
        match self {
            Self::Material(of, constant) => return constant.place(of.material(system)?),
            Self::Resistance(source) => return circuit(system, source)?.resistance.as_mut(),
            Self::Leakage(source) => return circuit(system, source)?.leakage.as_mut(),
            _ => {}
        }
        let muscles = &mut system.muscles;
        let (springs, tendons) = (
            &mut system.components.springs,
            &mut system.components.tendons,
        );
        match self {
            Self::Side(m, side) => muscles.get_mut(m)?.cross_section.get_mut(side),
            Self::Layer(m) => Some(&mut muscles.get_mut(m)?.layer_thickness),
            Self::End(m, 0, axis) => muscles.get_mut(m)?.from.at.get_mut(axis),
            Self::End(m, _, axis) => muscles.get_mut(m)?.to.at.get_mut(axis),
            Self::Prestretch(m) => muscles.get_mut(m)?.prestretch.as_mut(),
            Self::SpringStiffness(s) => springs.get_mut(s)?.stiffness.as_mut(),
            Self::SpringDamping(s) => springs.get_mut(s)?.damping.as_mut(),
            Self::SpringLength(s) => Some(&mut springs.get_mut(s)?.rest_length),
            Self::SpringEnd(s, 0, axis) => springs.get_mut(s)?.from.at.get_mut(axis),
            Self::SpringEnd(s, _, axis) => springs.get_mut(s)?.to.at.get_mut(axis),
            Self::TendonStiffness(t) => Some(&mut tendons.get_mut(t)?.stiffness),
            Self::TendonLength(t) => Some(&mut tendons.get_mut(t)?.rest_length),
            Self::TendonPoint(t, point, axis) => {
                let through = &mut tendons.get_mut(t)?.through;
                through.get_mut(point)?.at.get_mut(axis)
            }
            Self::JointDamping(j) => system.joints.get_mut(j)?.damping.as_mut(),
            Self::JointStiffness(j) => {
                let spring = system.joints.get_mut(j)?.spring.as_mut();
                spring.map(|spring| &mut spring.stiffness)
            }
            Self::JointRest(j) => {
                let spring = system.joints.get_mut(j)?.spring.as_mut();
                spring.map(|spring| &mut spring.rest)
            }
            Self::Mass(b) => Some(&mut system.bodies.get_mut(b)?.mass),
            Self::Inertia(b, axis) => system.bodies.get_mut(b)?.inertia.get_mut(axis),
            Self::BodyPlace(b, axis) => system.bodies.get_mut(b)?.centre.get_mut(axis),
            Self::BodySize(b, size) => system.bodies.get_mut(b)?.shape.size_mut(size),
            Self::JointPlace(j, axis) => system.joints.get_mut(j)?.at.get_mut(axis),
            Self::MarkerPlace(m, axis) => system.markers.get_mut(m)?.point.at.get_mut(axis),
            Self::Gravity(axis) => system.gravity.as_mut()?.get_mut(axis),
            Self::PeakVoltage
            | Self::Gain(_)
            | Self::Delay(_)
            | Self::Material(..)
            | Self::Resistance(_)
            | Self::Leakage(_) => None,
        }
    }

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

    /// All constants that parts of a system may have.
    pub fn all(system: &System) -> Vec<Self> {
        let mut all: Vec<Self> = (0..3).map(Self::Gravity).collect();
        for (m, muscle) in system.muscles.iter().enumerate() {
            let of = MaterialOf::Muscle(m);
            all.extend(MaterialConstant::all(&muscle.material).map(|c| Self::Material(of, c)));
            all.extend([Self::Side(m, 0), Self::Side(m, 1), Self::Layer(m)]);
            all.push(Self::Prestretch(m));
            all.extend((0..6).map(|i| Self::End(m, i / 3, i % 3)));
        }
        for (b, solid) in system.solids.iter().enumerate() {
            for (k, material) in solid.materials.iter().enumerate() {
                let of = MaterialOf::Block(b, k);
                all.extend(MaterialConstant::all(material).map(|c| Self::Material(of, c)));
            }
        }
        let sources = 0..system.sources().len();
        all.extend(sources.flat_map(|s| [Self::Resistance(s), Self::Leakage(s)]));
        for s in 0..system.components.springs.len() {
            all.extend([
                Self::SpringStiffness(s),
                Self::SpringDamping(s),
                Self::SpringLength(s),
            ]);
            all.extend((0..6).map(|i| Self::SpringEnd(s, i / 3, i % 3)));
        }
        for (t, tendon) in system.components.tendons.iter().enumerate() {
            all.extend([Self::TendonStiffness(t), Self::TendonLength(t)]);
            let components = 0..3 * tendon.through.len();
            all.extend(components.map(|i| Self::TendonPoint(t, i / 3, i % 3)));
        }
        for j in 0..system.joints.len() {
            all.extend([
                Self::JointDamping(j),
                Self::JointStiffness(j),
                Self::JointRest(j),
            ]);
            all.extend((0..3).map(|axis| Self::JointPlace(j, axis)));
        }
        for b in 0..system.bodies.len() {
            all.push(Self::Mass(b));
            all.extend((0..3).map(|axis| Self::Inertia(b, axis)));
            all.extend((0..3).flat_map(|i| [Self::BodySize(b, i), Self::BodyPlace(b, i)]));
        }
        for m in 0..system.markers.len() {
            all.extend((0..3).map(|axis| Self::MarkerPlace(m, axis)));
        }
        all
    }

    /// Its unit in the International System.
    pub fn unit(self, system: &System) -> SiUnit {
        let is_angle = |j: usize| matches!(system.joints[j].kind, JointKind::Revolute { .. });
        let (symbol, factor) = match self {
            Self::Material(_, constant) => constant.unit(),
            Self::Side(..)
            | Self::Layer(_)
            | Self::End(..)
            | Self::SpringLength(_)
            | Self::SpringEnd(..)
            | Self::BodyPlace(..)
            | Self::BodySize(..)
            | Self::JointPlace(..)
            | Self::MarkerPlace(..)
            | Self::TendonLength(_)
            | Self::TendonPoint(..) => ("m", 1e-3),
            Self::PeakVoltage => ("V", 1.0),
            Self::Gain(_) => ("", 1.0),
            Self::Delay(_) => ("s", 1e-3),
            Self::SpringStiffness(_) | Self::TendonStiffness(_) => ("N/m", 1e3),
            Self::Prestretch(_) => ("", 1.0),
            Self::Resistance(_) | Self::Leakage(_) => ("Ohm", 1.0),
            Self::SpringDamping(_) => ("N s/m", 1.0),
            Self::JointDamping(j) if is_angle(j) => ("N m s/rad", 1e-6),
            Self::JointDamping(_) => ("N s/m", 1.0),
            Self::JointStiffness(j) if is_angle(j) => ("N m/rad", 1e-3),
            Self::JointStiffness(_) => ("N/m", 1e3),
            Self::JointRest(j) if is_angle(j) => ("rad", 1.0),
            Self::JointRest(_) => ("m", 1e-3),
            Self::Mass(_) => ("kg", 1e-3),
            Self::Inertia(..) => ("kg m^2", 1e-9),
            Self::Gravity(_) => ("m/s^2", 1e3),
        };
        SiUnit { symbol, factor }
    }

    /// The component, side, end or axis that the system does not have.
    pub(super) fn missing(self, system: &System) -> Option<String> {
        let (what, index, count) = match self {
            Self::Side(_, side) if side >= 2 => ("side", side, 2),
            Self::End(_, end, _) | Self::SpringEnd(_, end, _) if end >= 2 => ("end", end, 2),
            Self::End(.., axis)
            | Self::SpringEnd(.., axis)
            | Self::Inertia(_, axis)
            | Self::BodyPlace(_, axis)
            | Self::JointPlace(_, axis)
            | Self::MarkerPlace(_, axis)
            | Self::TendonPoint(.., axis)
            | Self::Gravity(axis)
                if axis >= 3 =>
            {
                ("axis", axis, 3)
            }
            Self::SpringStiffness(s)
            | Self::SpringDamping(s)
            | Self::SpringLength(s)
            | Self::SpringEnd(s, ..) => ("spring", s, system.components.springs.len()),
            Self::TendonPoint(t, point, _) if t < system.components.tendons.len() => {
                ("point", point, system.components.tendons[t].through.len())
            }
            Self::TendonStiffness(t) | Self::TendonLength(t) | Self::TendonPoint(t, ..) => {
                ("tendon", t, system.components.tendons.len())
            }
            Self::JointDamping(j)
            | Self::JointStiffness(j)
            | Self::JointRest(j)
            | Self::JointPlace(j, _) => ("joint", j, system.joints.len()),
            Self::Mass(b) | Self::Inertia(b, _) | Self::BodyPlace(b, _) | Self::BodySize(b, _) => {
                ("body", b, system.bodies.len())
            }
            Self::MarkerPlace(m, _) => ("marker", m, system.markers.len()),
            Self::Material(MaterialOf::Block(b, _), _) => ("block", b, system.solids.len()),
            Self::Material(MaterialOf::Muscle(m), _)
            | Self::Side(m, _)
            | Self::Layer(m)
            | Self::Prestretch(m)
            | Self::End(m, ..) => ("muscle", m, system.muscles.len()),
            Self::Resistance(s) | Self::Leakage(s) | Self::Gain(s) | Self::Delay(s) => {
                ("source", s, system.sources().len())
            }
            Self::Gravity(_) | Self::PeakVoltage => return None,
        };
        (index >= count).then(|| format!("there is no {what} {index}, only {count}"))
    }

    /// The reason of a part that does not have it.
    pub(crate) fn lacking(self) -> &'static str {
        match self {
            Self::Material(_, constant) => constant.lacking(),
            Self::SpringDamping(_) => "the spring has no damping",
            Self::SpringStiffness(_) | Self::SpringLength(_) | Self::SpringEnd(..) => {
                "the spring has no stiffness"
            }
            Self::JointDamping(_) => "the joint has no damping",
            Self::JointStiffness(_) | Self::JointRest(_) => "the joint has no stiffness",
            Self::Prestretch(_) => "the muscle has no prestretch",
            Self::Resistance(_) => "the source has no resistor",
            Self::Leakage(_) => "the source has no leak",
            Self::Gravity(_) => "the scene has no gravity",
            _ => "there is no such constant",
        }
    }

    /// Returns true if the part that it is of names it.
    pub(super) fn is_named(self, system: &mut System) -> bool {
        match self {
            // A length is named with the stiffness of its spring.
            Self::SpringLength(s) => system.components.springs[s].stiffness.is_some(),
            Self::PeakVoltage | Self::Gain(_) | Self::Delay(_) => true,
            other => other.value(system).is_some(),
        }
    }
}
