//! `report.html`: scatter plot of two columns of the table, parallel coordinates of the varied values and results, and all rows.

use serde_json::json;

use crate::report::origin::Origin;
use crate::report::page::framed;
use crate::sweep::read::Sweep;
use crate::sweep::variant_record::VariantRecord;

/// The page around everything, as that of a run.
const FRAME: &str = include_str!("page.html");
/// Script that draws it.
const MODULE: &str = include_str!("page.js");

/// The page; `table` has a row of headings first.
pub(super) fn html(
    sweep: &Sweep,
    ends: &[VariantRecord],
    table: &[Vec<String>],
    origin: &Origin,
) -> String {
    let solved: Vec<bool> = ends.iter().map(|end| end.is_solved).collect();
    let count = solved.iter().filter(|&&is_solved| is_solved).count();
    let problem = sweep.problem.display();
    let data = json!({
        "title": sweep.title,
        "words": format!("{count} of {} variants of {problem} have an answer.", ends.len()),
        "places": sweep.places.len(),
        "table": table,
        "solved": solved,
    });
    framed(FRAME, &sweep.title, origin, &data, &[MODULE])
}
