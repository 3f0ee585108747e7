//! Conversion of costs of tensions, fields, currents, powers and rates in a problem file to costs of quantities.

use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::limits::lumped_muscles;
use crate::files::problem::source_limits::{Chosen, measured};
use crate::files::problem::spec_measured::{
    CurrentCostSpec, FieldCostSpec, JointRateCostSpec, MarkerSpeedCostSpec, PowerCostSpec,
    TensionCostSpec,
};
use crate::files::problem::state::{
    ELECTRIC_KEYS, joint_value, joint_with_coordinate, moving_marker,
};
use crate::files::units::quantity::{AngularVelocity, Velocity};
use crate::math::Signal;
use crate::model::system::{Muscle, System};
use crate::model::{MILLIAMPERE, Quantity};

/// A cost of a measured quantity as it is written.
#[derive(Clone, Copy, Debug)]
pub(super) enum Measured<'a> {
    Tension(&'a TensionCostSpec),
    Field(&'a FieldCostSpec),
    Current(&'a CurrentCostSpec),
    Power(&'a PowerCostSpec),
    JointRate(&'a JointRateCostSpec),
    MarkerSpeed(&'a MarkerSpeedCostSpec),
}

/// Quantities of which a cost is written, with the value that each is to have; those that are squares have none.
type Asked = Vec<(Quantity, Option<f64>)>;

impl Measured<'_> {
    /// The costs that it stands for.
    pub(super) fn costs(
        self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>, SceneError> {
        let weight = match self.weight().unwrap_or(1.0) {
            weight if weight > 0.0 => weight,
            weight => {
                let place = scope.key("weight");
                return Err(place.wrong(weight.to_string(), "a positive weight"));
            }
        };
        let cost = |(quantity, at): (Quantity, Option<f64>)| QuantityCost {
            quantity,
            weight,
            function: match at {
                Some(at) => CostFunction::Square {
                    reference: Signal::Constant(at),
                },
                None => CostFunction::Itself,
            },
            during,
        };
        Ok(self.asked(system, scope)?.into_iter().map(cost).collect())
    }

    fn weight(self) -> Option<f64> {
        match self {
            Self::Tension(spec) => spec.weight,
            Self::Field(spec) => spec.weight,
            Self::Current(spec) => spec.weight,
            Self::Power(spec) => spec.weight,
            Self::JointRate(spec) => spec.weight,
            Self::MarkerSpeed(spec) => spec.weight,
        }
    }

    fn asked(self, system: &System, scope: &Scope<'_>) -> Result<Asked, SceneError> {
        Ok(match self {
            Self::Tension(spec) => {
                let at = spec.at.as_ref().map_or(0.0, |at| at.value());
                let muscles = lumped_muscles((&spec.muscle, spec.muscles), system, scope)?;
                let tension = |muscle| (Quantity::tension(muscle), Some(at));
                muscles.into_iter().map(tension).collect()
            }
            Self::Field(spec) => fields(spec, system, scope)?,
            Self::Current(spec) => {
                let at = spec.at.as_ref().map_or(0.0, |at| at.value() / MILLIAMPERE);
                let muscles = behind_resistors((&spec.source, spec.sources), system, scope)?;
                let current = |muscle| (Quantity::current(muscle), Some(at));
                muscles.into_iter().map(current).collect()
            }
            Self::Power(spec) => {
                let at = spec.at.as_ref().map_or(0.0, |at| at.value());
                let muscles = behind_resistors((&spec.source, spec.sources), system, scope)?;
                let power = |muscle| (Quantity::power(muscle), Some(at));
                muscles.into_iter().map(power).collect()
            }
            Self::JointRate(spec) => {
                let joint = joint_with_coordinate(&spec.joint, system, &scope.key("joint"))?;
                let kinds = [AngularVelocity::kind(), Velocity::kind()];
                let at = spec.at.as_ref().map_or(Ok(0.0), |at| {
                    joint_value(at, &kinds, joint, system, &scope.key("at"))
                })?;
                let quantity = Quantity::joint_rate(joint);
                let factor = quantity.rate_factor(system).unwrap_or(1.0);
                vec![(quantity, Some(factor * at))]
            }
            Self::MarkerSpeed(spec) => {
                let marker = moving_marker(&spec.marker, system, &scope.key("marker"))?;
                vec![(Quantity::squared_speed(marker), None)]
            }
        })
    }
}

/// Squared fields of one muscle or of all.
fn fields(spec: &FieldCostSpec, system: &System, scope: &Scope<'_>) -> Result<Asked, SceneError> {
    let mut muscles = lumped_muscles((&spec.muscle, spec.muscles), system, scope)?;
    muscles.retain(|&muscle| system.muscles[muscle].material.electric.is_some());
    if muscles.is_empty() {
        let (key, found) = match &spec.muscle {
            Some(name) => (
                "muscle",
                format!("{name:?}, whose material has no electric term"),
            ),
            None => ("muscles", "nothing that a field reaches".to_owned()),
        };
        let expected = format!("a muscle of {ELECTRIC_KEYS}");
        return Err(scope.key(key).wrong(found, expected));
    }
    let field = |muscle: usize| {
        Quantity::squared_field(muscle, system.muscles[muscle].is_behind_resistor())
    };
    Ok(muscles.into_iter().map(|m| (field(m), None)).collect())
}

/// Muscles whose sources are behind a resistor.
fn behind_resistors(
    of: Chosen<'_>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<usize>, SceneError> {
    let key = if of.0.is_some() { "source" } else { "sources" };
    let muscles = measured(of, system, scope)?;
    let jumps = |&&muscle: &&usize| !Muscle::is_behind_resistor(&system.muscles[muscle]);
    match muscles.iter().find(jumps) {
        None => Ok(muscles),
        Some(&muscle) => {
            let name = &system.muscles[muscle].name;
            let found =
                format!("{name:?}, without a resistor: its voltage jumps between intervals");
            let expected = "a muscle with a \"resistance\" in its \"circuit\"; otherwise \"rate\", \"electrical_energy\" or a limit";
            Err(scope.key(key).wrong(found, expected))
        }
    }
}
