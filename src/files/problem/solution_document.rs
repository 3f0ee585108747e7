//! An earlier `solution.json` of which a problem reads a part.

use std::path::Path;

use crate::files::json::document::Document;
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::solution::complete;

/// The file with those of its arrays that are wanted, wherever they stand.
pub(crate) fn solution_document(path: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Document> {
    let mut document = Document::read(path)?;
    match complete(path, &mut document.tree, is_wanted) {
        Ok(()) => Ok(document),
        Err(reason) => Err(Scope::of(&document)
            .key("arrays")
            .wrong(reason.to_string(), "the file that was written with it")),
    }
}
