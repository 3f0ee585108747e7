//! Scene and problem files: their types as written, reading with units, checks, and conversion to systems and tasks.
//!
//! - [`units`]: numbers with units; [`json`]: text, places in it, mistakes, overrides.
//! - [`scene`], [`problem`]: types of the two files, and their conversion to [`System`] and [`Task`].
//! - `signal`: functions of time.
//! - [`study`], [`sweep`]: types of a study of variants of a problem, or a sweep of them; `changes`: their overrides.
//! - `feedback`: laws of controllers.
//! - [`solution`]: motions that later runs start from; [`npz`]: arrays of long ones; [`continuation`]: motions that go on.
//! - [`urdf`]: robots of ROS; [`stl`]: surfaces; `columns`: columns of CSV files; `typed`: scenes and voltages named on the command line.

use crate::control::Motion;
use crate::control::problem::{Disturbed, Duration, Regulator, Task};
use crate::files::changes::Changes;
use crate::files::json::error::Result;
use crate::files::json::scope::refuse;
use crate::files::json::set::Override;
use crate::files::problem::at::At;
use crate::files::problem::build::{ProblemSpec, SceneSource, build_problem};
use crate::files::problem::feedback::regulator;
use crate::files::problem::output::{Output, output};
use crate::files::problem::variants::{
    MotionDocument, add_plan, changed_scenes, disturbed, motions, together,
};
use crate::files::scene::build::build_scene;
use crate::files::scene::constants::WrittenScene;
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::spec::SceneSpec;
use crate::files::study::{ChangesSpec, StudySpec};
use crate::files::sweep::SweepSpec;
use crate::model::system::System;
use serde_json::Value;
use std::path::{Path, PathBuf};

pub(crate) mod changes;
mod columns;
pub mod continuation;
pub mod feedback;
pub mod json;
pub mod npz;
pub mod problem;
pub mod scene;
mod signal;
pub mod solution;
pub mod stl;
pub mod study;
pub mod sweep;
mod typed;
pub mod units;
pub mod urdf;

pub(crate) use columns::Columns;
pub(crate) use json::document::{Document, is_standard_input};
pub use json::error::{SceneError, lines, message, note, printable, printable_json};
pub(crate) use json::layout::{Entries, lay_out};
pub(crate) use json::scope::Scope;
pub(crate) use scene::build::LONGEST_CHAIN;
pub use scene::material::named_materials;
pub use scene::trunk::new_trunk;
pub use typed::{driven_voltages, each_entry_once, each_once, read_system};
pub(crate) use units::{number_and_unit, si};

/// A problem with its scene, read and checked.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// System of the scene.
    pub system: System,
    /// Task of the problem.
    pub task: Task,
    /// Part of a motion that is shown.
    pub output: Output,
    /// Costs of deviations of which the gains of a controller are the least.
    pub feedback: Option<Regulator>,
    /// The simulation with parts of the disturbance that its controller names.
    pub disturbed: Vec<Disturbed>,
    /// File of the scene; `None` where the problem holds the scene itself.
    pub scene_path: Option<PathBuf>,
    /// The JSON text of the scene without blanks, overrides applied.
    pub scene: String,
    /// That of the problem.
    pub problem: String,
    /// Notes on units that were taken for granted: those of columns that name none.
    pub notes: Vec<String>,
}

impl Loaded {
    /// The notes as lines of a message.
    pub(crate) fn note_lines(&self) -> impl Iterator<Item = String> + '_ {
        self.notes.iter().map(|note| format!("note: {note}"))
    }

    /// The text of an object of the problem without one of its keys; `null` where there is no such object.
    pub(crate) fn entry_without(&self, entry: &str, key: &str) -> String {
        let mut problem: Value = serde_json::from_str(&self.problem).unwrap_or_default();
        let mut entry = problem[entry].take();
        if let Some(entries) = entry.as_object_mut() {
            entries.remove(key);
        }
        entry.to_string()
    }
}

/// Reads a problem file, or standard input where it is `-`, and its scene, with overrides such as `control.intervals=80` or `scene.gravity=[0,0,0]`.
///
/// # Errors
/// A file cannot be read, is no JSON, or says what does not make sense; the error has its place.
pub fn read_problem(path: &Path, overrides: &[String]) -> Result<Loaded> {
    problem_of(|| Document::read_typed(path), overrides)
}

/// Reads a problem from its text, as if it stood in the file `path`, which need not exist: paths in it are relative to that file.
///
/// # Errors
/// As of [`read_problem`].
pub fn read_problem_text(path: &Path, text: &str, overrides: &[String]) -> Result<Loaded> {
    problem_of(|| Document::of_text(path, text.to_owned()), overrides)
}

fn problem_of(read: impl FnOnce() -> Result<Document>, overrides: &[String]) -> Result<Loaded> {
    let [of_scene, of_problem] = parted(Override::parse_each(overrides)?);
    let mut document = read()?;
    for change in &of_problem {
        change.apply(&mut document)?;
    }
    let Some(list) = motions(&document)? else {
        return with_changed_scenes(&document, &of_scene);
    };
    let mut first: Option<Loaded> = None;
    let mut each = Vec::new();
    for MotionDocument {
        name,
        document: of_motion,
        changes,
    } in list
    {
        let loaded = changed(of_motion, &of_scene, &changes, &ChangesSpec::default())?;
        let Task::Control(control) = &loaded.task else {
            unreachable!("an entry \"control\" is that task");
        };
        each.push(Motion {
            name,
            system: loaded.system.clone(),
            control: control.as_ref().clone(),
        });
        first.get_or_insert(loaded);
    }
    let first = first.expect("a list has a motion");
    refuse!(if first.feedback.is_some(), Scope::of(&document).key("feedback");
        found "a \"feedback\"",
        expected "none beside a list of motions: each has an optimum of its own");
    Ok(Loaded {
        task: Task::Motions(Box::new(together(each, &document)?)),
        problem: document.json().to_string(),
        ..first
    })
}

/// Overrides of the scene, and of the rest of a problem.
fn parted(overrides: Vec<Override>) -> [Vec<Override>; 2] {
    let of_scene = |change: &Override| change.in_scene().is_some();
    overrides.into_iter().partition(of_scene).into()
}

/// A problem with changes after overrides of its scene; an error of a change is one at its place.
fn changed(
    mut document: Document,
    of_scene: &[Override],
    changes: &Changes<'_>,
    set: &ChangesSpec,
) -> Result<Loaded> {
    let path = document.path.clone();
    let [in_scene, in_problem] = parted(Override::parse_each(&changes.words)?);
    let mut in_problem = in_problem.iter();
    let applied = in_problem.try_for_each(|change| change.apply(&mut document));
    let loaded = applied.and_then(|()| alone(document, &[of_scene, &in_scene].concat(), set));
    loaded.map_err(|error| changes.at_fault(error, &path))
}

/// A problem without a list of motions, whose recordings may have scenes of their own, and whose controller may name a disturbance.
fn with_changed_scenes(document: &Document, of_scene: &[Override]) -> Result<Loaded> {
    let scenes = changed_scenes(document)?;
    let mut loaded = alone(document.clone(), of_scene, &ChangesSpec::default())?;
    for of in scenes {
        let changed = changed(document.clone(), of_scene, &of.changes, &of.set)?;
        of.add(&mut loaded.task, changed.system, changed.task, document)?;
        let notes = changed.notes.into_iter();
        let further: Vec<_> = notes.filter(|note| !loaded.notes.contains(note)).collect();
        loaded.notes.extend(further);
    }
    let texts = [&*loaded.problem, &*loaded.scene];
    loaded.disturbed = disturbed(document, texts, |document, changes| {
        let found = changed(document, of_scene, changes, &ChangesSpec::default())?;
        Ok((found.system, found.task))
    })?;
    Ok(loaded)
}

/// A problem of one motion, or of another task; of an identification the recordings whose scene has these changes.
fn alone(mut document: Document, of_scene: &[Override], changes: &ChangesSpec) -> Result<Loaded> {
    let scene_apart = document
        .entry("scene")
        .is_some_and(|scene| scene.string().is_some());
    if !scene_apart {
        for change in of_scene {
            change.apply(&mut document)?;
        }
    }
    let problem: ProblemSpec = document.parse()?;
    let scope = Scope::of(&document);
    let apart = match &problem.scene {
        SceneSource::Inline(_) => None,
        SceneSource::Path(path) => {
            let file = scope.key("scene").file(path, "the path of a scene file")?;
            let mut scene = Document::read(&file)?;
            for change in of_scene.iter().filter_map(Override::in_scene) {
                change.apply(&mut scene)?;
            }
            Some((file, scene))
        }
    };
    let (scene_path, apart) = apart.unzip();
    let (written, place) = match (&problem.scene, &apart) {
        (SceneSource::Inline(scene), _) => (scene.as_ref().clone(), scope.key("scene")),
        (SceneSource::Path(_), apart) => {
            let scene = apart.as_ref().unwrap_or(&document);
            (scene.parse()?, Scope::of(scene))
        }
    };
    let system = build_scene(&written, &place)?;
    let scene = match &apart {
        Some(scene) => scene.json().to_string(),
        None => document
            .entry("scene")
            .map_or_else(String::new, |scene| scene.to_string()),
    };
    let of_scene = WrittenScene {
        spec: &written,
        system: &system,
        document: apart.as_ref().unwrap_or(&document),
        changes,
    };
    let at = At::new(&scope, &system);
    let mut task = build_problem(&problem, &of_scene, &at)?;
    add_plan(&mut task, &problem, &scope, |path| {
        let Loaded {
            system,
            task,
            feedback,
            ..
        } = read_problem(path, &[])?;
        Ok((system, task, feedback))
    })?;
    let output = shown(&problem, &task, &at)?;
    let feedback = feedback(&problem, &task, &at)?;
    let documents = [Some(&document), apart.as_ref()].into_iter().flatten();
    Ok(Loaded {
        notes: documents.flat_map(Document::notes).collect(),
        task,
        output,
        feedback,
        disturbed: Vec::new(),
        system,
        scene_path,
        scene,
        problem: document.json().to_string(),
    })
}

/// Part of the result of a task that is shown.
fn shown(problem: &ProblemSpec, task: &Task, at: &At<'_>) -> Result<Output> {
    let place = at.key("output");
    let expected = match (&problem.output, task) {
        (None, _) => return Ok(Output::default()),
        (Some(_), Task::Equilibrium(_)) => "none beside an equilibrium, which has no times",
        (Some(_), Task::Identify(_)) => "none beside an identification, which shows its readings",
        (Some(spec), _) => return output(spec, &place),
    };
    Err(place.wrong("an \"output\"", expected))
}

/// Feedback along an optimum.
fn feedback(problem: &ProblemSpec, task: &Task, at: &At<'_>) -> Result<Option<Regulator>> {
    let Some(spec) = &problem.feedback else {
        return Ok(None);
    };
    let place = at.key("feedback");
    let Task::Control(control) = task else {
        let expected = "none but beside \"control\", along whose optimum it is";
        return Err(place.wrong("a \"feedback\"", expected));
    };
    let regulator = regulator(spec, &place)?;
    let (Duration::Given(longest) | Duration::Free { max: longest, .. }) = control.duration;
    let too_long = spec.delay.as_ref().filter(|_| regulator.delay > longest);
    refuse!(if let Some(delay) = too_long, place.key("delay");
        found delay, expected "a time no longer than the motion");
    Ok(Some(regulator))
}

/// Reads a scene file.
///
/// # Errors
/// As of [`read_problem`].
pub fn read_scene(path: &Path) -> Result<System> {
    let document = Document::read(path)?;
    build_scene(&document.parse()?, &Scope::of(&document))
}

/// The JSON text of a scene file without shorthand, checked.
///
/// # Errors
/// As of [`read_problem`].
pub fn expand(path: &Path) -> Result<String> {
    let document = Document::read(path)?;
    let mut scene: SceneSpec = document.parse()?;
    build_scene(&scene, &Scope::of(&document))?;
    add_named(&mut scene);
    let compact = serde_json::to_string(&expanded(scene)).expect("a scene is JSON");
    Ok(lay_out(&compact))
}

/// The JSON Schemas of the scene file and of the problem file.
pub fn schema() -> (Value, Value) {
    let scene = schemars::schema_for!(SceneSpec);
    let problem = schemars::schema_for!(ProblemSpec);
    (identified("scene", scene), identified("problem", problem))
}

/// The JSON Schema of the study file.
pub fn study_schema() -> Value {
    identified("study", schemars::schema_for!(StudySpec))
}

/// The JSON Schema of the sweep file.
pub fn sweep_schema() -> Value {
    identified("sweep", schemars::schema_for!(SweepSpec))
}

/// A schema with the name by which other schemas and editors refer to it.
fn identified(file: &str, mut schema: schemars::Schema) -> Value {
    schema.insert("$id".to_owned(), format!("urn:proboscis:{file}").into());
    schema.to_value()
}
