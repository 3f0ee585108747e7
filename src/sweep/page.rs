//! `report.html`: any two columns of the table against each other, and all rows.

use serde_json::json;

use crate::report::origin::Origin;
use crate::sweep::kept::Kept;
use crate::sweep::read::Sweep;

/// The page without its data.
const PAGE: &str = include_str!("page.html");
/// Where they go.
const DATA: &str = "@DATA@";

/// The page; `table` has a row of headings first.
pub(super) fn html(sweep: &Sweep, ends: &[Kept], table: &[Vec<String>], origin: &Origin) -> String {
    let solved: Vec<bool> = ends.iter().map(|end| end.is_solved).collect();
    let count = solved.iter().filter(|&&is_solved| is_solved).count();
    let problem = sweep.problem.display();
    let data = json!({
        "title": sweep.title,
        "words": format!("{count} of {} variants of {problem} have an answer.", ends.len()),
        "origin": origin.line(),
        "places": sweep.places.len(),
        "table": table,
        "solved": solved,
    });
    // No text ends the element that it stands in.
    PAGE.replace(DATA, &data.to_string().replace('<', "\\u003c"))
}
