//! Files to begin with: templates of robots, robots from URDF, the scene without shorthand, the schemas.

use std::fs;
use std::path::{Path, PathBuf};

use crate::app::error::CommandError;
use crate::app::kept::record::make_folder;
use crate::app::request::CommandOutput;
use crate::files;
use crate::files::named_materials;
use crate::files::urdf::read_urdf;
use crate::report::{atomic, quoting};

/// A robot to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Template {
    /// Segments in a row, with two muscles at each joint, steered from rest to rest.
    Trunk {
        /// Their number.
        segments: usize,
    },
    /// An arm of three links under gravity, steered to a posture.
    Arm,
    /// A finger of finite elements with two electrodes, steered to a bent state of rest.
    Finger,
    /// Two fingers of two phalanges, which close.
    Gripper,
    /// A body that nothing holds, with a trunk, which tumbles.
    Satellite,
}

impl Template {
    /// Its scene and its problem.
    fn files(self) -> (String, String) {
        macro_rules! kept {
            ($name:literal) => {
                (
                    include_str!(concat!("templates/", $name, ".scene.json")).to_owned(),
                    include_str!(concat!("templates/", $name, ".problem.json")).to_owned(),
                )
            };
        }
        match self {
            Self::Trunk { segments } => files::new_trunk(segments),
            Self::Arm => kept!("arm"),
            Self::Finger => kept!("finger"),
            Self::Gripper => kept!("gripper"),
            Self::Satellite => kept!("satellite"),
        }
    }

    /// The command that does what its problem asks.
    const fn command(self) -> &'static str {
        match self {
            Self::Satellite => "simulate",
            _ => "solve",
        }
    }
}

/// Writes scene and problem of a robot into a folder, with the schemas from which editors complete them, and names the next command; files that
/// exist are left alone.
///
/// # Errors
/// A trunk has no segments or too many, a file exists, or cannot be written.
pub fn new_files(template: Template, folder: &Path) -> Result<CommandOutput, CommandError> {
    if let Template::Trunk { segments } = template
        && !(1..=files::LONGEST_CHAIN).contains(&segments)
    {
        let most = files::LONGEST_CHAIN;
        return Err(CommandError::option(
            "--segments",
            format!("found {segments}, expected a number of segments from 1 to {most}"),
        ));
    }
    let (scene, problem) = template.files();
    let files = [("scene.json".to_owned(), scene.into_bytes())];
    write_new(files.into(), problem, template.command(), folder)
}

/// Problem of a robot from a URDF file: its motion from rest.
const OF_URDF: &str = r#"{
  "$schema": "problem.schema.json",
  "scene": "scene.json",
  "simulate": { "duration": "1 s", "step": "1 ms" }
}
"#;

/// Writes the scene of a URDF file with its meshes into a folder, a problem and the schemas, as [`new_files`] does.
///
/// # Errors
/// The URDF file is wrong, a file exists, or cannot be written.
pub fn new_from_urdf(urdf: &Path, folder: &Path) -> Result<CommandOutput, CommandError> {
    let found = read_urdf(urdf)?;
    let mut files = found.meshes;
    files.push(("scene.json".to_owned(), found.scene.into_bytes()));
    let output = write_new(files, OF_URDF.to_owned(), "simulate", folder)?;
    let notes = found.notes.iter().map(|note| format!("note: {note}"));
    Ok(CommandOutput {
        notes: notes.collect(),
        ..output
    })
}

/// Writes files of a scene, its problem and the schemas into a folder, or none where the scene is wrong; `command` does what the problem asks.
fn write_new(
    mut files: Vec<(String, Vec<u8>)>,
    problem: String,
    command: &str,
    folder: &Path,
) -> Result<CommandOutput, CommandError> {
    let (of_scene, of_problem) = schema();
    files.extend(
        [
            ("problem.json", problem),
            ("scene.schema.json", of_scene + "\n"),
            ("problem.schema.json", of_problem + "\n"),
        ]
        .map(|(name, text)| (name.to_owned(), text.into_bytes())),
    );
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .into_iter()
        .map(|(name, bytes)| (folder.join(name), bytes))
        .collect();
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(CommandError::Exists(path.clone()));
    }
    for (path, bytes) in &files {
        write_file(path, bytes)?;
    }
    if let Err(wrong) = files::read_scene(&folder.join("scene.json")) {
        remove(&files, folder);
        return Err(wrong.into());
    }
    let names = files.iter().map(|(path, _)| path.display().to_string());
    let next = format!("next: {}", next(command, folder));
    Ok(CommandOutput {
        is_solved: true,
        result: names.chain([next]).collect::<Vec<_>>().join("\n"),
        notes: Vec::new(),
    })
}

/// Removes files that were written, and their folders where nothing else is in them.
fn remove(files: &[(PathBuf, Vec<u8>)], folder: &Path) {
    let paths = files.iter().map(|(path, _)| path);
    // What cannot be removed stays; the mistake is told all the same.
    for path in paths.clone() {
        let _ = fs::remove_file(path);
    }
    for beside in paths.filter_map(|path| path.parent()).chain([folder]) {
        let _ = fs::remove_dir(beside);
    }
}

/// A command on the problem in a folder, whose results go to a folder of its own name.
fn next(command: &str, folder: &Path) -> String {
    let problem = Path::new("problem.json");
    let problem = match folder == Path::new(".") {
        true => problem.to_owned(),
        false => folder.join(problem),
    };
    let problem = problem.display().to_string();
    let words = ["proboscis", command, &problem].map(str::to_owned);
    quoting::command(words)
}

/// Writes a file, and the folders that it lies in where they are missing.
///
/// # Errors
/// It cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    if let Some(folder) = path.parent() {
        make_folder(folder)?;
    }
    Ok(atomic::write(path, bytes)?)
}

/// The scene of a file without shorthand.
///
/// # Errors
/// The scene is wrong.
pub fn expand(path: &Path) -> Result<String, CommandError> {
    Ok(files::expand(path)?)
}

/// Names of the materials with published constants, or the text of one of them.
///
/// # Errors
/// There is no material of this name.
pub fn materials(name: Option<&str>) -> Result<String, CommandError> {
    let mut all = named_materials();
    let Some(wanted) = name else {
        let names: Vec<&str> = all.map(|(name, _)| name).collect();
        return Ok(names.join("\n"));
    };
    if let Some((_, text)) = all.find(|(name, _)| *name == wanted) {
        return Ok(text.trim_end().to_owned());
    }
    let names: Vec<&str> = named_materials().map(|(name, _)| name).collect();
    Err(CommandError::option(
        "materials",
        format!("found {wanted:?}, expected one of {}", names.join(", ")),
    ))
}

/// The JSON Schemas of scene and problem as text.
pub fn schema() -> (String, String) {
    let (scene, problem) = files::schema();
    (text(&scene), text(&problem))
}

/// The JSON Schema of a study as text.
pub fn study_schema() -> String {
    text(&files::study_schema())
}

/// The JSON Schema of a sweep as text.
pub fn sweep_schema() -> String {
    text(&files::sweep_schema())
}

fn text(schema: &serde_json::Value) -> String {
    serde_json::to_string_pretty(schema).expect("a schema is JSON")
}
