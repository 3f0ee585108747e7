//! The size of the sources: it goes down. A folder that needs more says why in `docs/decisions`, and its numbers here follow.

use crate::sources::sources;
use std::collections::BTreeMap;

/// Most lines, by fifties, and most files of each folder of `src`; the first is what lies above all folders.
const SIZES: [(&str, usize, usize); 26] = [
    (".", 1450, 8),
    ("app", 8600, 44),
    ("control", 9950, 38),
    ("coordinates", 3250, 17),
    ("dynamics", 10950, 35),
    ("element", 3550, 15),
    ("energy", 2400, 16),
    ("feedback", 850, 4),
    ("files", 17250, 92),
    ("functional", 5450, 20),
    ("identify", 3250, 9),
    ("interface", 2400, 15),
    ("ipopt", 2850, 13),
    ("kinematics", 250, 2),
    ("kkt", 4850, 19),
    ("math", 1450, 9),
    ("mesh", 1750, 12),
    ("model", 12750, 59),
    ("nlp", 2050, 8),
    ("report", 6550, 33),
    ("sensitivity", 2500, 8),
    ("sparse", 7550, 34),
    ("study", 2350, 11),
    ("sweep", 900, 4),
    ("tasks", 1550, 6),
    ("workflow", 11750, 36),
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
