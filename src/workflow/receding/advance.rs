//! The second part of an iteration: what was measured enters the right side, and the step goes as far as bounds allow.

use crate::nlp::Nlp;
use crate::workflow::receding::iteration::Iteration;

/// Part of the way to a bound that a step may go.
const TOWARDS: f64 = 0.995;
/// A multiplier of a bound differs from μ over the distance by no more than this factor.
const NEAR: f64 = 1e4;

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
        self.take_step();
        true
    }

    /// Takes the step as far as bounds allow.
    fn take_step(&mut self) {
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        for (i, number) in self.unknowns.iter().enumerate() {
            if number.is_none() {
                continue;
            }
            let dx = self.step[i];
            let distances = [self.x[i] - self.bounds[0][i], self.bounds[1][i] - self.x[i]];
            for (side, (distance, towards)) in distances.into_iter().zip([-dx, dx]).enumerate() {
                if towards > 0.0 {
                    primal = primal.min(TOWARDS * distance / towards);
                }
                let z = self.z[side][i];
                let dz = self.change(side, i, distance);
                if dz < 0.0 {
                    dual = dual.min(-TOWARDS * z / dz);
                }
            }
        }
        for i in 0..self.unknowns.len() {
            let dx = self.step[i];
            if self.unknowns[i].is_none() {
                self.x[i] += dx;
                continue;
            }
            let distances = [self.x[i] - self.bounds[0][i], self.bounds[1][i] - self.x[i]];
            let after = [distances[0] + primal * dx, distances[1] - primal * dx];
            for side in 0..2 {
                let dz = self.change(side, i, distances[side]);
                let wanted = self.barrier / after[side];
                let z = self.z[side][i] + dual * dz;
                self.z[side][i] = z.clamp(wanted / NEAR, wanted * NEAR);
            }
            self.x[i] += primal * dx;
        }
        for (y, number) in self.y.iter_mut().zip(&self.rows) {
            if let Some(number) = *number {
                *y += primal * self.solution[number];
            }
        }
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
