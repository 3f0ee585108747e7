//! Inputs of a problem: voltages and loads, given over time or sought between bounds.
//!
//! Voltages over time are written by the names of sources, as those of an earlier `solution.json`, or as a table.

use crate::control::problem::{Afterwards, BoundaryState, Duration, TableEnd, Voltages};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::{At, VoltageMap};
use crate::files::problem::state::{StartSpec, start_state};
use crate::files::scene::names::names;
use crate::files::signal::{SignalSpec, signal};
use crate::files::solution::record;
use crate::files::units::quantity::{Kind, LoadSize, Quantity, Time, Voltage};
use crate::math::{Signal, shortest};
use crate::model::system::System;
use schemars::JsonSchema;
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// Expected value of a path to an earlier result.
pub(crate) const SOLUTION_PATH: &str =
    "the path of a solution.json, or of the folder that holds it";

/// Voltages over time by the names of sources, by source.
fn by_source(
    map: &BTreeMap<String, SignalSpec<Voltage>>,
    at: &At<'_>,
) -> Result<BTreeMap<usize, Signal>> {
    at.each_named(map, |name, spec, at| {
        Ok((at.driven(name)?, signal(spec, &Voltage::kind(), at)?))
    })
}

/// Voltages that are given, source by source or all of them over time.
pub(crate) fn given_voltages(
    spec: &VoltagesSpec,
    duration: Duration,
    at: &At<'_>,
) -> Result<(BTreeMap<usize, Signal>, Option<Voltages>)> {
    if let VoltagesSpec::Signals(map) = spec {
        return Ok((by_source(map, at)?, None));
    }
    let course = over_time(spec, at)?;
    let jumps = course.table.is_some();
    refuse!(if jumps && matches!(duration, Duration::Free { .. }), at;
        found "voltages that jump from interval to interval where the duration is free",
        expected "functions of time by the names of sources, or a given duration");
    Ok((BTreeMap::new(), Some(course)))
}

/// Bounds of voltages; needed where one is sought.
pub(crate) fn voltage_bounds(
    written: &Option<[Quantity<Voltage>; 2]>,
    is_needed: bool,
    at: &At<'_>,
) -> Result<[f64; 2]> {
    let Some([lower, upper]) = written else {
        refuse!(if is_needed, at;
            found "no key \"voltage_bounds\"", expected "the bounds of the voltages that are sought");
        return Ok([0.0; 2]);
    };
    let at = at.key("voltage_bounds");
    let bounds = [lower.value(), upper.value()];
    refuse!(if bounds[0] < 0.0, at.index(0);
        found lower, expected "a voltage that is not negative");
    refuse!(if bounds[0] > bounds[1], at.index(1);
        found upper,
        expected format!("an upper bound that is no less than the lower bound {lower}"));
    Ok(bounds)
}

/// Rest voltages of sources that are sought lie in the bounds.
pub(crate) fn check_rest_voltages(
    state: &BoundaryState,
    is_given: impl Fn(usize) -> bool,
    [lower, upper]: [f64; 2],
    at: &At<'_>,
) -> Result<()> {
    let BoundaryState::RestAtVoltages(voltages, _) = state else {
        return Ok(());
    };
    for (s, (source, &voltage)) in at.sources.iter().zip(voltages).enumerate() {
        let outside = voltage < lower || voltage > upper;
        let is_sought = source.takes_voltage && !is_given(s);
        refuse!(if is_sought && outside, at.key("rest_at_voltages").key(&source.name);
            found format!("{} V", shortest(voltage, 9)),
            expected format!("a voltage within the bounds {lower} V to {upper} V"));
    }
    Ok(())
}

/// Voltages of a simulation.
pub(crate) fn over_time(spec: &VoltagesSpec, at: &At<'_>) -> Result<Voltages> {
    match spec {
        VoltagesSpec::Signals(map) => {
            let none = Voltages::constant(&vec![0.0; at.sources.len()]);
            Ok(none.with(by_source(map, at)?))
        }
        VoltagesSpec::Solution(solution) => {
            let place = at.key("solution");
            let path = place.solution_file(&solution.solution, SOLUTION_PATH)?;
            of_solution(&path, at.system)
        }
        VoltagesSpec::Table(table) => of_table(table, at),
    }
}

/// Voltages of a solution, then those that hold its goal, or where it names none the last ones; 0 for sources that it does
/// not know.
fn of_solution(path: &Path, system: &System) -> Result<Voltages> {
    let is_wanted = |name: &str| name == "time" || name.starts_with("voltages/");
    let (document, solution) = record(path, is_wanted)?;
    let at = At::new(&Scope::of(&document), system);
    let instants = solution.times(&at)?;
    let voltages = solution
        .voltages
        .ok_or_else(|| at.missing_key("voltages"))?;
    let all_series = voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().copied()));
    let rows = by_interval(&instants, all_series, &at)?;
    let hold = at.optional("hold", &solution.hold, |at, hold| {
        let mut row = vec![0.0; at.sources.len()];
        for (name, &voltage) in hold {
            row[at.key(name).driven(name)?] = voltage;
        }
        Ok(row)
    })?;
    Ok(in_steps(&instants, rows, hold, Some(path.to_owned())))
}

/// Voltages of a table, then those that it says are held, or the last ones; 0 for sources that it does not name.
fn of_table(table: &TableSpec, at: &At<'_>) -> Result<Voltages> {
    let instants: Vec<f64> = table.time.iter().map(|time| time.value()).collect();
    let all_series = table.voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().map(Quantity::value)));
    let rows = by_interval(&instants, all_series, at)?;
    refuse!(if instants[0] != 0.0, at.key("time").index(0);
        found format!("{} s", instants[0] / 1e3), expected "0");
    let hold = at.optional("hold", &table.hold, At::voltages)?;
    Ok(in_steps(&instants, rows, hold, None))
}

/// Voltages of each source in the intervals between instants in ms, and afterwards those of the last one.
fn by_interval<'a>(
    instants: &[f64],
    all_series: impl Iterator<Item = (&'a String, impl ExactSizeIterator<Item = f64>)>,
    at: &At<'_>,
) -> Result<Vec<Vec<f64>>> {
    let place = at.key("time");
    refuse!(if instants.len() < 2, place;
        found format!("{} instants", instants.len()), expected "2 instants or more");
    place.increasing(instants)?;
    let intervals = instants.len() - 1;
    let mut rows = vec![vec![0.0; intervals + 1]; at.sources.len()];
    for (name, series) in all_series {
        let place = at.key("voltages").key(name);
        let source = place.driven(name)?;
        refuse!(if series.len() != intervals, place;
            found format!("{} voltages", series.len()),
            expected format!("{intervals}, one per interval"));
        let row = &mut rows[source];
        row.iter_mut()
            .zip(series)
            .for_each(|(own, voltage)| *own = voltage);
        row[intervals] = row[intervals - 1];
    }
    Ok(rows)
}

/// Voltages of each source in intervals, followed by those that are held.
fn in_steps(
    instants: &[f64],
    mut rows: Vec<Vec<f64>>,
    hold: Option<Vec<f64>>,
    solution: Option<PathBuf>,
) -> Voltages {
    let last = instants.len() - 1;
    let held = rows.iter_mut().zip(hold.iter().flatten());
    held.for_each(|(row, voltage)| row[last] = *voltage);
    let steps = |values| Signal::Steps {
        ends: instants[1..].to_vec(),
        values,
    };
    Voltages {
        signals: rows.into_iter().map(steps).collect(),
        table: Some(TableEnd {
            time: instants[last],
            afterwards: match hold {
                Some(_) => Afterwards::Held,
                None => Afterwards::OfLastInterval,
            },
            solution,
        }),
    }
}

/// Voltages by muscle or driven electrode, constant or functions of time; 0 where not named; `{"solution": path}`, or `{"time": [...], "voltages": {...}}`.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum VoltagesSpec {
    /// Those of a `solution.json`.
    Solution(SolutionSpec),
    /// A table.
    Table(TableSpec),
    /// Constant, or functions of time.
    Signals(BTreeMap<String, SignalSpec<Voltage>>),
}

read_objects! {
    /// A solution by its path.
    pub struct SolutionSpec {
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder.
        pub solution: String,
    }
}

/// Voltages that are constant in intervals of time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Start and end of the intervals, growing, the first of them 0; SI unit s.
    pub time: Box<[Quantity<Time>]>,
    /// A voltage for each interval by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not
    /// named.
    pub voltages: BTreeMap<String, Box<[Quantity<Voltage>]>>,
    /// Voltages after the last interval; those of the last interval where not written.
    #[serde(default)]
    pub hold: Option<VoltageMap>,
}

impl Default for VoltagesSpec {
    fn default() -> Self {
        Self::Signals(BTreeMap::new())
    }
}

impl<'de> Deserialize<'de> for VoltagesSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(VoltagesVisitor)
    }
}

struct VoltagesVisitor;

impl<'de> Visitor<'de> for VoltagesVisitor {
    type Value = VoltagesSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "voltages by name, an object with \"solution\", or one with \"time\" and \"voltages\"",
        )
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<VoltagesSpec, A::Error> {
        let mut signals = BTreeMap::new();
        let (mut solution, mut time, mut voltages, mut hold) = (None, None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "solution" => solution = Some(map.next_value()?),
                "time" => time = Some(map.next_value()?),
                "voltages" => voltages = Some(map.next_value()?),
                "hold" => hold = Some(map.next_value()?),
                _ => drop(signals.insert(key, map.next_value()?)),
            }
        }
        let has_signals = !signals.is_empty();
        match (solution, time, voltages, hold) {
            (None, None, None, None) => Ok(VoltagesSpec::Signals(signals)),
            (Some(solution), None, None, None) if !has_signals => {
                Ok(VoltagesSpec::Solution(SolutionSpec { solution }))
            }
            (None, Some(time), Some(voltages), hold) if !has_signals => {
                Ok(VoltagesSpec::Table(TableSpec {
                    time,
                    voltages,
                    hold,
                }))
            }
            (Some(_), ..) => {
                let found = Unexpected::Other("\"solution\" beside voltages");
                Err(A::Error::invalid_value(found, &self))
            }
            (None, time, voltages, _) => {
                let lacks = match (time, voltages) {
                    (None, _) => "a table without \"time\"",
                    (_, None) => "a table without \"voltages\"",
                    _ => "a table beside voltages by name",
                };
                Err(A::Error::invalid_value(Unexpected::Other(lacks), &self))
            }
        }
    }
}

/// Loads by name, constant or functions of time.
pub(crate) type LoadMap = BTreeMap<String, SignalSpec<LoadSize>>;

/// Bounds of loads by name.
pub(crate) type LoadBounds = BTreeMap<String, [Quantity<LoadSize>; 2]>;

/// Index and unit of a load.
fn find(name: &str, at: &At<'_>) -> Result<(usize, Kind)> {
    let first = at.system.first_load();
    let loads = names(&at.sources[first..], |source| &source.name);
    let index = at.find(name, &loads, "the name of a load")?;
    Ok((first + index, at.kind_of_source(first + index)))
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
