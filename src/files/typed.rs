//! Arguments of the command line other than overrides: the scene of any file, and voltages by source.

use crate::files::Loaded;
use crate::files::json::document::Document;
use crate::files::json::error::{Mistake, Result, SceneError, nearest};
use crate::files::json::path::Step;
use crate::files::json::scope::Scope;
use crate::files::json::set::{Override, resolved};
use crate::files::problem::at::A_SOURCE;
use crate::files::scene::build::build_scene;
use crate::files::units::quantity::{Quantity, Voltage};
use crate::model::system::{Source, System};
use serde_json::Value;
use std::path::Path;

/// Refuses overrides of which two are of one place; where a list is made, the later one counts.
///
/// # Errors
/// There are two, or one is no override.
pub fn each_once(overrides: &[String]) -> Result<()> {
    Override::check(overrides, |change| change.place.clone())
}

/// Refuses overrides of which two are of one place of the problem that was read with them: an entry of a list has an index and a name.
///
/// # Errors
/// There are two.
pub fn each_entry_once(overrides: &[String], loaded: &Loaded) -> Result<()> {
    Override::check(overrides, |change| match change.in_scene() {
        Some(inside) => {
            let mut place = resolved(&loaded.scene, &inside.place);
            place.0.insert(0, Step::Key("scene".to_owned()));
            place
        }
        None => resolved(&loaded.problem, &change.place),
    })
}

/// The system of a scene file, or of the scene of a problem file, with overrides as for the file itself.
///
/// # Errors
/// The file, its scene or an override is wrong.
pub fn read_system(path: &Path, overrides: &[String]) -> Result<System> {
    let mut document = Document::read_typed(path)?;
    if document.entry("scene").is_some() {
        return Ok(crate::files::read_problem(path, overrides)?.system);
    }
    for change in Override::parse_each(overrides)? {
        change.in_scene().unwrap_or(change).apply(&mut document)?;
    }
    build_scene(&document.parse()?, &Scope::of(&document))
}

/// One voltage per source in V from words such as `muscle2=1.7kV`, 0 where not named.
///
/// # Errors
/// A source does not exist or takes no voltage, or a voltage is none.
pub fn driven_voltages(words: &[String], system: &System) -> Result<Vec<f64>> {
    let sources = system.sources();
    let mut voltages = vec![None; sources.len()];
    let mistake = |word: &str, expected: String, nearest: Option<String>| -> SceneError {
        Mistake {
            path: "--voltages".to_owned(),
            nearest,
            ..Mistake::of_file("command line", format!("{word:?}"), expected)
        }
        .into()
    };
    for word in words.iter().filter(|word| !word.trim().is_empty()) {
        let expected = || "muscle=voltage, such as muscle2=1.7kV".to_owned();
        let (name, value) = word
            .split_once('=')
            .ok_or_else(|| mistake(word, expected(), None))?;
        let name = name.trim();
        let named = |source: &Source| source.name == name && source.takes_voltage;
        let source = sources.iter().position(named).ok_or_else(|| {
            let nearest = nearest(name, sources.iter().map(|source| source.name.as_str()));
            let expected = format!("{A_SOURCE} that takes a voltage");
            mistake(name, expected, nearest.filter(|other| other != name))
        })?;
        let value = value.trim();
        let json = serde_json::from_str(value).unwrap_or_else(|_| Value::from(value));
        let quantity: Quantity<Voltage> = serde_json::from_value(json)
            .map_err(|_| mistake(word, Quantity::<Voltage>::expected(), None))?;
        if voltages[source].replace(quantity.value()).is_some() {
            let expected = format!("one voltage of {name:?}");
            return Err(mistake(word, expected, None));
        }
    }
    Ok(voltages
        .into_iter()
        .map(Option::unwrap_or_default)
        .collect())
}
