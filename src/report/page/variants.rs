//! The page of variants of one problem: scatter plot of two columns, parallel coordinates of the varied values and results, and all rows.

use crate::report::origin::Origin;
use crate::report::page::framed;
use serde_json::json;

/// The page around everything, as that of a run.
const FRAME: &str = include_str!("variants.html");
/// Script that draws it.
const MODULE: &str = include_str!("variants.js");

/// Variants of one problem with their ends.
#[derive(Debug)]
pub struct Variants<'a> {
    /// What they are: `Sweep`.
    pub kind: &'a str,
    /// Title of the page.
    pub title: &'a str,
    /// How many have an answer, in a sentence.
    pub words: String,
    /// Number of columns, after name, status and seconds, with what varies.
    pub places: usize,
    /// Headings, then a row of cells for each variant.
    pub table: &'a [Vec<String>],
    /// The page of each variant that has an answer.
    pub pages: Vec<Option<String>>,
}

/// The page.
pub fn html(variants: &Variants<'_>, origin: &Origin) -> String {
    let data = json!({
        "kind": variants.kind,
        "title": variants.title,
        "words": variants.words,
        "places": variants.places,
        "table": variants.table,
        "pages": variants.pages,
    });
    framed(FRAME, variants.title, origin, &data, &[MODULE])
}
