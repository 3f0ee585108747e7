//! One step forward: Newton on the rows of one instant of the discrete Euler–Lagrange equations.
//!
//! With the momentum p_k = P_kᵀ (D₂L_d(q_{k−1}, q_k) + f⁺) known, the unknowns u_{k+1} and λ_k solve
//!
//! ```text
//! p_k + P_kᵀ [ D₁L_d(q_k, q_{k+1}) + f⁻ − h₀ G(q_k)ᵀ λ_k ] = 0,     g(q_{k+1}) = 0,     ∂V/∂φ (q_{k+½}, φ_{k+½}) = 0
//! ```
//!
//! with the potentials φ of the interval, which have no inertia, by Gauss's law.

use crate::dynamics::StepError;
use crate::dynamics::anderson::Anderson;
use crate::dynamics::spans;
use crate::dynamics::tangent::{Entries, Tangent};
use crate::functional::{Level, Sides};
use crate::math::Vector;
use crate::model::Model;
use crate::reduction::{Instant as Place, Interval, Scratch};
use crate::sparse::{Backend, Singular};
use std::time::Instant;

/// Limit of Newton iterations in one step.
const ITERATIONS: usize = 16;
/// How often a step is halved before it is refused.
const HALVINGS: u32 = 10;
/// Convergence: the error after a Newton update of relative size δ is of order δ².
const UPDATE: f64 = 1e-9;

/// Error, by the rate of the updates, that an iteration with a reused tangent leaves.
const LEFT: f64 = 1e-10;
/// A reused tangent that makes the updates shrink by less than this is factorised anew.
const SLOW: f64 = 0.75;
/// Limit of iterations with a reused tangent.
const REUSED: usize = 40;

/// When the tangent of a step is factorised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Newton {
    /// In every iteration: few iterations, each with a factorisation.
    #[default]
    Full,
    /// Only where the last factorisation, of an iteration or of a step before, converges too slowly.
    Reused,
}

/// How the equations of a step are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solving {
    /// When the tangent is factorised.
    pub newton: Newton,
    /// Who factorises it; `None`: whoever is fastest as a rule.
    pub backend: Option<Backend>,
}

/// What the steps cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepperReport {
    /// Steps taken, halved ones included.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Steps that had to be halved.
    pub halved: usize,
    /// Factorisations of the tangent.
    pub factorisations: usize,
    /// Seconds in the rows and the tangent.
    pub assembly: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Seconds in solutions with them.
    pub solution: f64,
}

/// State at one instant and the storage to go on from it.
#[derive(Debug)]
pub struct Stepper<'m> {
    model: &'m Model,
    here: Place,
    next: Place,
    /// Momentum P_kᵀ p_k by coordinate, in the units of an action per coordinate.
    momentum: Vec<f64>,
    /// Rates of the coordinates over the last step, and how they changed, for the first guess.
    rates: Vec<f64>,
    changes: Vec<f64>,
    time: f64,
    scratch: Scratch,
    values: Vec<f64>,
    tangent: Tangent,
    newton: Newton,
    anderson: Anderson,
    /// Step of the tangent that is factorised.
    factored: Option<f64>,
    /// Whether the last attempt began with the tangent of a step before.
    stale: bool,
    /// Voltages and potentials of the interval.
    scalars: Vec<f64>,
    residual: Vec<f64>,
    scales: Vec<f64>,
    report: StepperReport,
}

impl<'m> Stepper<'m> {
    /// Starts at coordinates `z` with the momentum of each coordinate at time zero.
    pub fn new(model: &'m Model, z: &[f64], momentum: &[f64], solving: Solving) -> Self {
        let motion = &model.action.motion;
        let (n, layout) = (motion.coordinates, model.action.layout());
        let mut entries = Entries::default();
        for (slot, &entry) in layout.cross.entries().iter().enumerate() {
            entries.add(layout.upper_at(0) + slot, entry);
        }
        for (slot, &(row, col)) in layout.same.entries().iter().enumerate() {
            if row < n && col >= n {
                entries.add(layout.same_at(0) + slot, (row, col));
            }
            if row >= n && col < n {
                entries.add(layout.same_at(1) + slot, (row, col));
            }
        }
        entries.add_potentials(model, &[[0, 1]]);
        let size = motion.unknowns() + model.potentials;
        let (mut here, next) = (motion.instant(), motion.instant());
        here.z.copy_from_slice(z);
        motion.place(&mut here);
        let length = model.length();
        // Potentials are lengths too; what multipliers do says nothing about convergence.
        let scale = |i: usize| match i {
            i if i < n && !model.is_length(i) => 1.0,
            i if i >= n && i < motion.unknowns() => f64::INFINITY,
            _ => length,
        };
        Self {
            model,
            here,
            next,
            momentum: momentum.to_vec(),
            rates: vec![0.0; n],
            changes: vec![0.0; n],
            time: 0.0,
            scratch: model.action.scratch(Level::Hessian),
            values: vec![0.0; layout.values(1)],
            tangent: entries.tangent(size, model.step_symmetry(), solving.backend),
            newton: solving.newton,
            anderson: Anderson::default(),
            factored: None,
            stale: false,
            scalars: vec![0.0; layout.interval_scalars],
            residual: vec![0.0; size],
            scales: (0..size).map(scale).collect(),
            report: StepperReport::default(),
        }
    }

    /// The method that factorises.
    pub fn solver(&self) -> &'static str {
        self.tangent.name()
    }

    /// Time in ms.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Coordinates now, and the multipliers of the step that led away from the instant before.
    pub fn coordinates(&self) -> &[f64] {
        &self.here.z
    }

    /// The instant now.
    pub fn instant(&self) -> &Place {
        &self.here
    }

    /// Voltages and potentials of the last interval.
    pub fn scalars(&self) -> &[f64] {
        &self.scalars
    }

    /// Momentum of each coordinate.
    pub fn momentum(&self) -> &[f64] {
        &self.momentum
    }

    /// What the steps cost so far.
    pub fn report(&self) -> StepperReport {
        self.report
    }

    /// Goes on by `h` ms under constant voltages; returns the multipliers at the start.
    ///
    /// # Errors
    /// The step and its halves fail; the state is then that of the last accepted step.
    pub fn step(&mut self, h: f64, voltages: &[f64]) -> Result<Vec<f64>, StepError> {
        let n = self.model.action.motion.coordinates;
        let (mut done, mut part) = (0.0, h);
        let mut multipliers = None;
        let mut halvings = 0;
        self.scalars[..voltages.len()].copy_from_slice(voltages);
        while done < h * (1.0 - 1e-12) {
            part = part.min(h - done);
            match self.attempt(part) {
                Ok(()) => {
                    done += part;
                    multipliers.get_or_insert_with(|| self.next.z[n..].to_vec());
                }
                // What an old tangent could not do, a new one may.
                Err(_) if std::mem::take(&mut self.stale) => self.factored = None,
                Err(error) if halvings == HALVINGS => return Err(error),
                Err(_) => {
                    halvings += 1;
                    self.report.halved += 1;
                    part *= 0.5;
                }
            }
        }
        Ok(multipliers.unwrap_or_default())
    }

    fn evaluate(&mut self, level: Level, h: f64) {
        let action = &self.model.action;
        let (n, m) = (action.motion.coordinates, action.motion.unknowns());
        let Self {
            here,
            next,
            scratch,
            values,
            residual,
            scalars,
            ..
        } = self;
        action.motion.place(next);
        for instant in [&mut *here, &mut *next] {
            instant.forces.fill(Vector::zeros());
        }
        if level >= Level::Hessian {
            values.fill(0.0);
        }
        residual[..n].copy_from_slice(&self.momentum);
        residual[n..].fill(0.0);
        let interval = Interval {
            sides: Sides::FORWARD,
            ..Interval::given(scalars, h)
        };
        action.evaluate_interval(level, [here, next], &interval, scratch);
        action.pull_back_interval(level, [here, next], &interval, 0, scratch, values);
        let gauss = &scratch.interval.plain.rows[self.model.voltages.len()..];
        residual[m..].copy_from_slice(gauss);
        if m > n {
            // Multipliers of the step act at its start, constraints hold at its end.
            action.evaluate_instant(level, next, &[], scratch);
            action.pull_back_instant(level, next, 1, scratch, values);
            residual[n..m].copy_from_slice(&scratch.instant.plain.rows);
            here.z[n..].copy_from_slice(&next.z[n..]);
            action.evaluate_instant(level, here, &[], scratch);
            action.pull_back_instant(level, here, 0, scratch, values);
        }
        action
            .motion
            .pull_back(&here.columns, &here.forces, &mut residual[..n]);
    }

    fn factor(&mut self, h: f64) -> Result<(), Singular> {
        let began = Instant::now();
        let done = self.tangent.factor(&self.values);
        self.report.factorisation += began.elapsed().as_secs_f64();
        self.report.factorisations += 1;
        self.factored = done.is_ok().then_some(h);
        done
    }

    /// One Newton solution; accepted only when it converged.
    fn attempt(&mut self, h: f64) -> Result<(), StepError> {
        let n = self.model.action.motion.coordinates;
        let m = self.model.action.motion.unknowns();
        for i in 0..n {
            self.next.z[i] = self.here.z[i] + h * (self.rates[i] + self.changes[i]);
        }
        let saved: Vec<f64> = self.here.z[n..].to_vec();
        self.next.z[n..].copy_from_slice(&saved);
        let driven = self.model.voltages.len();
        let potentials = self.scalars[driven..].to_vec();
        let mut residuals = Vec::with_capacity(ITERATIONS);
        // A tangent of another step length is another matrix.
        let mut reused = self.newton == Newton::Reused && self.factored == Some(h);
        self.stale = reused;
        let mut last = f64::INFINITY;
        self.anderson.start();
        let limit = match self.newton {
            Newton::Full => ITERATIONS,
            Newton::Reused => REUSED,
        };
        for _ in 0..limit {
            self.report.iterations += 1;
            let level = if reused {
                Level::Gradient
            } else {
                Level::Hessian
            };
            let began = Instant::now();
            self.evaluate(level, h);
            self.report.assembly += began.elapsed().as_secs_f64();
            let norm = self.residual.iter().map(|r| r * r).sum::<f64>().sqrt();
            residuals.push(norm);
            if !norm.is_finite() {
                break;
            }
            if !reused {
                self.anderson.start();
            }
            if !reused && let Err(singular) = self.factor(h) {
                self.here.z[n..].copy_from_slice(&saved);
                self.scalars[driven..].copy_from_slice(&potentials);
                let name = self.model.unknown_name(singular.column);
                let redundant = self.model.redundant_constraints(&self.here.z);
                return Err(StepError::Singular {
                    time: self.time,
                    step: h,
                    name,
                    redundant,
                });
            }
            let began = Instant::now();
            match self.newton {
                Newton::Full => self.tangent.solve(&mut self.residual),
                Newton::Reused => self.tangent.solve_roughly(&mut self.residual),
            }
            self.report.solution += began.elapsed().as_secs_f64();
            let mut size: f64 = 0.0;
            for (update, scale) in self.residual.iter().zip(&self.scales) {
                size = size.max((update / scale).abs());
            }
            if self.newton == Newton::Reused {
                self.anderson.improve(&mut self.residual);
            }
            for (z, update) in self.next.z.iter_mut().zip(&self.residual) {
                *z -= update;
            }
            for (potential, update) in self.scalars[driven..].iter_mut().zip(&self.residual[m..]) {
                *potential -= update;
            }
            // Newton's updates shrink quadratically, those of a reused tangent by a factor.
            // What a tangent of an earlier step does is not known before its second update.
            let rate = match last.is_finite() {
                true => size / last,
                false if reused => SLOW,
                false => 0.0,
            };
            let is_close = match self.newton {
                Newton::Full => size < UPDATE,
                Newton::Reused => size * (rate / (1.0 - rate)).max(size) < LEFT,
            };
            if is_close && (rate < 1.0 || size < UPDATE) {
                let accepted = self.accept(h);
                if accepted.is_err() {
                    self.here.z[n..].copy_from_slice(&saved);
                    self.scalars[driven..].copy_from_slice(&potentials);
                }
                return accepted;
            }
            reused = self.newton == Newton::Reused && (rate < SLOW || last == f64::INFINITY);
            last = size;
        }
        self.here.z[n..].copy_from_slice(&saved);
        self.scalars[driven..].copy_from_slice(&potentials);
        let first = residuals.first().copied().unwrap_or(f64::NAN);
        let residuals = residuals
            .iter()
            .rev()
            .take(4)
            .rev()
            .map(|r| r / first)
            .collect();
        Err(StepError::NoConvergence {
            time: self.time,
            step: h,
            residuals,
            muscle: self.short_muscle(),
        })
    }

    /// The muscle that a failure at this instant is laid to: its name and stretch.
    fn short_muscle(&self) -> Option<(String, f64)> {
        let (muscle, stretch) = spans::shortest(self.model, &self.here)?;
        Some((self.model.system.muscles[muscle].name.clone(), stretch))
    }

    /// Makes a solution the instant now, unless a muscle passed through no length on the way, or an element is crushed there.
    fn accept(&mut self, h: f64) -> Result<(), StepError> {
        self.evaluate(Level::Gradient, h);
        if let Some(muscle) = spans::reversed(self.model, &self.here, &self.next) {
            return Err(StepError::Reversed {
                time: self.time,
                step: h,
                muscle: self.model.system.muscles[muscle].name.clone(),
            });
        }
        if spans::is_inverted(self.model, &self.next, &self.scalars) {
            return Err(StepError::Inverted {
                time: self.time,
                step: h,
            });
        }
        let motion = &self.model.action.motion;
        self.momentum.fill(0.0);
        motion.pull_back(
            &self.next.columns,
            &self.scratch.interval.plain.forces[1],
            &mut self.momentum,
        );
        for (i, rate) in self.rates.iter_mut().enumerate() {
            let new = (self.next.z[i] - self.here.z[i]) / h;
            // In the first step nothing is known of the change.
            self.changes[i] = if self.report.steps > 0 {
                new - *rate
            } else {
                0.0
            };
            *rate = new;
        }
        std::mem::swap(&mut self.here, &mut self.next);
        self.time += h;
        self.report.steps += 1;
        Ok(())
    }
}
