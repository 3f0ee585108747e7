//! Scenes that are other ones in some recordings of an identification.

use crate::control::problem::{ChangedScene, Identification, Recording, Task};
use crate::files::changes::Changes;
use crate::files::json::document::Document;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::build::ProblemSpec;
use crate::files::problem::identify::IdentifySpec;
use crate::files::study::ChangesSpec;
use crate::model::Parameter;
use crate::model::system::System;

/// Changes of the scene for some recordings.
pub(crate) struct SceneChanges<'a> {
    pub(crate) set: ChangesSpec,
    pub(crate) changes: Changes<'a>,
    /// Place of the first one.
    scope: Scope<'a>,
}

/// The changes that recordings and candidates of a problem name, each once.
pub(crate) fn changed_scenes(document: &Document) -> Result<Vec<SceneChanges<'_>>> {
    let mut out: Vec<SceneChanges<'_>> = Vec::new();
    let Some(spec) = written(document)? else {
        return Ok(out);
    };
    let scope = Scope::of(document).key("identify");
    let of = |key, sets: Vec<ChangesSpec>| {
        let place = scope.key(key);
        let each = sets.into_iter().enumerate();
        each.map(move |(index, set)| (set, place.index(index).key("set")))
            .collect::<Vec<_>>()
    };
    let recordings = spec.recordings.into_iter().map(|one| one.set).collect();
    let candidates = spec.candidates.into_iter().map(|one| one.set).collect();
    let all = [of("recordings", recordings), of("candidates", candidates)];
    for (set, scope) in all.into_iter().flatten() {
        if set.is_empty() || out.iter().any(|known| known.set == set) {
            continue;
        }
        let mut changes = Changes::default();
        for (key, value) in &set {
            let place = scope.key(key);
            refuse!(if !key.starts_with("scene."), place;
                found format!("the key {key:?}"),
                expected "a place in the scene, such as scene.gravity");
            changes.push(key, value, place)?;
        }
        out.push(SceneChanges {
            set,
            changes,
            scope,
        });
    }
    Ok(out)
}

/// The identification that a problem asks for, if it does.
fn written(document: &Document) -> Result<Option<IdentifySpec>> {
    match document.entry("identify") {
        None => Ok(None),
        Some(_) => Ok(document.parse::<ProblemSpec>()?.identify),
    }
}

impl SceneChanges<'_> {
    /// Adds the recordings of the changed scene to a task, in the order in which the problem names them.
    pub(crate) fn add(
        &self,
        task: &mut Task,
        system: System,
        of_changed: Task,
        document: &Document,
    ) -> Result<()> {
        let (Task::Identify(task), Task::Identify(other)) = (task, of_changed) else {
            unreachable!("an entry \"identify\" is that task");
        };
        let numbers = |of: &Parameter| [of.lower, of.upper, of.guess];
        for (sought, other) in task.parameters.iter().zip(&other.parameters) {
            refuse!(if numbers(sought) != numbers(other), self.scope;
                found format!("a change of {}, which is sought", sought.name),
                expected "changes of numbers that are not sought");
        }
        let Identification {
            parameters,
            recordings,
            candidates,
            ..
        } = *other;
        let scene = Some(Box::new(ChangedScene { system, parameters }));
        let changed = |one: Recording| Recording {
            scene: scene.clone(),
            ..one
        };
        task.recordings.extend(recordings.into_iter().map(changed));
        task.candidates.extend(candidates.into_iter().map(changed));
        if let Some(spec) = written(document)? {
            let names = spec.recordings.iter().map(|one| &one.name);
            let candidates = spec.candidates.iter().map(|one| &one.name);
            let names: Vec<&String> = names.into_iter().chain(candidates).collect();
            let place = |one: &Recording| names.iter().position(|name| **name == one.name);
            task.recordings.sort_by_key(place);
            task.candidates.sort_by_key(place);
        }
        Ok(())
    }
}
