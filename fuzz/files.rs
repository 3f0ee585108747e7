//! A folder with files to read, and what every answer about them has to be.

use proboscis::app::CommandError;
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A scene that problems refer to as `scenes/pair.json`.
pub const SCENE: &str = include_str!("../problems/scenes/pair.json");
/// A problem of it.
pub const PROBLEM: &str = include_str!("../problems/pair.json");

thread_local! {
    static FOLDER: RefCell<Option<TempDir>> = const { RefCell::new(None) };
}

/// Calls `read` with the folder, in which a file holds these bytes.
pub fn with(name: &str, bytes: &[u8], read: impl FnOnce(&Path, PathBuf)) {
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(prepared).path();
        let path = folder.join(name);
        fs::write(&path, bytes).expect("a file");
        read(folder, path);
    });
}

fn prepared() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenes = folder.path().join("scenes");
    fs::create_dir(&scenes).expect("a folder");
    fs::write(scenes.join("pair.json"), SCENE).expect("a scene");
    folder
}

/// A mistake names its file in one line, and the lines around it can be shown.
pub fn check(name: &str, error: impl Into<CommandError>) {
    let error = error.into();
    let told = error.to_string();
    assert!(told.contains(name), "{told}");
    assert_eq!(error.exit_status(), 2, "{told}");
    error.excerpt();
}
