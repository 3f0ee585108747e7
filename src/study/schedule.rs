//! All runs of a study: each point once to observe its answer, then round after round of timed runs, so that whatever else the
//! machine does falls on all alike.

use indicatif::ProgressBar;

use crate::app::{ProgressDisplay, progress_bar};
use crate::stop;
use crate::study::outcome::{Observed, RunOutcome, run};
use crate::study::read::{Method, Study, StudyPoint};

/// A point after its runs.
#[derive(Debug)]
pub struct Done<'a> {
    /// The point.
    pub point: &'a StudyPoint,
    /// Outcome of its first run, which is not timed.
    pub first: RunOutcome,
    /// Observations of its answer.
    pub seen: Option<Observed>,
    /// Seconds of its timed runs, ascending.
    pub seconds: Vec<f64>,
}

/// All points after their runs.
#[derive(Debug)]
pub struct Results<'a> {
    /// The study.
    pub study: &'a Study,
    /// The points of each method.
    pub methods: Vec<Vec<Done<'a>>>,
    /// Those of the reference alone, which are not timed.
    pub reference: Vec<Done<'a>>,
    /// True if Ctrl-C ended it early.
    pub is_interrupted: bool,
}

impl<'a> Results<'a> {
    /// Numbers of points with an answer, and of all.
    pub fn solved(&self) -> [usize; 2] {
        let points = || self.methods.iter().flatten();
        let solved = points().filter(|done| done.first.is_solved).count();
        [solved, points().count()]
    }

    /// Observations of all answers, those of the reference last.
    pub(super) fn seen(&self) -> impl Iterator<Item = &Observed> {
        let points = self.methods.iter().flatten().chain(&self.reference);
        points.filter_map(|done| done.seen.as_ref())
    }

    /// The methods with their points.
    pub fn each(&self) -> impl Iterator<Item = (&'a Method, &[Done<'a>])> {
        let points = self.methods.iter().map(Vec::as_slice);
        self.study.methods.iter().zip(points)
    }
}

/// A bar as long as all runs of a study.
pub(super) fn bar(study: &Study, runs: usize, shown: ProgressDisplay) -> ProgressBar {
    let count: usize = study.methods.iter().map(|m| m.points.len()).sum();
    progress_bar(
        shown,
        Some(study.of_reference.len() + count * (1 + runs)),
        "{elapsed_precise} {wide_bar} run {pos} of {len}  {msg}",
    )
}

/// Runs every point once and observes its answer; points that Ctrl-C leaves out are reported as interrupted.
pub(super) fn look<'a>(study: &'a Study, bar: &ProgressBar) -> Results<'a> {
    let look = |name: &str, point: &'a StudyPoint| {
        bar.set_message(format!("{name}, {}", point.label));
        let (first, seen) = run(point, Some(&study.markers));
        bar.inc(1);
        Done {
            point,
            first,
            seen,
            seconds: Vec::new(),
        }
    };
    let of_method = |method: &'a Method| {
        let points = method.points.iter();
        points.map(|point| look(&method.name, point)).collect()
    };
    let methods: Vec<Vec<_>> = study.methods.iter().map(of_method).collect();
    let reference = study.of_reference.iter();
    let reference = reference.map(|point| look("reference", point)).collect();
    Results {
        study,
        methods,
        reference,
        is_interrupted: stop::requested(),
    }
}

/// Times every point that has an answer in `runs` rounds, until Ctrl-C.
pub(super) fn time(results: &mut Results<'_>, runs: usize, bar: &ProgressBar) {
    for _ in 0..runs {
        for (method, points) in results.study.methods.iter().zip(&mut results.methods) {
            for done in points {
                done.time(&method.name, bar);
            }
        }
    }
    for done in results.methods.iter_mut().flatten() {
        done.seconds.sort_by(f64::total_cmp);
    }
    results.is_interrupted = stop::requested();
}

impl Done<'_> {
    /// One timed run, of a point that has an answer.
    fn time(&mut self, name: &str, bar: &ProgressBar) {
        if self.first.is_solved && !stop::requested() {
            bar.set_message(format!("{name}, {}", self.point.label));
            let (ended, _) = run(self.point, None);
            if ended.is_solved {
                self.seconds.push(ended.seconds);
            }
        }
        bar.inc(1);
    }

    /// Steps that had to be halved in the run that was observed.
    pub fn halved(&self) -> usize {
        self.seen.as_ref().map_or(0, |seen| seen.halved)
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
