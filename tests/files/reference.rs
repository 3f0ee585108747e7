//! `docs/reference.md`: all keys of all files, made from the schemas, with units, defaults and examples.

use crate::schema_walk::{Examples, base, resolved};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs;

/// The files with their schemas and headings.
pub(crate) fn schemas() -> [(&'static str, &'static str, Value); 4] {
    let (scene, problem) = proboscis::files::schema();
    [
        ("SceneSpec", "Scene file", scene),
        ("ProblemSpec", "Problem file", problem),
        ("StudySpec", "Study file", proboscis::files::study_schema()),
        ("SweepSpec", "Sweep file", proboscis::files::sweep_schema()),
    ]
}

const HEAD: &str = "# Reference of all keys

Made from the JSON Schemas by `PROBOSCIS_WRITE_REFERENCE=1 cargo test --test files reference`; a test keeps it equal to them. [`scenes.md`](scenes.md) and
[`problems.md`](problems.md) say what the keys are for. A quantity is a number in the unit of its row, or a text with a unit of its own, such as `\"50 mm\"`. What
has no default and is not required does not exist where it is not written.
";

/// Set `PROBOSCIS_WRITE_REFERENCE` to write the kept file anew.
#[test]
fn the_reference_is_that_of_the_schemas() {
    let examples = Examples::kept();
    let mut text = HEAD.to_owned();
    let mut written = Vec::new();
    for (name, heading, schema) in schemas() {
        let mut left = vec![(name.to_owned(), schema.clone(), heading.to_owned())];
        while let Some((name, node, heading)) = left.pop() {
            if written.contains(&name) {
                continue;
            }
            let level = if name == left_root(&schema) {
                "##"
            } else {
                "###"
            };
            section(
                &mut text,
                (level, &heading),
                &name,
                &node,
                &schema,
                &examples,
            );
            written.push(name);
            let mut below = Vec::new();
            objects_below(&schema, &node, &mut below);
            below.reverse();
            left.extend(below.into_iter().map(|(name, node)| {
                let heading = title(&name);
                (name, node, heading)
            }));
        }
    }
    let path = "docs/reference.md";
    if std::env::var_os("PROBOSCIS_WRITE_REFERENCE").is_some() {
        fs::write(path, &text).expect("a written reference");
    }
    let kept = fs::read_to_string(path).unwrap_or_default();
    assert!(kept == text, "{path} is out of date");
}

fn left_root(schema: &Value) -> String {
    schema["title"].as_str().unwrap_or_default().to_owned()
}

/// A heading of an object from the name of its type: `MuscleSpec` is a muscle.
fn title(name: &str) -> String {
    let name = name.strip_suffix("Spec").unwrap_or(name);
    let mut words = String::new();
    for c in name.chars() {
        match c.is_uppercase() && !words.is_empty() {
            true => words.extend([' ', c.to_ascii_lowercase()]),
            false => words.push(c),
        }
    }
    words
}

/// Objects that values below a node are, each with its properties, in their order.
fn objects_below(root: &Value, node: &Value, found: &mut Vec<(String, Value)>) {
    match node {
        Value::Object(entries) => {
            if let Some(name) = entries.get("$ref").and_then(Value::as_str) {
                let name = name.rsplit('/').next().unwrap_or_default();
                let target = &root["$defs"][name];
                let name = base(name);
                if found.iter().any(|(other, _)| *other == name) {
                    return;
                }
                let properties = properties(target);
                match properties.is_empty() {
                    true => objects_below(root, target, found),
                    false => {
                        found.push((name, target.clone()));
                        // A word beside an object, such as that of a guess.
                        let others: Vec<&Value> =
                            ["anyOf", "oneOf"].iter().map(|key| &target[*key]).collect();
                        others
                            .into_iter()
                            .for_each(|other| objects_below(root, other, found));
                    }
                }
            }
            let inner = entries.iter().filter(|(key, _)| *key != "$defs");
            inner.for_each(|(_, value)| objects_below(root, value, found));
        }
        Value::Array(list) => list
            .iter()
            .for_each(|value| objects_below(root, value, found)),
        _ => {}
    }
}

/// Properties of an object, and of the objects that it may be; with whether they are required.
fn properties(node: &Value) -> BTreeMap<String, (Value, bool)> {
    let mut all = BTreeMap::new();
    let variants = node["oneOf"].as_array().into_iter().flatten();
    for one in [node].into_iter().chain(variants) {
        let required = [&one["required"], &one["then"]["required"]];
        let required = required.into_iter().find_map(Value::as_array);
        let empty = Map::new();
        for (key, value) in one["properties"].as_object().unwrap_or(&empty) {
            let is_required = required.is_some_and(|list| list.iter().any(|name| name == key));
            let mut value = value.clone();
            if value["description"].is_null() {
                value["description"] = one["description"].clone();
            }
            all.insert(key.clone(), (value, is_required && one["oneOf"].is_null()));
        }
    }
    all
}

fn section(
    text: &mut String,
    (level, heading): (&str, &str),
    name: &str,
    node: &Value,
    root: &Value,
    examples: &Examples,
) {
    let about = line(node["description"].as_str().unwrap_or_default());
    text.push_str(&format!("\n{level} {heading}\n\n{about}\n\n"));
    text.push_str("| key | meaning | unit | default | example |\n|:--|:--|:--|:--|:--|\n");
    for (key, (value, is_required)) in properties(node) {
        let said = line(value["description"].as_str().unwrap_or_default());
        let example = examples.of(name, &key);
        let example = example.unwrap_or_else(|| panic!("no example of {key:?} of {name}"));
        let default = match is_required {
            true => "required".to_owned(),
            false => default(&value, &said),
        };
        let row = [
            format!("`{key}`"),
            format!("{said}{}", kinds(root, &value)),
            unit(root, &value, &said),
            default,
            format!("`{example}`"),
        ];
        let row = row.map(|cell| cell.replace('|', "\\|"));
        text.push_str(&format!("| {} |\n", row.join(" | ")));
    }
}

fn line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The unit of a number without one.
fn unit(root: &Value, value: &Value, said: &str) -> String {
    if let Some((_, unit)) = said.split_once("SI unit ") {
        let end = unit.find([';', ',', ':', '.']).unwrap_or(unit.len());
        return unit[..end].to_owned();
    }
    let (_, name) = resolved(root, value);
    let unit = match name.as_str() {
        "Voltage" => "V",
        "Length" => "m",
        "Time" => "s",
        "Angle" => "rad",
        "JointCoordinate" => "rad or m",
        "SoughtConstant" => "of the constant",
        _ => "",
    };
    unit.to_owned()
}

/// Default of a key that is not written.
fn default(value: &Value, said: &str) -> String {
    let written = &value["default"];
    let is_empty = written.as_object().is_some_and(Map::is_empty)
        || written.as_array().is_some_and(Vec::is_empty);
    if !written.is_null() && !is_empty {
        return format!("`{written}`");
    }
    if value["type"] == "boolean" {
        return "`false`".to_owned();
    }
    let Some(at) = said
        .find("where not written")
        .or_else(|| said.find("where not named"))
    else {
        return String::new();
    };
    let before = said[..at].trim_end_matches([' ', '(', ',']);
    // A point within a number ends no sentence.
    let is_end = |(at, sign): &(usize, char)| {
        let next = before[at + 1..].chars().next();
        matches!(sign, ';' | '.' | ':') && next.is_none_or(char::is_whitespace)
    };
    let start = before.char_indices().rev().find(is_end);
    let start = start.map_or(0, |(at, _)| at + 1);
    let clause = before[start..].trim();
    let clause = clause.rsplit_once(", ").map_or(clause, |(_, last)| last);
    match clause.is_empty() {
        true => "see its meaning".to_owned(),
        false => clause.to_owned(),
    }
}

/// Words that a value may be, and the section of the object that it may be.
fn kinds(root: &Value, value: &Value) -> String {
    let mut words = Vec::new();
    let mut sections = Vec::new();
    kinds_below(root, value, (&mut words, &mut sections), 0);
    let mut text = String::new();
    if !words.is_empty() {
        text.push_str(&format!(" Words: {}.", words.join(", ")));
    }
    if !sections.is_empty() {
        text.push_str(&format!(" → {}", sections.join(", ")));
    }
    text
}

fn kinds_below(
    root: &Value,
    value: &Value,
    (words, sections): (&mut Vec<String>, &mut Vec<String>),
    depth: usize,
) {
    let (node, name) = resolved(root, value);
    if let (Some(word), true) = (node["const"].as_str(), depth > 0) {
        let said = line(node["description"].as_str().unwrap_or_default());
        let said = said.trim_end_matches('.');
        words.push(format!("`\"{word}\"` ({said})"));
        return;
    }
    if !properties(node).is_empty() && !name.is_empty() {
        let title = title(&base(&name));
        let link = format!("[{title}](#{})", title.to_lowercase().replace(' ', "-"));
        let link = match name.as_str() {
            "SceneSpec" => "[Scene file](#scene-file)".to_owned(),
            _ => link,
        };
        if !sections.contains(&link) {
            sections.push(link);
        }
        if node["anyOf"].is_null() && node["oneOf"].is_null() {
            return;
        }
    }
    for key in ["anyOf", "oneOf"] {
        for one in node[key].as_array().into_iter().flatten() {
            kinds_below(root, one, (&mut *words, &mut *sections), depth + 1);
        }
    }
    for key in ["items", "additionalProperties"] {
        if node[key].is_object() {
            kinds_below(root, &node[key], (&mut *words, &mut *sections), depth + 1);
        }
    }
}
