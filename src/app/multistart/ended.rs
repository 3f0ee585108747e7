//! Starts of a problem, their ends, and the comparison of the optima of several.

use super::rank::Rank;
use crate::app::batch::{RunEnd, Said};
use crate::app::error::CommandError;
use crate::app::kept::record::{WrittenSummary, parsed};
use crate::app::request::CommandInput;
use crate::stop;
use serde::{Deserialize, Serialize};
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
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Ended {
    /// Its number, from 1.
    pub(super) start: usize,
    /// Seed of a random guess; none for the guess of the problem itself.
    pub(super) seed: Option<u64>,
    /// The word of its summary; `not_started`, or `failed` where it left none.
    pub(super) status: String,
    /// Reason why it left no summary.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) message: Option<String>,
    pub(super) objective: Option<f64>,
    pub(super) iterations: Option<usize>,
    /// Greatest violation of an equation or limit.
    pub(super) infeasibility: Option<f64>,
    pub(super) seconds: f64,
    /// Number of the optimum it found, from 1 for the best.
    pub(super) optimum: Option<usize>,
    #[serde(skip)]
    pub(super) is_solved: bool,
    /// True if nothing warns that it leaves its goal afterwards, or does not come back to its period.
    #[serde(skip)]
    pub(super) is_held: bool,
    #[serde(skip)]
    pub(super) voltages: Vec<f64>,
    /// Further notes on it.
    #[serde(skip)]
    pub(super) notes: Vec<String>,
}

/// Entries that are read of the solution of a start.
#[derive(Deserialize)]
struct SolutionRecord {
    voltages: BTreeMap<String, Vec<f64>>,
}

impl Ended {
    /// Reads what a start left.
    ///
    /// # Errors
    /// It says that the input is wrong.
    pub(super) fn from_run(
        start: Start,
        end: &RunEnd,
        folder: &Path,
    ) -> Result<Self, CommandError> {
        if let Said::Refused(message) = &end.said {
            return Err(CommandError::Start {
                start: start.number,
                message: message.clone(),
            });
        }
        let path = folder_of(folder, start.number);
        let mut ended = Self {
            start: start.number,
            seed: start.seed,
            seconds: end.seconds,
            is_held: true,
            ..Self::default()
        };
        match end.summary(&path) {
            Some(summary) => ended.read(summary, &path, end.said == Said::Solved),
            None if end.said == Said::NotStarted => "not_started".clone_into(&mut ended.status),
            None if stop::requested() => "interrupted".clone_into(&mut ended.status),
            None => {
                "failed".clone_into(&mut ended.status);
                ended.message = end.message();
            }
        }
        Ok(ended)
    }

    /// Takes the numbers of a summary, and voltages and notes of the motions beside it.
    fn read(&mut self, summary: WrittenSummary, path: &Path, is_solved: bool) {
        let own = summary.motions.iter().map(|one| path.join(&one.folder));
        let mut folders: Vec<PathBuf> = own.collect();
        let mut remarks = vec![(None, summary.notes)];
        for (motion, own) in summary.motions.iter().zip(&folders) {
            let own = WrittenSummary::of_folder(own);
            remarks.extend(own.map(|own| (Some(&motion.name), own.notes)));
        }
        if folders.is_empty() {
            folders.push(path.to_owned());
        }
        let solutions = folders.iter().filter(|_| is_solved);
        let solutions =
            solutions.filter_map(|own| parsed::<SolutionRecord>(&own.join("solution.json")));
        let mut all = remarks.iter().flat_map(|(_, own)| &own.0);
        self.is_held = !all.any(|one| LEAVES.contains(&&*one.code));
        self.voltages = solutions
            .flat_map(|one| one.voltages.into_values().flatten())
            .collect();
        for (motion, own) in &remarks {
            let name = motion.map(|name| format!("motion \"{name}\": "));
            let name = name.unwrap_or_default();
            self.notes
                .extend(own.lines().map(|line| format!("{name}{line}")));
        }
        self.status = summary.status;
        self.objective = summary.objective;
        self.iterations = summary.iterations;
        self.infeasibility = summary.infeasibility;
        self.seconds = summary.seconds.total;
        self.is_solved = is_solved;
    }

    /// Its rank.
    fn rank(&self) -> Rank {
        match (self.is_solved, self.objective) {
            (true, Some(objective)) => Rank::of_optimum(objective, self.is_held),
            _ => Rank::of_end(self.infeasibility),
        }
    }

    /// Returns true if two solutions are one optimum.
    fn is_same(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.objective, other.objective) else {
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
pub(super) fn best(ended: &[Ended]) -> Option<usize> {
    let best = (0..ended.len()).min_by(|&a, &b| ended[a].rank().compare(&ended[b].rank()))?;
    ended[best].rank().has_point().then_some(best)
}

/// Numbers the distinct optima, the best first; returns their number.
pub(super) fn number_optima(ended: &mut [Ended]) -> usize {
    let mut solved: Vec<usize> = (0..ended.len()).filter(|&i| ended[i].is_solved).collect();
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
