//! Entries of a JSON object in the order in which they are added.

use crate::files::json::layout::lay_out;
use serde::{Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};

/// Names with values: a section of a result, which says the name of a value and where it is from at once, in the order of the file.
///
/// ```text
/// Entries::default()
///     .with("steps", steps)
///     .with_some("tolerance", task.tolerance)
/// ```
#[derive(Clone, Debug, Default)]
pub(crate) struct Entries(Vec<(&'static str, Box<RawValue>)>);

impl Entries {
    /// Adds a value.
    pub(crate) fn with(mut self, name: &'static str, value: impl Serialize) -> Self {
        let value = to_raw_value(&value).expect("numbers and words are JSON");
        self.0.push((name, value));
        self
    }

    /// Adds a value where there is one.
    pub(crate) fn with_some(self, name: &'static str, value: Option<impl Serialize>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Adds a list.
    pub(crate) fn with_each<T: Serialize>(
        self,
        name: &'static str,
        list: impl IntoIterator<Item = T>,
    ) -> Self {
        self.with(name, list.into_iter().collect::<Vec<_>>())
    }

    /// Adds a list that is not empty.
    pub(crate) fn with_any<T: Serialize>(
        self,
        name: &'static str,
        list: impl IntoIterator<Item = T>,
    ) -> Self {
        let list: Vec<_> = list.into_iter().collect();
        self.with_some(name, Some(list).filter(|list| !list.is_empty()))
    }

    /// Its text as a file.
    pub(crate) fn laid_out(&self) -> String {
        lay_out(&serde_json::to_string(self).expect("names and values are JSON"))
    }
}

impl Serialize for Entries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}
