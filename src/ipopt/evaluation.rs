//! The nonlinear program as Ipopt asks for it: timed, counted, refused where it does not exist, and remembered.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::ipopt::interrupt::{self, Watch};
use crate::ipopt::solution::{Evaluations, Iteration, Seconds};
use crate::ipopt::status::Status;
use crate::nlp::{Entries, Nlp};

/// Records of iterations for which room is made beforehand.
const RESERVED_ITERATIONS: usize = 4096;

/// Answers the questions of Ipopt about one nonlinear program.
///
/// A quantity that is NaN or ±∞ anywhere is refused, and Ipopt then shortens its step. When it is time to stop every value is
/// refused, and Ipopt soon gives up; without structures it cannot.
///
/// Before Ipopt tells of an iterate it has asked for the derivatives there, because it needs them to tell the dual
/// infeasibility; at points which it merely tries it asks for f and g alone. So the point at which derivatives were
/// asked last, seen when an iteration is told, is the iterate (in the restoration phase that one's own). This
/// matters for Ipopt before 3.14, which has no call for it.
pub(super) struct Evaluator<'a> {
    nlp: &'a mut dyn Nlp,
    observer: &'a mut dyn FnMut(&Iteration, &[f64]) -> ControlFlow<()>,
    jacobian: Entries,
    hessian: Entries,
    /// Factor of f in all that Ipopt sees.
    scale: f64,
    began: Instant,
    _watch: Watch,
    derivatives_at: Vec<f64>,
    record: Record,
}

/// What is left of a solve besides the answer of Ipopt.
pub(super) struct Record {
    /// One record per iteration.
    pub(super) iterations: Vec<Iteration>,
    /// The latest iterate told; before the first one, the starting point.
    pub(super) latest: Vec<f64>,
    /// Why the solve was stopped from outside, if it was.
    pub(super) stopped: Option<Status>,
    /// Where the time went; `total` and `solver` are filled in at the end.
    pub(super) seconds: Seconds,
    /// How often each quantity was asked for.
    pub(super) evaluations: Evaluations,
    /// How many of them met NaN or ±∞.
    pub(super) failed: usize,
}

impl<'a> Evaluator<'a> {
    /// Answers for `nlp`, whose structures are given, in a solve that begins now at `start`.
    pub(super) fn new(
        nlp: &'a mut dyn Nlp,
        observer: &'a mut dyn FnMut(&Iteration, &[f64]) -> ControlFlow<()>,
        jacobian: Entries,
        hessian: Entries,
        start: &[f64],
        max_seconds: Option<f64>,
    ) -> Self {
        Self {
            scale: nlp.objective_scale(),
            nlp,
            observer,
            jacobian,
            hessian,
            began: Instant::now(),
            _watch: interrupt::watch(max_seconds),
            derivatives_at: start.to_vec(),
            record: Record {
                iterations: Vec::with_capacity(RESERVED_ITERATIONS),
                latest: start.to_vec(),
                stopped: None,
                seconds: Seconds::default(),
                evaluations: Evaluations::default(),
                failed: 0,
            },
        }
    }

    /// f(x), scaled.
    pub(super) fn objective(&mut self, x: &[f64]) -> Option<f64> {
        if self.is_stopped() {
            return None;
        }
        self.record.evaluations.objective += 1;
        let f = timed(&mut self.record.seconds.objective, || {
            self.scale * self.nlp.objective(x)
        });
        self.accepts(&[f]).then_some(f)
    }

    /// ∇f(x), scaled.
    pub(super) fn gradient(&mut self, x: &[f64], grad: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.derivatives_at.copy_from_slice(x);
        self.record.evaluations.gradient += 1;
        timed(&mut self.record.seconds.gradient, || {
            self.nlp.gradient(x, grad);
            grad.iter_mut().for_each(|g| *g *= self.scale);
        });
        self.accepts(grad)
    }

    /// g(x).
    pub(super) fn constraints(&mut self, x: &[f64], g: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.record.evaluations.constraints += 1;
        timed(&mut self.record.seconds.constraints, || {
            self.nlp.constraint(x, g);
        });
        self.accepts(g)
    }

    /// Values of ∇g(x).
    pub(super) fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        self.derivatives_at.copy_from_slice(x);
        self.record.evaluations.jacobian += 1;
        timed(&mut self.record.seconds.jacobian, || {
            self.nlp.jacobian(x, values);
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
        if self.is_stopped() {
            return false;
        }
        self.record.evaluations.hessian += 1;
        timed(&mut self.record.seconds.hessian, || {
            self.nlp.hessian(x, sigma * self.scale, costates, values);
        });
        self.accepts(values)
    }

    /// Places of ∇g.
    pub(super) const fn jacobian_structure(&self) -> &Entries {
        &self.jacobian
    }

    /// Places of the Hessian.
    pub(super) const fn hessian_structure(&self) -> &Entries {
        &self.hessian
    }

    /// Takes note of an accepted iterate and says whether to go on.
    pub(super) fn iteration(&mut self, iteration: &Iteration) -> ControlFlow<()> {
        let objective = iteration.objective / self.scale;
        let iteration = &Iteration {
            objective,
            ..*iteration
        };
        self.record.iterations.push(*iteration);
        self.record.latest.copy_from_slice(&self.derivatives_at);
        let verdict = timed(&mut self.record.seconds.observer, || {
            (self.observer)(iteration, &self.derivatives_at)
        });
        if verdict.is_break() {
            self.record.stopped = Some(Status::Interrupted);
        }
        match self.is_stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Ends the solve.
    pub(super) fn into_record(mut self) -> Record {
        let seconds = &mut self.record.seconds;
        seconds.total = self.began.elapsed().as_secs_f64();
        let outside = seconds.objective
            + seconds.gradient
            + seconds.constraints
            + seconds.jacobian
            + seconds.hessian
            + seconds.observer;
        seconds.solver = (seconds.total - outside).max(0.0);
        self.record
    }

    /// Whether it is time to stop, which is then remembered.
    fn is_stopped(&mut self) -> bool {
        self.record.stopped = self.record.stopped.or_else(interrupt::stop);
        self.record.stopped.is_some()
    }

    /// Whether all `values` are there and finite; if not finite, that is counted. What was evaluated while it became time to
    /// stop may be there in part.
    fn accepts(&mut self, values: &[f64]) -> bool {
        if self.is_stopped() {
            return false;
        }
        let finite = values.iter().all(|value| value.is_finite());
        self.record.failed += usize::from(!finite);
        finite
    }
}

/// What `evaluate` returns, with its duration added to `seconds`.
fn timed<T>(seconds: &mut f64, evaluate: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let value = evaluate();
    *seconds += began.elapsed().as_secs_f64();
    value
}
