//! Starts that were sought, as joint coordinates and their rates.

use crate::control::problem::{Identification, SoughtStart};
use crate::dynamics::{observations, simulate};
use crate::identify::error::IdentifyError;
use crate::identify::refine::Identified;
use crate::identify::setup::Setup;
use crate::model::{System, joint_unit};
use std::ops::ControlFlow;

/// The start of a recording that was sought.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundStart {
    /// Index of the recording.
    pub recording: usize,
    /// Joints that have one coordinate: index, coordinate in rad or mm, and its rate in rad/ms or mm/ms.
    pub joints: Vec<(usize, f64, f64)>,
}

/// The starts of all recordings that were fitted with theirs.
///
/// # Errors
/// A recording cannot be simulated.
pub fn found_starts(
    system: &System,
    task: &Identification,
    found: &Identified,
) -> Result<Vec<FoundStart>, IdentifyError> {
    let is_sought = |&&r: &&usize| task.recordings[r].sought_start != SoughtStart::Nothing;
    let of = |&recording: &usize| FoundStart::new(system, task, (found, recording));
    found.fitted.iter().filter(is_sought).map(of).collect()
}

impl FoundStart {
    fn new(
        system: &System,
        task: &Identification,
        (found, index): (&Identified, usize),
    ) -> Result<Self, IdentifyError> {
        let recording = &task.recordings[index];
        let intervals = 2.0 * found.grid.intervals[index] as f64;
        let grid = [recording.duration(), intervals];
        let setup = Setup::new(system, task, recording, found.fit.of_constants(), grid)?;
        let (start, _) = setup.start((0, found.fit.unknowns.of_start(index)))?;
        let model = &setup.model;
        let scalars = |from: f64, to: f64| model.scalars(&setup.inputs.within(from, to));
        // Tables tell a state at its instant.
        let h = recording.duration() / intervals;
        let (first, _) = simulate(model, &start, h, 1, scalars, |_| ControlFlow::Continue(()));
        let table = observations(model, &first);
        let value = |name: &str| {
            let column = table.columns.iter().find(|column| column.name == name);
            column.and_then(|column| column.values.first().copied())
        };
        let joints = model.system.joints.iter().enumerate();
        let joints = joints.filter_map(|(joint, of)| {
            let rate = value(&format!("{}_rate", of.name))?;
            Some((joint, value(&of.name)?, rate))
        });
        Ok(Self {
            recording: index,
            joints: joints.collect(),
        })
    }

    /// Name, unit, coordinate and rate of each joint in International units.
    pub fn in_si<'a>(
        &'a self,
        system: &'a System,
    ) -> impl Iterator<Item = (&'a str, &'static str, f64, f64)> + 'a {
        self.joints.iter().map(|&(joint, value, rate)| {
            let (unit, length, velocity) = match joint_unit(system, joint) {
                "mm" => ("m", 1e-3, 1.0),
                _ => ("rad", 1.0, 1e3),
            };
            let name = system.joints[joint].name.as_str();
            (name, unit, length * value, velocity * rate)
        })
    }
}
