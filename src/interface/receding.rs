//! Controllers that plan anew.

use crate::control::problem::{Ahead, Regulator};
use crate::interface::control::Control;
use crate::interface::error::{Result, require};
use crate::model::System;
use crate::workflow::receding::Horizon;

impl Control {
    /// Solves the problem, for controllers that plan anew over a horizon of a number of its intervals, with the usual costs of deviations.
    ///
    /// # Errors
    /// As of [`solve`](Self::solve); no optimum was found, nothing holds the goal, or the problem has something that is not offered.
    pub fn horizon(&self, system: &System, intervals: usize) -> Result<Horizon> {
        require(
            intervals > 0,
            "horizon",
            || "0 intervals".to_owned(),
            "1 or more",
        )?;
        require(
            intervals <= Ahead::MOST_INTERVALS,
            "horizon",
            || format!("{intervals} intervals"),
            "no more than 10000",
        )?;
        let system = system.checked()?;
        let ahead = Ahead {
            control: self.resolve(&system)?,
            regulator: Regulator::default(),
            system,
            intervals,
        };
        Ok(Horizon::solved(&ahead).map_err(|error| error.at("horizon", ""))?)
    }
}
