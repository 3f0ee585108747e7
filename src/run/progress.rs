//! Progress on standard error: the iterations of a solve, the steps of a simulation.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::ipopt::Iteration;

/// Whether progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Where standard error is a terminal.
    OnTerminal,
    /// Never.
    Never,
}

/// A line that changes while a run goes on.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    began: Instant,
}

impl Progress {
    /// A solve with an open number of iterations.
    pub(super) fn of_solve(shown: Shown) -> Self {
        let bar = target(ProgressBar::no_length(), shown);
        bar.set_style(style("{spinner} {elapsed_precise} {msg}"));
        bar.enable_steady_tick(Duration::from_millis(120));
        Self::starting(bar)
    }

    /// A simulation of `steps` steps.
    pub(super) fn of_steps(shown: Shown, steps: usize) -> Self {
        let bar = target(ProgressBar::new(steps as u64), shown);
        bar.set_style(style(
            "{elapsed_precise} {wide_bar} step {pos} of {len} {msg}",
        ));
        Self::starting(bar)
    }

    /// A solve from `starts` starting points.
    pub(super) fn of_starts(shown: Shown, starts: usize) -> Self {
        let bar = target(ProgressBar::new(starts as u64), shown);
        bar.set_style(style(
            "{elapsed_precise} {wide_bar} start {pos} of {len} {msg}",
        ));
        bar.enable_steady_tick(Duration::from_millis(120));
        Self::starting(bar)
    }

    fn starting(bar: ProgressBar) -> Self {
        let began = Instant::now();
        Self { bar, began }
    }

    /// An iterate on so many intervals was accepted.
    pub(super) fn iteration(&self, intervals: usize, at: &Iteration) {
        self.bar.set_message(format!(
            "{intervals} intervals  iteration {}  objective {:.6e}  infeasibility {:.1e}  optimality {:.1e}{}",
            at.iteration,
            at.objective,
            at.primal_infeasibility,
            at.dual_infeasibility,
            if at.restoration { "  restoration" } else { "" }
        ));
    }

    /// So many starts have ended, some of them solved, with this objective at best.
    pub(super) fn start(&self, ended: usize, solved: usize, best: Option<f64>) {
        self.bar.set_position(ended as u64);
        let best = best.map_or_else(String::new, |best| format!(", best objective {best:.6e}"));
        self.bar.set_message(format!("({solved} solved{best})"));
    }

    /// Step `step` of so many is done.
    pub(super) fn step(&self, steps: usize, step: usize) {
        self.bar.set_length(steps as u64);
        self.bar.set_position(step as u64);
        let seconds = self.began.elapsed().as_secs_f64() / step.max(1) as f64;
        // Short steps are too many to watch.
        if seconds > 0.01 {
            self.bar.set_message(format!("({seconds:.2} s each)"));
        }
    }
}

/// A bar of another command: `length` steps, shown by a template of indicatif.
pub(crate) fn progress_bar(shown: Shown, length: u64, template: &str) -> ProgressBar {
    let bar = target(ProgressBar::new(length), shown);
    bar.set_style(style(template));
    bar
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn target(bar: ProgressBar, shown: Shown) -> ProgressBar {
    if shown == Shown::Never {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is well formed")
}
