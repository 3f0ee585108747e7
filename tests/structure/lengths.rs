//! One concept a file: none of them is long.

use crate::sources::{Source, sources};

/// Most lines of a file.
const MOST: usize = 400;

/// Files that are longer still.
const LONG: [&str; 1] = ["src/model/mod.rs"];

#[test]
fn files_are_short() {
    let mut seen = 0;
    for folder in ["src", "tests"] {
        for Source { name, text } in sources(folder) {
            let (name, lines) = (format!("{folder}/{name}"), text.lines().count());
            let is_long = LONG.contains(&name.as_str());
            assert!(
                lines <= MOST || is_long,
                "{name} has {lines} lines, more than {MOST}"
            );
            assert!(
                lines > MOST || !is_long,
                "{name} is short now: take it out of the list"
            );
            seen += 1;
        }
    }
    assert!(seen > 300, "{seen} files");
}
