//! Origin of a result, in one line: program, command, input, Ipopt.

use crate::ipopt;
use std::path::Path;

/// Origin of a result: the first line of each table and the caption of each figure and page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// The command as typed.
    pub command: String,
    /// The file that was read.
    pub input: String,
    /// Version of the program, see [`Origin::program`].
    pub version: String,
    /// Version of Ipopt; empty where it had no part.
    pub ipopt: String,
}

impl Origin {
    /// Origin of a result of this program; Ipopt is named where it has a part.
    pub fn new(command: &str, input: &Path, with_ipopt: bool) -> Self {
        Self {
            command: command.to_owned(),
            input: input.display().to_string(),
            version: Self::program(),
            ipopt: if with_ipopt { ipopt::VERSION } else { "" }.to_owned(),
        }
    }

    /// Crate version, and the commit where the build knew it (environment variable `PROBOSCIS_COMMIT`).
    pub fn program() -> String {
        let version = env!("CARGO_PKG_VERSION");
        match option_env!("PROBOSCIS_COMMIT") {
            Some(commit) if !commit.is_empty() => format!("{version} ({commit})"),
            _ => version.to_owned(),
        }
    }

    /// One line that names everything known; line breaks in the parts become spaces.
    pub fn line(&self) -> String {
        let mut parts = vec![format!("proboscis {}", self.version)];
        for (label, value) in [
            ("command: ", &self.command),
            ("input: ", &self.input),
            ("Ipopt ", &self.ipopt),
        ] {
            if !value.is_empty() {
                parts.push(format!("{label}{value}"));
            }
        }
        parts.join(" · ").replace(char::is_control, " ")
    }
}
