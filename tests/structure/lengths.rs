//! One concept a file: none of them is long.

use crate::sources::{Source, sources};

/// Most lines of a file.
const MOST: usize = 600;

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
