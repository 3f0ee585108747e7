//! Sought constants in a system: their values put in their places, their units, and the cases in which none can be sought.

use crate::model::constant::{
    Constant, DielectricLaw, Follower, FoundParameter, MOST_MOVES, Parameter, SiUnit,
};
use crate::model::system::{ElectricConstants, Fidelity, JointKind, System};
use std::fmt;

/// A value this near to a bound, relative to the size of the parameter, lies at it.
const AT_BOUND: f64 = 1e-6;

impl DielectricLaw {
    /// The electric constants of a relative permittivity.
    pub fn constants(self, ratio: f64) -> ElectricConstants {
        match self {
            Self::FirstOrder => ElectricConstants::first_order(ratio),
            Self::Ideal => ElectricConstants::ideal(ratio),
        }
    }
}

impl Constant {
    /// Puts a value in its place.
    fn put(self, value: f64, system: &mut System) {
        let muscles = &mut system.muscles;
        let springs = &mut system.components.springs;
        match self {
            Self::ShearModulus(m) => muscles[m].material.shear_modulus = value,
            Self::Permittivity(m, law) => {
                let electric = &mut muscles[m].material.electric;
                *electric = electric.map(|_| law.constants(value));
            }
            Self::Viscosity(m) => muscles[m].material.viscosity = Some(value),
            Self::Side(m, side) => muscles[m].cross_section[side] = value,
            Self::Layer(m) => muscles[m].layer_thickness = value,
            Self::End(m, 0, axis) => muscles[m].from.at[axis] = value,
            Self::End(m, _, axis) => muscles[m].to.at[axis] = value,
            Self::SpringStiffness(s) => springs[s].stiffness = Some(value),
            Self::SpringDamping(s) => springs[s].damping = Some(value),
            Self::SpringLength(s) => springs[s].rest_length = value,
            Self::JointDamping(j) => system.joints[j].damping = Some(value),
            Self::PeakVoltage => {}
        }
    }

    /// Its unit in the International System.
    pub fn unit(self, system: &System) -> SiUnit {
        let (symbol, factor) = match self {
            Self::ShearModulus(_) => ("Pa", 1e6),
            Self::Permittivity(..) => ("", 1.0),
            Self::Viscosity(_) => ("Pa s", 1e3),
            Self::Side(..) | Self::Layer(_) | Self::End(..) | Self::SpringLength(_) => ("m", 1e-3),
            Self::PeakVoltage => ("V", 1.0),
            Self::SpringStiffness(_) => ("N/m", 1e3),
            Self::SpringDamping(_) => ("N s/m", 1.0),
            Self::JointDamping(j) => match system.joints[j].kind {
                JointKind::Revolute { .. } => ("N m s/rad", 1e-6),
                _ => ("N s/m", 1.0),
            },
        };
        SiUnit { symbol, factor }
    }

    /// The component, side, end or axis that the system does not have.
    fn missing(self, system: &System) -> Option<String> {
        let [muscles, springs, joints] = [
            system.muscles.len(),
            system.components.springs.len(),
            system.joints.len(),
        ];
        let (what, index, count) = match self {
            Self::Side(_, side) if side >= 2 => ("side", side, 2),
            Self::End(_, end, _) if end >= 2 => ("end", end, 2),
            Self::End(.., axis) if axis >= 3 => ("axis", axis, 3),
            Self::SpringStiffness(s) | Self::SpringDamping(s) | Self::SpringLength(s) => {
                ("spring", s, springs)
            }
            Self::JointDamping(j) => ("joint", j, joints),
            Self::PeakVoltage => return None,
            other => ("muscle", other.muscle().unwrap_or(0), muscles),
        };
        (index >= count).then(|| format!("there is no {what} {index}, only {count}"))
    }

    /// Returns the reason why it cannot be sought, if there is one.
    fn obstacle(self, system: &System) -> Option<String> {
        if let Some(missing) = self.missing(system) {
            return Some(missing);
        }
        if let Some(muscle) = self.muscle().map(|m| &system.muscles[m]) {
            let name = &muscle.name;
            if muscle.fidelity != Fidelity::Lumped {
                return Some(format!(
                    "muscle \"{name}\" of finite elements reads it; of muscles, lumped ones alone can have sought constants"
                ));
            }
            if muscle.material.law.is_some() && !matches!(self, Self::Viscosity(_)) {
                return Some(format!(
                    "muscle \"{name}\" has a law of elasticity other than the neo-Hookean one; of its constants, the viscosity alone can be sought"
                ));
            }
            if self.is_shape() && !muscle.material.maxwell.list().is_empty() {
                return Some(format!(
                    "the Maxwell branches of muscle \"{name}\" depend on it; sought shapes of muscles with branches are not offered"
                ));
            }
            let is_electric = matches!(self, Self::Permittivity(..) | Self::Layer(_));
            let is_charged = self.muscle().is_some_and(|m| !system.has_source_voltage(m));
            if (self.is_shape() || is_electric) && is_charged {
                return Some(format!(
                    "the charge of muscle \"{name}\" depends on it; sought capacitances of muscles with a circuit or a given charge are not offered"
                ));
            }
            if self.is_shape() && muscle.mass().is_some() {
                return Some(format!(
                    "the mass of muscle \"{name}\" depends on it, as its material has a density; sought masses are not offered"
                ));
            }
        }
        let lacks = |what: &str| Some(format!("{what}, which the scene has to name"));
        let material = |muscle: usize| &system.muscles[muscle].material;
        match self {
            Self::Permittivity(m, _) if material(m).electric.is_none() => {
                lacks("the muscle has no electric constants")
            }
            Self::Viscosity(m) if material(m).viscosity.is_none() => {
                lacks("the muscle has no viscosity")
            }
            Self::SpringStiffness(s) if system.components.springs[s].stiffness.is_none() => {
                lacks("the spring has no stiffness")
            }
            Self::SpringLength(s) if system.components.springs[s].stiffness.is_none() => {
                lacks("the spring has no stiffness")
            }
            Self::SpringDamping(s) if system.components.springs[s].damping.is_none() => {
                lacks("the spring has no damping")
            }
            Self::JointDamping(j) if system.joints[j].damping.is_none() => {
                lacks("the joint has no damping")
            }
            _ => None,
        }
    }
}

impl Parameter {
    /// Puts a value of the parameter in the place of its constants.
    pub fn put(&self, value: f64, system: &mut System) {
        for follower in &self.constants {
            let value = follower.offset + follower.factor * value;
            follower.constant.put(value, system);
        }
    }

    /// Its unit in the International System.
    pub fn unit(&self, system: &System) -> SiUnit {
        let first = self.constants.first();
        first.map_or(
            SiUnit {
                symbol: "",
                factor: 1.0,
            },
            |first| first.constant.unit(system),
        )
    }

    /// Returns the result for the parameter at a value.
    pub fn found(&self, value: f64, system: &System) -> FoundParameter {
        let near = |bound: f64| (value - bound).abs() <= AT_BOUND * self.size();
        FoundParameter {
            name: self.name.clone(),
            value,
            unit: self.unit(system),
            is_at_bound: near(self.lower) || near(self.upper),
        }
    }
}

/// The system with values of parameters put in.
#[must_use]
pub fn with_parameters(system: &System, parameters: &[Parameter], values: &[f64]) -> System {
    let mut system = system.clone();
    for (parameter, &value) in parameters.iter().zip(values) {
        parameter.put(value, &mut system);
    }
    system
}

/// A parameter that cannot be sought, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct NotSought {
    /// Index of the parameter.
    pub parameter: usize,
    /// Reason.
    pub reason: String,
}

impl fmt::Display for NotSought {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

/// Returns the reason why a parameter cannot be sought, if there is one.
///
/// # Errors
/// A constant cannot be sought, follows two parameters, loses its meaning within the bounds, or the guess lies outside them.
pub fn check(system: &System, parameters: &[Parameter]) -> Result<(), NotSought> {
    for (index, parameter) in parameters.iter().enumerate() {
        let not = |reason: String| {
            Err(NotSought {
                parameter: index,
                reason,
            })
        };
        let Parameter {
            constants,
            lower,
            upper,
            guess,
            ..
        } = parameter;
        if constants.is_empty() {
            return not("it is no constant of a component".to_owned());
        }
        let is_within = lower < upper && lower <= guess && guess <= upper;
        if !is_within || !guess.is_finite() {
            return not(format!(
                "a guess of {guess} is not within the bounds {lower} and {upper}"
            ));
        }
        if parameters[..index]
            .iter()
            .any(|other| other.name == parameter.name)
        {
            return not("another parameter has the same name".to_owned());
        }
        for (place, follower) in constants.iter().enumerate() {
            let Follower {
                constant,
                factor,
                offset,
            } = *follower;
            if let Some(reason) = constant.obstacle(system) {
                return not(reason);
            }
            let least = offset + (factor * lower).min(factor * upper);
            if constant.is_positive() && (least <= 0.0 || least.is_nan()) {
                return not("its bounds have to be positive".to_owned());
            }
            if matches!(constant, Constant::JointDamping(_)) && offset != 0.0 {
                return not("a damping of a joint follows without an offset".to_owned());
            }
            let before = parameters[..index].iter().flat_map(|p| &p.constants);
            let mut others = before.chain(&constants[..place]);
            if others.any(|other| other.constant == constant) {
                return not("another parameter is the same constant".to_owned());
            }
        }
    }
    for (m, muscle) in system.muscles.iter().enumerate() {
        let moving = (0..parameters.len()).filter(|&p| parameters[p].moves(m));
        if let Some(parameter) = moving.clone().nth(MOST_MOVES) {
            let reason = format!(
                "{} parameters move the ends of muscle \"{}\"; no more than {MOST_MOVES} are offered",
                moving.count(),
                muscle.name
            );
            return Err(NotSought { parameter, reason });
        }
    }
    Ok(())
}
