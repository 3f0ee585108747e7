//! Common texts of all pages: status, notes, and the problem.

use crate::app::summary::Summary;
use crate::files::{Loaded, lay_out};
use crate::report::PageContent;

/// Names and texts of problem and scene as they were read, overrides applied.
pub(super) fn asked(loaded: &Loaded) -> Vec<(String, String)> {
    let mut documents = vec![("Problem".to_owned(), lay_out(&loaded.problem))];
    if loaded.scene_path.is_some() {
        documents.push(("Scene".to_owned(), lay_out(&loaded.scene)));
    }
    documents
}

/// Texts of a summary, before rows and plots; `asked` are the texts of problem and scene.
pub(super) fn content(title: &str, summary: &Summary, asked: &[(String, String)]) -> PageContent {
    let mut documents = vec![("Summary".to_owned(), summary.text())];
    documents.extend_from_slice(asked);
    PageContent {
        title: title.to_owned(),
        is_solved: summary.message.is_none(),
        answer: summary.status.replace('_', " "),
        notes: summary
            .message
            .iter()
            .cloned()
            .chain(summary.notes.lines())
            .collect(),
        documents,
        ..PageContent::default()
    }
}
