//! JSON that is written: objects whose entries keep their order, laid out for people: a value that fits stands on one line.

use crate::files::json::tree::{Json, Tree};
use serde::{Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};

/// Columns of a line.
const WIDTH: usize = 110;

/// Lays out JSON text, as serde_json writes it.
pub(crate) fn lay_out(compact: &str) -> String {
    let mut text = String::with_capacity(compact.len() + compact.len() / 4);
    lines(Tree::of(compact.to_owned()).json(), 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes a value that starts `used` columns into a line, its parts indented one step further.
fn lines(json: Json<'_>, indent: usize, used: usize, text: &mut String) {
    let (written, count) = (json.written(), json.parts().len());
    // A character takes at most four bytes: a long list is not read in vain.
    let line = match written.len() <= 4 * WIDTH {
        _ if count == 0 => Some(json.to_string()),
        true if indent > 0 => Some(format!("{json:#}")),
        _ => None,
    };
    if let Some(line) = line.filter(|line| count == 0 || used + line.chars().count() <= WIDTH) {
        text.push_str(&line);
        return;
    }
    let start = |text: &mut String, steps: usize| {
        text.push('\n');
        text.extend(std::iter::repeat_n("  ", steps));
    };
    text.push_str(&written[..1]);
    for (index, part) in json.parts().enumerate() {
        if index > 0 {
            text.push(',');
        }
        start(text, indent + 1);
        let mut column = 2 * (indent + 1);
        let key = part.written_key();
        if !key.is_empty() {
            text.push_str(key);
            text.push_str(": ");
            column += key.chars().count() + 2;
        }
        lines(part, indent + 1, column, text);
    }
    start(text, indent);
    text.push_str(&written[written.len() - 1..]);
}

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
