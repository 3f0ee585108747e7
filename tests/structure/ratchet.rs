//! The size of the sources: it goes down. A folder that needs more says why in `docs/decisions`, and its numbers here follow.

use crate::sources::sources;
use std::collections::BTreeMap;

/// Most lines, by fifties, and most files of each folder of `src`; the first is what lies above all folders.
const SIZES: [(&str, usize, usize); 26] = [
    (".", 1450, 8),
    ("app", 9300, 44),
    ("control", 10150, 48),
    ("coordinates", 3500, 18),
    ("dynamics", 11050, 41),
    ("element", 3600, 16),
    ("energy", 2400, 17),
    ("feedback", 850, 4),
    ("files", 17850, 98),
    ("functional", 5600, 22),
    ("identify", 3300, 9),
    ("interface", 2550, 16),
    ("ipopt", 2900, 13),
    ("kinematics", 250, 2),
    ("kkt", 4850, 19),
    ("math", 1500, 9),
    ("mesh", 1750, 12),
    ("model", 13100, 62),
    ("nlp", 1900, 7),
    ("report", 6650, 34),
    ("sensitivity", 2650, 8),
    ("sparse", 8050, 34),
    ("study", 2500, 11),
    ("sweep", 900, 5),
    ("tasks", 1600, 6),
    ("workflow", 12050, 36),
];
/// Most patterns of tuples with a type, such as `(a, b): (A, B)`, which should be structures with names.
const TUPLES: usize = 263;

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
