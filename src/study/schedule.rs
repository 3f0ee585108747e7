//! All runs of a study: each point once to look at its answer, then round after round by the clock, so that whatever else the
//! machine does falls on all alike.

use indicatif::ProgressBar;

use crate::ipopt::interrupt;
use crate::run::{Shown, progress_bar};
use crate::study::outcome::{Ended, INTERRUPTED, Seen, run};
use crate::study::read::{Point, Reference, Study};

/// A point after its runs.
#[derive(Debug)]
pub struct Done<'a> {
    /// The point.
    pub point: &'a Point,
    /// How its first run ended, which is not timed.
    pub first: Ended,
    /// What is seen of its answer.
    pub seen: Option<Seen>,
    /// Seconds of its timed runs, ascending.
    pub seconds: Vec<f64>,
}

/// All points after their runs.
#[derive(Debug)]
pub struct Results<'a> {
    /// The points of each method.
    pub methods: Vec<Vec<Done<'a>>>,
    /// Those of the reference alone, which are not timed.
    pub reference: Vec<Done<'a>>,
    /// Whether Ctrl-C ended it early.
    pub is_interrupted: bool,
}

/// Runs a study, `runs` times each point, until it is done or Ctrl-C is pressed.
pub fn run_all(study: &Study, runs: usize, shown: Shown) -> Results<'_> {
    let extra = match &study.reference {
        Reference::Own => [].as_slice(),
        Reference::Of { points, .. } => points.as_slice(),
    };
    let count: usize = study.methods.iter().map(|method| method.points.len()).sum();
    let bar = progress_bar(
        shown,
        (extra.len() + count * (1 + runs)) as u64,
        "{elapsed_precise} {wide_bar} run {pos} of {len}  {msg}",
    );
    let look = |name: &str, point: &'_ Point| -> (Ended, Option<Seen>) {
        bar.set_message(format!("{name}, {}", point.label));
        let result = match interrupt::requested() {
            true => (not_run(), None),
            false => run(point, Some(&study.markers)),
        };
        bar.inc(1);
        result
    };
    let mut methods: Vec<Vec<Done<'_>>> = Vec::new();
    for method in &study.methods {
        let points = method.points.iter().map(|point| {
            let (first, seen) = look(&method.name, point);
            Done::new(point, first, seen)
        });
        methods.push(points.collect());
    }
    let reference = extra.iter().map(|point| {
        let (first, seen) = look("reference", point);
        Done::new(point, first, seen)
    });
    let reference = reference.collect();
    for _ in 0..runs {
        for (method, points) in study.methods.iter().zip(&mut methods) {
            for done in points {
                done.time(&method.name, &bar);
            }
        }
    }
    for done in methods.iter_mut().flatten() {
        done.seconds.sort_by(f64::total_cmp);
    }
    bar.finish_and_clear();
    Results {
        methods,
        reference,
        is_interrupted: interrupt::requested(),
    }
}

fn not_run() -> Ended {
    Ended {
        status: INTERRUPTED,
        message: None,
        seconds: 0.0,
        is_solved: false,
    }
}

impl<'a> Done<'a> {
    fn new(point: &'a Point, first: Ended, seen: Option<Seen>) -> Self {
        Self {
            point,
            first,
            seen,
            seconds: Vec::new(),
        }
    }

    /// One timed run, of a point that has an answer.
    fn time(&mut self, name: &str, bar: &ProgressBar) {
        if self.first.is_solved && !interrupt::requested() {
            bar.set_message(format!("{name}, {}", self.point.label));
            let (ended, _) = run(self.point, None);
            if ended.is_solved {
                self.seconds.push(ended.seconds);
            }
        }
        bar.inc(1);
    }

    /// The part `fraction` of the runs took no longer than this; none where there was no run.
    pub fn quantile(&self, fraction: f64) -> Option<f64> {
        let last = self.seconds.len().checked_sub(1)?;
        let place = fraction * last as f64;
        let below = place.floor() as usize;
        let (a, b) = (self.seconds[below], self.seconds[(below + 1).min(last)]);
        Some(a + (b - a) * (place - below as f64))
    }

    /// Median of the seconds.
    pub fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }
}
