//! JSON laid out for people: a value that fits stands on one line.

use crate::files::json::tree::{Json, Tree};

/// Columns of a line.
const WIDTH: usize = 110;

/// Lays out JSON text, as serde_json writes it.
pub(crate) fn lay_out(compact: &str) -> String {
    let mut text = String::with_capacity(compact.len() + compact.len() / 4);
    lines(Tree::of(compact.to_owned()).json(), 0, 0, &mut text);
    text.push('\n');
    text
}

/// Writes a value that starts `used` columns into a line, its parts indented one step further.
fn lines(json: Json<'_>, indent: usize, used: usize, text: &mut String) {
    let (written, count) = (json.written(), json.parts().len());
    // A character takes at most four bytes: a long list is not read in vain.
    let line = match written.len() <= 4 * WIDTH {
        _ if count == 0 => Some(json.to_string()),
        true if indent > 0 => Some(format!("{json:#}")),
        _ => None,
    };
    if let Some(line) = line.filter(|line| count == 0 || used + line.chars().count() <= WIDTH) {
        text.push_str(&line);
        return;
    }
    let start = |text: &mut String, steps: usize| {
        text.push('\n');
        text.extend(std::iter::repeat_n("  ", steps));
    };
    text.push_str(&written[..1]);
    for (index, part) in json.parts().enumerate() {
        if index > 0 {
            text.push(',');
        }
        start(text, indent + 1);
        let mut column = 2 * (indent + 1);
        let key = part.written_key();
        if !key.is_empty() {
            text.push_str(key);
            text.push_str(": ");
            column += key.chars().count() + 2;
        }
        lines(part, indent + 1, column, text);
    }
    start(text, indent);
    text.push_str(&written[written.len() - 1..]);
}
