//! Several motions in one optimisation.

use crate::control::problem::Combined;
use crate::control::{self, Motions};
use crate::interface::control::Control;
use crate::interface::error::{Result, require};
use crate::interface::input::Input;
use crate::interface::optimum::Optimum;
use crate::model::System;
use crate::tasks::{self, SolveRequest};
use crate::workflow::Iterate;
use std::ops::ControlFlow;

/// Motions that are optimised together: parameters of the same names are one, and the objective is the sum of theirs, or the [greatest](Self::worst).
#[derive(Clone, Debug, Default)]
pub struct Together<'a> {
    motions: Vec<(&'a System, &'a Control)>,
    shared: Vec<Input>,
    combined: Combined,
}

impl<'a> Together<'a> {
    /// No motion yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a motion of a system.
    pub fn motion(mut self, system: &'a System, control: &'a Control) -> Self {
        self.motions.push((system, control));
        self
    }

    /// Seeks the input of a part once for all motions, which have then one given duration and one number of intervals.
    pub fn shared_input(mut self, input: impl Into<Input>) -> Self {
        self.shared.push(input.into());
        self
    }

    /// Minimises the greatest of the objectives in place of their sum.
    pub fn worst(self) -> Self {
        let combined = Combined::Worst;
        Self { combined, ..self }
    }

    /// Solves; each motion is verified as one by itself, and solved again on a finer grid where a simulation under its inputs does not reproduce it.
    ///
    /// # Errors
    /// As of [`Control::solve`], or something cannot be the same in all motions. A problem without a solution is no error: see
    /// [`Optimum::is_solved`] of each.
    pub fn solve(&self) -> Result<Vec<Optimum>> {
        let found = || "none".to_owned();
        require(!self.motions.is_empty(), "motions", found, "one or more")?;
        let mut list = Vec::new();
        for (number, (system, control)) in self.motions.iter().enumerate() {
            let system = system.checked()?;
            list.push(control::Motion {
                name: format!("motion{}", number + 1),
                control: control.resolve(&system)?,
                system,
            });
        }
        let sources = list[0].system.sources();
        let name = |input: &Input| {
            let found = input.source(&list[0].system);
            let words = || format!("{input:?}");
            let expected = "a muscle, driven electrode or load of all systems";
            require(found.is_some(), "shared inputs", words, expected)?;
            Ok(sources[found.unwrap_or_default()].name.clone())
        };
        let shared_inputs = self.shared.iter().map(name).collect::<Result<_>>()?;
        let motions = Motions {
            list,
            shared_inputs,
            combined: self.combined,
        };
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        let found = tasks::solve_motions(&motions, SolveRequest::default(), go_on)?;
        Ok(found.list.into_iter().map(Optimum::from_result).collect())
    }
}
