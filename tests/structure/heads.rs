//! Form of file heads and doc comments: a noun phrase or a verb, not a question.

use crate::sources::sources;

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
