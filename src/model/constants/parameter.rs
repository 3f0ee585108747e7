//! Free parameters in a system: their values put in the places of their constants, and the cases in which none can be free.

use crate::model::constants::constant::{Constant, Follower, FoundParameter, Parameter, SiUnit};
use crate::model::presolve::graph::Graph;
use crate::model::system::{Fidelity, Muscle, System};
use std::fmt;

/// A value this near to a bound, relative to the size of the parameter, lies at it.
const AT_BOUND: f64 = 1e-6;

/// Parts of a system that read places of bodies otherwise than as points that a parameter can move, in words.
fn moved_otherwise(system: &System) -> Option<&'static str> {
    let of_elements = |muscle: &Muscle| muscle.fidelity != Fidelity::Lumped;
    let components = &system.components;
    let list = [
        (!system.solids.is_empty(), "elastic blocks"),
        (
            system.muscles.iter().any(of_elements),
            "muscles of finite elements",
        ),
        (!components.contacts.is_empty(), "contacts"),
        (!components.others.is_empty(), "components of other kinds"),
        (
            !Graph::new(system).loops().is_empty(),
            "joints that close a loop",
        ),
    ];
    list.into_iter()
        .find_map(|(is_there, what)| is_there.then_some(what))
}

impl Constant {
    /// Returns the reason why it cannot be free, if there is one.
    fn obstacle(self, system: &mut System) -> Option<String> {
        if let Some(missing) = self.missing(system) {
            return Some(missing);
        }
        if !self.is_named(system) {
            return Some(format!("{}, which the scene has to name", self.lacking()));
        }
        let muscle = &system.muscles[self.muscle()?];
        let reason = match (muscle.fidelity, self) {
            (Fidelity::Lumped, _) => return None,
            (_, Self::Material(_, constant)) => {
                let is_read = constant.is_elastic() && muscle.prestretch.is_some();
                is_read.then_some("its stretches across the prestretch depend on it")?
            }
            _ => "sought shapes of finite elements are not offered",
        };
        let name = &muscle.name;
        Some(format!(
            "muscle \"{name}\" of finite elements has it; {reason}"
        ))
    }
}

impl Parameter {
    /// Puts a value of the parameter in the place of its constants.
    pub fn put(&self, value: f64, system: &mut System) {
        for follower in &self.constants {
            follower.constant.set(follower.at(value), system);
        }
    }

    /// Its unit in the International System.
    pub fn unit(&self, system: &System) -> SiUnit {
        unit(&self.constants, system)
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

/// Unit in the International System of what constants follow: that of the first one, where it is that constant itself.
pub fn unit(followers: &[Follower], system: &System) -> SiUnit {
    let is_itself = |first: &&Follower| first.factor.abs() == 1.0 && first.is_linear();
    let first = followers.first().filter(is_itself);
    let other = SiUnit {
        symbol: "",
        factor: 1.0,
    };
    first.map_or(other, |first| first.constant.unit(system))
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

/// A parameter that cannot be free, and why.
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

/// Returns the reason why a parameter cannot be free, if there is one.
///
/// # Errors
/// A constant cannot be free, follows two parameters, loses its meaning within the bounds, or the guess lies outside them.
pub fn check(system: &System, parameters: &[Parameter]) -> Result<(), NotSought> {
    if parameters.is_empty() {
        return Ok(());
    }
    // Places of constants are those of a system that can be changed.
    let system = &mut system.clone();
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
        let moves_places = constants.iter().any(|one| one.constant.is_place());
        if let Some(other) = moves_places.then(|| moved_otherwise(system)).flatten() {
            return not(format!(
                "sought places of bodies, joints and markers are not offered beside {other}"
            ));
        }
        for (place, follower) in constants.iter().enumerate() {
            let constant = follower.constant;
            if let Some(reason) = constant.obstacle(system) {
                return not(reason);
            }
            if constant.is_point() && !follower.is_linear() {
                return not("a place that is not linear in it depends on it".to_owned());
            }
            let least = follower.at(*lower).min(follower.at(*upper));
            if constant.is_positive() && (least <= 0.0 || least.is_nan()) {
                return not("its bounds have to be positive".to_owned());
            }
            let follows = |list: &[Follower]| list.iter().any(|one| one.constant == constant);
            let mut before = parameters[..index].iter();
            let other = before.find(|other| follows(&other.constants));
            let own = follows(&constants[..place]).then_some(&parameters[index]);
            if let Some(Parameter { name, .. }) = other.or(own) {
                return not(format!("\"{name}\" changes the same constant"));
            }
        }
    }
    Ok(())
}
