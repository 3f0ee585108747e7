//! Input of a report: a run with its motion, observations and texts.

use nalgebra::Vector3;

use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::kinematics::Pose;
use crate::model::system::System;
use crate::report::lines::LinePlot;
use crate::report::origin::Origin;
use crate::report::skins::Skins;
use crate::report::style;
use crate::report::view::View;
use crate::report::viewpoint::Viewpoint;
use crate::workflow::Tracked;
use crate::workflow::closed_loop::DisturbedLoop;

/// Settings of figures, and further formats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Viewpoint of figures in space.
    pub view: Viewpoint,
    /// True if a glTF file of the motion is written.
    pub gltf: bool,
    /// True if ParaView files of bodies, muscles and markers are written.
    pub parts: bool,
}

/// Data of a run for its report.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The system that moved.
    pub system: &'a System,
    /// Its motion and voltages.
    pub trajectory: &'a Trajectory,
    /// Surfaces of its elastic blocks.
    pub skins: &'a Skins,
    /// Name of the motion in legends, such as `optimal voltages`.
    pub name: &'a str,
    /// Observations at the instants, see [`Trajectory::observe`]; energies are columns in N mm.
    pub observations: &'a Observations,
    /// Columns of `trajectory.csv`.
    pub tabulated: &'a Observations,
    /// Another motion of the same system and its name, such as `constant voltages`.
    pub comparison: Option<(&'a str, &'a Trajectory)>,
    /// Voltages in V, one per muscle, that hold the last instant, where they are known; they colour the configuration.
    pub held: Option<&'a [f64]>,
    /// Equilibria on the way to a state of rest, where they were followed.
    pub equilibria: Option<&'a Trajectory>,
    /// The whole path of equilibria, along which the page walks.
    pub branch: Option<Branch<'a>>,
    /// Settings of figures.
    pub figures: Figures,
    /// References of markers and joints.
    pub tracked: &'a [Tracked],
    /// Closed loops with parts of the disturbance.
    pub disturbed: &'a [DisturbedLoop],
    /// Origin of the results.
    pub origin: &'a Origin,
    /// Poses of the bodies where the motion was to end, where they are known.
    pub goal: Option<&'a [Pose]>,
    /// Places in mm where markers were to end, with their indices.
    pub targets: &'a [(usize, Vector3<f64>)],
    /// Places in mm that markers were to pass on the way, with their indices.
    pub waypoints: &'a [(usize, Vector3<f64>)],
    /// Titles and plots over time that the page shows first, as its clock goes.
    pub plots: &'a [(String, LinePlot)],
    /// Texts of the page; none where no page is wanted.
    pub page: Option<&'a PageContent>,
}

/// A path of equilibria.
#[derive(Clone, Copy, Debug)]
pub struct Branch<'a> {
    /// The equilibria at the times 0, 1 s, 2 s, …, and the first of them once more before, so that each ends an interval with its voltages.
    pub trajectory: &'a Trajectory,
    /// Surfaces at these instants.
    pub skins: &'a Skins,
    /// The fraction of the voltages of each equilibrium.
    pub fractions: &'a [f64],
    /// The equilibrium that figures show.
    pub shown: usize,
}

/// Texts of a page about a run, and its plots in addition to the motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PageContent {
    /// Title of the page.
    pub title: String,
    /// True if the task has an answer.
    pub is_solved: bool,
    /// Status, in a few words.
    pub answer: String,
    /// Further notes: reasons, warnings.
    pub notes: Vec<String>,
    /// Rows of the table next to the motion.
    pub rows: Vec<(String, String)>,
    /// Titles and plots beside those of motions, which no clock follows.
    pub plots: Vec<(String, LinePlot)>,
    /// Names and texts of the input and the answer: `summary.json`, problem, scene.
    pub documents: Vec<(String, String)>,
}

impl<'a> Run<'a> {
    /// The run as its page shows it: along the whole path of equilibria where there is one.
    pub(super) fn along_branch(&self) -> Self {
        match self.branch {
            None => *self,
            Some(branch) => Self {
                trajectory: branch.trajectory,
                skins: branch.skins,
                ..*self
            },
        }
    }

    /// A motion with all that is observed of it in its table, alone and without a page.
    pub fn from_trajectory(
        system: &'a System,
        trajectory: &'a Trajectory,
        skins: &'a Skins,
        observations: &'a Observations,
        origin: &'a Origin,
    ) -> Self {
        Self {
            system,
            trajectory,
            skins,
            name: "motion",
            observations,
            tabulated: observations,
            comparison: None,
            held: None,
            equilibria: None,
            branch: None,
            figures: Figures::default(),
            tracked: &[],
            disturbed: &[],
            origin,
            goal: None,
            targets: &[],
            waypoints: &[],
            plots: &[],
            page: None,
        }
    }

    /// The view of its figures in space.
    pub(super) fn view(&self) -> View {
        let viewpoint = self.figures.view;
        viewpoint.view(self.system, self.trajectory, self.skins)
    }

    /// Full scale in V of the colours of its voltages and potentials.
    pub(super) fn voltage_scale(&self) -> f64 {
        let highest = [self.skins.highest()];
        let voltages = self.trajectory.voltages(self.system);
        style::voltage_scale(voltages.chain([&highest[..]]))
    }

    /// The motions whose paths its figures show, with their names: the one that it is compared with, then its own.
    pub(super) fn motions(&self) -> Vec<(&'a str, &'a Trajectory)> {
        let own = (self.name, self.trajectory);
        self.comparison.into_iter().chain([own]).collect()
    }
}
