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

/// Texts of a summary, before rows and plots, and those of its problem, where there is a file of it.
pub(super) fn content(title: &str, summary: &Summary, loaded: Option<&Loaded>) -> PageContent {
    let mut documents = vec![("Summary".to_owned(), summary.text())];
    documents.extend(loaded.into_iter().flat_map(asked));
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
