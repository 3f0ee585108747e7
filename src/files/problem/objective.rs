//! The objective of a control problem.

use crate::control::problem::{EnergyCost, Objective, SourceEnergy};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::problem::quantities::keys::{FinalSpec, TrackSpec, at_the_end, track};
use crate::files::problem::quantities::muscle::amount_costs;

read_objects! {
    /// Weights of the objective.
    pub struct ObjectiveSpec {
        /// Weight of Σ h |V_k|², V in kV, h in s.
        pub effort?: f64,
        /// Weight of Σ |V_k − V_{k−1}|²/h, V in kV, h in s, with the rest voltages of start and goal at the ends.
        pub rate?: f64,
        /// Weight of the final time in s.
        pub duration?: f64,
        /// Weight of the square of the peak voltage in kV: of the largest voltage of all sources that are sought, in all intervals.
        pub peak_voltage?: f64,
        /// Weight per J of the electrical energy from the sources of lumped muscles, of all sources or of named ones; what flows back is negative.
        pub electrical_energy?: EnergySpec,
        /// Weight per J of the mechanical work of the electrical forces of lumped muscles, of all sources or of named ones.
        pub mechanical_work?: EnergySpec,
        /// Weight per cm³ of the volume of all lumped muscles at rest, which follows from free parameters.
        pub muscle_volume?: f64,
        /// Weight per g of the mass of all lumped muscles with a density, which follows from free parameters.
        pub muscle_mass?: f64,
        /// References of markers and joints in time.
        pub track?: Vec<TrackSpec>,
        /// Targets of markers and joints at the end.
        #[serde(rename = "final")]
        pub at_the_end?: Vec<FinalSpec>,
    }

    /// The weight of an energy of some sources.
    pub struct SourceEnergySpec {
        /// Weight per J.
        pub weight: f64,
        /// Names of lumped muscles.
        pub sources: Vec<String>,
    }

    /// The weight of an energy of all sources, or of those that are named.
    pub either EnergySpec("a weight, or an object with \"weight\" and \"sources\"") {
        /// Of all sources, per J.
        All: f64,
        /// Of those that are named.
        Named: SourceEnergySpec,
    }
}

impl Default for EnergySpec {
    fn default() -> Self {
        Self::All(0.0)
    }
}

pub(crate) fn objective(spec: &ObjectiveSpec, at: &At<'_>) -> Result<Objective> {
    let weights = [
        ("effort", spec.effort),
        ("rate", spec.rate),
        ("duration", spec.duration),
        ("peak_voltage", spec.peak_voltage),
        ("muscle_volume", spec.muscle_volume),
        ("muscle_mass", spec.muscle_mass),
    ];
    for (key, weight) in weights {
        at.key(key).weight(weight)?;
    }
    let along: Vec<_> = at.key("track").each(&spec.track, track)?;
    let ends: Vec<_> = at.key("final").each(&spec.at_the_end, at_the_end)?;
    let mut quantities = [along, ends].concat().concat();
    quantities.extend(amount_costs([spec.muscle_volume, spec.muscle_mass], at)?);
    let (electrical, mechanical) = (&spec.electrical_energy, &spec.mechanical_work);
    let place = at.key("electrical_energy");
    let mut of_sources = energies(electrical, SourceEnergy::Electrical, &place)?;
    let place = at.key("mechanical_work");
    of_sources.extend(energies(mechanical, SourceEnergy::Mechanical, &place)?);
    let is_any = !quantities.is_empty() || !of_sources.is_empty();
    refuse!(if !is_any && weights.iter().all(|(_, weight)| *weight == 0.0), at;
        found "no weight",
        expected "a positive weight of \"effort\", \"rate\", \"duration\", \"peak_voltage\", \"muscle_volume\", \"muscle_mass\", \"electrical_energy\" or \"mechanical_work\", or something to \"track\" or a \"final\" place");
    Ok(Objective {
        effort: spec.effort,
        rate: spec.rate,
        duration: spec.duration,
        quantities,
        energies: of_sources,
    })
}

/// Names that an energy may have, for messages: the charge of an electrode of finite elements is not known at instants.
const LUMPED: &str =
    "lumped muscles: all sources, or those that \"sources\" names beside the \"weight\"";

/// The costs that one weight stands for; none where it is zero.
fn energies(spec: &EnergySpec, energy: SourceEnergy, at: &At<'_>) -> Result<Vec<EnergyCost>> {
    let cost = |source: usize, weight: f64, place: &At<'_>| {
        let cost = EnergyCost {
            source,
            energy,
            weight,
        };
        let muscle = at.system.muscles.get(source);
        let what = match muscle.and_then(|muscle| muscle.circuit) {
            Some(circuit) if circuit.resistance.is_none() => "leaks and has no resistor",
            Some(_) => "has a resistor",
            None => "drives finite elements",
        };
        let found = || format!("{:?}, which {what}", at.sources[source].name);
        refuse!(if !cost.exists(at.system), place; found found(), expected LUMPED);
        Ok(cost)
    };
    match spec {
        EnergySpec::All(weight) => {
            let weight = at.weight(*weight)?;
            let takes = |s: &usize| at.sources[*s].takes_voltage && weight > 0.0;
            let all = (0..at.sources.len()).filter(takes);
            all.map(|source| cost(source, weight, at)).collect()
        }
        EnergySpec::Named(spec) => {
            let weight = at.key("weight").weight(spec.weight)?;
            let list = at.key("sources");
            refuse!(if spec.sources.is_empty(), list;
                found "no source", expected "one source or more");
            let mut costs: Vec<EnergyCost> = Vec::new();
            for (index, name) in spec.sources.iter().enumerate() {
                let place = list.index(index);
                let source = place.driven(name)?;
                refuse!(if costs.iter().any(|cost| cost.source == source), place;
                    found format!("{name:?} again"), expected "each source once");
                costs.push(cost(source, weight, &place)?);
            }
            costs.retain(|cost| cost.weight > 0.0);
            Ok(costs)
        }
    }
}
