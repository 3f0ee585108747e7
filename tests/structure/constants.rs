//! Numbers that decide something belong to no unit: answers do not depend on the size of a robot.

use crate::sources::sources;
use std::collections::BTreeSet;

/// Folders whose numbers decide what a motion, an optimum or a verdict is.
const FOLDERS: [&str; 9] = [
    "control",
    "dynamics",
    "feedback",
    "functional",
    "identify",
    "model",
    "sensitivity",
    "tasks",
    "workflow",
];

/// Units inside, as sentences on constants name them.
const UNITS: [&str; 21] = [
    "mm", "ms", "mJ", "mW", "N", "V", "kV", "mA", "W", "mC", "MPa", "s", "rad/ms", "mm/ms", "g",
    "g/mm³", "N/V²", "V/mm", "V/µm", "V²", "J",
];

/// Constants with a unit: factors between units, constants of nature, defaults that a problem may change, and what only catches slips.
const WITH_UNITS: [(&str, &str); 15] = [
    ("control/prescribed.rs", "REST"),
    ("control/regulator.rs", "DEGREE"),
    ("control/regulator.rs", "INTEGRAL_TIME"),
    ("control/regulator.rs", "RATE_TIME"),
    ("control/transcription/cost_rows.rs", "MILLISECOND"),
    ("control/transcription/cost_rows.rs", "MILLIJOULE"),
    ("model/components/contact_law.rs", "SLIP_SPEED"),
    ("model/system/check.rs", "DENSEST"),
    ("model/system/check.rs", "SHORTEST_SPAN"),
    ("model/constants/constant.rs", "ROUNDING"),
    ("model/quantities/measures.rs", "KILOVOLT"),
    ("model/quantities/quantity.rs", "MEGAVOLT_PER_METRE"),
    ("model/system/mod.rs", "VACUUM_PERMITTIVITY"),
    ("tasks/check.rs", "AT"),
    ("workflow/regulator/observer.rs", "BLIND"),
];

/// Returns true if a sentence names a unit.
fn has_unit(sentence: &str) -> bool {
    let words = sentence.split(|c: char| c.is_whitespace() || ",;:()`".contains(c));
    words
        .map(|word| word.trim_end_matches('.'))
        .any(|word| UNITS.contains(&word))
}

#[test]
fn numbers_that_decide_have_no_unit() {
    let mut found = BTreeSet::new();
    for source in sources("src") {
        if !source
            .folder()
            .is_some_and(|folder| FOLDERS.contains(&folder))
        {
            continue;
        }
        let mut about = String::new();
        for line in source.text.lines() {
            let line = line.trim();
            if let Some(sentence) = line.strip_prefix("///") {
                about.push_str(sentence);
                continue;
            }
            let declared = line
                .split_once("const ")
                .filter(|(_, rest)| rest.contains(": f64 =") || rest.contains(": [f64;"));
            if let Some((_, rest)) = declared.filter(|_| has_unit(&about)) {
                let name = rest.split(':').next().unwrap_or_default();
                found.insert((source.name.clone(), name.to_owned()));
            }
            about.clear();
        }
    }
    let allowed = WITH_UNITS.map(|(file, name)| (file.to_owned(), name.to_owned()));
    assert_eq!(found, BTreeSet::from(allowed));
    assert!(
        has_unit("Rates below this, in rad/ms or mm/ms, are rest.")
            && !has_unit("A part of the length.")
    );
}
