//! Documents and doc comments: links lead to files, sources that documents name exist, sections of `docs/theory.md` that
//! sources cite are there, and doc comments begin with what they define.

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

/// First words that make a question of a head or a doc comment, in place of a noun or a verb.
const QUESTIONS: [&str; 9] = [
    "What", "How", "Where", "Which", "Whether", "From", "When", "Why", "Who",
];

fn is_question(text: &str) -> bool {
    let first = text.split(|c: char| !c.is_alphabetic()).next();
    first.is_some_and(|word| QUESTIONS.contains(&word))
}

#[test]
fn heads_are_no_questions() {
    let mut seen = 0;
    for folder in ["src", "tests", "benches", "examples", "fuzz", "python/src"] {
        for source in sources(folder) {
            let Some(head) = source
                .text
                .lines()
                .next()
                .and_then(|line| line.strip_prefix("//! "))
            else {
                continue;
            };
            let name = source.name;
            assert!(
                !is_question(head),
                "the head of {folder}/{name} is {head:?}"
            );
            seen += 1;
        }
    }
    assert!(seen > 700, "{seen} heads");
}

#[test]
fn doc_comments_are_no_questions() {
    let mut seen = 0;
    for source in sources("src") {
        let mut before = "";
        for (number, line) in (1..).zip(source.text.lines()) {
            let line = line.trim_start();
            if let Some(text) = line
                .strip_prefix("/// ")
                .filter(|_| !before.starts_with("///"))
            {
                let name = &source.name;
                assert!(
                    !is_question(text),
                    "src/{name}:{number} begins with {text:?}"
                );
                seen += 1;
            }
            before = line;
        }
    }
    assert!(seen > 5000, "{seen} doc comments");
}
