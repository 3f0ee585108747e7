//! Displayed part of a motion, and the notes on it.

use std::collections::HashSet;
use std::io;

use crate::app::summary::{ShownPart, Summary};
use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::files::npz::NpzWriter;
use crate::files::problem::output::Output;
use crate::math::join;
use crate::model::{Model, System};
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::sampled::{Sampled, thinned};
use crate::report::skins::Skins;
use crate::report::{Run, table};
use crate::workflow::Tracked;

/// The complete tables of a long motion.
const TABLES: &str = "tables.npz";

/// A motion as tables, figures and page show it.
#[derive(Debug)]
pub(super) struct DisplayedMotion {
    pub(super) trajectory: Trajectory,
    pub(super) observations: Observations,
    /// Columns of the table.
    pub(super) tabulated: Observations,
    pub(super) skins: Skins,
    sampled: Option<Sampled>,
}

/// A motion with its observations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<'a> {
    pub(super) model: &'a Model,
    pub(super) discrete: &'a DiscreteTrajectory,
    pub(super) trajectory: &'a Trajectory,
    pub(super) observations: &'a Observations,
}

impl DisplayedMotion {
    /// Returns the displayed part of a motion: all that is asked for, or where nothing is asked all of it, and of a long simulation fewer instants,
    /// between which the motion is straight to the eye; its complete tables are then a file of the result. The summary tells which part it is.
    ///
    /// # Errors
    /// That file cannot be written.
    pub(super) fn from_motion(
        motion: Motion<'_>,
        output: &Output,
        is_simulated: bool,
        summary: &mut Summary,
        files: &mut FileSet,
    ) -> Result<Self, WriteError> {
        let Motion {
            model,
            discrete,
            trajectory,
            observations,
        } = motion;
        let is_asked = output.every.is_some();
        let sampled = (is_asked || is_simulated)
            .then(|| Sampled::from_observations(observations, output.every))
            .flatten();
        let choose = || match &sampled {
            None => (
                trajectory.clone(),
                observations.clone(),
                Skins::new(model, discrete),
            ),
            Some(sampled) => (
                sampled.trajectory(trajectory),
                sampled.observations(observations),
                Skins::new(model, &sampled.discrete_trajectory(discrete)),
            ),
        };
        let is_complete_beside = sampled.is_some() && !is_asked;
        let complete =
            || is_complete_beside.then(|| tables(&model.system, trajectory, observations));
        let ((trajectory, observations, skins), complete) = join(choose, complete);
        let columns = observations.columns.iter();
        let taken = columns.filter(|column| output.takes(&column.name, &model.system));
        let tabulated = taken.cloned().collect();
        let is_lacking = |name: &&String| {
            let alone = Output {
                every: None,
                quantities: Some(vec![(*name).clone()]),
            };
            let mut columns = observations.columns[1..].iter();
            !columns.any(|column| alone.takes(&column.name, &model.system))
        };
        let lacking = output.quantities.iter().flatten().filter(is_lacking);
        let lacking =
            lacking.map(|name| format!("\"quantities\": this motion has no column of {name:?}"));
        summary.notes.note("shown", lacking);
        summary.shown = sampled.as_ref().map(|sampled| ShownPart {
            instants: sampled.instants.len(),
            of: discrete.times.len(),
        });
        match (summary.shown, complete) {
            (Some(ShownPart { instants, of }), Some(bytes)) => {
                let note = format!(
                    "tables, figures and page show {instants} of {of} instants, between which nothing is lost to the eye; {TABLES} and the solution have all, \"output\": {{\"every\": …}} chooses"
                );
                summary.notes.note("shown", [note]);
                let bytes = bytes.map_err(WriteError::at(files.folder().join(TABLES)))?;
                files.add(TABLES, &bytes)?;
            }
            _ => files.remove(TABLES),
        }
        Ok(Self {
            tabulated: Observations { columns: tabulated },
            trajectory,
            observations,
            skins,
            sampled,
        })
    }

    /// The run that is shown, without what it is compared with.
    pub(super) fn run<'a>(&'a self, system: &'a System, origin: &'a Origin) -> Run<'a> {
        let (trajectory, observations) = (&self.trajectory, &self.observations);
        Run {
            tabulated: &self.tabulated,
            ..Run::from_trajectory(system, trajectory, &self.skins, observations, origin)
        }
    }

    /// Returns the references at the instants that are shown.
    pub(super) fn tracked(&self, full: &[Tracked]) -> Vec<Tracked> {
        match &self.sampled {
            Some(sampled) => sampled.tracked(full),
            None => full.to_vec(),
        }
    }

    /// Another motion that is drawn next to it.
    pub(super) fn beside(&self, other: Trajectory) -> Trajectory {
        match &self.sampled {
            Some(_) => thinned(&other),
            None => other,
        }
    }
}

/// All rows of both tables.
fn tables(
    system: &System,
    trajectory: &Trajectory,
    observations: &Observations,
) -> io::Result<Vec<u8>> {
    let mut arrays = NpzWriter::default();
    let mut names = HashSet::new();
    // Of columns with one heading the second one ends with a stroke.
    let mut unique = |table: &str, heading: &str| {
        let mut name = format!("{table}/{heading}");
        while !names.insert(name.clone()) {
            name.push('′');
        }
        name
    };
    for (name, columns) in [
        ("trajectory", table::columns(observations)),
        ("controls", table::controls(trajectory, system)),
    ] {
        for column in columns {
            let values = column.values();
            let name = unique(name, &column.heading);
            arrays.array(&name, &[values.len()], values);
        }
    }
    Ok(arrays.finish()?.0)
}
