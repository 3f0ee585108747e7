//! Exchange of start and goal of a program that exists.

use crate::control::BoundaryError;
use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::limits::BoundedQuantity;
use crate::control::transcription::Transcription;
use crate::control::transcription::limit_rows::{LimitRow, Step};
use crate::control::transcription::segment::Placed;
use crate::model::Model;

impl Transcription<'_> {
    /// Gives the program another start and goal: coordinates, momenta, voltages at rest, values of goals and limits. Nothing is built, and all scales
    /// stay as they are, so that points and multipliers keep their meaning.
    ///
    /// The bounds of [`Nlp`](crate::nlp::Nlp) may change: those of goals, and of limits if they have moved.
    ///
    /// # Errors
    /// Other coordinates are given, other quantities are bounded, or something else rests, so that variables or equations would be others.
    /// The program is as before.
    pub fn move_ends(&mut self, boundary: &BoundaryConditions) -> Result<(), BoundaryError> {
        self.check_ends(boundary)?;
        let BoundaryConditions {
            start, goal, rest, ..
        } = boundary;
        self.workspace.instants[0].z.copy_from_slice(&start.z);
        if !self.layout.is_closed() {
            self.momentum.given.copy_from_slice(&start.momentum);
        }
        let unknowns = self.model.action.map.unknowns();
        let last = &mut self.workspace.instants[self.layout.end].z;
        goal.give(last, unknowns);
        for (limit, bounded) in self
            .layout
            .limits
            .iter_mut()
            .zip(measured(self.model, boundary))
        {
            (limit.bounded.lower, limit.bounded.upper) = (bounded.lower, bounded.upper);
            if let Some(step) = &mut limit.step {
                step.move_ends(self.model, rest);
            }
        }
        self.set_row_bounds();
        for (kept, row) in self.objective.cost.ends_mut().iter_mut().zip(rest) {
            let units = &self.objective.inputs;
            let sources = self.model.variables.sources().zip(units);
            let new = row
                .as_ref()
                .map(|row| sources.map(move |(s, input)| row[s] / input.unit));
            match (kept, new) {
                (Some(kept), Some(new)) => kept.iter_mut().zip(new).for_each(|(v, new)| *v = new),
                (kept, new) => *kept = new.map(Iterator::collect),
            }
        }
        for energy in &mut self.objective.energies {
            energy.move_ends(rest);
        }
        self.workspace.point.fill(f64::NAN);
        self.workspace.placed = Placed::Nothing;
        Ok(())
    }

    /// Returns an error unless these ends give the same values and equations as those that the program was built for.
    fn check_ends(&self, boundary: &BoundaryConditions) -> Result<(), BoundaryError> {
        let other = |reason: String| Err(BoundaryError::OtherProgram { reason });
        let BoundaryConditions { start, goal, .. } = boundary;
        if boundary.sought_rest != [false; 2] {
            return other("a state of rest depends on a free parameter".to_owned());
        }
        if start.z.len() != self.workspace.instants[0].z.len()
            || start.momentum.len() != self.momentum.given.len()
        {
            return other("the start belongs to another model".to_owned());
        }
        let is_given = |i: usize| self.layout.unknowns.unknown(self.layout.end, i).is_none();
        let given = goal.coordinates.iter().map(Option::is_some);
        if !given.eq((0..self.model.coordinate_count()).map(is_given)) {
            return other("the goal gives other coordinates".to_owned());
        }
        if goal.rests != self.rests {
            return other("something else comes to rest".to_owned());
        }
        if boundary.limits.list.len() != self.bounded {
            return other("there are more or fewer goals and limits".to_owned());
        }
        let is_known = |step: &Step| step.has_ends(&boundary.rest);
        let mut steps = self
            .layout
            .limits
            .iter()
            .filter_map(|limit| limit.step.as_ref());
        if !steps.all(is_known) {
            return other(
                "voltages at rest are known that were not, or are not any more".to_owned(),
            );
        }
        let is_equation = |one: &BoundedQuantity| one.lower == one.upper;
        let mut others = measured(self.model, boundary);
        for LimitRow { bounded, .. } in &self.layout.limits {
            let is_same = others.next().is_some_and(|one| {
                (&one.quantity, one.when) == (&bounded.quantity, bounded.when)
                    && is_equation(one) == is_equation(bounded)
            });
            if !is_same {
                return other(format!("{} is no goal or limit any more", bounded.name));
            }
        }
        Ok(())
    }
}

/// The goals and limits that the model can measure: those that have rows.
fn measured<'b>(
    model: &Model,
    boundary: &'b BoundaryConditions,
) -> impl Iterator<Item = &'b BoundedQuantity> {
    let list = boundary.limits.list.iter().zip(&model.measured);
    list.filter_map(|(bounded, place)| place.map(|_| bounded))
}
