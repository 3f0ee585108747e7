//! Starts of a problem, their ends, and the comparison of the optima of several.

use super::rank::Rank;
use crate::app::batch::Ended;
use crate::app::error::CommandError;
use crate::app::kept::record::{WrittenSummary, parsed};
use crate::app::request::CommandInput;
use crate::files::Entries;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Relative difference of the objectives of one optimum.
const SAME_OBJECTIVE: f64 = 1e-6;

/// Difference of the voltages of one optimum, relative to the largest: weakly bounded ones are known to 1e-4.
const SAME_VOLTAGE: f64 = 1e-3;

/// Warnings about an optimum whose goal is not held, or whose period does not come back.
const LEAVES: [&str; 2] = ["goal_not_held", "not_periodic"];

/// Folder of the starts within that of the results.
pub(super) const FOLDER: &str = "starts";

/// Folder of one start.
pub(super) fn folder_of(folder: &Path, start: usize) -> PathBuf {
    folder.join(FOLDER).join(format!("{start:02}"))
}

/// A starting point of a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// Its number, from 1.
    pub(super) number: usize,
    /// Seed of a random guess; none for the guess of the problem itself.
    pub(super) seed: Option<u64>,
}

impl Start {
    /// Its solve, of a problem whose guesses stand at these `places`.
    ///
    /// All guesses have one seed, so that inputs which motions share begin alike.
    pub(super) fn run(
        self,
        request: &CommandInput,
        folder: &Path,
        places: &[String],
    ) -> CommandInput {
        let mut run = CommandInput {
            output: Some(folder_of(folder, self.number)),
            ..request.clone()
        };
        if let Some(seed) = self.seed {
            let guess = |place| format!("{place}={{\"random\":{{\"seed\":{seed}}}}}");
            run.set.extend(places.iter().map(guess));
        }
        run
    }
}

/// End of one start.
#[derive(Debug)]
pub(super) struct StartEnd {
    pub(super) start: Start,
    pub(super) ended: Ended,
    /// Number of the optimum it found, from 1 for the best.
    pub(super) optimum: Option<usize>,
    /// True if nothing warns that it leaves its goal afterwards, or does not come back to its period.
    pub(super) is_held: bool,
    voltages: Vec<f64>,
    /// Notes on it and its motions.
    pub(super) notes: Vec<String>,
}

/// Entries that are read of the solution of a start.
#[derive(Deserialize)]
struct SolutionRecord {
    voltages: BTreeMap<String, Vec<f64>>,
}

impl StartEnd {
    /// Reads what a start left in its folder: its summary, and voltages and notes of the motions beside it.
    ///
    /// # Errors
    /// It says that the input is wrong.
    pub(super) fn new(start: Start, ended: Ended, folder: &Path) -> Result<Self, CommandError> {
        let summary = &ended.summary;
        if summary.status == "refused" {
            return Err(CommandError::Start {
                start: start.number,
                message: ended.message.unwrap_or_default(),
            });
        }
        let path = folder_of(folder, start.number);
        let own = summary.motions.iter().map(|one| path.join(&one.folder));
        let mut folders: Vec<PathBuf> = own.collect();
        let mut remarks = vec![(None, summary.notes.clone())];
        for (motion, own) in summary.motions.iter().zip(&folders) {
            let own = WrittenSummary::of_folder(own);
            remarks.extend(own.map(|own| (Some(&motion.name), own.notes)));
        }
        if folders.is_empty() {
            folders.push(path);
        }
        let solutions = folders.iter().filter(|_| ended.is_solved);
        let solutions =
            solutions.filter_map(|own| parsed::<SolutionRecord>(&own.join("solution.json")));
        let voltages = solutions.flat_map(|one| one.voltages.into_values().flatten());
        let mut all = remarks.iter().flat_map(|(_, own)| &own.0);
        let notes = remarks.iter().flat_map(|(motion, own)| {
            let name = motion.map_or_else(String::new, |name| format!("motion \"{name}\": "));
            let lines = own.lines();
            lines.map(move |line| format!("{name}{line}"))
        });
        Ok(Self {
            optimum: None,
            is_held: !all.any(|one| LEAVES.contains(&&*one.code)),
            voltages: voltages.collect(),
            notes: notes.collect(),
            start,
            ended,
        })
    }

    /// Objective of its point, where there is one.
    pub(super) fn objective(&self) -> Option<f64> {
        self.ended.summary.objective
    }

    /// Its part of the summary.
    pub(super) fn entries(&self) -> Entries {
        let summary = &self.ended.summary;
        Entries::default()
            .with("start", self.start.number)
            .with("seed", self.start.seed)
            .with("status", &summary.status)
            .with_some("message", self.ended.message.as_ref())
            .with("objective", summary.objective)
            .with("iterations", summary.iterations)
            // Greatest violation of an equation or limit.
            .with("infeasibility", summary.infeasibility)
            .with("seconds", summary.seconds.total)
            .with("optimum", self.optimum)
    }

    fn rank(&self) -> Rank {
        match self.objective() {
            Some(objective) if self.ended.is_solved => Rank::of_optimum(objective, self.is_held),
            _ => Rank::of_end(self.ended.summary.infeasibility),
        }
    }

    /// Returns true if two solutions are one optimum.
    fn is_same(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.objective(), other.objective()) else {
            return false;
        };
        let close = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance;
        let largest = self
            .voltages
            .iter()
            .fold(0.0, |most: f64, v| most.max(v.abs()));
        close(a, b, SAME_OBJECTIVE * a.abs().max(b.abs()))
            && self.voltages.len() == other.voltages.len()
            && self
                .voltages
                .iter()
                .zip(&other.voltages)
                .all(|(a, b)| close(*a, *b, SAME_VOLTAGE * largest))
    }
}

/// The best start: see [`Rank`]; none where no start left a point.
pub(super) fn best(ended: &[StartEnd]) -> Option<usize> {
    let best = (0..ended.len()).min_by(|&a, &b| ended[a].rank().compare(&ended[b].rank()))?;
    ended[best].rank().has_point().then_some(best)
}

/// Numbers the distinct optima, the best first; returns their number.
pub(super) fn number_optima(ended: &mut [StartEnd]) -> usize {
    let mut solved: Vec<usize> = (0..ended.len())
        .filter(|&i| ended[i].ended.is_solved)
        .collect();
    solved.sort_by(|&a, &b| ended[a].rank().compare(&ended[b].rank()));
    let mut firsts: Vec<usize> = Vec::new();
    for i in solved {
        let known = firsts
            .iter()
            .position(|&first| ended[first].is_same(&ended[i]));
        let number = known.unwrap_or_else(|| {
            firsts.push(i);
            firsts.len() - 1
        });
        ended[i].optimum = Some(number + 1);
    }
    firsts.len()
}
