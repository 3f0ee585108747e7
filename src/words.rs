//! Messages on standard error and answers on standard output: the one place that writes them.
//!
//! Messages that cannot be written to standard error are dropped. An answer that cannot be written is an error, unless
//! its reader has gone, as `head` does.

use anstyle::AnsiColor;
use std::io::{self, ErrorKind, IsTerminal, Stderr, Write};
use std::process::ExitCode;

/// Exit status where an answer cannot be written.
const UNWRITTEN: u8 = 1;

/// Labels of messages and their colours on a terminal.
const LABELS: [(&str, AnsiColor); 3] = [
    ("error:", AnsiColor::Red),
    ("warning:", AnsiColor::Yellow),
    ("note:", AnsiColor::Cyan),
];

/// Writes a line to standard error, a label at its beginning in colour on a terminal.
pub(crate) fn tell(words: &str) {
    let labelled = LABELS
        .iter()
        .find_map(|(label, colour)| Some((label, colour, words.strip_prefix(label)?)));
    let mut errors = anstream::stderr();
    match labelled {
        Some((label, colour, text)) => {
            let style = colour.on_default().bold();
            writeln!(errors, "{style}{label}{style:#}{text}")
        }
        None => writeln!(errors, "{words}"),
    }
    .ok();
}

/// Writes the answer of a command that ends with a status, and returns with which one it does.
pub(crate) fn answered(answer: &str, status: u8) -> ExitCode {
    let mut output = io::stdout().lock();
    let written = writeln!(output, "{}", answer.trim_end()).and_then(|()| output.flush());
    printed(written, status)
}

/// The exit status of a command that ends with a status and has written its answer, or has not.
pub(crate) fn printed(written: io::Result<()>, status: u8) -> ExitCode {
    match written {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => {
            tell(&format!(
                "error: cannot write the answer to standard output: {cause}"
            ));
            ExitCode::from(status.max(UNWRITTEN))
        }
        _ => ExitCode::from(status),
    }
}

/// Standard error as events are written to it.
#[derive(Debug)]
pub(crate) struct Events(Stderr);

impl Events {
    /// In a terminal without the line that shows progress.
    pub(crate) fn on_a_new_line() -> Self {
        let mut errors = io::stderr();
        if errors.is_terminal() {
            // What cannot be cleared stays.
            errors.write_all(b"\r\x1b[2K").ok();
        }
        Self(errors)
    }
}

impl Write for Events {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write_all(bytes).ok();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush().ok();
        Ok(())
    }
}
