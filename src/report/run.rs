//! What a report is made of.

use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::model::system::System;
use crate::report::origin::Origin;
use crate::report::skins::Skins;
use crate::workflow::Tracked;

/// What there is to show of a run.
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
    /// What was observed at the instants, see [`Trajectory::observe`]; energies are columns in N mm.
    pub observations: &'a Observations,
    /// Another motion of the same system and its name, such as `constant voltages`.
    pub comparison: Option<(&'a str, &'a Trajectory)>,
    /// Voltages in V, one per muscle, that hold the last instant, where they are known; they colour the configuration.
    pub held: Option<&'a [f64]>,
    /// What markers and joints were to follow.
    pub tracked: &'a [Tracked],
    /// Where the results come from.
    pub origin: &'a Origin,
    /// Title of the page.
    pub title: &'a str,
    /// Rows of the page's table.
    pub summary: &'a [(String, String)],
}
