//! Conversion of weights of energies in a problem file to costs of sources.

use crate::control::problem::{EnergyCost, SourceEnergy};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_energies::EnergySpec;
use crate::files::problem::state::driven;
use crate::model::system::System;

/// Names that an energy may have, for messages: the charge of an electrode of finite elements is not known at instants.
const LUMPED: &str =
    "lumped muscles: all sources, or those that \"sources\" names beside the \"weight\"";

/// The costs that one weight stands for; none where it is zero.
pub(crate) fn energies(
    spec: &EnergySpec,
    energy: SourceEnergy,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<EnergyCost>, SceneError> {
    let sources = system.sources();
    let cost = |source: usize, weight: f64, place: &Scope<'_>| {
        let cost = EnergyCost {
            source,
            energy,
            weight,
        };
        let muscle = system.muscles.get(source);
        let what = match muscle.and_then(|muscle| muscle.circuit) {
            Some(circuit) if circuit.resistance.is_none() => "leaks and has no resistor",
            Some(_) => "has a resistor",
            None => "drives finite elements",
        };
        let found = || format!("{:?}, which {what}", sources[source].name);
        match cost.exists(system) {
            true => Ok(cost),
            false => Err(place.wrong(found(), LUMPED)),
        }
    };
    match spec {
        EnergySpec::All(weight) => {
            let weight = scope.weight(*weight)?;
            let takes = |s: &usize| sources[*s].takes_voltage && weight > 0.0;
            let all = (0..sources.len()).filter(takes);
            all.map(|source| cost(source, weight, scope)).collect()
        }
        EnergySpec::Named(spec) => {
            let weight = scope.key("weight").weight(spec.weight)?;
            let list = scope.key("sources");
            if spec.sources.is_empty() {
                return Err(list.wrong("no source", "one source or more"));
            }
            let mut costs: Vec<EnergyCost> = Vec::new();
            for (index, name) in spec.sources.iter().enumerate() {
                let place = list.index(index);
                let source = driven(name, &sources, &place)?;
                if costs.iter().any(|cost| cost.source == source) {
                    return Err(place.wrong(format!("{name:?} again"), "each source once"));
                }
                costs.push(cost(source, weight, &place)?);
            }
            costs.retain(|cost| cost.weight > 0.0);
            Ok(costs)
        }
    }
}
