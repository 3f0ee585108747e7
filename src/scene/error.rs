//! What is wrong with a scene or a problem: the place, what was found, what is expected, and the nearest name.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

/// A mistake in a file or in an override; [`fmt::Display`] is one readable line, miette shows the text around it.
#[derive(Clone, Debug)]
pub struct SceneError(Box<Mistake>);

#[derive(Clone, Debug)]
pub(crate) struct Mistake {
    /// File as the user named it.
    pub(crate) file: String,
    /// Path of the value in the file, empty for the whole.
    pub(crate) path: String,
    /// What was found.
    pub(crate) found: String,
    /// What is expected instead.
    pub(crate) expected: String,
    /// The nearest name.
    pub(crate) nearest: Option<String>,
    /// Text of the file and the bytes of the value.
    pub(crate) source: Option<(NamedSource<String>, Range<usize>)>,
    /// Whether the value comes from the command line.
    pub(crate) overridden: bool,
}

impl From<Mistake> for SceneError {
    fn from(mistake: Mistake) -> Self {
        Self(Box::new(mistake))
    }
}

impl SceneError {
    /// Path of the wrong value, such as `muscles[1].from.body`; empty for the whole file.
    pub fn path(&self) -> &str {
        &self.0.path
    }

    /// What was found.
    pub fn found(&self) -> &str {
        &self.0.found
    }

    /// What is expected instead.
    pub fn expected(&self) -> &str {
        &self.0.expected
    }

    /// The nearest name, where a name is wrong.
    pub fn nearest(&self) -> Option<&str> {
        self.0.nearest.as_deref()
    }

    /// Whether the wrong value comes from an override.
    pub(crate) fn is_overridden(&self) -> bool {
        self.0.overridden
    }

    /// Bytes of the wrong value in the file.
    pub fn span(&self) -> Option<Range<usize>> {
        self.0.source.as_ref().map(|(_, span)| span.clone())
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Mistake {
            file,
            path,
            found,
            expected,
            nearest,
            overridden,
            ..
        } = self.0.as_ref();
        write!(f, "{}: ", printable(file))?;
        if !path.is_empty() {
            write!(f, "{}: ", printable(&shortened(path)))?;
        }
        write!(f, "found {}", printable(&shortened(found)))?;
        if *overridden {
            f.write_str(" (set on the command line)")?;
        }
        write!(f, ", expected {}", printable(expected))?;
        if let Some(nearest) = nearest {
            write!(f, "; did you mean {nearest:?}?")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        let (source, _) = self.0.source.as_ref()?;
        Some(source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = format!("expected {}", printable(&self.0.expected));
        let span = LabeledSpan::at(self.span()?, label);
        Some(Box::new([span].into_iter()))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let nearest = self.0.nearest.as_ref()?;
        Some(Box::new(format!("did you mean {nearest:?}?")))
    }
}

/// Whether a character only shows itself: a control character can command a terminal, and marks of direction can make a line
/// read as what it does not say.
pub(crate) fn is_printable(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text in which characters that are not printable stand as their escapes, such as `\u{1b}`.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_printable) {
        return Cow::Borrowed(text);
    }
    let escaped = text.chars().map(|c| match is_printable(c) {
        true => c.to_string(),
        false => c.escape_default().to_string(),
    });
    Cow::Owned(escaped.collect())
}

/// Characters of a path or of what was found that are told.
const TOLD: usize = 400;

/// A text of the file that is told in a line: its beginning, where it is long.
fn shortened(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(TOLD) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// The candidate most like a name, where one is like enough.
pub(crate) fn nearest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|&(distance, candidate)| distance <= candidate.chars().count().max(3) / 3)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate.to_owned())
}
