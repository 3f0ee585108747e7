//! `report.html`: one self-contained page with the motion in space, its curves, and its texts.
//!
//! The page is written here as data and drawn in the browser: `page.html` and `page.css` are its frame, the modules `*.js` its
//! code, which stands on three.js and Chart.js.

mod charts;
mod code;
pub mod compared;
mod disturbance;
mod scene;

use serde_json::{Value, json};

use crate::report::markup::escape;
use crate::report::origin::Origin;
use crate::report::{PageContent, Run};

/// The page of a run, or of a path of equilibria.
pub fn html(run: &Run<'_>, content: &PageContent) -> String {
    let run = &run.along_branch();
    let of_disturbance = disturbance::chart(run.disturbed).into_iter();
    let charts = of_disturbance.chain(charts::charts(run, content)).collect();
    let mut data = data(&run.system.name, content, charts, run.origin);
    data["scene"] = scene::scene(run);
    let title = format!("{}: {}", run.system.name, content.title);
    page(&title, run.origin, &data)
}

/// A page of plots and words without a motion; `subject` stands before the title.
pub fn of_plots(subject: &str, content: &PageContent, origin: &Origin) -> String {
    let data = data(subject, content, charts::plots(content), origin);
    page(&format!("{subject}: {}", content.title), origin, &data)
}

/// The contents of a page but its scene.
fn data(subject: &str, content: &PageContent, charts: Vec<Value>, origin: &Origin) -> Value {
    let documents = content.documents.iter();
    let documents = documents.map(|(name, text)| json!({ "name": name, "text": text }));
    json!({
        "title": content.title,
        "system": subject,
        "isSolved": content.is_solved,
        "answer": content.answer,
        "notes": content.notes,
        "rows": content.rows,
        "command": origin.command,
        "charts": charts,
        "documents": documents.collect::<Vec<_>>(),
    })
}

/// A page with its title, its origin, and its contents.
fn page(title: &str, origin: &Origin, data: &Value) -> String {
    framed(code::FRAME, title, origin, data, &code::MODULES)
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
            ("sheet", code::SHEET),
            ("data", &data),
            ("libraries", &code::libraries()),
            ("script", &code::script(modules)),
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
