//! `report.html`: one self-contained page with the motion in space, its curves, and its texts.
//!
//! The page is written here as data and drawn in the browser: `page.html` and `page.css` are its frame, the modules `*.js` its
//! code, which stands on three.js and Chart.js.

mod charts;
pub mod compared;
mod disturbance;
mod scene;

use crate::report::origin::Origin;
use crate::report::quoting::escape;
use crate::report::{PageContent, Run};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::ops::Range;

/// The page of motions or paths of equilibria, of which it shows one with its charts, or of plots and words alone; `subject` stands before the
/// title, and the reader chooses among several motions by their names.
pub fn html(subject: &str, runs: &[Run<'_>], content: &PageContent, origin: &Origin) -> String {
    let (mut scenes, mut charts) = (Vec::new(), Vec::new());
    for run in runs.iter().map(Run::along_branch) {
        scenes.push(scene::scene(&run));
        let own = disturbance::chart(run.disturbed).into_iter();
        charts.extend(own.chain(charts::charts(&run)).map(|mut chart| {
            // The motion with which it is shown.
            chart["of"] = (runs.len() > 1).then_some(run.name).into();
            chart
        }));
    }
    // The path of equilibria has their fraction of the voltages upwards.
    let is_path = runs.iter().any(|run| run.branch.is_some());
    charts.extend(content.plots.iter().map(|plot| {
        let mut chart = charts::of_plot(plot);
        chart["level"] = is_path.into();
        chart
    }));
    let documents = content.documents.iter();
    let documents = documents.map(|(name, text)| json!({ "name": name, "text": text }));
    let data = json!({
        "title": content.title,
        "system": subject,
        "isSolved": content.is_solved,
        "answer": content.answer,
        "notes": content.notes,
        "rows": content.rows,
        "command": origin.command,
        "scenes": scenes,
        "charts": charts,
        "documents": documents.collect::<Vec<_>>(),
    });
    page(&format!("{subject}: {}", content.title), origin, &data)
}

/// Variants of one problem with their ends.
#[derive(Debug)]
pub struct Variants<'a> {
    /// Their kind: `Sweep`.
    pub kind: &'a str,
    /// Title of the page.
    pub title: &'a str,
    /// Their name in a sentence: `variants of pair.json`.
    pub of: String,
    /// Columns with what varies.
    pub varied: Range<usize>,
    /// Headings, then a row of cells for each variant, of which the first is its name.
    pub table: &'a [Vec<String>],
    /// The page of each variant that has an answer.
    pub pages: Vec<Option<String>>,
}

impl Variants<'_> {
    /// Their page: scatter plot of two columns, parallel coordinates of the varied values and results, and all rows.
    pub fn html(&self, origin: &Origin) -> String {
        let (count, all) = (self.pages.iter().flatten().count(), self.pages.len());
        let data = json!({
            "kind": self.kind,
            "title": self.title,
            "words": format!("{count} of {all} {} have an answer.", self.of),
            "varied": [self.varied.start, self.varied.end],
            "table": self.table,
            "pages": self.pages,
        });
        framed(VARIANTS, self.title, origin, &data, &[VARIANTS_MODULE])
    }
}

/// A page with its title, its origin, and its contents.
fn page(title: &str, origin: &Origin, data: &Value) -> String {
    framed(FRAME, title, origin, data, &MODULES)
}

/// A frame with its places `{{name}}` filled: `title`, `origin`, `sheet`, `data`, `script`, and `libraries`, the code of others;
/// `modules` are the code of the page in addition to the helpers that all pages share.
pub fn framed(frame: &str, title: &str, origin: &Origin, data: &Value, modules: &[&str]) -> String {
    // In JSON such a sign stands in texts only; there it must not end the script.
    let data = data.to_string().replace('<', "\\u003c");
    filled(
        frame,
        &[
            ("title", &escape(title)),
            ("origin", &escape(&origin.line())),
            ("sheet", SHEET),
            ("data", &data),
            ("libraries", &libraries()),
            ("script", &script(modules)),
        ],
    )
}

/// A text with its places `{{name}}` filled.
fn filled(frame: &str, parts: &[(&str, &str)]) -> String {
    let mut pieces = frame.split("{{");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        let part = parts.iter().find(|(other, _)| *other == name);
        text.push_str(part.map_or("", |(_, part)| part));
        text.push_str(rest);
    }
    text
}

/// A library: the name of its element, and its code, packed by gzip.
const LIBRARIES: [(&str, &[u8]); 2] = [
    (
        "three",
        include_bytes!(concat!(env!("OUT_DIR"), "/three.min.js.gz")),
    ),
    (
        "chart",
        include_bytes!(concat!(env!("OUT_DIR"), "/chart.min.js.gz")),
    ),
];

/// Frame and code of the page of variants.
const VARIANTS: &str = include_str!("variants.html");
const VARIANTS_MODULE: &str = include_str!("variants.js");
/// The page around everything, with places `{{name}}` for what differs.
const FRAME: &str = include_str!("page.html");
/// Style sheet of the page.
const SHEET: &str = include_str!("page.css");
/// Scripts that all pages share.
const HELPERS: [&str; 2] = [include_str!("read.js"), include_str!("theme.js")];
/// The modules of the page of a run in the order in which they need each other.
const MODULES: [&str; 10] = [
    include_str!("clock.js"),
    include_str!("camera.js"),
    include_str!("parts.js"),
    include_str!("picture.js"),
    include_str!("ground.js"),
    include_str!("scene.js"),
    include_str!("charts.js"),
    include_str!("answer.js"),
    include_str!("print.js"),
    include_str!("start.js"),
];

/// A page's own code: one function around helpers and modules.
fn script(modules: &[&str]) -> String {
    let (helpers, modules) = (HELPERS.concat(), modules.concat());
    format!("(() => {{\n\"use strict\";\n{helpers}{modules}}})();\n")
}

/// The elements of the libraries, which the page unpacks.
fn libraries() -> String {
    let elements = LIBRARIES.map(|(name, code)| {
        let text = STANDARD.encode(code);
        format!("<script type=\"application/gzip\" id=\"library-{name}\">{text}</script>\n")
    });
    elements.concat()
}
