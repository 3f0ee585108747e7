//! What is wrong with a scene or a problem: the place, what was found, what is expected, and the nearest name.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

/// A mistake in a file or in an override; [`fmt::Display`] is one readable line, [`SceneError::excerpt`] the text around it.
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
    pub(crate) source: Option<(String, Range<usize>)>,
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

    /// The lines of the file around the mistake, marked, where there is such a place.
    pub fn excerpt(&self) -> Option<String> {
        let (text, span) = self.0.source.as_ref()?;
        let before = text.get(..span.start)?;
        let from = before
            .rmatch_indices('\n')
            .nth(CONTEXT)
            .map_or(0, |(at, _)| at + 1);
        let mut after = text.get(span.end..)?.match_indices('\n');
        let to = after
            .nth(CONTEXT)
            .map_or(text.len(), |(at, _)| span.end + at);
        let shown = &text[from..to];
        if shown.lines().any(|line| line.len() > LONGEST_LINE) {
            return None;
        }
        let label = format!("expected {}", printable(&self.0.expected));
        let span = span.start - from..span.end - from;
        let file = printable(&self.0.file);
        let snippet = Snippet::source(shown)
            .path(file.as_ref())
            .line_start(1 + text[..from].matches('\n').count())
            .fold(shown.lines().count() > UNFOLDED)
            .annotation(AnnotationKind::Primary.span(span).label(label));
        Some(
            Renderer::plain()
                .render(&[Level::ERROR.no_name().secondary_title("").element(snippet)]),
        )
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

/// Lines shown before and after a mistake.
const CONTEXT: usize = 1;
/// Of mistakes that are longer than so many lines, the first and the last lines are shown.
const UNFOLDED: usize = 8;
/// Bytes of the longest line that is shown.
const LONGEST_LINE: usize = 2000;
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
