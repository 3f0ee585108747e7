//! Problems within a problem: the motions of a list, recordings whose scenes are other ones, parts of a disturbance, a problem that a controller plans
//! anew.
//!
//! Each motion is the problem that remains with the keys of its entry in the place of those of `control`; phases are motions one after another, of which
//! the first one begins at the start of `control` and the last one ends at its goal. The disturbance of a closed loop is the same
//! simulation with values between those of no disturbance and those that the problem has.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::control::problem::{
    Ahead, ChangedScene, Combined, Disturbed, Duration, Identification, Recording, Regulator,
    Simulation, Task,
};
use crate::control::{Motion, Motions};
use crate::feedback::{Law, LawInput};
use crate::files::changes::{Changes, word};
use crate::files::json::document::Document;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::json::set::{Override, value_at};
use crate::files::json::tree::Json;
use crate::files::problem::build::ProblemSpec;
use crate::files::problem::control::{COMMON, CombinedSpec};
use crate::files::problem::feedback::{CONTROL_FILE, DisturbanceSpec, ROUNDING};
use crate::files::problem::identify::IdentifySpec;
use crate::files::problem::simulation::refuse_given;
use crate::files::study::ChangesSpec;
use crate::files::units::number_and_unit;
use crate::files::units::quantity::{Quantity, Time};
use crate::math::shortest;
use crate::model::Parameter;
use crate::model::system::{Source, System};

/// Keys of a motion that are none of a control problem.
const OWN: [&str; 2] = ["name", "set"];
/// Keys of a control problem with motions that no motion has.
const OF_ALL: [&str; 4] = ["combine", "motions", "phases", "shared_inputs"];
/// Key of motions one after another.
const PHASES: &str = "phases";
/// Keys of a control problem with phases that no phase has.
const ENDS: [&str; 2] = ["goal", "start"];

/// A motion as a problem of its own.
pub(crate) struct MotionDocument<'a> {
    pub(crate) name: String,
    pub(crate) document: Document,
    /// Constants of its scene, after those of all motions.
    pub(crate) changes: Changes<'a>,
}

/// Key and list of the motions or phases of a control problem.
fn list_of<'d>(control: Json<'d>) -> Option<(&'static str, Json<'d>)> {
    let list = |key| Some((key, control.entry(key)?));
    list("motions").or_else(|| list(PHASES))
}

/// The motions of a problem, if it has a list of them.
pub(crate) fn motions(document: &Document) -> Result<Option<Vec<MotionDocument<'_>>>> {
    let Some(control) = document.entry("control") else {
        return Ok(None);
    };
    let Some((key, list)) = list_of(control) else {
        return Ok(None);
    };
    let scope = Scope::of(document).key("control");
    refuse!(if control.entry("sensitivity").is_some(), scope.key("sensitivity");
        found "sensitivities of several motions", expected "a problem of one motion");
    let apart: &[&str] = match key {
        PHASES => &["combine", "shared_inputs"],
        _ => &[PHASES],
    };
    let other = apart.iter().find(|other| control.entry(other).is_some());
    refuse!(if let Some(other) = other, scope.key(other);
        found format!("the key {other:?}"), expected format!("none beside {key:?}"));
    let scope = scope.key(key);
    refuse!(if list.first() != Some('['), scope; found list, expected "a list of motions");
    refuse!(if list.parts().len() == 0, scope;
        found "no motion", expected "a list of one motion or more");
    let mut names = BTreeSet::new();
    let count = list.parts().len();
    let each = list.parts().enumerate().map(|(number, written)| {
        let mut motion = one(written, number, control, key, &scope.index(number))?;
        if key == PHASES && number + 1 < count {
            let goal = JsonPath::default().key("control").key("goal");
            Override::new(goal, "free".into()).apply(&mut motion.document)?;
        }
        refuse!(if !names.insert(motion.name.clone()), scope.index(number).key("name");
            found format!("{:?} a second time", motion.name),
            expected "another name for each motion");
        Ok(motion)
    });
    each.collect::<Result<_, _>>().map(Some)
}

/// A motion by its entry in the list.
fn one<'a>(
    motion: Json<'_>,
    number: usize,
    control: Json<'_>,
    list: &str,
    scope: &Scope<'a>,
) -> Result<MotionDocument<'a>> {
    refuse!(if motion.first() != Some('{'), scope;
        found motion, expected "a motion: an object with the keys that are other ones in it");
    let is_of =
        |list: &[&str], entry: &Json<'_>| entry.key().is_some_and(|key| list.contains(&&*key));
    let mut common = motion.parts().filter(|entry| is_of(&COMMON, entry));
    refuse!(if let Some(key) = common.find_map(Json::key), scope.key(&key);
        found format!("the key {key:?} in a motion"),
        expected format!("it beside {list:?}: all of them have it in common"));
    let is_phase = list == PHASES;
    let mut ends = ENDS.into_iter().filter(|_| is_phase);
    refuse!(if let Some(key) = ends.find(|key| motion.entry(key).is_some()), scope.key(key);
        found format!("the key {key:?} in a phase"),
        expected "it beside \"phases\": the first phase has the start and the last one the goal; \"waypoints\" at \"part\": 1 are places between two phases");
    refuse!(if is_phase && motion.entry("duration").is_none(), scope;
        found "no key \"duration\"", expected "the duration of the phase, or its bounds and a guess");
    let is_shared = |entry: &Json<'_>| {
        let is_own = entry.key().is_some_and(|key| motion.entry(&key).is_some());
        !is_own && !is_of(&OF_ALL, entry)
    };
    let shared = control.parts().filter(is_shared);
    let own = motion.parts().filter(|entry| !is_of(&OWN, entry));
    let mut document = scope.document.clone();
    let all = shared.chain(own.clone()).map(Json::node);
    document.tree.set_entries("control", all.collect());
    let place = JsonPath::default().key("control");
    for key in own.filter_map(Json::key) {
        document
            .moved
            .push((place.key(&key), scope.place.key(&key)));
    }
    let set = "an object of values by their places in the scene";
    let set: Option<ChangesSpec> = written(motion, "set", scope, set)?;
    let expected = "a place in the scene, such as scene.gravity; keys of \"control\" stand in the motion itself";
    Ok(MotionDocument {
        name: name(motion, number, scope)?,
        changes: Changes::of_scene(&set.unwrap_or_default(), &scope.key("set"), expected)?,
        document,
    })
}

/// The value under a key of an object at a place; none where there is none, or `null`.
fn written<T: DeserializeOwned>(
    object: Json<'_>,
    key: &str,
    scope: &Scope<'_>,
    expected: &str,
) -> Result<Option<T>> {
    let Some(entry) = object.entry(key) else {
        return Ok(None);
    };
    let wrong = |_| scope.key(key).wrong(entry.to_string(), expected);
    entry.read::<Option<T>>().map_err(wrong)
}

/// The name of a motion, which is that of a folder.
fn name(motion: Json<'_>, number: usize, scope: &Scope<'_>) -> Result<String> {
    let Some(name) = written::<String>(motion, "name", scope, "a name")? else {
        return Ok(format!("motion{}", number + 1));
    };
    let fits = |c: char| c.is_alphanumeric() || "_-".contains(c);
    refuse!(if name.is_empty() || !name.chars().all(fits), scope.key("name");
        found format!("{name:?}"),
        expected "a name of letters, digits, _ and -, which is that of its folder");
    Ok(name)
}

/// The motions, if what they are to share can be shared, and phases can follow one another.
pub(crate) fn together(list: Vec<Motion>, document: &Document) -> Result<Motions> {
    let of_all = Scope::of(document).key("control");
    let scope = of_all.key("shared_inputs");
    let names = "a list of names of muscles, driven electrodes and loads";
    let control = document.entry("control").expect("it has the motions");
    if control.entry(PHASES).is_some() {
        return in_sequence(list, control, &of_all);
    }
    let shared_inputs: Option<_> = written(control, "shared_inputs", &of_all, names)?;
    let combined = written(control, "combine", &of_all, "\"sum\" or \"worst\"")?;
    let motions = Motions {
        list,
        shared_inputs: shared_inputs.unwrap_or_default(),
        combined: match combined {
            None | Some(CombinedSpec::Sum) => Combined::Sum,
            Some(CombinedSpec::Worst) => Combined::Worst,
        },
    };
    scope.unique(&motions.shared_inputs, &[], |index| scope.index(index))?;
    for (index, name) in motions.shared_inputs.iter().enumerate() {
        check_input(&motions.list, name, &scope.index(index))?;
    }
    let other = motions.task().other_grid().map(|motion| motion.name);
    refuse!(if let Some(name) = other.filter(|_| !motions.shared_inputs.is_empty()), scope;
        found format!("inputs in common with the motion {name:?}, whose instants are other ones"),
        expected "motions of one given \"duration\" and one number of \"intervals\"");
    Ok(motions)
}

/// Phases, each of which goes on where the one before ended.
fn in_sequence(list: Vec<Motion>, control: Json<'_>, scope: &Scope<'_>) -> Result<Motions> {
    let place = scope.key("duration");
    let expected = "the time of all phases together, such as \"1 s\"";
    let whole: Option<Quantity<Time>> = written(control, "duration", scope, expected)?;
    let whole = whole.map(|whole| place.positive(&whole)).transpose()?;
    Motions::in_sequence(list, whole).map_err(|fault| {
        let steps = JsonPath::parse(&fault.at).unwrap_or_default().0;
        let at = steps.iter().fold(scope.clone(), |at, step| match step {
            Step::Key(key) => at.key(key),
            Step::Index(index) => at.index(*index),
        });
        at.error_of(fault)
    })
}

/// That an input is sought in all motions.
fn check_input(list: &[Motion], name: &str, scope: &Scope<'_>) -> Result<()> {
    for motion in list {
        let sources = motion.system.sources();
        let names: Vec<String> = sources.iter().map(|source| source.name.clone()).collect();
        let source = scope.find(name, &names, "a muscle, driven electrode or load")?;
        let is_sought = match sources[source].takes_voltage {
            true => !motion.control.is_given(source),
            false => motion.control.load_bounds.contains_key(&source),
        };
        refuse!(if !is_sought, scope;
            found format!("{name:?}, which is not sought in the motion {:?}", motion.name),
            expected "an input that is sought in all motions");
    }
    Ok(())
}

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
    let Some(spec) = identify(document)? else {
        return Ok(out);
    };
    let scope = Scope::of(document).key("identify");
    let place = |key, index| scope.key(key).index(index).key("set");
    let recordings = spec.recordings.into_iter().enumerate();
    let recordings = recordings.map(|(index, one)| (one.set, place("recordings", index)));
    let candidates = spec.candidates.into_iter().enumerate();
    let candidates = candidates.map(|(index, one)| (one.set, place("candidates", index)));
    for (set, scope) in recordings.chain(candidates) {
        if set.is_empty() || out.iter().any(|known| known.set == set) {
            continue;
        }
        let expected = "a place in the scene, such as scene.gravity";
        let changes = Changes::of_scene(&set, &scope, expected)?;
        out.push(SceneChanges {
            set,
            changes,
            scope,
        });
    }
    Ok(out)
}

/// The identification that a problem asks for, if it does.
fn identify(document: &Document) -> Result<Option<IdentifySpec>> {
    Ok(with_entry(document, "identify")?.and_then(|spec| spec.identify))
}

/// The problem, if it has an entry.
fn with_entry(document: &Document, key: &str) -> Result<Option<ProblemSpec>> {
    let entry = document.entry(key);
    entry.map(|_| document.parse()).transpose()
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
        if let Some(spec) = identify(document)? {
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

/// Most sizes.
const MOST: usize = 20;

/// The simulations of a problem whose controller names a disturbance, one for each of its sizes. `texts` are those of the problem and of its scene;
/// `read` reads a document with changes.
pub(crate) fn disturbed(
    document: &Document,
    texts: [&str; 2],
    read: impl Fn(Document, &Changes<'_>) -> Result<(System, Task)>,
) -> Result<Vec<Disturbed>> {
    let simulate = with_entry(document, "simulate")?.and_then(|spec| spec.simulate);
    let Some(spec) = simulate.and_then(|one| one.controller?.disturbance) else {
        return Ok(Vec::new());
    };
    let scope = Scope::of(document).key("simulate").key("controller");
    let scope = scope.key("disturbance");
    let sizes = sizes(&spec, &scope)?;
    let place = scope.key("without");
    refuse!(if spec.without.is_empty(), place;
        found "nothing", expected "values without the disturbance, by their places");
    let mut ends = Vec::new();
    for (key, without) in &spec.without {
        ends.push((key, without, with(key, texts, &place.key(key))?));
    }
    let mut out = Vec::new();
    for size in sizes {
        let mut changes = Changes::default();
        for (key, without, with) in &ends {
            let place = place.key(key);
            let Some(value) = between(without, with, size) else {
                let expected = format!("a value like that of the problem, {}", word(with));
                return Err(place.wrong(word(without), expected));
            };
            changes.push(key, &value, place)?;
        }
        let none = JsonPath::parse("simulate.controller.disturbance").expect("a path");
        let mut part = document.clone();
        Override::new(none, Value::Null).apply(&mut part)?;
        let (system, Task::Simulate(task)) = read(part, &changes)? else {
            unreachable!("an entry \"simulate\" is that task");
        };
        out.push(Disturbed { size, system, task });
    }
    Ok(out)
}

fn sizes(spec: &DisturbanceSpec, scope: &Scope<'_>) -> Result<Vec<f64>> {
    let place = scope.key("sizes");
    let Some(sizes) = &spec.sizes else {
        return Ok(vec![0.0, 0.25, 0.5, 1.0]);
    };
    refuse!(if !(2..=MOST).contains(&sizes.len()), place;
        found sizes.len(), expected format!("2 to {MOST} sizes"));
    for (i, size) in sizes.iter().enumerate() {
        let before = i.checked_sub(1).map_or(f64::NEG_INFINITY, |i| sizes[i]);
        refuse!(if !(size.is_finite() && *size >= 0.0 && *size > before), place.index(i);
            found size,
            expected "sizes from 0 on, the smallest first, of which 1 is that of the problem");
    }
    Ok(sizes.clone())
}

/// The value that a problem has in a place.
fn with(key: &str, texts: [&str; 2], place: &Scope<'_>) -> Result<Value> {
    let wrong = || {
        let expected = "a place in the problem or its scene that has a value, such as scene.materials.silicone.shear_modulus";
        place.wrong(format!("the key {key:?}"), expected)
    };
    let path = JsonPath::parse(key).ok_or_else(wrong)?;
    let [problem, scene] = texts;
    let found = match path.0.as_slice() {
        [Step::Key(first), rest @ ..] if first == "scene" => {
            value_at(scene, &JsonPath(rest.to_vec()))
        }
        _ => value_at(problem, &path),
    };
    found.ok_or_else(wrong)
}

/// A value a part of the way from one to another: numbers, numbers with the same unit, lists of them; a number 0 has any unit.
fn between(from: &Value, to: &Value, part: f64) -> Option<Value> {
    if let (Value::Array(a), Value::Array(b)) = (from, to) {
        let each = a.iter().zip(b).map(|(a, b)| between(a, b, part));
        return (a.len() == b.len())
            .then(|| each.collect::<Option<Vec<Value>>>())?
            .map(Value::Array);
    }
    let (a, of_a) = number_and_unit(from)?;
    let (b, of_b) = number_and_unit(to)?;
    let unit = match (of_a, of_b) {
        (Some(a), Some(b)) if a != b => return None,
        (None, Some(_)) if a != 0.0 => return None,
        (Some(_), None) if b != 0.0 => return None,
        (a, b) => a.or(b),
    };
    let value = a + part * (b - a);
    // The ends as they are written.
    let value = if part == 1.0 { b } else { value };
    match unit {
        Some(unit) => Some(format!("{value} {unit}").into()),
        None => serde_json::Number::from_f64(value).map(Value::Number),
    }
}

/// Reads the problem that the controller of a simulation plans anew, where there is one, by a reader of problem files.
pub(crate) fn add_plan(
    task: &mut Task,
    spec: &ProblemSpec,
    scope: &Scope<'_>,
    read: impl Fn(&Path) -> Result<(System, Task, Option<Regulator>)>,
) -> Result<()> {
    let written = spec.simulate.as_ref().and_then(|simulate| {
        let controller = simulate.controller.as_ref()?;
        Some((simulate, &controller.delay, controller.horizon.as_ref()?))
    });
    let Some((simulate, written_delay, horizon)) = written else {
        return Ok(());
    };
    let place = scope.key("simulate").key("controller").key("horizon");
    let most = Ahead::MOST_INTERVALS;
    let intervals = place.key("intervals");
    intervals.count(horizon.intervals, "interval", most)?;
    let Task::Simulate(Simulation {
        duration,
        step,
        controller: Some(controller),
        ..
    }) = task
    else {
        return Ok(());
    };
    let step = *duration / (*duration / *step - 1e-9).ceil().max(1.0);
    let place = place.key("problem");
    let of = &horizon.problem;
    // A simulation could name itself.
    let without = || place.wrong(format!("{of:?}, which has none"), CONTROL_FILE);
    if Document::read(&controller.path)?.entry("control").is_none() {
        return Err(without());
    }
    let (system, Task::Control(control), regulator) = read(&controller.path)? else {
        return Err(without());
    };
    let Duration::Given(duration) = control.duration else {
        let found = format!("{of:?}, whose duration is free");
        return Err(place.wrong(found, "a given duration"));
    };
    let sample = duration / control.intervals as f64;
    let steps = (sample / step).round();
    let is_multiple = steps >= 1.0 && (sample / step - steps).abs() <= ROUNDING * steps;
    refuse!(if control.is_refined || !is_multiple, place;
        found format!("{of:?} with intervals of {} ms", shortest(sample, 9)),
        expected format!("given intervals that are multiples of the step {} ms", shortest(step, 9)));
    let given = system.sources().into_iter().enumerate();
    let inputs = given.filter(|(source, named)| named.acts() && !control.is_given(*source));
    let input = |(_, named): (usize, Source)| LawInput {
        name: named.name,
        is_squared: false,
        bounds: [f64::NEG_INFINITY, f64::INFINITY],
    };
    controller.law = Arc::new(Law {
        inputs: inputs.map(input).collect(),
        h: sample,
        ..(*controller.law).clone()
    });
    refuse_given(simulate, &controller.law, &scope.key("simulate"))?;
    let regulator = regulator.unwrap_or_default();
    controller.sample = sample;
    if written_delay.is_none() {
        controller.delay = regulator.delayed(sample) as f64 * sample;
    }
    controller.ahead = Some(Box::new(Ahead {
        system,
        control: *control,
        regulator,
        intervals: horizon.intervals,
    }));
    Ok(())
}
