//! The size of the sources: it goes down. A folder that needs more says why in `docs/decisions`, and its numbers here follow.

use crate::sources::sources;
use std::collections::BTreeMap;

/// Most lines, by fifties, and most files of each folder of `src`; the first is what lies above all folders.
const SIZES: [(&str, usize, usize); 26] = [
    (".", 1450, 8),
    ("app", 9600, 55),
    ("control", 10150, 57),
    ("coordinates", 3500, 19),
    ("dynamics", 11100, 51),
    ("element", 3600, 18),
    ("energy", 2150, 16),
    ("feedback", 850, 5),
    ("files", 19200, 105),
    ("functional", 5700, 26),
    ("identify", 3350, 17),
    ("interface", 2900, 17),
    ("ipopt", 2950, 15),
    ("kinematics", 250, 2),
    ("kkt", 4900, 23),
    ("math", 1500, 9),
    ("mesh", 1750, 14),
    ("model", 13950, 67),
    ("nlp", 1900, 10),
    ("report", 6800, 43),
    ("sensitivity", 2650, 13),
    ("sparse", 8300, 45),
    ("study", 2950, 12),
    ("sweep", 950, 7),
    ("tasks", 1800, 10),
    ("workflow", 12700, 61),
];
/// Most patterns of tuples with a type, such as `(a, b): (A, B)`, which should be structures with names.
const TUPLES: usize = 337;

/// The number of patterns of tuples that have a type.
fn tuples(text: &str) -> usize {
    let ends = text.match_indices("): (").map(|(end, _)| end);
    let is_pattern = |end: usize| {
        let begin = text[..end].rfind('(');
        begin.is_some_and(|begin| {
            let mut inside = text[begin + 1..end].chars();
            inside.all(|c| c.is_alphanumeric() || "_, &\n".contains(c))
        })
    };
    ends.filter(|&end| is_pattern(end)).count()
}

#[test]
fn sources_do_not_grow() {
    let mut found: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let mut patterns = 0;
    for source in sources("src") {
        let size = found.entry(source.folder().unwrap_or(".").to_owned());
        let (lines, files) = size.or_default();
        *lines += source.text.lines().count();
        *files += 1;
        patterns += tuples(&source.text);
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
    assert!(patterns <= TUPLES, "{patterns} patterns of tuples");
    assert_eq!(
        tuples("fn f((a, b): (A, B), (c): (C), x: (u, v)) |(d, e): (D, E)|"),
        3
    );
}
