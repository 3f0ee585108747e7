//! Retired words: names that the code no longer has, in code, tests and documents, each with the one in its place.

use crate::sources::sources;
use std::fs;
use std::path::Path;

/// A retired word.
struct Retired {
    /// The word, or code without spaces such as `action.motion`.
    word: &'static str,
    /// What is written instead.
    instead: &'static str,
    /// Beginnings of paths where it means something else, and that.
    allowed: &'static [(&'static str, &'static str)],
}

const fn retired(word: &'static str, instead: &'static str) -> Retired {
    Retired {
        word,
        instead,
        allowed: &[],
    }
}

/// Words that are no names any more.
const WORDS: [Retired; 21] = [
    retired("question", "analysis"),
    retired("answering", "for_analysis"),
    retired("continuum", "block"),
    retired("continua", "blocks"),
    retired("gauge", "reading"),
    retired("gauges", "joint_readings"),
    retired("history", "discrete, of type DiscreteTrajectory"),
    retired("histories", "series, of values in time"),
    retired("from_history", "from_discrete"),
    retired("stirred", "initially_moving"),
    retired("action.motion", "action.map"),
    retired("motion:&CoordinateMap", "map"),
    retired("fn told", "a noun: message, warning, notes, command_output"),
    retired("Told", "PageContent"),
    retired("halo", "boundary_instant"),
    retired("evened", "on_uniform_grid"),
    retired("Care", "PivotStrategy"),
    retired("care", "strategy"),
    retired("Cured", "Together"),
    Retired {
        word: "bench",
        instead: "workspace",
        allowed: &[
            ("CONTRIBUTING.md", "a command of make"),
            ("docs/performance.md", "a command of make"),
        ],
    },
    Retired {
        word: "condensed",
        instead: "presolved",
        allowed: &[
            ("src/kkt/", "a system after static condensation"),
            ("src/app/linear_systems.rs", "such systems, counted"),
            ("tests/solver/", "such systems"),
            ("tests/allocations/main.rs", "such systems, counted"),
        ],
    },
];

/// Retired paths below `src`, without `.rs`, and those in their place.
const PATHS: [(&str, &str); 52] = [
    ("app/continuation", "app/kept/resume_file"),
    ("app/digest", "app/kept/record"),
    ("app/exchanged", "app/blocks"),
    ("app/extent", "app/inspect"),
    ("app/followed", "app/equilibrium_summary"),
    ("app/forward", "app/simulation"),
    ("app/forward_page", "app/simulation"),
    ("app/rest", "app/equilibrium"),
    ("app/rest_model", "tasks/equilibrium"),
    ("app/rest_observed", "app/equilibrium_summary"),
    ("app/rest_refused", "app/summary"),
    ("app/rest_words", "app/equilibrium_summary"),
    ("app/shown", "app/displayed_motion"),
    ("app/solve_words", "tasks/solve_messages"),
    ("app/tracking_words", "tasks/solve_messages"),
    ("app/words", "app/request"),
    ("control/calls", "control/required_analysis"),
    ("control/conditions", "control/boundary_conditions"),
    ("control/ends", "control/endpoint_checks"),
    ("control/evened", "control/guess"),
    ("control/meshes", "control/boundary_state"),
    (
        "control/transcription/placed",
        "control/transcription/segment",
    ),
    (
        "control/transcription/sweep",
        "control/transcription/interval_pass",
    ),
    ("dynamics/history", "dynamics/trajectory"),
    ("dynamics/rest", "dynamics/equilibrium"),
    (
        "dynamics/equilibrium/arc",
        "dynamics/equilibrium/arc_length",
    ),
    (
        "dynamics/equilibrium/continuation",
        "dynamics/equilibrium/stable",
    ),
    (
        "dynamics/equilibrium/equilibrium",
        "dynamics/equilibrium/rest_state",
    ),
    (
        "dynamics/equilibrium/softest",
        "dynamics/equilibrium/softest_mode",
    ),
    ("dynamics/spans", "dynamics/singular_configurations"),
    ("dynamics/stages", "dynamics/galerkin"),
    ("dynamics/galerkin/places", "dynamics/galerkin/state"),
    ("ipopt/centre", "ipopt/solver"),
    ("ipopt/hook", "ipopt/ma57_adapter"),
    ("ipopt/reached", "ipopt/evaluation"),
    ("kkt/arrange", "kkt/bandwidth_order"),
    ("kkt/care", "kkt/solver"),
    ("kkt/groups", "kkt/eliminable_groups"),
    ("kkt/halves", "kkt/condensed"),
    ("kkt/trial", "kkt/solver"),
    ("math/both", "math/join"),
    ("math/counted", "math/sets"),
    ("model/continua", "model/layout/solids"),
    ("model/gauges", "model/system/joints"),
    ("model/places", "model/layout/variables"),
    ("sparse/again", "sparse/factorisation"),
    ("study/price", "study/table"),
    ("sweep/kept", "app/batch"),
    ("workflow/at_once", "workflow/parallel_map"),
    ("workflow/cure", "workflow/grids"),
    ("workflow/holding", "workflow/hold_check"),
    ("workflow/second_start", "workflow/optimise"),
];

/// End of the text that begins at a quote, after `hashes` signs of a raw string.
fn end_of_string(rest: &str, hashes: usize, is_raw: bool) -> usize {
    let closing = format!("\"{}", "#".repeat(hashes));
    let mut at = 1;
    while !rest[at..].starts_with(&closing) {
        let is_escape = !is_raw && rest[at..].starts_with('\\');
        at += usize::from(is_escape);
        at += rest[at..].chars().next().map_or(1, char::len_utf8);
    }
    at + closing.len()
}

/// Names of a text of Rust without comments, with the signs between them and no spaces but between two words. Names in
/// braces of strings, as `format!` has them, stay.
fn code(text: &str) -> String {
    let mut out = String::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let is_in_word = out.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let raw = rest
            .strip_prefix('r')
            .map(|r| r.len() - r.trim_start_matches('#').len())
            .filter(|&hashes| rest[1 + hashes..].starts_with('"') && !is_in_word);
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if c == '"' || raw.is_some() {
            let before = raw.map_or(0, |hashes| 1 + hashes);
            let length = end_of_string(&rest[before..], raw.unwrap_or(0), raw.is_some());
            for part in rest[before..before + length].split('{').skip(1) {
                let name = part.split(['}', ':', '"']).next().unwrap_or_default();
                out.push_str(&format!(";{name};"));
            }
            at += before + length;
        } else if rest.starts_with("'\"'") || rest.starts_with("'\\\"'") {
            at += rest[1..].find("'").map_or(1, |end| end + 2);
        } else if c.is_whitespace() {
            let after = rest.trim_start();
            let is_word = after.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            out.push_str(if is_in_word && is_word { " " } else { "" });
            at += rest.len() - after.len();
        } else {
            out.push(c);
            at += c.len_utf8();
        }
    }
    out
}

/// True if a text has a word between other signs than those of words.
fn has(text: &str, word: &str) -> bool {
    let is_sign = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric() && c != '_');
    text.match_indices(word).any(|(at, _)| {
        let after = text[at + word.len()..].chars().next();
        is_sign(text[..at].chars().next_back()) && is_sign(after)
    })
}

/// Spans of code of a document.
fn spans(text: &str) -> String {
    let prose = text.split("```").step_by(2);
    let spans: Vec<&str> = prose
        .flat_map(|part| part.split('`').skip(1).step_by(2))
        .collect();
    spans.join("\n")
}

/// Path and text of the documents about the code.
fn documents() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = ["README.md", "CONTRIBUTING.md"].map(str::to_owned).to_vec();
    for folder in ["docs", "docs/decisions"] {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let names = names.filter(|name| name.ends_with(".md"));
        paths.extend(names.map(|name| format!("{folder}/{name}")));
    }
    let text = |path: String| {
        let text = fs::read_to_string(root.join(&path)).unwrap();
        (path, spans(&text))
    };
    paths.into_iter().map(text).collect()
}

#[test]
fn retired_words_are_no_names() {
    let mut texts = documents();
    for folder in ["src", "tests", "benches", "fuzz", "python/src"] {
        for source in sources(folder) {
            texts.push((format!("{folder}/{}", source.name), code(&source.text)));
        }
    }
    assert!(texts.len() > 700, "{} texts", texts.len());
    let mut found = Vec::new();
    for retired in WORDS {
        let allowed = |path: &str| {
            let mut places = retired.allowed.iter();
            places.any(|(place, meaning)| path.starts_with(place) && !meaning.is_empty())
        };
        for (path, text) in texts.iter().filter(|(path, _)| !allowed(path)) {
            if has(text, retired.word) {
                let Retired { word, instead, .. } = retired;
                found.push(format!("{path}: {word}; write {instead}"));
            }
        }
        for (place, _) in retired.allowed {
            let mut here = texts.iter().filter(|(path, _)| path.starts_with(place));
            let is_used = here.any(|(_, text)| has(text, retired.word));
            assert!(is_used, "{} is not in {place} any more", retired.word);
        }
    }
    assert!(found.is_empty(), "retired words: {found:#?}");
}

#[test]
fn retired_paths_are_gone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let exists = |path: &str| {
        let path = root.join("src").join(path);
        path.is_dir() || path.with_extension("rs").is_file()
    };
    let documents = documents();
    for (old, new) in PATHS {
        assert!(exists(new), "src/{new}, named for {old}, is not there");
        assert!(!exists(old), "src/{old} is src/{new}");
        for (document, text) in &documents {
            let named = text.lines().any(|span| {
                let rest = span.trim_start_matches("src/").strip_prefix(old);
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '/']))
            });
            assert!(!named, "{document} names {old}; it is {new}");
        }
    }
}

#[test]
fn code_has_no_comments_and_no_texts() {
    let text = "let a = f(\"b \\\" {c:?}\"); // d\nlet e = r#\"g\" h\"#; 'x' '\"' fn told () i . j";
    let code = code(text);
    for word in ["a", "c", "e", "fn told", "i.j"] {
        assert!(has(&code, word), "{word} is not in {code}");
    }
    for word in ["b", "d", "g", "h", "told fn"] {
        assert!(!has(&code, word), "{word} is in {code}");
    }
}
