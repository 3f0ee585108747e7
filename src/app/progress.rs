//! Progress on standard error: the phase of work before there is anything to count, the iterations of a solve, the steps of a
//! simulation.

use crate::ipopt::Iteration;
use crate::workflow::listen_to_phases;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::RefCell;
use std::sync::mpsc;
use std::sync::mpsc::{RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

/// Display of progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgressDisplay {
    /// If standard error is a terminal.
    OnTerminal,
    /// Never.
    #[default]
    Never,
}

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub enum Reached<'a> {
    /// A solve on this number of intervals accepted an iterate.
    Iteration(usize, &'a Iteration),
    /// A simulation has done this number of steps, up to this time in ms.
    Step(usize, f64),
}

thread_local! {
    /// The line of the run of this thread.
    static LINE: RefCell<Option<ProgressBar>> = const { RefCell::new(None) };
}

/// Shows what this thread does: reading, building, ….
fn show_phases() {
    listen_to_phases(|doing| {
        LINE.with_borrow(|line| {
            if let Some(bar) = line {
                bar.set_message(doing);
                bar.tick();
            }
        });
    });
}

/// A line that changes during a run.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    began: Instant,
    before: Option<ProgressBar>,
    _ticker: Option<Ticker>,
}

impl Progress {
    /// A solve with an open number of iterations, or a run of which only the phase is known yet.
    pub(super) fn of_solve(shown: ProgressDisplay) -> Self {
        let template = "{spinner} {elapsed_precise} {msg}";
        Self::starting(progress_bar(shown, None, template))
    }

    /// A simulation of `steps` steps.
    pub(super) fn of_steps(shown: ProgressDisplay, steps: usize) -> Self {
        let template = "{elapsed_precise} {bar:20} step {pos} of {len} {msg}";
        Self::starting(progress_bar(shown, Some(steps), template))
    }

    /// Several runs, each of which is called `what`.
    pub(super) fn of_runs(shown: ProgressDisplay, what: &str, count: usize) -> Self {
        let template =
            format!("{{elapsed_precise}} {{wide_bar}} {what} {{pos}} of {{len}} {{msg}}");
        Self::starting(progress_bar(shown, Some(count), &template))
    }

    /// Shows a bar in the place of the one before.
    fn starting(bar: ProgressBar) -> Self {
        let ticker = match bar.is_hidden() {
            true => None,
            false => Ticker::for_bar(&bar),
        };
        show_phases();
        let before = LINE.replace(Some(bar.clone()));
        if let Some(line) = &before {
            line.finish_and_clear();
        }
        Self {
            bar,
            began: Instant::now(),
            before,
            _ticker: ticker,
        }
    }

    /// Reports an accepted iterate on a number of intervals.
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

    /// Numbers of starts that have ended and of those that are solved, and the best objective.
    pub(super) fn run(&self, ended: usize, solved: usize, best: Option<f64>) {
        self.bar.set_position(ended as u64);
        let best = best.map_or_else(String::new, |best| format!(", best objective {best:.6e}"));
        let waiting = self.bar.length().unwrap_or(0).saturating_sub(ended as u64);
        let seconds = self.began.elapsed().as_secs_f64() / ended.max(1) as f64;
        let left = match waiting {
            0 => String::new(),
            waiting => left(seconds * waiting as f64),
        };
        self.bar
            .set_message(format!("({solved} solved{best}{left})"));
    }

    /// Reports that step `step` is done.
    pub(super) fn step(&self, steps: usize, step: usize) {
        // The number of steps that a tolerance controls is not known.
        let known = if steps == usize::MAX { step } else { steps };
        self.bar.set_length(known as u64);
        self.bar.set_position(step as u64);
        let seconds = self.began.elapsed().as_secs_f64() / step.max(1) as f64;
        // Short steps are too many to watch.
        if seconds > 0.01 {
            let left = match steps {
                usize::MAX => String::new(),
                _ => left(seconds * steps.saturating_sub(step) as f64),
            };
            self.bar.set_message(format!("{seconds:.2} s each{left}"));
        }
    }
}

/// The time that is left as one says it.
fn left(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!(", about {s:.0} s left"),
        s if s < 5400.0 => format!(", about {:.0} min left", s / 60.0),
        s => format!(", about {:.1} h left", s / 3600.0),
    }
}

/// A bar of a number of steps, where it is known, shown by a template of indicatif.
pub(crate) fn progress_bar(
    shown: ProgressDisplay,
    steps: Option<usize>,
    template: &str,
) -> ProgressBar {
    let bar = ProgressBar::no_length();
    if let Some(steps) = steps {
        bar.set_length(steps as u64);
    }
    if shown == ProgressDisplay::Never {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    let style = ProgressStyle::with_template(template);
    bar.with_style(style.expect("the template is well formed"))
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some(line) = &self.before {
            line.reset();
            line.set_message("finishing");
        }
        LINE.set(self.before.take());
    }
}

/// Time between two pictures of the line.
const PERIOD: Duration = Duration::from_millis(120);

/// A thread that draws a line again and again, until it is dropped.
#[derive(Debug)]
pub(super) struct Ticker {
    /// Nothing is ever sent: the thread notices that it is gone.
    _alive: Sender<()>,
}

impl Ticker {
    /// Draws a line; none where no thread can be had, and then it is drawn at the next message.
    pub(super) fn for_bar(bar: &ProgressBar) -> Option<Self> {
        let (alive, gone) = mpsc::channel();
        let bar = bar.downgrade();
        let draw = move || {
            while gone.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                match bar.upgrade() {
                    Some(bar) if bar.is_finished() => {}
                    Some(bar) => bar.tick(),
                    None => return,
                }
            }
        };
        let thread = thread::Builder::new().spawn(draw);
        thread.is_ok().then_some(Self { _alive: alive })
    }
}
