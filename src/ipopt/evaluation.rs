//! The nonlinear program as Ipopt asks for it: timed, counted, refused where it does not exist, and remembered.
//!
//! An iterate as an observer sees it, and the data of the one before.

use std::mem;
use std::ops::ControlFlow;
use std::time::Instant;

use crate::ipopt::session;
use crate::ipopt::solution::{Evaluations, Iteration, Seconds};
use crate::nlp::squares::Squares;
use crate::nlp::{Bounds, Entries, Multipliers, Nlp, Status};
use crate::stop::{self, Watch};

/// Answers the questions of Ipopt about one nonlinear program.
///
/// A quantity that is NaN or ±∞ anywhere is refused, and Ipopt then shortens its step. When it is time to stop every value is
/// refused, and Ipopt soon gives up; without structures it cannot.
///
/// Before Ipopt reports an iterate it has asked for the derivatives there, because it needs them for the dual
/// infeasibility; at points which it merely tries it asks for f and g alone. So the point at which derivatives were
/// asked last, seen when an iteration is reported, is the iterate (in the restoration phase that one's own). This
/// matters for Ipopt before 3.14, which has no call for it.
pub(super) struct Evaluator<'a> {
    asked: Asked<'a>,
    began: Instant,
    _watch: Watch,
    record: &'a mut Record,
}

/// Program that Ipopt evaluates, and the observer of its iterates.
pub(super) struct Asked<'a> {
    pub(super) nlp: &'a mut dyn Nlp,
    pub(super) observer: &'a mut dyn FnMut(&Iteration, &Reached<'_>) -> ControlFlow<()>,
    /// Factor of f in all that Ipopt sees.
    pub(super) scale: f64,
    pub(super) structures: &'a Structures,
    /// Right-hand sides that are subtracted from g.
    pub(super) right: &'a [f64],
    /// Unknowns that are squares of what the observer sees.
    pub(super) squares: &'a Squares,
}

/// Structures of a program.
#[derive(Debug)]
pub(super) struct Structures {
    pub(super) jacobian: Entries,
    pub(super) hessian: Entries,
}

impl<'a> Evaluator<'a> {
    /// Answers in a solve that begins now at `start`.
    pub(super) fn new(
        asked: Asked<'a>,
        record: &'a mut Record,
        start: &[f64],
        max_seconds: Option<f64>,
    ) -> Self {
        record.begin(start);
        Self {
            asked,
            began: Instant::now(),
            _watch: stop::watch(max_seconds),
            record,
        }
    }

    /// f(x), scaled.
    pub(super) fn objective(&mut self, x: &[f64]) -> Option<f64> {
        if self.is_stopped() {
            return None;
        }
        self.record.evaluations.objective += 1;
        let f = timed(&mut self.record.seconds.objective, || {
            self.asked.scale * self.asked.nlp.objective(x)
        });
        self.accepts(&[f]).then_some(f)
    }

    /// ∇f(x), scaled.
    pub(super) fn gradient(&mut self, x: &[f64], grad: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.record.derivatives_at.copy_from_slice(x);
        self.record.evaluations.gradient += 1;
        timed(&mut self.record.seconds.gradient, || {
            self.asked.nlp.gradient(x, grad);
            grad.iter_mut().for_each(|g| *g *= self.asked.scale);
        });
        self.accepts(grad)
    }

    /// g(x) less the right-hand sides.
    pub(super) fn constraints(&mut self, x: &[f64], g: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.record.evaluations.constraints += 1;
        timed(&mut self.record.seconds.constraints, || {
            self.asked.nlp.constraint(x, g);
            let pairs = g.iter_mut().zip(self.asked.right);
            pairs.for_each(|(g, right)| *g -= right);
        });
        self.accepts(g)
    }

    /// Values of ∇g(x).
    pub(super) fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.record.derivatives_at.copy_from_slice(x);
        self.record.evaluations.jacobian += 1;
        timed(&mut self.record.seconds.jacobian, || {
            self.asked.nlp.jacobian(x, values);
        });
        self.accepts(values)
    }

    /// Values of σ ∇²f(x) + Σ yᵢ ∇²gᵢ(x), with f scaled.
    pub(super) fn hessian(
        &mut self,
        x: &[f64],
        sigma: f64,
        costates: &[f64],
        values: &mut [f64],
    ) -> bool {
        // In the restoration phase, where σ is zero, they are of another problem.
        if sigma > 0.0 && x == self.record.latest {
            self.record.costates.clear();
            let scaled = costates.iter().map(|y| y / sigma);
            self.record.costates.extend(scaled);
        }
        if self.is_stopped() {
            return false;
        }
        self.record.evaluations.hessian += 1;
        timed(&mut self.record.seconds.hessian, || {
            self.asked
                .nlp
                .hessian(x, sigma * self.asked.scale, costates, values);
        });
        self.accepts(values)
    }

    /// Places of ∇g.
    pub(super) const fn jacobian_structure(&self) -> &Entries {
        &self.asked.structures.jacobian
    }

    /// Places of the Hessian.
    pub(super) const fn hessian_structure(&self) -> &Entries {
        &self.asked.structures.hessian
    }

    /// Records an accepted iterate; breaks if the solve is to stop. An iterate whose step was stopped before its end does not count.
    pub(super) fn iteration(&mut self, iteration: &Iteration) -> ControlFlow<()> {
        if session::stopped().is_some() {
            return ControlFlow::Break(());
        }
        let objective = iteration.objective / self.asked.scale;
        let iteration = &Iteration {
            objective,
            ..*iteration
        };
        let (bounds, mut seconds) = (self.asked.nlp.variables(), 0.0);
        let (mut places, mut multipliers) = mem::take(&mut self.record.shown);
        let ([now, before], record, squares) = (&mut places, &*self.record, self.asked.squares);
        let x = squares.point(&record.derivatives_at, now);
        let before = squares.point(&record.latest, before);
        let report = record.iterations.last();
        let report = report.filter(|_| !record.costates.is_empty());
        if report.is_some() {
            multipliers.reset(before.len(), record.costates.len());
            record.write_multipliers(bounds, &mut multipliers);
            squares.of_roots(before, &mut multipliers);
            multipliers.scale(self.asked.scale.recip());
        }
        let before = report.map(|report| Before {
            report,
            x: before,
            multipliers: &multipliers,
        });
        let reached = Reached { x, before };
        let verdict = timed(&mut seconds, || (self.asked.observer)(iteration, &reached));
        let record = &mut *self.record;
        record.shown = (places, multipliers);
        record.seconds.observer += seconds;
        record.iterations.push(*iteration);
        record.latest.copy_from_slice(&record.derivatives_at);
        record.costates.clear();
        if verdict.is_break() {
            self.record.stopped = Some(Status::Interrupted);
        }
        match self.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Ends the solve.
    pub(super) fn end(self) {
        let seconds = &mut self.record.seconds;
        seconds.total = self.began.elapsed().as_secs_f64();
        let outside = seconds.objective
            + seconds.gradient
            + seconds.constraints
            + seconds.jacobian
            + seconds.hessian
            + seconds.observer;
        seconds.solver = (seconds.total - outside).max(0.0);
    }

    /// Returns true if it is time to stop, and remembers that.
    fn is_stopped(&mut self) -> bool {
        self.record.stopped = self.record.stopped.or_else(stop::reason);
        self.record.stopped.is_some()
    }

    /// Returns true if all `values` are there and finite; counts those that are not finite. An evaluation during which it became time to
    /// stop may have left some of them unset.
    fn accepts(&mut self, values: &[f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        let finite = values.iter().all(|value| value.is_finite());
        self.record.failed += usize::from(!finite);
        finite
    }
}

/// Returns the result of `evaluate`, and adds its duration to `seconds`.
fn timed<T>(seconds: &mut f64, evaluate: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let value = evaluate();
    *seconds += began.elapsed().as_secs_f64();
    value
}

/// An accepted iterate.
#[derive(Debug)]
pub struct Reached<'a> {
    /// Its variables.
    pub x: &'a [f64],
    /// The iterate before, where its multipliers are known: Ipopt gives those of an iterate on the way to the next one, and none in the
    /// restoration phase.
    pub before: Option<Before<'a>>,
}

/// The iterate before, with its multipliers.
#[derive(Debug)]
pub struct Before<'a> {
    /// Report of Ipopt on it.
    pub report: &'a Iteration,
    /// Its variables.
    pub x: &'a [f64],
    /// Its multipliers; those of bounds are the barrier parameter over the distance, to which Ipopt keeps them near.
    pub multipliers: &'a Multipliers,
}

/// Distance from a relaxed bound that is distinguished from zero, of its magnitude and at least of one.
const CLOSEST: f64 = 1e-14;
/// Records of iterations for which room is made beforehand.
const RESERVED_ITERATIONS: usize = 4096;

/// Record of a solve in addition to the answer of Ipopt.
#[derive(Debug, Default)]
pub(super) struct Record {
    /// Relaxation of bounds, relative to their magnitude and at least to one.
    pub(super) relaxed: f64,
    /// One record per iteration.
    pub(super) iterations: Vec<Iteration>,
    /// Point at which derivatives were evaluated last.
    pub(super) derivatives_at: Vec<f64>,
    /// The latest iterate reported; before the first one, the starting point.
    pub(super) latest: Vec<f64>,
    /// Room for an iterate and the one before, where they are shown as other points than Ipopt has them, and for the multipliers of that one.
    pub(super) shown: ([Vec<f64>; 2], Multipliers),
    /// Multipliers of the constraints there, as the Hessian was asked with; empty until it was.
    pub(super) costates: Vec<f64>,
    /// Reason why the solve was stopped from outside, if it was.
    pub(super) stopped: Option<Status>,
    /// Seconds of each part; `total` and `solver` are filled in at the end.
    pub(super) seconds: Seconds,
    /// Number of evaluations of each quantity.
    pub(super) evaluations: Evaluations,
    /// Number of evaluations that met NaN or ±∞.
    pub(super) failed: usize,
}

impl Record {
    /// Nothing is known yet but the start.
    pub(super) fn begin(&mut self, start: &[f64]) {
        self.iterations.clear();
        self.iterations.reserve(RESERVED_ITERATIONS);
        for place in [&mut self.derivatives_at, &mut self.latest] {
            place.clear();
            place.extend_from_slice(start);
        }
        self.costates.clear();
        self.stopped = None;
        self.seconds = Seconds::default();
        self.evaluations = Evaluations::default();
        self.failed = 0;
    }

    /// Multipliers of the latest iterate, where they are known: Ipopt has lost them where it was stopped on the way to the next one. Those of
    /// bounds are the barrier parameter over the distance, to which Ipopt keeps them near.
    pub(super) fn write_multipliers(&self, bounds: &Bounds, to: &mut Multipliers) {
        let (Some(last), false) = (self.iterations.last(), self.costates.is_empty()) else {
            return;
        };
        to.constraints.copy_from_slice(&self.costates);
        for (i, x) in self.latest.iter().enumerate() {
            let (lower, upper) = (bounds.lower[i], bounds.upper[i]);
            let of_bound = |gap: f64, bound: f64| match lower == upper {
                true => 0.0,
                false => {
                    let size = bound.abs().max(1.0);
                    last.mu / (gap + self.relaxed * size).max(CLOSEST * size)
                }
            };
            to.lower[i] = of_bound(x - lower, lower);
            to.upper[i] = of_bound(upper - x, upper);
        }
    }
}
