//! The circuit of a muscle as it is written, and its conversion.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::units::quantity::{Quantity, Resistance};
use crate::model::system::{Circuit, Muscle};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Circuit between a source and the electrodes of a muscle or a block: a resistor, a leak or both.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircuitSpec {
    /// Resistance in series, SI unit Ohm; without it the electrodes have the voltage of the source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance: Option<Quantity<Resistance>>,
    /// Resistance of a leak parallel to the electrodes, SI unit Ohm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leakage: Option<Quantity<Resistance>>,
}

/// Resistances of a circuit; `place` is its own.
pub(super) fn parts(spec: &CircuitSpec, place: &Scope<'_>) -> Result<Circuit, SceneError> {
    let part = |key: &str, written: &Option<Quantity<Resistance>>| {
        let part = written.as_ref().map(|part| place.key(key).positive(part));
        part.transpose()
    };
    Ok(Circuit {
        resistance: part("resistance", &spec.resistance)?,
        leakage: part("leakage", &spec.leakage)?,
    })
}

/// The circuit of a muscle.
pub(super) fn circuit(
    spec: Option<&CircuitSpec>,
    muscle: &Muscle,
    scope: &Scope<'_>,
) -> Result<Option<Circuit>, SceneError> {
    let (Some(spec), place) = (spec, scope.key("circuit")) else {
        return Ok(None);
    };
    let circuit = parts(spec, &place)?;
    match circuit.fault(muscle.takes_circuit(), muscle.is_meshed()) {
        Some([found, expected]) => Err(place.wrong(found, expected)),
        None => Ok(Some(circuit)),
    }
}
