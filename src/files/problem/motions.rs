//! The motions of a control problem: each is the problem that remains with the keys of its entry in the place of those of `control`.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::control::problem::Combined;
use crate::control::{Motion, Motions};
use crate::files::changes::Changes;
use crate::files::json::document::Document;
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::json::tree::Json;
use crate::files::problem::spec_control::COMMON;

/// Keys of a motion that are none of a control problem.
const OWN: [&str; 2] = ["name", "set"];
/// Keys of a control problem with motions that no motion has.
const OF_ALL: [&str; 3] = ["combine", "motions", "shared_inputs"];

/// A motion as a problem of its own.
pub(crate) struct MotionDocument<'a> {
    pub(crate) name: String,
    pub(crate) document: Document,
    /// Constants of its scene, after those of all motions.
    pub(crate) changes: Changes<'a>,
}

/// The motions of a problem, if it has a list of them.
pub(crate) fn motions(document: &Document) -> Result<Option<Vec<MotionDocument<'_>>>> {
    let Some(control) = document.entry("control") else {
        return Ok(None);
    };
    let Some(list) = control.entry("motions") else {
        return Ok(None);
    };
    let scope = Scope::of(document).key("control");
    refuse!(if control.entry("sensitivity").is_some(), scope.key("sensitivity");
        found "sensitivities of several motions", expected "a problem of one motion");
    let scope = scope.key("motions");
    refuse!(if list.first() != Some('['), scope; found list, expected "a list of motions");
    refuse!(if list.parts().len() == 0, scope;
        found "no motion", expected "a list of one motion or more");
    let mut names = BTreeSet::new();
    let each = list.parts().enumerate().map(|(number, written)| {
        let motion = one(written, number, control, &scope.index(number))?;
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
    scope: &Scope<'a>,
) -> Result<MotionDocument<'a>> {
    refuse!(if motion.first() != Some('{'), scope;
        found motion, expected "a motion: an object with the keys that are other ones in it");
    let is_of =
        |list: &[&str], entry: &Json<'_>| entry.key().is_some_and(|key| list.contains(&&*key));
    let mut common = motion.parts().filter(|entry| is_of(&COMMON, entry));
    refuse!(if let Some(key) = common.find_map(Json::key), scope.key(&key);
        found format!("the key {key:?} in a motion"),
        expected "it beside \"motions\": all of them have it in common");
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
    let value = |key: &str| motion.entry(key)?.read().ok();
    Ok(MotionDocument {
        name: name(value("name"), number, &scope.key("name"))?,
        changes: changes(value("set"), &scope.key("set"))?,
        document,
    })
}

/// The name of a motion, which is that of a folder.
fn name(written: Option<Value>, number: usize, scope: &Scope<'_>) -> Result<String> {
    let name = match written {
        None | Some(Value::Null) => return Ok(format!("motion{}", number + 1)),
        Some(Value::String(name)) => name,
        Some(other) => return Err(scope.wrong(other.to_string(), "a name")),
    };
    let fits = |c: char| c.is_alphanumeric() || "_-".contains(c);
    refuse!(if name.is_empty() || !name.chars().all(fits), scope;
        found format!("{name:?}"),
        expected "a name of letters, digits, _ and -, which is that of its folder");
    Ok(name)
}

/// The constants of the scene that are other ones in a motion.
fn changes<'a>(written: Option<Value>, scope: &Scope<'a>) -> Result<Changes<'a>> {
    let mut changes = Changes::default();
    let entries = match written {
        None | Some(Value::Null) => return Ok(changes),
        Some(Value::Object(entries)) => entries,
        Some(other) => {
            return Err(scope.wrong(
                other.to_string(),
                "an object of values by their places in the scene",
            ));
        }
    };
    for (key, value) in &entries {
        let place = scope.key(key);
        refuse!(if !key.starts_with("scene."), place;
            found format!("the key {key:?}"),
            expected "a place in the scene, such as scene.gravity; keys of \"control\" stand in the motion itself");
        changes.push(key, value, place)?;
    }
    Ok(changes)
}

/// The objective of all motions, the sum where none is written.
fn combined(written: Option<&str>, scope: &Scope<'_>) -> Result<Combined> {
    match written {
        None | Some("\"sum\"" | "null") => Ok(Combined::Sum),
        Some("\"worst\"") => Ok(Combined::Worst),
        Some(other) => Err(scope.wrong(other, "\"sum\" or \"worst\"")),
    }
}

/// The motions, if what they are to share can be shared.
pub(crate) fn together(list: Vec<Motion>, document: &Document) -> Result<Motions> {
    let of_all = Scope::of(document).key("control");
    let scope = of_all.key("shared_inputs");
    let key = |key: &str| document.entry("control")?.entry(key);
    let shared_inputs: Vec<String> = match key("shared_inputs") {
        None => Vec::new(),
        Some(written) => written.read().map_err(|_| {
            scope.wrong(
                written.to_string(),
                "a list of names of muscles, driven electrodes and loads",
            )
        })?,
    };
    let motions = Motions {
        list,
        shared_inputs,
        combined: combined(key("combine").map(Json::written), &of_all.key("combine"))?,
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
