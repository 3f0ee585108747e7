//! Form of file heads and doc comments: a noun phrase or a verb, not a question.

use crate::sources::sources;
use std::path::Path;

/// First words that make a question of a head or a doc comment.
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

/// Names that a list at the head of a folder explains: those before a colon, at the beginning of an entry or after a semicolon.
fn explained(head: &str) -> Vec<&str> {
    let parts = head.split("\n- ").skip(1).flat_map(|one| one.split("; "));
    let named = parts.filter_map(|part| part.trim_start().split_once(": "));
    let named = named.filter(|(names, _)| names.starts_with('`'));
    named
        .flat_map(|(names, _)| names.split('`').skip(1).step_by(2))
        .collect()
}

#[test]
fn files_that_heads_explain_exist() {
    let mut seen = 0;
    for source in sources("src") {
        let Some(folder) = source.name.strip_suffix("mod.rs") else {
            continue;
        };
        let lines = source.text.lines().map_while(|l| l.strip_prefix("//!"));
        let lines: Vec<&str> = lines.map(str::trim_start).collect();
        for name in explained(&lines.join("\n")) {
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("src")
                .join(folder)
                .join(name);
            assert!(
                path.is_dir() || path.with_extension("rs").is_file(),
                "the head of src/{folder}mod.rs explains {name}"
            );
            seen += 1;
        }
    }
    assert!(seen > 150, "{seen} files");
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
