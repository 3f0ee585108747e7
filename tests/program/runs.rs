//! Runs of the program in a folder, and what they leave.

use assert_cmd::Command;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::system::System;
use proboscis::report::file_set::FileSet;
use proboscis::report::origin::Origin;
use proboscis::report::skins::Skins;
use proboscis::report::{Figures, Run, write_run};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with a copy of the kept problems.
pub(crate) fn workshop() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let problems = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    for part in ["", "scenes", "meshes", "measured", "feedback"] {
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

/// Asserts that a run is refused with words.
pub(crate) fn refused(folder: &Path, arguments: &[&str], told: &[&str]) {
    let (status, out, err) = run(folder, arguments);
    assert_eq!(status, 2, "{arguments:?}: {out}{err}");
    told.iter()
        .for_each(|told| assert!(err.contains(told), "{told}: {err}"));
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

/// Writes the files of a motion, without a page.
pub(crate) fn write_motion(
    folder: &Path,
    system: &System,
    trajectory: &Trajectory,
    figures: Figures,
) {
    let origin = Origin {
        command: "proboscis".to_owned(),
        input: "a.json".to_owned(),
        version: Origin::program(),
        ipopt: String::new(),
    };
    let observations = trajectory.observe(system);
    let skins = Skins::default();
    let run = Run {
        figures,
        ..Run::from_trajectory(system, trajectory, &skins, &observations, &origin)
    };
    let mut files = FileSet::in_folder(folder);
    write_run(&mut files, &run).unwrap();
    files.finish().unwrap();
}
