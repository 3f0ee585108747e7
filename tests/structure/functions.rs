//! Lengths of functions: at most 80 lines, from the line of `fn` to the closing brace.

use crate::sources::sources;

/// Most lines of a function.
const MOST: usize = 80;

/// Longer functions: file, name, and the reason. The list only gets shorter.
const EXCEPTIONS: [(&str, &str, &str); 1] = [(
    "element/variations.rs",
    "tangent",
    "one formula, in registers: its parts share all of their intermediate values",
)];

/// A function of a file with its number of lines.
#[derive(Debug, PartialEq)]
struct Function<'t> {
    name: &'t str,
    lines: usize,
}

/// Words before `fn`.
const QUALIFIERS: [&str; 6] = ["pub", "const", "unsafe", "async", "extern", "\"C\""];

/// Name of the function whose declaration a line begins; none of one that a macro names.
fn declared(line: &str) -> Option<&str> {
    let mut rest = line.trim_start();
    while !rest.starts_with("fn ") {
        let (word, _) = rest.split_once(' ')?;
        let length = match word.starts_with("pub(") {
            true => rest.find(')')? + 1,
            false if QUALIFIERS.contains(&word) => word.len(),
            false => return None,
        };
        rest = rest[length..].trim_start();
    }
    let name = &rest["fn ".len()..];
    let end = name.find(|c: char| !c.is_alphanumeric() && c != '_');
    Some(&name[..end.unwrap_or(name.len())]).filter(|name| !name.is_empty())
}

/// The functions of a text as rustfmt lays it out: the closing brace stands below the first letter of the declaration.
fn functions(text: &str) -> Vec<Function<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (begin, line) in lines.iter().enumerate() {
        let Some(name) = declared(line) else {
            continue;
        };
        let body = lines[begin..].iter().position(|line| {
            let line = line.trim_end();
            line.ends_with('{') || line.ends_with('}') || line.ends_with(';')
        });
        let Some(body) = body.filter(|&body| lines[begin + body].ends_with('{')) else {
            continue;
        };
        let indent = line.len() - line.trim_start().len();
        let closing = format!("{}}}", " ".repeat(indent));
        let end = lines[begin + body..].iter().position(|l| *l == closing);
        let end = end.unwrap_or_else(|| panic!("{name} has no closing brace"));
        let lines = body + end + 1;
        found.push(Function { name, lines });
    }
    found
}

#[test]
fn functions_are_short() {
    let (mut seen, mut long) = (0, Vec::new());
    for source in sources("src") {
        for Function { name, lines } in functions(&source.text) {
            seen += 1;
            if lines > MOST {
                long.push((source.name.clone(), name.to_owned(), lines));
            }
        }
    }
    assert!(seen > 3500, "{seen} functions");
    let is_known = |file: &str, name: &str| {
        let mut known = EXCEPTIONS.iter();
        known.any(|(f, n, _)| (*f, *n) == (file, name))
    };
    let unknown: Vec<_> = long.iter().filter(|(f, n, _)| !is_known(f, n)).collect();
    assert!(unknown.is_empty(), "more than {MOST} lines: {unknown:#?}");
    for (file, name, reason) in EXCEPTIONS {
        let is_long = long.iter().any(|(f, n, _)| f == file && n == name);
        assert!(is_long, "{name} of {file} is no exception any more");
        assert!(reason.len() > 20, "{name} of {file} has no reason");
    }
}

#[test]
fn functions_are_measured_from_their_declaration_to_their_brace() {
    let text = "\
impl A {
    pub(in crate::control) const fn one(
        &self,
    ) -> [f64; 2]
    where
        Self: Sized,
    {
        if true {
        }
    }

    fn declared(&self) -> bool;
    fn empty() {}
}

unsafe extern \"C\" fn two() {
}
// fn none() {
let fnord = 1;
";
    let lengths = functions(text);
    let expected = [("one", 9), ("two", 2)].map(|(name, lines)| Function { name, lines });
    assert_eq!(lengths, expected);
}
