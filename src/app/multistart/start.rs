//! A starting point, and its solve.

use std::path::{Path, PathBuf};

use crate::app::request::CommandInput;

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
