//! Error in a scene or a problem: the place, the value found, the value expected, and the nearest name.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use crate::files::json::path::JsonPath;

/// An error in a file or in an override; [`fmt::Display`] is one readable line, [`SceneError::excerpt`] the text around it.
#[derive(Clone, Debug)]
pub struct SceneError(Box<Mistake>);

/// A value that is read, or the first error.
pub type Result<T, E = SceneError> = std::result::Result<T, E>;

#[derive(Clone, Debug, Default)]
pub(crate) struct Mistake {
    /// File as the user named it.
    pub(crate) file: String,
    /// Path of the value in the file, empty for the whole.
    pub(crate) path: String,
    /// Value that was found.
    pub(crate) found: String,
    /// Value that is expected instead.
    pub(crate) expected: String,
    /// The nearest name.
    pub(crate) nearest: Option<String>,
    /// The lines of the file around the value.
    pub(crate) source: Option<Excerpt>,
    /// The place as it was typed, where the value comes from an override.
    pub(crate) overridden: Option<JsonPath>,
}

impl Mistake {
    /// One of a file, or of a line of it, without more places.
    pub(crate) fn of_file(
        file: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            file: file.into(),
            found: found.into(),
            expected: expected.into(),
            ..Self::default()
        }
    }
}

/// Lines of a file around a value.
#[derive(Clone, Debug)]
pub(crate) struct Excerpt {
    /// The lines, as they are shown; none where one of them is too long.
    lines: Option<String>,
    /// Number of the first one.
    first: usize,
    /// Byte of the file where they begin.
    start: usize,
    /// Bytes of the value in the file.
    span: Range<usize>,
}

impl Excerpt {
    /// Around some bytes of a text.
    pub(crate) fn of(text: &str, span: Range<usize>) -> Self {
        let before = text.get(..span.start).unwrap_or_default();
        let start = before
            .rmatch_indices('\n')
            .nth(CONTEXT)
            .map_or(0, |(at, _)| at + 1);
        let mut after = text.get(span.end..).unwrap_or_default().match_indices('\n');
        let end = after
            .nth(CONTEXT)
            .map_or(text.len(), |(at, _)| span.end + at);
        let lines = &text[start..end];
        let is_long = lines.lines().any(|line| line.len() > LONGEST_LINE);
        Self {
            lines: (!is_long).then(|| shown(lines).into_owned()),
            first: 1 + before[..start].matches('\n').count(),
            start,
            span,
        }
    }
}

/// The text with question marks, as many as bytes, in place of unprintable characters, and spaces for carriage returns; places
/// in it stay where they are.
fn shown(text: &str) -> Cow<'_, str> {
    replaced(text, &['\n', '\t'], |c| match c {
        '\r' => " ".to_owned(),
        _ => "?".repeat(c.len_utf8()),
    })
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

    /// Returns the value that was found.
    pub fn found(&self) -> &str {
        &self.0.found
    }

    /// Returns the value that is expected instead.
    pub fn expected(&self) -> &str {
        &self.0.expected
    }

    /// The nearest name, where a name is wrong.
    pub fn nearest(&self) -> Option<&str> {
        self.0.nearest.as_deref()
    }

    /// The place of the override that the wrong value comes from, as it was typed.
    pub(crate) fn overridden(&self) -> Option<&JsonPath> {
        self.0.overridden.as_ref()
    }

    /// The lines of the file around the error, marked, where there is such a place.
    pub fn excerpt(&self) -> Option<String> {
        let Excerpt {
            lines,
            first,
            start,
            span,
        } = self.0.source.as_ref()?;
        let lines = lines.as_deref()?;
        let label = format!("expected {}", printable(&shortened(&self.0.expected, TOLD)));
        let span = span.start - start..span.end - start;
        let file = printable(&self.0.file);
        let snippet = Snippet::source(lines)
            .path(file.as_ref())
            .line_start(*first)
            .fold(lines.lines().count() > UNFOLDED)
            .annotation(AnnotationKind::Primary.span(span).label(label));
        Some(
            Renderer::plain()
                .render(&[Level::ERROR.no_name().secondary_title("").element(snippet)]),
        )
    }

    /// Bytes of the wrong value in the file.
    pub fn span(&self) -> Option<Range<usize>> {
        self.0.source.as_ref().map(|source| source.span.clone())
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
        let told = |text: &str| printable(&shortened(text, TOLD)).into_owned();
        write!(f, "{}: ", told(file))?;
        if !path.is_empty() {
            write!(f, "{}: ", told(path))?;
        }
        write!(f, "found {}", told(found))?;
        if overridden.is_some() {
            f.write_str(" (set on the command line)")?;
        }
        write!(
            f,
            ", expected {}",
            printable(&shortened(expected, EXPECTED))
        )?;
        if let Some(nearest) = nearest {
            write!(f, "; did you mean {:?}?", shortened(nearest, TOLD))?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

/// Returns true if a character only shows itself: a control character can command a terminal, and marks of direction can make a line
/// read as what it does not say.
pub(crate) fn is_printable(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text with something else in place of characters that are not printable and none of those `kept`.
fn replaced<'t>(text: &'t str, kept: &[char], by: impl Fn(char) -> String) -> Cow<'t, str> {
    let stays = |c: &char| is_printable(*c) || kept.contains(c);
    if text.chars().all(|c| stays(&c)) {
        return Cow::Borrowed(text);
    }
    let shown = text.chars().map(|c| match stays(&c) {
        true => c.to_string(),
        false => by(c),
    });
    Cow::Owned(shown.collect())
}

fn escape(c: char) -> String {
    c.escape_default().to_string()
}

/// A text in which characters that are not printable stand as their escapes, such as `\u{1b}`.
pub fn printable(text: &str) -> Cow<'_, str> {
    replaced(text, &[], escape)
}

/// Lines shown before and after an error.
const CONTEXT: usize = 1;
/// Number of lines of an error above which only the first and the last lines are shown.
const UNFOLDED: usize = 8;
/// Bytes of the longest line that is shown.
const LONGEST_LINE: usize = 2000;
/// Maximum number of characters shown of a name of a file, of a path, or of a value found.
const TOLD: usize = 400;
/// Maximum number of characters shown of an expected value, which may be a list of names.
const EXPECTED: usize = 1200;
/// Characters of the longest message.
const MESSAGE: usize = 4000;

/// Shortens a text to this number of characters: of a longer one its beginning and its end stay.
fn shortened(text: &str, most: usize) -> Cow<'_, str> {
    // A character takes at most four bytes.
    let length = match text.len() <= most {
        true => return Cow::Borrowed(text),
        false => text.chars().count(),
    };
    if length <= most {
        return Cow::Borrowed(text);
    }
    let kept = most - 1;
    let (head, tail) = (kept - kept / 3, kept / 3);
    let at = |n: usize| text.char_indices().nth(n).map_or(text.len(), |(at, _)| at);
    Cow::Owned(format!(
        "{}…{}",
        &text[..at(head)],
        &text[at(length - tail)..]
    ))
}

/// Formats a message in one line of a few thousand characters, with escapes for those that are not printable.
pub fn message(text: &str) -> String {
    printable(&shortened(text, MESSAGE)).into_owned()
}

/// The same of a note, whose lines stay lines.
pub fn note(text: &str) -> String {
    lines(&shortened(text, MESSAGE))
}

/// Lines in which characters that are not printable stand as their escapes; tabs are printable.
pub fn lines(text: &str) -> String {
    replaced(text, &['\n', '\t'], escape).into_owned()
}

/// A JSON text in which characters that are not printable stand as escapes of JSON.
pub fn printable_json(text: &str) -> String {
    // All of them are below 2^16.
    let escape = |c: char| format!("\\u{:04x}", u32::from(c));
    replaced(text, &['\n', '\t'], escape).into_owned()
}

/// The candidate most like a name, where one is like enough.
pub(crate) fn nearest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    // More letters than may differ: a long text is not compared letter by letter.
    let length = name.chars().count();
    let allowed = |candidate: &str| candidate.chars().count().max(3) / 3;
    candidates
        .into_iter()
        .filter(|one| one.chars().count().abs_diff(length) <= allowed(one))
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .filter(|&(distance, candidate)| distance <= allowed(candidate))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate.to_owned())
}
