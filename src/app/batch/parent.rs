//! End of the processes of a batch with the program that started them, however that ends.
//!
//! The program holds one end of a pipe, of which the other one is the standard input of the process. The operating system closes
//! what a program held when it is gone, also after `kill -9`, and the process reads the end of its input. Nothing is sent.

use std::env;
use std::io;
use std::process::{self, Command, Stdio};
use std::thread;

/// The environment variable that says so to a process.
const NAME: &str = "PROBOSCIS_ENDS_WITH_ITS_INPUT";

/// Exit status of a process that nobody waits for.
const EXIT_STATUS: i32 = 1;

/// A command whose process ends with this one.
pub(super) fn bind(command: &mut Command) -> &mut Command {
    command.env(NAME, "1").stdin(Stdio::piped())
}

/// Lets this process end with the program that started it, where it is one of a batch.
pub fn end_with_parent() {
    if env::var_os(NAME).is_none() {
        return;
    }
    let watch = || {
        // Nothing comes before the end.
        io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
        process::exit(EXIT_STATUS);
    };
    if let Err(error) = thread::Builder::new().spawn(watch) {
        tracing::warn!("this process will not end with the one that started it: {error}");
    }
}
