//! Systems of optimal control with random numbers, dense and by entries.

use crate::matrices::Random;
use nalgebra::DMatrix;
use proboscis::kkt::{Inertia, Unknown};

/// A symmetric matrix by entries of the lower triangle, some places listed twice.
#[derive(Clone)]
pub(crate) struct System {
    pub(crate) rows: Vec<u32>,
    pub(crate) cols: Vec<u32>,
    pub(crate) entries: Vec<f64>,
    pub(crate) unknowns: Vec<Unknown>,
}

/// Parameters of a horizon.
#[derive(Clone, Copy)]
pub(crate) struct Horizon {
    pub(crate) intervals: usize,
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    /// Inequalities of each interval.
    pub(crate) limits: usize,
    /// True if one variable couples all stages.
    pub(crate) has_border: bool,
    /// Number added to the entry of each state in its own equation.
    pub(crate) own: f64,
}

impl System {
    /// One front: a full matrix, whose entries at row and column are asked row by row.
    pub(crate) fn full(order: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        let mut system = Self {
            rows: Vec::new(),
            cols: Vec::new(),
            entries: Vec::new(),
            unknowns: vec![Unknown::Variable(0); order],
        };
        for i in 0..order {
            for j in 0..=i {
                system.push(i, j, entry(i, j));
            }
        }
        system
    }

    pub(crate) fn order(&self) -> usize {
        self.unknowns.len()
    }

    pub(crate) fn push(&mut self, i: usize, j: usize, value: f64) {
        self.rows.push(i.max(j) as u32);
        self.cols.push(i.min(j) as u32);
        self.entries.push(value);
    }

    pub(crate) fn dense(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.order(), self.order());
        for ((&i, &j), value) in self.rows.iter().zip(&self.cols).zip(&self.entries) {
            let (i, j) = (i as usize, j as usize);
            matrix[(i, j)] += value;
            if i != j {
                matrix[(j, i)] += value;
            }
        }
        matrix
    }

    /// By eigenvalues; those below 1e-13 of the largest are zero.
    pub(crate) fn inertia(&self) -> Inertia {
        let eigenvalues = self.dense().symmetric_eigenvalues();
        let zero = 1e-13 * eigenvalues.amax();
        Inertia {
            negative: eigenvalues.iter().filter(|&&e| e < -zero).count(),
            zero: eigenvalues.iter().filter(|e| e.abs() <= zero).count(),
        }
    }

    /// Variables with an indefinite Hessian, equations that couple three instants, limits with slacks: as an interior-point method
    /// lists them. `diagonal` multiplies what stands on the diagonal of variables.
    pub(crate) fn of_horizon(horizon: Horizon, diagonal: f64, random: &mut Random) -> Self {
        let Horizon {
            intervals,
            states,
            inputs,
            limits,
            has_border,
            own: dominance,
        } = horizon;
        let width = states + inputs;
        let variables = width * intervals + usize::from(has_border);
        let slacks = variables..variables + limits * intervals;
        let equations = slacks.end..slacks.end + states * intervals;
        let order = equations.end + limits * intervals;
        let mut unknowns = vec![Unknown::Border; variables];
        for (i, unknown) in unknowns.iter_mut().enumerate().take(width * intervals) {
            let is_state = i % width >= inputs;
            *unknown = Unknown::Variable((i / width * 2) as u32 + u32::from(is_state));
        }
        unknowns.resize(slacks.end, Unknown::Slack);
        unknowns.resize(equations.end, Unknown::Equality);
        unknowns.resize(order, Unknown::Inequality);
        let mut system = Self {
            rows: Vec::new(),
            cols: Vec::new(),
            entries: Vec::new(),
            unknowns,
        };
        let state = |k: usize, i: usize| k * width + inputs + i;
        let border = variables - 1;
        for k in 0..intervals {
            for i in 0..width {
                let own = k * width + i;
                system.push(own, own, diagonal * random.number());
                system.push(own, own, 0.5 * diagonal * random.number());
                if has_border {
                    system.push(border, own, random.number());
                }
            }
            for i in 0..states {
                for j in 0..i {
                    system.push(state(k, i), state(k, j), random.number());
                }
                for j in (0..states).filter(|_| k > 0) {
                    system.push(state(k, i), state(k - 1, j), random.number());
                }
                let row = equations.start + k * states + i;
                for l in k.saturating_sub(2)..=k {
                    for j in 0..states {
                        system.push(row, state(l, j), random.number());
                    }
                }
                for j in 0..inputs {
                    system.push(row, k * width + j, random.number());
                }
                system.push(row, state(k, i), dominance);
                system.push(row, row, 0.0);
            }
            for i in 0..limits {
                let slack = slacks.start + k * limits + i;
                let row = equations.end + k * limits + i;
                system.push(slack, slack, 10.0_f64.powf(6.0 * random.number()));
                system.push(row, slack, -1.0);
                system.push(row, row, 0.0);
                for j in 0..width {
                    system.push(row, k * width + j, random.number());
                }
            }
        }
        system
    }
}
