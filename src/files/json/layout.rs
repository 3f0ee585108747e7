//! JSON laid out for people: what fits stands on one line.

/// Columns of a line.
const WIDTH: usize = 110;

/// Lays out compact JSON text, as serde_json writes it.
pub(crate) fn lay_out(compact: &str) -> String {
    let mut text = String::new();
    lay_out_value(compact, 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes one value that starts `used` columns into a line, its parts indented one step further.
fn lay_out_value(value: &str, indent: usize, used: usize, text: &mut String) {
    let is_list = value.starts_with(['{', '[']) && value.len() > 2;
    // A character takes at most four bytes: a long list is not read in vain.
    let may_fit = !is_list || indent > 0 && value.len() <= 4 * WIDTH;
    if may_fit {
        let line = spaced(value);
        if !is_list || used + line.chars().count() <= WIDTH {
            text.push_str(&line);
            return;
        }
    }
    let (open, close) = (&value[..1], &value[value.len() - 1..]);
    let inner = " ".repeat(2 * (indent + 1));
    text.push_str(open);
    for (index, item) in split(&value[1..value.len() - 1]).into_iter().enumerate() {
        text.push_str(if index == 0 { "\n" } else { ",\n" });
        text.push_str(&inner);
        let mut column = inner.len();
        let mut rest = item;
        if open == "{"
            && let Some((key, entry)) = entry(item)
        {
            text.push_str(key);
            text.push_str(": ");
            column += key.chars().count() + 2;
            rest = entry;
        }
        lay_out_value(rest, indent + 1, column, text);
    }
    text.push('\n');
    text.push_str(&" ".repeat(2 * indent));
    text.push_str(close);
}

/// Compact JSON with a space after each comma and colon and inside braces.
fn spaced(value: &str) -> String {
    let mut text = String::new();
    for (_, character, quoted) in characters(value) {
        match character {
            ',' | ':' if !quoted => text.extend([character, ' ']),
            '{' if !quoted => text.push_str("{ "),
            '}' if !quoted && text.ends_with("{ ") => {
                text.pop();
                text.push(character);
            }
            '}' if !quoted => text.push_str(" }"),
            _ => text.push(character),
        }
    }
    text
}

/// Key, with its quotation marks, and value of an entry of an object.
fn entry(item: &str) -> Option<(&str, &str)> {
    let colon = structure(item).find(|&(_, character)| character == ':')?.0;
    Some((&item[..colon], &item[colon + 1..]))
}

/// The parts of a compact list, split at the commas outside of strings and brackets.
fn split(list: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut depth, mut start) = (0_usize, 0);
    for (at, character) in structure(list) {
        match character {
            '{' | '[' => depth += 1,
            '}' | ']' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&list[start..]);
    parts
}

/// Characters outside of strings, with their places.
fn structure(text: &str) -> impl Iterator<Item = (usize, char)> {
    characters(text)
        .filter(|&(_, character, quoted)| !quoted && character != '"')
        .map(|(at, character, _)| (at, character))
}

/// Characters with their places, and whether a string holds them or ends with them.
fn characters(text: &str) -> impl Iterator<Item = (usize, char, bool)> {
    let (mut quoted, mut escaped) = (false, false);
    text.char_indices().map(move |(at, character)| {
        let inside = quoted;
        match character {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            _ => {}
        }
        (at, character, inside)
    })
}
