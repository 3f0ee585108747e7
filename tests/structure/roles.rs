//! Roles of the scalars of an interval: only the table of variables and the numbering of a horizon compute with the numbers of
//! voltages and potentials.

use crate::sources::sources;

/// Files that know the order of variables.
const OWNERS: [&str; 2] = ["model/layout/variables.rs", "control/numbering.rs"];

/// Lists and ranges of variables of a role.
const NAMES: [&str; 4] = ["voltages", "potentials", "inputs", "algebraic"];

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the begin of the expression that ends at `end`: names, points, calls and references.
fn start(code: &str, end: usize) -> usize {
    let (mut at, mut depth) = (end, 0);
    for (i, c) in code[..end].char_indices().rev() {
        match c {
            ')' => depth += 1,
            '(' if depth > 0 => depth -= 1,
            c if depth > 0 || is_word(c) || c == '.' || c == ':' => {}
            _ => break,
        }
        at = i;
    }
    // `..` before it is no part of it.
    at + code[at..end].rfind("..").map_or(0, |dots| dots + 2)
}

/// The numbers of variables of a role in code without white space, each with what stands before and after it.
fn counts(code: &str) -> Vec<[&str; 3]> {
    let mut found = Vec::new();
    for end in [".len()", ".start", ".end", ".count(Role::"] {
        for (at, _) in code.match_indices(end) {
            let (begin, mut after) = (start(code, at), at + end.len());
            let list = &code[begin..at];
            let is_of_role = list.ends_with(')') && list.contains("(Role::");
            let name = list.trim_end_matches("()").rsplit('.').next();
            let is_named = name.is_some_and(|name| NAMES.contains(&name));
            if end.ends_with(':') {
                after += code[after..].find(')').unwrap_or_default() + 1;
            } else if !(is_of_role || is_named) || code[after..].starts_with(is_word) {
                continue;
            }
            found.push([&code[..begin], &code[begin..after], &code[after..]]);
        }
    }
    found
}

/// Returns true if something is computed with a number: it is added, compared, or cuts a list.
fn is_computed([before, _, after]: &[&str; 3]) -> bool {
    let operators = ['+', '-', '*', '/', '%', '<'];
    let calls = ["checked_sub(", "split_at(", "split_at_mut(", ".."];
    before.ends_with(operators)
        || calls.iter().any(|call| before.ends_with(call))
        || after.starts_with(operators)
        || after.starts_with("..")
        || (before.ends_with('>') && !before.ends_with("=>"))
        || after.starts_with('>')
}

#[test]
fn nobody_counts_voltages() {
    let computed = |code: &str| {
        counts(code)
            .iter()
            .filter(|found| is_computed(found))
            .count()
    };
    // The test sees what it looks for.
    for code in [
        "ifs<model.voltages.len(){",
        "scalars[model.voltages.len()..]",
        "scalars[..voltages.len()]",
        "m+model.variables.count(Role::Potential);",
        "s-variables.range(Role::Voltage).end",
        "s.checked_sub(self.model.variables.algebraic().start)",
        "k*inputs.len()+s",
    ] {
        assert_eq!(computed(code), 1, "{code}");
    }
    for code in [
        "vec![0.0;voltages.len()]",
        "rows.len()+1",
        "Some(s)=>voltages.len()",
    ] {
        assert_eq!(computed(code), 0, "{code}");
    }
    let mut seen = [0, 0];
    for source in sources("src") {
        let code: String = source.code().collect::<Vec<_>>().join(" ");
        let code: String = code.chars().filter(|c| !c.is_whitespace()).collect();
        let found = counts(&code);
        let bad: Vec<_> = found.iter().filter(|found| is_computed(found)).collect();
        if OWNERS.contains(&source.name.as_str()) {
            seen[0] += bad.len();
            continue;
        }
        seen[1] += found.len();
        let bad: Vec<&str> = bad.iter().map(|[_, count, _]| *count).collect();
        assert!(bad.is_empty(), "{} computes with {bad:?}", source.name);
    }
    assert!(seen[0] > 3 && seen[1] > 10, "{seen:?}");
}
