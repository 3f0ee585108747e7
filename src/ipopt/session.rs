//! The linear systems of the solves of a program: from the calls of Ipopt to [`kkt`](crate::kkt).
//!
//! Ipopt holds no pointer to it. A solve works in one thread and in no other, so that its session stands in a variable of the thread; a
//! solve within a callback has a session of its own.

use crate::ipopt::solution::StagesReport;
use crate::kkt::{Inertia, Plan, Solver, Unknown};
use crate::nlp::{Bounds, Stage, Status};
use crate::stop;
use std::any::Any;
use std::cell::RefCell;
use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

thread_local! {
    static CURRENT: RefCell<Option<Session>> = const { RefCell::new(None) };
    /// The solver of a session that has ended, for one of the same pattern.
    static KEPT: RefCell<Option<Kept>> = const { RefCell::new(None) };
}

/// A solver with the unknowns that gave its order.
struct Kept {
    solver: Solver,
    unknowns: Option<Vec<Unknown>>,
}

/// The linear systems of the solves of a program.
pub(super) struct Session {
    /// The unknowns as Ipopt lists them: without fixed variables, and with them.
    layouts: [Vec<Unknown>; 2],
    current: Option<Kept>,
    /// Pivot tolerance that was asked for last.
    tolerance: f64,
    report: StagesReport,
    panic: Option<Box<dyn Any + Send>>,
}

impl Session {
    /// For a program with these bounds; nothing is known of its order without stages.
    pub(super) fn new(variables: &Bounds, constraints: &Bounds, stages: Option<&[Stage]>) -> Self {
        Self {
            layouts: match stages {
                Some(stages) => layouts(variables, constraints, stages),
                None => [Vec::new(), Vec::new()],
            },
            current: None,
            tolerance: 0.0,
            report: StagesReport::default(),
            panic: None,
        }
    }

    /// Does `solve` with this session as that of the thread, and returns its result, the report of the session, and the session.
    pub(super) fn during<T>(mut self, solve: impl FnOnce() -> T) -> (T, StagesReport, Self) {
        /// Puts the session of an outer solve back, also where the inner one panics.
        struct Outer(Option<Session>);
        impl Drop for Outer {
            fn drop(&mut self) {
                CURRENT.set(self.0.take());
            }
        }
        self.tolerance = 0.0;
        self.report = StagesReport::default();
        let outer = Outer(CURRENT.replace(Some(self)));
        let found = solve();
        let mut session = CURRENT.take().expect("the session of this solve");
        drop(outer);
        if let Some(panic) = session.panic.take() {
            session.current = None;
            std::panic::resume_unwind(panic);
        }
        let mut report = session.report;
        if let Some(kept) = &session.current {
            report.statistics = *kept.solver.statistics();
        }
        (found, report, session)
    }

    /// A solver for systems of `order` unknowns with these entries, counted from one; none where it is time to stop.
    pub(super) fn analyse(&mut self, order: usize, rows: &[c_int], cols: &[c_int]) -> Option<()> {
        let began = Instant::now();
        let unknowns = self.layouts.iter().find(|layout| layout.len() == order);
        let fits = |kept: &Kept| {
            let plan = kept.solver.plan();
            let known = plan.pattern();
            kept.unknowns.as_ref() == unknowns
                && plan.order() == order
                && from_zero(rows).eq(known.rows.iter().copied())
                && from_zero(cols).eq(known.cols.iter().copied())
        };
        let kept = self.current.take().filter(fits);
        let kept = kept.or_else(|| KEPT.take().filter(fits));
        self.current = Some(match kept {
            Some(mut kept) => {
                kept.solver.restart();
                kept
            }
            None => {
                self.report.analyses += 1;
                let [rows, cols] = [rows, cols].map(|list| from_zero(list).collect::<Vec<_>>());
                let of_unknowns = unknowns.map(Vec::as_slice);
                let plan = stop::heed(|is_over| {
                    Plan::new_unless(order, &rows, &cols, of_unknowns, is_over)
                });
                let plan = plan.map_err(|stopped| self.report.stopped = Some(stopped.0));
                Kept {
                    solver: Solver::new(plan.ok()?),
                    unknowns: unknowns.cloned(),
                }
            }
        });
        self.report.analysis += began.elapsed().as_secs_f64();
        Some(())
    }

    /// Factors a matrix; a tolerance greater than before asks for better factors. What takes long stops when it is time to.
    ///
    /// Ipopt 3.11 repeats its request for ever if a matrix with NaN is reported as singular: the factorisation of such a matrix fails.
    pub(super) fn factor(&mut self, entries: &[f64], tolerance: f64) -> Option<Inertia> {
        self.report.stopped = self.report.stopped.or_else(stop::reason);
        if self.report.stopped.is_some() || !entries.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let began = Instant::now();
        let solver = &mut self.current.as_mut().expect("analysed first").solver;
        if self.tolerance > 0.0 && tolerance > self.tolerance {
            solver.improve();
        }
        self.tolerance = tolerance;
        let factored = stop::heed(|is_over| solver.factor_unless(entries, is_over));
        let factored = factored.map_err(|stopped| self.report.stopped = Some(stopped.0));
        let seconds = began.elapsed().as_secs_f64();
        self.report.factorisation += seconds;
        if solver.is_whole() {
            self.report.wholes += 1;
            self.report.whole += seconds;
        }
        factored.ok()
    }

    /// Solves for right-hand sides that begin every `stride` numbers.
    pub(super) fn solve(&mut self, right: &mut [f64], stride: usize) {
        let began = Instant::now();
        let solver = &mut self.current.as_mut().expect("analysed first").solver;
        let order = solver.plan().order();
        for x in right.chunks_mut(stride) {
            solver.solve(&mut x[..order]);
        }
        self.report.solution += began.elapsed().as_secs_f64();
    }
}

impl Drop for Session {
    /// The plan is left to the next session of this thread.
    fn drop(&mut self) {
        if let Some(kept) = self.current.take() {
            KEPT.try_with(|place| place.replace(Some(kept))).ok();
        }
    }
}

/// Indices that are counted from one.
fn from_zero(indices: &[c_int]) -> impl Iterator<Item = u32> {
    indices.iter().map(|i| (i - 1).cast_unsigned())
}

/// Does `work` with the session of this thread. `None` if there is none, or it failed: a panic goes on when the solve has returned.
pub(super) fn with_current<T>(work: impl FnOnce(&mut Session) -> T) -> Option<T> {
    CURRENT.with_borrow_mut(|current| {
        let session = current.as_mut().filter(|session| session.panic.is_none())?;
        catch_unwind(AssertUnwindSafe(|| work(session)))
            .inspect_err(|_| tracing::debug!("the linear solver failed"))
            .map_err(|panic| session.panic = Some(panic))
            .ok()
    })
}

/// Returns the reason why the solve of this thread stopped a factorisation before its end, if it did.
pub(super) fn stopped() -> Option<Status> {
    CURRENT.with_borrow(|current| current.as_ref()?.report.stopped)
}

impl From<Stage> for Unknown {
    /// The kind of a variable.
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Of(stage) => Self::Variable(stage),
            Stage::Multiplier(stage) => Self::Multiplier(stage),
            Stage::Border => Self::Border,
        }
    }
}

/// The unknowns in the order of Ipopt: variables, slacks, multipliers of equalities, multipliers of inequalities.
///
/// Fixed variables are left out, unless there would be more equations than variables.
fn layouts(variables: &Bounds, constraints: &Bounds, stages: &[Stage]) -> [Vec<Unknown>; 2] {
    let rows = constraints.count();
    let equalities = (0..rows).filter(|&i| constraints.are_equal(i)).count();
    [false, true].map(|with_fixed| {
        let mut unknowns: Vec<Unknown> = (0..variables.count())
            .filter(|&i| with_fixed || !variables.are_equal(i))
            .map(|i| stages[i].into())
            .collect();
        let counts = [
            (Unknown::Slack, rows - equalities),
            (Unknown::Equality, equalities),
            (Unknown::Inequality, rows - equalities),
        ];
        for (unknown, count) in counts {
            unknowns.resize(unknowns.len() + count, unknown);
        }
        unknowns
    })
}
