//! Start and inputs of a motion under given inputs, of a simulation or of a recording.

use crate::control::problem::{BoundaryState, Voltages};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::loads::{LoadMap, load, with_loads};
use crate::files::problem::spec_states::StartSpec;
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::problem::state::start_state;
use crate::files::problem::voltages::over_time;
use crate::model::system::System;
use std::collections::BTreeMap;

/// Start and inputs of a motion under given ones: at rest in the reference configuration where no start is written.
pub(crate) fn driven(
    start: Option<&StartSpec>,
    (voltages, loads): (&VoltagesSpec, &LoadMap),
    system: &System,
    scope: &Scope<'_>,
) -> Result<(BoundaryState, Voltages), SceneError> {
    let mut start = match start {
        Some(start) => start_state(start, system, &scope.key("start"))?,
        None => BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: Default::default(),
        },
    };
    let voltages = over_time(voltages, system, &scope.key("voltages"))?;
    let (voltages, loads) = with_loads(voltages, loads, system, &scope.key("loads"))?;
    load(&mut start, &loads, 0.0);
    Ok((start, voltages))
}
