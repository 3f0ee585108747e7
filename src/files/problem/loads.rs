//! Loads of a problem: sizes over time, bounds of those that are sought, and loads at rest.

use crate::control::problem::{BoundaryState, Duration, Voltages};
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::problem::state::{StartSpec, start_state};
use crate::files::problem::voltages::{VoltagesSpec, over_time};
use crate::files::scene::names::names;
use crate::files::signal::{SignalSpec, signal};
use crate::files::units::quantity::{
    Charge, ChargeDensity, Force, ForceDensity, Kind, LoadSize, Quantity, Stress, Torque, Voltage,
};
use crate::math::Signal;
use crate::model::system::InputKind;
use std::collections::BTreeMap;

/// Loads by name, constant or functions of time.
pub(crate) type LoadMap = BTreeMap<String, SignalSpec<LoadSize>>;

/// Bounds of loads by name.
pub(crate) type LoadBounds = BTreeMap<String, [Quantity<LoadSize>; 2]>;

/// Index and unit of a load.
fn find(name: &str, at: &At<'_>) -> Result<(usize, Kind)> {
    let first = at.system.first_load();
    let loads = names(&at.sources[first..], |source| &source.name);
    let index = at.find(name, &loads, "the name of a load")?;
    let kind = match at.sources[first + index].kind {
        InputKind::Voltage => Voltage::kind(),
        InputKind::Force => Force::kind(),
        InputKind::Torque => Torque::kind(),
        InputKind::Traction => Stress::kind(),
        InputKind::BodyForce => ForceDensity::kind(),
        InputKind::SurfaceCharge => ChargeDensity::kind(),
        InputKind::Charge => Charge::kind(),
    };
    Ok((first + index, kind))
}

/// Loads over time, by source.
pub(crate) fn loads(map: &LoadMap, at: &At<'_>) -> Result<BTreeMap<usize, Signal>> {
    at.each_named(map, |name, spec, at| {
        let (source, kind) = find(name, at)?;
        Ok((source, signal(spec, &kind, at)?))
    })
}

/// Bounds of the loads that are sought, by source; none of them is `given`.
pub(crate) fn load_bounds(
    map: &LoadBounds,
    given: &BTreeMap<usize, Signal>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, [f64; 2]>> {
    at.each_named(map, |name, written, at| {
        let (source, kind) = find(name, at)?;
        refuse!(if given.contains_key(&source), at;
            found format!("{name:?}, which \"loads\" gives"), expected "a load that is sought");
        let value = |index: usize| at.index(index).value_as(&written[index], &kind);
        let bounds = [value(0)?, value(1)?];
        refuse!(if bounds[0] > bounds[1], at.index(1);
            found written[1],
            expected format!("an upper bound that is no less than the lower bound {}", written[0]));
        Ok((source, bounds))
    })
}

/// Puts the loads of a time in ms on a state of rest.
pub(crate) fn load(state: &mut BoundaryState, loads: &BTreeMap<usize, Signal>, time: f64) {
    let row = match state {
        BoundaryState::RestAtVoltages(row, _) => row,
        BoundaryState::Markers {
            hold: Some(row), ..
        } => row,
        _ => return,
    };
    for (&source, signal) in loads {
        row[source] = signal.at(time);
    }
}

/// Refuses loads under which a goal rests at one free duration and not at another.
pub(crate) fn check_end(
    loads: &BTreeMap<usize, Signal>,
    goal: &BoundaryState,
    duration: Duration,
    at: &At<'_>,
) -> Result<()> {
    let changes = |(_, load): &(&usize, &Signal)| duration.final_value(load).is_none();
    let mut changing = loads.iter().filter(|_| goal.voltages().is_some());
    refuse!(if let Some((&source, _)) = changing.find(changes), at.key(&at.sources[source].name);
        found "a load that still changes between the bounds of the free duration, while the goal rests under it",
        expected "one that is constant from the lower bound on, another goal, or a given duration");
    Ok(())
}

/// Start and inputs of a motion under given ones: at rest in the reference configuration where no start is written.
pub(crate) fn driven(
    start: Option<&StartSpec>,
    voltages: &VoltagesSpec,
    loads: &LoadMap,
    at: &At<'_>,
) -> Result<(BoundaryState, Voltages)> {
    let mut start = match start {
        Some(start) => start_state(start, &at.key("start"))?,
        None => BoundaryState::at_joints(BTreeMap::new()),
    };
    let voltages = over_time(voltages, &at.key("voltages"))?;
    let loads = self::loads(loads, &at.key("loads"))?;
    load(&mut start, &loads, 0.0);
    Ok((start, voltages.with(loads)))
}
