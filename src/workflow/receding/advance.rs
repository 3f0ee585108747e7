//! The second part of an iteration: what was measured enters the right side, and each variable goes as far as its bounds allow.

use crate::nlp::Nlp;
use crate::workflow::receding::iteration::Iteration;

/// Part of the way to a bound that a step may go.
const TOWARDS: f64 = 0.995;
/// A step of a slack is cut if less than this part of it is taken; steps of scaled limits below the other number do not count.
const WHOLE: f64 = 0.5;
const STILL: f64 = 1e-6;

impl<N: Nlp> Iteration<N> {
    /// Takes the step of the point that was prepared, with changes of held variables and of the values of rows; false if it is not finite. The
    /// variables of the whole step go to `full`.
    pub(super) fn advance(
        &mut self,
        changes: &[(usize, f64)],
        rows: &[(usize, f64)],
        full: &mut [f64],
    ) -> bool {
        self.step.fill(0.0);
        changes.iter().for_each(|&(i, value)| self.step[i] = value);
        self.solution.copy_from_slice(&self.right);
        for (list, values) in self
            .held
            .iter()
            .zip([&self.hessian_values, &self.jacobian_values])
        {
            for &(row, variable, entry) in list {
                self.solution[row] -= values[entry] * self.step[variable];
            }
        }
        for &(row, value) in rows {
            if let Some(number) = self.rows[row] {
                self.solution[number] -= value;
            }
        }
        self.solver.solve(&mut self.solution);
        if !self.solution.iter().all(|value| value.is_finite()) {
            return false;
        }
        for (step, number) in self.step.iter_mut().zip(&self.unknowns) {
            if let Some(number) = *number {
                *step = self.solution[number];
            }
        }
        let values = self.x.iter().zip(&self.step);
        full.iter_mut()
            .zip(values)
            .for_each(|(to, (x, dx))| *to = x + dx);
        self.is_cut = self.take_step();
        true
    }

    /// Takes the step as far as bounds of variables allow, and that of each slack as far as its own ones do: limits that are reached hold nothing else
    /// back. Returns true if one of them cut the step of its slack.
    fn take_step(&mut self) -> bool {
        let variables = 0..self.columns;
        let allowed = variables.fold([1.0_f64; 2], |[primal, dual], i| {
            let own = self.allowed(i);
            [primal.min(own[0]), dual.min(own[1])]
        });
        let mut is_cut = false;
        for i in 0..self.unknowns.len() {
            let dx = self.step[i];
            if self.unknowns[i].is_none() {
                self.x[i] += dx;
                continue;
            }
            let is_slack = i >= self.columns;
            let [primal, dual] = if is_slack { self.allowed(i) } else { allowed };
            is_cut |= is_slack && primal < WHOLE && dx.abs() > STILL;
            let distances = self.distances(i);
            let after = [distances[0] + primal * dx, distances[1] - primal * dx];
            for side in 0..2 {
                let z = self.z[side][i] + dual * self.change(side, i, distances[side]);
                self.z[side][i] = self.near(i, z, after[side]);
            }
            self.x[i] += primal * dx;
        }
        for (y, number) in self.y.iter_mut().zip(&self.rows) {
            if let Some(number) = *number {
                *y += allowed[0] * self.solution[number];
            }
        }
        is_cut
    }

    /// Parts of the steps of a variable or slack and of its multipliers that its bounds allow.
    fn allowed(&self, i: usize) -> [f64; 2] {
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        if self.unknowns[i].is_none() {
            return [primal, dual];
        }
        let dx = self.step[i];
        for (side, (distance, towards)) in self.distances(i).into_iter().zip([-dx, dx]).enumerate()
        {
            if towards > 0.0 {
                primal = primal.min(TOWARDS * distance / towards);
            }
            let dz = self.change(side, i, distance);
            if dz < 0.0 {
                dual = dual.min(-TOWARDS * self.z[side][i] / dz);
            }
        }
        [primal, dual]
    }

    /// Distances of a variable or slack from its bounds.
    fn distances(&self, i: usize) -> [f64; 2] {
        [self.x[i] - self.bounds[0][i], self.bounds[1][i] - self.x[i]]
    }

    /// Δz of a bound at a distance.
    fn change(&self, side: usize, i: usize, distance: f64) -> f64 {
        let away = if side == 0 {
            self.step[i]
        } else {
            -self.step[i]
        };
        let z = self.z[side][i];
        (self.barrier - z * away) / distance - z
    }
}
