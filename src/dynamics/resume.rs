//! Conversion between a stepper and the state from which it is resumed.

use crate::dynamics::solving::Newton;
use crate::dynamics::step_state::{StepState, StepperReport};
use crate::dynamics::stepper::{Equations, Steps};

impl<E: Equations> Steps<E> {
    /// Writes the state at the end of a step.
    pub(super) fn keep(&mut self, to: &mut StepState) {
        let mut index = 0;
        self.equations.visit_state(&mut |name, list| {
            if index == to.lists.len() {
                to.lists.push((name.to_owned(), Vec::new()));
            }
            let (of, kept) = &mut to.lists[index];
            // Lists that come to be move those behind them.
            if of != name {
                name.clone_into(of);
            }
            kept.clear();
            kept.extend_from_slice(list);
            index += 1;
        });
        to.lists.truncate(index);
        let made = |report: &StepperReport| [report.factorisations, report.multigrid.hierarchies];
        let is_new = to.tangent.is_none() || made(&self.report) != made(&to.report);
        if is_new {
            self.updates.keep(self.factored, &mut to.tangent);
        }
        to.report = self.report;
    }

    /// Restores a saved state. Returns false if it does not fit these equations. A state before the first step is restored already.
    pub(super) fn take(&mut self, from: &StepState) -> bool {
        if from.lists.is_empty() {
            return true;
        }
        let mut lists = from.lists.iter();
        let mut fits = true;
        self.equations
            .visit_state(&mut |name, list| match lists.next() {
                Some((of, kept)) if of == name && kept.len() == list.len() => {
                    list.copy_from_slice(kept);
                }
                _ => fits = false,
            });
        if !fits || lists.next().is_some() {
            return false;
        }
        self.equations.take_state();
        self.report = from.report;
        match &from.tangent {
            Some(tangent) => {
                self.factored = tangent.step;
                self.updates.take(self.equations.model(), tangent)
            }
            None => self.updates.newton() == Newton::Full,
        }
    }
}
