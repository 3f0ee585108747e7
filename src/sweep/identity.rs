//! What tells whether two variants are one, and whether a result is that of a variant.

use std::fmt;

use crate::app::digest;
use crate::files::Loaded;
use crate::report::origin::Origin;

/// Digits of an identity.
const DIGITS: usize = 16;

/// Hexadecimal digits of a hash of a problem as it was read, with the files that it names, and of the version of the program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Identity(String);

impl Identity {
    /// Of a problem.
    pub(super) fn of_problem(loaded: &Loaded) -> Self {
        // All numbers are written so that they read back identical.
        Self::of(format_args!("{:?}{:?}", loaded.system, loaded.task))
    }

    /// Of overrides that make no problem.
    pub(super) fn of_words(words: &[String]) -> Self {
        Self::of(format_args!("{words:?}"))
    }

    fn of(written: fmt::Arguments<'_>) -> Self {
        let program = Origin::program();
        Self(digest(format_args!("{program}\n{written}"), DIGITS))
    }

    /// Its digits.
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }
}
