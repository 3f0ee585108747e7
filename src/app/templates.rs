//! Files to begin with: a trunk of any length, the scene without shorthand, the schemas.

use std::path::{Path, PathBuf};

use crate::app::error::CommandError;
use crate::app::folder::make_folder;
use crate::files;
use crate::report::atomic;

/// Writes `scene.json` and `problem.json` of a trunk into a folder; files that exist are left alone.
///
/// # Errors
/// There are no segments, a file exists, or cannot be written.
pub fn new_trunk(segments: usize, folder: &Path) -> Result<Vec<PathBuf>, CommandError> {
    if segments == 0 {
        return Err(CommandError::Option {
            option: "--segments",
            reason: "a trunk has 1 segment or more".to_owned(),
        });
    }
    let (scene, problem) = files::new_trunk(segments);
    let files = [("scene.json", scene), ("problem.json", problem)]
        .map(|(name, text)| (folder.join(name), text));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(CommandError::Exists(path.clone()));
    }
    make_folder(folder)?;
    for (path, text) in &files {
        atomic::write(path, text.as_bytes())?;
    }
    Ok(files.map(|(path, _)| path).to_vec())
}

/// The scene of a file without shorthand.
///
/// # Errors
/// The scene is wrong.
pub fn expand(path: &Path) -> Result<String, CommandError> {
    Ok(files::expand(path)?)
}

/// The JSON Schemas of scene and problem as text.
pub fn schema() -> (String, String) {
    let (scene, problem) = files::schema();
    (text(&scene), text(&problem))
}

/// The JSON Schema of a study as text.
pub fn study_schema() -> String {
    text(&files::study_schema())
}

fn text(schema: &serde_json::Value) -> String {
    serde_json::to_string_pretty(schema).expect("a schema is JSON")
}
