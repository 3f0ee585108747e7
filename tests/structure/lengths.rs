//! One concept a file: none of them is long, nor a cupboard, and no folder holds many.

use crate::sources::{Source, sources};
use std::collections::BTreeMap;

/// Most lines of a file.
const MOST: usize = 600;
/// Fewest lines of a file of `src` that is no head of a folder.
const FEWEST: usize = 60;
/// Shorter files: traits, tables, and what others could not hold without a circle. The list only gets shorter.
const SHORT: [&str; 6] = [
    "app/multistart/rank.rs",
    "energy/constraint.rs",
    "files/scene/point.rs",
    "model/system/maxwell.rs",
    "report/origin.rs",
    "report/quoting.rs",
];
/// Most files of a folder, those of its folders apart.
const IN_FOLDER: usize = 30;

#[test]
fn files_are_short() {
    let mut seen = 0;
    for folder in ["src", "tests"] {
        for Source { name, text } in sources(folder) {
            let (name, lines) = (format!("{folder}/{name}"), text.lines().count());
            assert!(lines <= MOST, "{name} has {lines} lines, more than {MOST}");
            seen += 1;
        }
    }
    assert!(seen > 300, "{seen} files");
}

#[test]
fn files_of_the_library_are_rooms() {
    let mut folders: BTreeMap<String, usize> = BTreeMap::new();
    for Source { name, text } in sources("src") {
        let (folder, file) = name.rsplit_once('/').unwrap_or(("", &name));
        *folders.entry(folder.to_owned()).or_default() += 1;
        let is_head = ["mod.rs", "lib.rs", "main.rs"].contains(&file);
        let is_short = text.lines().count() < FEWEST;
        assert!(
            is_short == SHORT.contains(&&*name) || is_head,
            "src/{name} has {} lines, {FEWEST} are a room",
            text.lines().count()
        );
    }
    for (folder, files) in folders {
        assert!(files <= IN_FOLDER, "src/{folder} has {files} files");
    }
}
