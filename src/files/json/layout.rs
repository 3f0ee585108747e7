//! JSON laid out for people: a value that fits stands on one line.

/// Columns of a line.
const WIDTH: usize = 110;

/// Lays out compact JSON text, as serde_json writes it.
pub(crate) fn lay_out(compact: &str) -> String {
    let mut text = String::with_capacity(compact.len() + compact.len() / 4);
    Compact::new(compact).lay_out(0, 0, 0, &mut text);
    text.push('\n');
    text
}

/// Compact JSON, whose lists are known by their ends.
struct Compact<'a> {
    text: &'a str,
    /// Positions at which lists open, in this order, and the positions behind them.
    ends: Vec<(usize, usize)>,
}

impl<'a> Compact<'a> {
    /// Finds the ends of all lists.
    fn new(text: &'a str) -> Self {
        let bytes = text.as_bytes();
        let (mut ends, mut open, mut at) = (Vec::new(), Vec::new(), 0);
        while at < bytes.len() {
            match bytes[at] {
                b'"' => at = behind_string(bytes, at) - 1,
                b'{' | b'[' => {
                    open.push(ends.len());
                    ends.push((at, at));
                }
                b'}' | b']' => {
                    if let Some(opened) = open.pop() {
                        ends[opened].1 = at + 1;
                    }
                }
                _ => {}
            }
            at += 1;
        }
        Self { text, ends }
    }

    /// The place behind the value that starts at a byte.
    fn end(&self, at: usize) -> usize {
        let bytes = self.text.as_bytes();
        match bytes[at] {
            b'"' => behind_string(bytes, at),
            b'{' | b'[' => {
                let index = self.ends.partition_point(|&(start, _)| start < at);
                self.ends[index].1
            }
            _ => {
                let rest = bytes[at..].iter();
                let length = rest.take_while(|byte| !matches!(byte, b',' | b'}' | b']'));
                at + length.count()
            }
        }
    }

    /// Writes the value at a byte, which starts `used` columns into a line, its parts indented one step further; returns the place
    /// behind it.
    fn lay_out(&self, at: usize, indent: usize, used: usize, text: &mut String) -> usize {
        let bytes = self.text.as_bytes();
        let end = self.end(at);
        let value = &self.text[at..end];
        if !value.starts_with(['{', '[']) || value.len() == 2 {
            text.push_str(value);
            return end;
        }
        // A character takes at most four bytes: a long list is not read in vain.
        if indent > 0 && value.len() <= 4 * WIDTH {
            let before = text.len();
            space(value, text);
            if used + text[before..].chars().count() <= WIDTH {
                return end;
            }
            text.truncate(before);
        }
        let indented = |text: &mut String, steps: usize| {
            text.push('\n');
            text.extend(std::iter::repeat_n("  ", steps));
        };
        text.push_str(&value[..1]);
        let mut place = at + 1;
        loop {
            indented(text, indent + 1);
            let mut column = 2 * (indent + 1);
            if bytes[at] == b'{' {
                let key = &self.text[place..behind_string(bytes, place)];
                text.push_str(key);
                text.push_str(": ");
                column += key.chars().count() + 2;
                place += key.len() + 1;
            }
            place = self.lay_out(place, indent + 1, column, text);
            if bytes[place] != b',' {
                break;
            }
            text.push(',');
            place += 1;
        }
        indented(text, indent);
        text.push_str(&value[value.len() - 1..]);
        end
    }
}

/// The place behind the string that opens at a byte.
fn behind_string(bytes: &[u8], at: usize) -> usize {
    let mut place = at + 1;
    while bytes[place] != b'"' {
        place += if bytes[place] == b'\\' { 2 } else { 1 };
    }
    place + 1
}

/// Compact JSON with a space after each comma and colon and inside braces.
fn space(value: &str, text: &mut String) {
    let bytes = value.as_bytes();
    // What is copied as it is, up to the present place.
    let (mut from, mut at) = (0, 0);
    while at < bytes.len() {
        let gap = match bytes[at] {
            b'"' => {
                at = behind_string(bytes, at);
                continue;
            }
            b',' | b':' => Some(at + 1),
            b'{' if bytes[at + 1] != b'}' => Some(at + 1),
            b'}' if bytes[at - 1] != b'{' => Some(at),
            _ => None,
        };
        if let Some(gap) = gap {
            text.push_str(&value[from..gap]);
            text.push(' ');
            from = gap;
        }
        at += 1;
    }
    text.push_str(&value[from..]);
}
