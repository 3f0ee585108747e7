//! Messages on standard error and answers on standard output: the one place that writes them.
//!
//! Messages that cannot be written to standard error are dropped. An answer that cannot be written is an error, unless
//! its reader has gone, as `head` does.

use std::io::{self, ErrorKind, IsTerminal, Stderr, Write};
use std::process::ExitCode;

/// Exit status where an answer cannot be written.
const UNWRITTEN: u8 = 1;

/// Writes a line to standard error.
pub(crate) fn tell(words: &str) {
    writeln!(io::stderr(), "{words}").ok();
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
