//! One step forward: Newton on the equations of a method, and halves of the step where it fails.

use crate::coordinates::Configuration;
use crate::dynamics::contraction::Verdict;
use crate::dynamics::energies::Work;
use crate::dynamics::error::StepError;
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::resolution::{Balance, part_to_touch, turned};
use crate::dynamics::singular_configurations;
use crate::dynamics::solving::{Drive, Newton};
use crate::dynamics::trajectory::{StepState, StepperReport};
use crate::dynamics::updates::Updates;
use crate::functional::{NodeBlocks, Order};
use crate::model::Model;
use crate::stop::{self, Stopped};
use std::time::Instant;

/// Limit of Newton iterations in one step.
const ITERATIONS: usize = 16;
/// Largest number of halvings of a step before it is refused.
const HALVINGS: u32 = 10;
/// Limit of iterations with a reused tangent.
const REUSED: usize = 40;

/// Limits of a step that a tolerance controls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    /// Length in ms of the shortest step.
    pub(super) shortest: f64,
    /// Local error per ms.
    pub(super) error_per_ms: f64,
    /// Local error of a step, where that per ms is less.
    pub(super) error: f64,
}

/// State at one instant and the means to go on from it.
#[derive(Debug)]
pub struct Steps<E> {
    pub(super) equations: E,
    pub(super) updates: Updates,
    /// Step of the tangent that is factorised.
    pub(super) factored: Option<f64>,
    /// True if the last attempt began with the tangent of a step before.
    pub(super) stale: bool,
    pub(super) residual: Vec<f64>,
    /// Unknowns whose values are prescribed.
    held: Vec<usize>,
    /// Limits of steps that a tolerance controls; none of steps of given length.
    pub(super) allowed: Option<Allowed>,
    /// Local error of the last attempt as a part of the allowed one.
    pub(super) used: f64,
    /// Part of the last attempt after which a contact begins or ends, where a tolerance controls the steps.
    pub(super) touch: Option<f64>,
    /// Energy balance of the last attempt, where the method has one.
    balance: Option<Balance>,
    pub(super) report: StepperReport,
}

impl<E: Equations> Steps<E> {
    /// Steps by these equations, with a matrix and a scale for each unknown; `held` are those with prescribed values.
    pub(super) fn by(
        equations: E,
        matrix: NewtonMatrix,
        held: Vec<usize>,
        scales: Vec<f64>,
        newton: Newton,
    ) -> Self {
        Self {
            equations,
            held,
            factored: None,
            stale: false,
            residual: vec![0.0; scales.len()],
            updates: Updates::new(matrix, scales, newton),
            allowed: None,
            used: 0.0,
            touch: None,
            balance: None,
            report: StepperReport::default(),
        }
    }

    /// The method that factorises.
    pub fn solver(&self) -> String {
        self.updates.matrix.name()
    }

    /// Coordinates now, and the multipliers of the step that led away from the instant before.
    pub fn coordinates(&self) -> &[f64] {
        self.equations.now().z
    }

    /// Voltages and potentials of the last interval.
    pub fn scalars(&self) -> &[f64] {
        self.equations.now().scalars
    }

    /// Momentum of each coordinate.
    pub fn momentum(&self) -> &[f64] {
        self.equations.now().momentum
    }

    /// Work in mJ that forces without a potential did over the last step, where its ends alone do not determine it.
    pub(super) fn work(&self) -> Option<Work> {
        self.equations.work()
    }

    /// Returns the report of the steps so far.
    pub fn report(&self) -> StepperReport {
        self.report
    }

    /// Goes on by `h` ms under constant voltages; returns the multipliers at the start, where the method knows them there.
    ///
    /// # Errors
    /// The step and its halves fail; the state is then that of the last accepted step.
    pub fn step(&mut self, h: f64, voltages: &[f64]) -> Result<Vec<f64>, StepError> {
        let constant = |_: f64, _: f64| voltages.to_vec();
        self.go([0.0, h], h, &constant)
    }

    /// Goes on by `h` ms between two times of the drive; returns the multipliers at the start, where the method knows them there.
    ///
    /// # Errors
    /// The step and its halves fail; the state is then that of the last accepted step.
    pub(super) fn go(
        &mut self,
        [from, to]: [f64; 2],
        h: f64,
        drive: &dyn Drive,
    ) -> Result<Vec<f64>, StepError> {
        let (mut done, mut part) = (0.0, h);
        let mut multipliers = None;
        let mut halvings = 0;
        while done < h * (1.0 - 1e-12) {
            part = part.min(h - done);
            let end = if part < h - done {
                from + done + part
            } else {
                to
            };
            self.equations.begin([from + done, end], drive);
            match self.attempt(part) {
                Ok(()) => {
                    done += part;
                    multipliers.get_or_insert_with(|| self.equations.now().multipliers.to_vec());
                }
                Err(stopped @ StepError::Stopped { .. }) => return Err(stopped),
                // Retry with a fresh tangent.
                Err(_) if std::mem::take(&mut self.stale) => self.factored = None,
                Err(ref error) if self.make_exact_after(error) => self.factored = None,
                // Switch to double precision last: errors of single precision were already checked for each factorisation.
                Err(_) if halvings == HALVINGS && self.updates.make_double() => {
                    self.factored = None;
                    (part, halvings) = (h - done, 0);
                }
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

    /// Factorises the whole tangent from now on, where an iteration failed; returns true if it did not before.
    pub(super) fn make_exact_after(&mut self, error: &StepError) -> bool {
        matches!(error, StepError::NoConvergence { .. }) && self.updates.make_exact()
    }

    /// One Newton solution; accepted only when it converged.
    pub(super) fn attempt(&mut self, h: f64) -> Result<(), StepError> {
        self.equations.guess(h);
        let mut residuals = Vec::with_capacity(ITERATIONS);
        // A tangent of another step length is another matrix.
        let newton = self.updates.newton;
        let mut reused = newton == Newton::Modified && self.factored == Some(h);
        self.stale = reused;
        let mut contraction = self.updates.contraction();
        let mut are_placed = false;
        self.updates.begin();
        let limit = match newton {
            Newton::Full => ITERATIONS,
            Newton::Modified => REUSED,
        };
        for _ in 0..limit {
            self.go_on(h)?;
            self.report.iterations += 1;
            let order = if reused {
                Order::Gradient
            } else {
                Order::Hessian
            };
            let began = Instant::now();
            self.evaluate(order, h);
            self.report.assembly += began.elapsed().as_secs_f64();
            self.go_on(h)?;
            let norm = self.residual.iter().map(|r| r * r).sum::<f64>().sqrt();
            residuals.push(norm);
            if !norm.is_finite() {
                break;
            }
            if !reused && !std::mem::replace(&mut are_placed, true) && self.place_potentials(h)? {
                continue;
            }
            if !reused {
                self.updates.start();
                self.factor(h)?;
                self.go_on(h)?;
            }
            let size = self.solve(h, !reused)?;
            let verdict = self.updates.judge(&mut contraction, size, reused);
            reused = verdict == Verdict::Shrinks;
            if verdict == Verdict::Astray {
                residuals.pop();
                continue;
            }
            self.updates.accelerate(&mut self.residual);
            self.equations.update(&self.residual);
            if verdict == Verdict::Converged {
                if self.accept(h)? {
                    return Ok(());
                }
                residuals.push(f64::NAN);
                break;
            }
        }
        let limit = self.part_near_limit(residuals.last().is_some_and(|r| r.is_finite()));
        self.equations.restore();
        let first = residuals.first().copied().unwrap_or(f64::NAN);
        let last = &residuals[residuals.len().saturating_sub(4)..];
        let model = self.equations.model();
        let [start, _] = self.equations.ends();
        let short = singular_configurations::shortest(model, start);
        Err(StepError::NoConvergence {
            time: self.equations.now().time,
            step: h,
            residuals: last.iter().map(|r| r / first).collect(),
            limit,
            muscle: short.map(|(name, stretch)| (name.to_owned(), stretch)),
            overflow: singular_configurations::overflow(model, self.equations.now().scalars),
        })
    }

    /// Evaluates the equations; those of prescribed unknowns hold. The residual is no number where it was time to stop.
    pub(super) fn evaluate(&mut self, order: Order, h: f64) {
        let grids = self.updates.matrix.grids_mut();
        match grids.filter(|_| order >= Order::Hessian) {
            Some(grids) => {
                // The matrix of a step before is no more.
                self.factored = None;
                let residual = &mut self.residual;
                let is_whole =
                    grids.write(|nodes| self.equations.evaluate(order, h, residual, Some(nodes)));
                if !is_whole {
                    residual.fill(f64::NAN);
                }
            }
            None => self.equations.evaluate(order, h, &mut self.residual, None),
        }
        for &unknown in &self.held {
            self.residual[unknown] = 0.0;
        }
    }

    /// Returns an error if it is time to stop.
    fn go_on(&mut self, h: f64) -> Result<(), StepError> {
        stop::check().map_err(|stopped| self.stopped(h, stopped))
    }

    fn stopped(&mut self, step: f64, Stopped(status): Stopped) -> StepError {
        self.equations.restore();
        let time = self.equations.now().time;
        StepError::Stopped { time, step, status }
    }

    /// Makes a solution the instant now; not where the momentum does not exist, nor where the step does not resolve the
    /// motion.
    fn accept(&mut self, h: f64) -> Result<bool, StepError> {
        self.equations.place_end();
        if let Some(refusal) = self.refusal(h) {
            self.equations.restore();
            return Err(refusal);
        }
        let accepted = self.equations.accept(h);
        if accepted {
            self.report.steps += 1;
            if let Some(balance) = self.balance {
                self.report.made += balance.made();
                self.report.exchanged = self.report.exchanged.max(balance.exchanged());
            }
        }
        Ok(accepted)
    }

    /// Returns the reason why a solution is not accepted: a muscle passed through zero length or the limit of its law, a joint turned too
    /// far, an element is crushed, the energy balance does not close.
    fn refusal(&mut self, step: f64) -> Option<StepError> {
        let time = self.equations.now().time;
        let model = self.equations.model();
        let [start, end] = self.equations.ends();
        if let Some(muscle) = singular_configurations::reversed(model, start, end) {
            let muscle = model.system.muscles[muscle].name.clone();
            return Some(StepError::Reversed { time, step, muscle });
        }
        if let Some(part) = singular_configurations::beyond_law(model, end) {
            return Some(StepError::BeyondLaw { time, step, part });
        }
        if let Some((what, angle)) = turned(model, start, end) {
            return Some(StepError::Turned {
                time,
                step,
                what,
                angle,
            });
        }
        self.balance = self.equations.balance(step);
        let refusal = match self.balance {
            Some(balance) => balance.refusal(self.equations.model(), time, step),
            None => {
                let [_, end] = self.equations.ends();
                let scalars = self.equations.now().scalars;
                singular_configurations::is_inverted(self.equations.model(), end, scalars)
                    .then_some(StepError::Inverted { time, step })
            }
        };
        let limits = self.allowed.filter(|_| refusal.is_none());
        let Some(limits) = limits else {
            return refusal;
        };
        let allowed = limits.error.max(limits.error_per_ms * step);
        let error = self.equations.local_error(step);
        self.used = error / allowed;
        // A contact that changes within the shortest step does so at the start.
        self.touch = part_to_touch(self.equations.model(), self.equations.ends())
            .filter(|part| part * step >= limits.shortest);
        (error > allowed || self.touch.is_some()).then_some(StepError::Inaccurate {
            time,
            step,
            error,
            allowed,
        })
    }

    /// The muscle or block that a failure is laid to, as its law is near its limit at this instant, or has no energy at the end of the step that was tried
    /// where forces do not exist.
    fn part_near_limit(&mut self, is_finite: bool) -> Option<String> {
        if !is_finite {
            self.equations.place_end();
        }
        let (model, [start, end]) = (self.equations.model(), self.equations.ends());
        let beyond = match is_finite {
            true => None,
            false => singular_configurations::beyond_law(model, end),
        };
        beyond.or_else(|| singular_configurations::near_limit(model, start))
    }
}

impl<E: Equations> Steps<E> {
    /// Takes the tangent evaluated last, and factorises it where it is solved so.
    fn factor(&mut self, h: f64) -> Result<(), StepError> {
        let began = Instant::now();
        let values = self.equations.values();
        let done = stop::heed(|is_over| self.updates.factor_unless(values, is_over));
        self.report.factorisation += began.elapsed().as_secs_f64();
        let is_kept = self.updates.matrix.is_kept() && done == Ok(Ok(()));
        self.factored = is_kept.then_some(h);
        let done = done.map_err(|stopped| self.stopped(h, stopped))?;
        if self.updates.matrix.direct().is_some() {
            self.report.factorisations += 1;
        }
        done.map_err(|singular| {
            self.equations.restore();
            let [start, _] = self.equations.ends();
            StepError::Singular {
                time: self.equations.now().time,
                step: h,
                name: self.equations.unknown_name(singular.column),
                redundant: self.equations.model().redundant_constraints(&start.z),
            }
        })
    }

    /// Solves for an update, with the whole tangent where a new factor leaves out too much; returns its size relative to the
    /// scales, which is no number where there is no update.
    fn solve(&mut self, h: f64, is_fresh: bool) -> Result<f64, StepError> {
        let size = match self.solve_once(h)? {
            Some(size) => size,
            None if self.fall_back() => {
                self.report.fallbacks += 1;
                self.evaluate(Order::Hessian, h);
                self.factor(h)?;
                self.solve_once(h)?.unwrap_or(f64::NAN)
            }
            None => {
                self.residual.fill(f64::NAN);
                return Ok(f64::NAN);
            }
        };
        if !(is_fresh && self.updates.leave_out_much(&self.residual, size)) {
            return Ok(size);
        }
        self.evaluate(Order::Hessian, h);
        self.updates.make_exact();
        self.factor(h)?;
        Ok(self.solve_once(h)?.unwrap_or(f64::NAN))
    }

    fn fall_back(&mut self) -> bool {
        let model = self.equations.model();
        self.updates.matrix.fall_back_with_room(model)
    }

    /// Solves for an update; `None` where the iteration does not converge.
    fn solve_once(&mut self, h: f64) -> Result<Option<f64>, StepError> {
        let began = Instant::now();
        let solved = stop::heed(|is_over| self.updates.solve(&mut self.residual, is_over));
        self.report.solution += began.elapsed().as_secs_f64();
        self.count();
        let solved = solved.map_err(|stopped| self.stopped(h, stopped))?;
        Ok(solved.ok())
    }

    /// Takes in the counts of the iterations.
    fn count(&mut self) {
        if let Some(grids) = self.updates.matrix.grids_mut() {
            self.report.multigrid.add(grids.counted());
        }
    }

    /// Brings potentials that are far from Gauss's law to it before anything moves; returns true if it did so.
    fn place_potentials(&mut self, h: f64) -> Result<bool, StepError> {
        let Some(grids) = self.updates.matrix.grids_mut() else {
            return Ok(false);
        };
        let update = stop::heed(|is_over| grids.potentials_first(&self.residual, is_over));
        self.count();
        let update = update.map_err(|stopped| self.stopped(h, stopped))?;
        if let Some(update) = &update {
            self.equations.update(update);
        }
        Ok(update.is_some())
    }
}

/// State at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// Time in ms.
    pub time: f64,
    /// Coordinates and multipliers.
    pub z: &'a [f64],
    /// Momentum of each coordinate.
    pub momentum: &'a [f64],
    /// Voltages and potentials of the last interval.
    pub scalars: &'a [f64],
    /// Multipliers at the start of the last step, where the method knows them there.
    pub multipliers: &'a [f64],
}

/// The equations that lead from one instant to the next.
pub trait Equations {
    /// Takes the voltages of a step between two times in ms, at the points where the method reads them.
    fn begin(&mut self, step: [f64; 2], drive: &dyn Drive);

    /// First guess of the unknowns of a step of `h` ms.
    fn guess(&mut self, h: f64);

    /// Writes the residual; at order `Hessian` also the tangent, to a matrix of nodes where there is one.
    fn evaluate(
        &mut self,
        order: Order,
        h: f64,
        residual: &mut [f64],
        nodes: Option<&mut NodeBlocks>,
    );

    /// Values of the tangent.
    fn values(&self) -> &[f64];

    /// Subtracts an update from the unknowns.
    fn update(&mut self, update: &[f64]);

    /// Undoes what a failed attempt changed in the state.
    fn restore(&mut self);

    /// The model.
    fn model(&self) -> &Model;

    /// Places the end of the step where the last update put it.
    fn place_end(&mut self);

    /// The start and the end of the step.
    fn ends(&self) -> [&Configuration; 2];

    /// Energy balance of the step that the last update led to, where the method has one.
    fn balance(&mut self, _h: f64) -> Option<Balance> {
        None
    }

    /// Local error of the step that the last update led to, relative to the sizes of the coordinates; zero where the method
    /// has no estimate.
    fn local_error(&mut self, _h: f64) -> f64 {
        0.0
    }

    /// Visits (and may overwrite) the complete state, list by list in a fixed order, for checkpoints.
    fn visit_state(&mut self, visit: &mut dyn FnMut(&'static str, &mut [f64]));

    /// Updates the equations after a change of the state.
    fn take_state(&mut self);

    /// Makes the end of the step the state, unless the momentum does not exist there.
    fn accept(&mut self, h: f64) -> bool;

    /// Name of an unknown.
    fn unknown_name(&self, unknown: usize) -> String;

    /// The state now.
    fn now(&self) -> Now<'_>;

    /// Work in mJ that forces without a potential did over the last step, where its ends alone do not determine it.
    fn work(&self) -> Option<Work> {
        None
    }
}

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
                self.updates.matrix.restore(self.equations.model(), tangent)
            }
            None => self.updates.newton == Newton::Full,
        }
    }
}
