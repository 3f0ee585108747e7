//! The state at rest that a regulator holds.
//!
//! At the end of an optimum bodies rest, and what muscles remember may go on: branches of rubber relax long after. Inputs that hold the goal lead to the
//! state in which a step changes nothing, `f(x) = x`, which Newton's method finds from the end with the linearised step A: `(1 − A) δx = f(x) − x`.

use crate::dynamics::Linearisation;
use crate::workflow::regulator::design::{Design, State};
use nalgebra::{DMatrix, DVector};

/// Most iterations, and a change of all coordinates, relative to their typical sizes, that ends them.
const ITERATIONS: usize = 20;
const SMALL: f64 = 1e-10;

impl Design<'_> {
    /// The state at rest near the end under inputs by scalar; the end itself where nothing is remembered, and `None` where none is found.
    pub(super) fn at_rest(
        &self,
        linearisation: &mut Linearisation<'_>,
        inputs: &[f64],
    ) -> Option<State> {
        let mut state = self.goal().clone();
        let sizes = self.model.sizes();
        if self.model.memory().next().is_none() {
            return Some(state);
        }
        for _ in 0..ITERATIONS {
            let after = self.after(&state, inputs).ok()?;
            let (step, _) = self.linearised(linearisation, &state, inputs)?;
            let by = &step.by_state;
            let change = DVector::from_iterator(by.nrows(), self.change([&state, &after]));
            let matrix = DMatrix::identity(by.nrows(), by.ncols()) - by;
            let change = matrix.lu().solve(&change)?;
            let (places, momenta) = change.as_slice().split_at(self.coordinates.len());
            let own = self.coordinates.iter().zip(places);
            own.for_each(|(&i, change)| state.z[i] += change);
            let own = self.momenta.iter().zip(momenta);
            own.for_each(|(&i, change)| state.momentum[i] += change);
            if !change.iter().all(|value| value.is_finite()) {
                return None;
            }
            let mut own = self.coordinates.iter().zip(places);
            if own.all(|(&i, change)| change.abs() < SMALL * sizes[i]) {
                return Some(state);
            }
        }
        None
    }

    /// Change of the coordinates, then of the momenta, between two states.
    pub(super) fn change<'s>(
        &'s self,
        [from, to]: [&'s State; 2],
    ) -> impl Iterator<Item = f64> + 's {
        let coordinates = self.coordinates.iter().map(|&i| to.z[i] - from.z[i]);
        let momenta = self.momenta.iter();
        let momenta = momenta.map(|&i| to.momentum[i] - from.momentum[i]);
        coordinates.chain(momenta)
    }
}
