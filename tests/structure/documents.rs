//! Form and references of the documents: links, names of sources and types, cited sections of `docs/theory.md`, lengths of
//! lines, the folders in `docs/architecture.md`, the paths in `docs/glossary.md`.

use crate::sources::{Source, sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of the repository.
fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Path and text of the documents.
fn documents() -> Vec<(PathBuf, String)> {
    let mut paths = ["README.md", "CONTRIBUTING.md"].map(PathBuf::from).to_vec();
    for folder in ["docs", "docs/decisions"] {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        let names = entries.map(|entry| Path::new(folder).join(entry.unwrap().file_name()));
        paths.extend(names.filter(|path| path.extension().is_some_and(|end| end == "md")));
    }
    let text = |path: PathBuf| {
        let text = fs::read_to_string(root().join(&path)).unwrap();
        (path, text)
    };
    paths.into_iter().map(text).collect()
}

/// Texts between backquotes outside of blocks of code.
fn spans(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    prose
        .flat_map(|part| part.split('`').skip(1).step_by(2))
        .collect()
}

#[test]
fn links_lead_to_files() {
    let mut seen = 0;
    for (path, text) in documents() {
        let folder = root().join(path.parent().unwrap());
        for link in text.split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap();
            if target.is_empty() || target.starts_with("http") {
                continue;
            }
            let found = folder.join(target).exists();
            assert!(found, "{} links to {target}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen} links");
}

#[test]
fn sources_that_documents_name_exist() {
    let files: BTreeSet<String> = ["src", "tests", "benches", "examples", "python/src"]
        .into_iter()
        .filter(|folder| root().join(folder).exists())
        .flat_map(|folder| {
            let path = move |source: Source| format!("/{folder}/{}", source.name);
            sources(folder).into_iter().map(path)
        })
        .collect();
    let mut seen = 0;
    for (path, text) in documents() {
        for name in spans(&text) {
            if !name.ends_with(".rs") || name == "build.rs" || name.contains(' ') {
                continue;
            }
            let end = format!("/{name}");
            let found = files.iter().any(|file| file.ends_with(&end));
            assert!(found, "{} names {name}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 100, "{seen} sources");
}

#[test]
fn types_that_documents_name_exist() {
    let all: Vec<Source> = ["src", "tests"].into_iter().flat_map(sources).collect();
    let words: BTreeSet<&str> = all
        .iter()
        .flat_map(|source| {
            source
                .text
                .split(|c: char| !c.is_alphanumeric() && c != '_')
        })
        .collect();
    let mut seen = 0;
    for (path, text) in documents()
        .into_iter()
        .filter(|(path, _)| path.starts_with("docs"))
    {
        for name in spans(&text) {
            let is_type = name.starts_with(|c: char| c.is_ascii_uppercase())
                && name.chars().any(char::is_lowercase)
                && name
                    .chars()
                    .all(|c| c.is_alphanumeric() || c == '_' || c == ':');
            for word in name.split("::").filter(|_| is_type) {
                assert!(words.contains(word), "{} names {name}", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 40, "{seen} names");
}

#[test]
fn sections_that_sources_cite_exist() {
    let text = fs::read_to_string(root().join("docs/theory.md")).unwrap();
    let headings: BTreeSet<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("### ")?.split(' ').next())
        .collect();
    // In two parts, so that this file cites nothing.
    let citation = ["docs/theory", ".md, "].concat();
    let mut seen = 0;
    for source in ["src", "tests"].into_iter().flat_map(sources) {
        for rest in source.text.split(citation.as_str()).skip(1) {
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.');
            let section = rest[..end.unwrap_or(rest.len())].trim_end_matches('.');
            let found = headings.contains(section);
            assert!(found, "{} cites section {section}", source.name);
            seen += 1;
        }
    }
    assert!(seen > 10, "{seen} citations");
}

/// Longest line of a document, without the targets of its links.
const WIDTH: usize = 120;

/// Documents that a program writes.
const GENERATED: [&str; 1] = ["docs/reference.md"];

/// Documents outside of those that other tests read.
const OTHERS: [&str; 7] = [
    "CHANGELOG.md",
    "SECURITY.md",
    "benches/README.md",
    "benches/peers/README.md",
    "fuzz/README.md",
    "python/README.md",
    "tests/reference/README.md",
];

/// Numbers and texts of the lines that are neither in a table nor in a block of code.
fn prose(text: &str) -> Vec<(usize, &str)> {
    let mut is_code = false;
    let mut lines = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let start = line.trim_start();
        if start.starts_with("```") {
            is_code = !is_code;
        } else if !is_code && !start.starts_with('|') {
            lines.push((i + 1, line));
        }
    }
    lines
}

/// Characters of a line without the targets of its links.
fn width(line: &str) -> usize {
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default().chars().count();
    let after = parts.map(|part| match part.split_once(')') {
        Some((_, after)) => 1 + after.chars().count(),
        None => 2 + part.chars().count(),
    });
    first + after.sum::<usize>()
}

#[test]
fn lines_of_prose_end_at_the_width() {
    let others = OTHERS.map(|name| {
        let path = PathBuf::from(name);
        let text = fs::read_to_string(root().join(&path)).unwrap();
        (path, text)
    });
    let all = documents().into_iter().chain(others);
    let mut seen = 0;
    let mut long = Vec::new();
    for (path, text) in all.filter(|(path, _)| !GENERATED.contains(&path.to_str().unwrap())) {
        for (number, line) in prose(&text) {
            if width(line) > WIDTH {
                long.push(format!("{}:{number}", path.display()));
            }
            seen += 1;
        }
    }
    assert!(long.is_empty(), "lines above {WIDTH} characters: {long:?}");
    assert!(seen > 1500, "{seen} lines");
}

/// Paths of all folders below one of the repository, relative to it.
fn folders(below: &str) -> BTreeSet<String> {
    let parents = sources(below).into_iter().flat_map(|source| {
        let ends: Vec<usize> = source.name.match_indices('/').map(|(at, _)| at).collect();
        let name = source.name;
        ends.into_iter().map(move |end| name[..end].to_owned())
    });
    parents.collect()
}

#[test]
fn architecture_is_short_and_names_every_folder() {
    let text = fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let lines = text.lines().count();
    assert!(lines <= 200, "docs/architecture.md has {lines} lines");
    let named: BTreeSet<&str> = spans(&text)
        .into_iter()
        .map(|span| span.trim_end_matches('/'))
        .collect();
    let folders = folders("src");
    assert!(folders.len() > 35, "{} folders", folders.len());
    for folder in folders {
        let is_named = named.contains(folder.as_str());
        assert!(is_named, "docs/architecture.md does not name src/{folder}");
    }
}

#[test]
fn glossary_is_short_and_its_paths_exist() {
    let text = fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let entries: Vec<Vec<&str>> = text
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"))
        .map(|row| row.split(" | ").map(str::trim).collect::<Vec<_>>())
        .filter(|cells| cells[0] != "term")
        .collect();
    let count = entries.len();
    assert!((40..=80).contains(&count), "{count} entries");
    let mut terms = BTreeSet::new();
    for cells in &entries {
        let [term, .., place] = cells[..] else {
            panic!("an entry without a place: {cells:?}");
        };
        assert!(terms.insert(term), "{term} stands twice");
        let path = place.trim_matches('`');
        let exists = !path.is_empty() && root().join("src").join(path).is_file();
        assert!(exists, "{term} names src/{path}");
    }
}
