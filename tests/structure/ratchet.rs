//! The size of the sources: it goes down. A folder that needs more says why in `docs/decisions`, and its numbers here follow.

use crate::sources::sources;
use std::collections::BTreeMap;

/// Most lines, by fifties, and most files of each folder of `src`; the first is what lies above all folders.
const SIZES: [(&str, usize, usize); 26] = [
    (".", 1450, 7),
    ("app", 8400, 34),
    ("control", 9800, 37),
    ("coordinates", 3190, 17),
    ("dynamics", 11750, 40),
    ("element", 3500, 16),
    ("energy", 4700, 22),
    ("feedback", 850, 4),
    ("files", 17450, 83),
    ("functional", 5350, 20),
    ("identify", 2950, 9),
    ("interface", 2400, 12),
    ("ipopt", 2750, 10),
    ("kinematics", 250, 2),
    ("kkt", 4500, 19),
    ("math", 1450, 8),
    ("mesh", 2950, 19),
    ("model", 14250, 66),
    ("nlp", 2200, 7),
    ("report", 6450, 33),
    ("sensitivity", 2450, 7),
    ("sparse", 7300, 34),
    ("study", 2200, 11),
    ("sweep", 650, 3),
    ("tasks", 1700, 7),
    ("workflow", 11850, 38),
];
/// The number of parameters of functions that are patterns of tuples, such as `(a, b): (A, B)`, which should have names or be structures.
fn tuples(text: &str) -> usize {
    let ends = [text.find("{\n"), text.find(";\n")];
    let head = &text[..ends.into_iter().flatten().min().unwrap_or(text.len())];
    head.matches("): (").count()
}

#[test]
fn sources_do_not_grow() {
    let mut found: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for source in sources("src") {
        let size = found.entry(source.folder().unwrap_or(".").to_owned());
        let (lines, files) = size.or_default();
        *lines += source.text.lines().count();
        *files += 1;
    }
    let allowed: BTreeMap<&str, (usize, usize)> = SIZES.map(|(name, l, f)| (name, (l, f))).into();
    for (name, (lines, files)) in &found {
        let most = allowed.get(name.as_str());
        let &(most_lines, most_files) = most.unwrap_or_else(|| panic!("src/{name} has no size"));
        assert!(
            *lines <= most_lines && *files <= most_files,
            "src/{name} has {lines} lines in {files} files, more than {most_lines} in {most_files}"
        );
    }
}

#[test]
fn no_parameter_is_a_pattern_of_a_tuple() {
    for source in sources("src") {
        for function in source.text.split("fn ").skip(1) {
            let name = function.split('(').next().unwrap_or_default();
            assert_eq!(tuples(function), 0, "src/{}: {name}", source.name);
        }
    }
    assert_eq!(
        tuples("f(a: [f64; 2], (b, c): (B, C)) {\n |(d, e): (D, E)| }"),
        1
    );
}
