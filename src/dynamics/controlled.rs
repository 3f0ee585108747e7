//! Steps whose length the local error controls.

use crate::dynamics::StepError;
use crate::dynamics::drive::Drive;
use crate::dynamics::equations::Equations;
use crate::dynamics::stepper::Steps;

/// A step of controlled length.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Controlled {
    /// Its length in ms.
    pub(super) taken: f64,
    /// Length in ms that the next one may have.
    pub(super) next: f64,
    /// Multipliers at its start.
    pub(super) multipliers: Vec<f64>,
}

/// Factor of a step whose local error, of third order, is `used` of the allowed error per time, with some room.
fn factor(used: f64) -> f64 {
    (0.9 / used.sqrt()).max(0.1)
}

impl<E: Equations> Steps<E> {
    /// Goes on between two times of the drive by at most all of the `h` ms, with a local error that is allowed per ms and at least; returns
    /// how far it went and how far it would go next.
    ///
    /// # Errors
    /// Steps down to `least` ms fail; the state is then that of the last accepted step.
    pub(super) fn step_within(
        &mut self,
        [from, to]: [f64; 2],
        h: f64,
        (least, allowed): (f64, [f64; 2]),
        drive: &dyn Drive,
    ) -> Result<Controlled, StepError> {
        self.allowed = Some(allowed);
        let mut part = h;
        loop {
            let end = if part < h { from + part } else { to };
            self.equations.begin([from, end], drive);
            self.used = 0.0;
            let error = match self.attempt(part) {
                Ok(()) => break,
                Err(stopped @ StepError::Stopped { .. }) => return Err(stopped),
                Err(error) => error,
            };
            if std::mem::take(&mut self.stale) || self.make_exact_after(&error) {
                self.factored = None;
                if self.used <= 1.0 {
                    continue;
                }
            }
            let shorter = part * factor(self.used).min(0.5);
            if shorter < least {
                if !self.updates.make_double() {
                    return Err(error);
                }
                (self.factored, part) = (None, h);
                continue;
            }
            self.report.halved += 1;
            part = shorter;
        }
        // A step that hardly changes keeps its factorisation.
        let next = match factor(self.used) {
            close if (1.0..1.3).contains(&close) => part,
            other => part * other.min(2.0),
        };
        Ok(Controlled {
            taken: part,
            next,
            multipliers: self.equations.multipliers().to_vec(),
        })
    }
}
