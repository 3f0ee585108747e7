//! Request of the command `sweep`.

use std::path::PathBuf;
use std::str::FromStr;

use crate::app::{ProgressDisplay, RunIn};

/// A command on a sweep file.
#[derive(Clone, Debug)]
pub struct SweepRequest {
    /// The command as typed.
    pub command: String,
    /// The sweep file as typed.
    pub input: PathBuf,
    /// Folder for the results; `results/sweeps/<name of the sweep>` where not given.
    pub output: Option<PathBuf>,
    /// The part of the variants that is solved.
    pub shard: Shard,
    /// Processes or threads in which variants are solved.
    pub run_in: RunIn,
    /// Seconds that the whole command may take.
    pub max_seconds: Option<f64>,
    /// Display of progress.
    pub progress: ProgressDisplay,
}

impl SweepRequest {
    /// Folder for the results.
    pub fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = self.input.file_stem().unwrap_or_default();
            PathBuf::from("results/sweeps").join(stem)
        })
    }
}

/// Each n-th variant, from the i-th one: what one of n machines does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// All variants.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Returns true if the variant with an index belongs to it.
    pub(crate) fn has(self, index: usize) -> bool {
        index % self.of == self.number - 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let parsed = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parsed {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("expected i/n with 1 <= i <= n, such as 2/8".to_owned()),
        }
    }
}
