//! Words of a conclusion: names of methods, lists of them, times.

use crate::math::significant;
use crate::study::read::Study;

/// Methods of which the same is said.
#[derive(Debug, Default)]
pub(super) struct Grouped(pub(super) Vec<(String, Vec<usize>)>);

impl Grouped {
    /// Says something of a method.
    pub(super) fn add(&mut self, words: String, method: usize) {
        match self.0.iter_mut().find(|(other, _)| *other == words) {
            Some((_, methods)) => methods.push(method),
            None => self.0.push((words, vec![method])),
        }
    }
}

/// Returns true if methods need names.
pub(super) fn several(study: &Study) -> bool {
    study.methods.len() > 1
}

/// The name of a method in backticks.
pub(super) fn name(study: &Study, method: usize) -> String {
    format!("`{}`", study.methods[method].name)
}

/// The names of methods.
pub(super) fn names(study: &Study, methods: &[usize]) -> String {
    list(methods.iter().map(|&m| name(study, m)).collect())
}

/// Names one after the other, with an "and" before the last.
pub(super) fn list(mut names: Vec<String>) -> String {
    match (names.pop(), names.is_empty()) {
        (Some(last), false) => format!("{} and {last}", names.join(", ")),
        (last, _) => last.unwrap_or_default(),
    }
}

/// A time in the unit that suits it.
pub(super) fn seconds(seconds: f64) -> String {
    match seconds {
        x if x >= 1.0 => format!("{} s", significant(x, 2)),
        x if x >= 1e-3 => format!("{} ms", significant(1e3 * x, 2)),
        x => format!("{} µs", significant(1e6 * x, 2)),
    }
}
