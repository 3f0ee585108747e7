//! Remarks on a result: warnings and notes, each with a code by which programs find it and a text for people.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;

/// The code of a warning on a result that another attempt may find better, since this one was stopped.
pub(crate) const STOPPED_EARLY: &str = "stopped_early";

/// The weight of a remark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The result may be less than it seems.
    Warning,
    /// The result is as good as it seems; something about it is worth knowing.
    Note,
}

/// A warning or a note on a result; [`fmt::Display`] is one labelled text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// Warning or note.
    pub severity: Severity,
    /// The code, such as `coarse_intervals`, which stays while texts change.
    pub code: Cow<'static, str>,
    /// The text.
    pub text: String,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let label = match self.severity {
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        write!(f, "{label}: {}", self.text)
    }
}

/// Remarks in the order in which they are shown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Remarks(pub Vec<Remark>);

impl Remarks {
    /// Adds warnings with a code.
    pub fn warn(&mut self, code: &'static str, texts: impl IntoIterator<Item = String>) {
        self.add(Severity::Warning, code, texts);
    }

    /// Adds notes with a code.
    pub fn note(&mut self, code: &'static str, texts: impl IntoIterator<Item = String>) {
        self.add(Severity::Note, code, texts);
    }

    fn add(
        &mut self,
        severity: Severity,
        code: &'static str,
        texts: impl IntoIterator<Item = String>,
    ) {
        self.0.extend(texts.into_iter().map(|text| Remark {
            severity,
            code: code.into(),
            text,
        }));
    }

    /// Returns true if there is one with a code.
    pub fn have(&self, code: &str) -> bool {
        self.0.iter().any(|remark| remark.code == code)
    }

    /// Returns true if there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The labelled texts.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(Remark::to_string)
    }
}

type Listener = Box<dyn Fn(&'static str)>;

thread_local! {
    /// Listener to the phases of this thread.
    static LISTENER: RefCell<Option<Listener>> = const { RefCell::new(None) };
}

/// Makes this thread report its phases to `listener`: building the model, finding the start, ….
pub fn listen_to_phases(listener: impl Fn(&'static str) + 'static) {
    LISTENER.replace(Some(Box::new(listener)));
}

/// Reports the phase that begins now.
pub(crate) fn phase(doing: &'static str) {
    LISTENER.with_borrow(|listener| {
        if let Some(listener) = listener {
            listener(doing);
        }
    });
}
