//! Runs of the program in a folder, and what they leave.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with a copy of the kept problems.
pub(crate) fn workshop() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let problems = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    for part in ["", "scenes", "measured"] {
        fs::create_dir_all(folder.path().join("problems").join(part)).unwrap();
        for entry in fs::read_dir(problems.join(part)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let name = path.file_name().unwrap();
                fs::copy(&path, folder.path().join("problems").join(part).join(name)).unwrap();
            }
        }
    }
    folder
}

/// Path of a kept problem.
pub(crate) fn problem(name: &str) -> String {
    format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"))
}

/// The program, to be run in a folder.
pub(crate) fn proboscis(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("proboscis").unwrap();
    command.current_dir(folder);
    command
}

/// Exit status, standard output and standard error of a run in a folder.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    run_with_input(folder, arguments, "")
}

/// A run with a text on standard input.
pub(crate) fn run_with_input(
    folder: &Path,
    arguments: &[&str],
    input: &str,
) -> (i32, String, String) {
    let mut command = proboscis(folder);
    let output = command.args(arguments).write_stdin(input).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let status = output.status.code().unwrap();
    (status, text(output.stdout), text(output.stderr))
}

/// A JSON file.
pub(crate) fn read(path: impl AsRef<Path>) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}
