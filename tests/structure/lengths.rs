//! One concept a file: none of them is long.

use crate::sources::{Source, sources};

/// Most lines of a file.
const MOST: usize = 400;

/// Files that are longer still.
const LONG: [&str; 8] = [
    "src/dynamics/observe.rs",
    "src/dynamics/stages/mod.rs",
    "src/dynamics/stepper.rs",
    "src/model/mod.rs",
    "src/coordinates/pull_back/articulated.rs",
    "src/coordinates/reduced.rs",
    "tests/common/cases.rs",
    "tests/motion/screws.rs",
];

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
