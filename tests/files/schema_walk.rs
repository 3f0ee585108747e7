//! Files walked beside their schemas: an example of each key, and the keys that there are.

use crate::reference::schemas;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

/// The definition that a node refers to, with its name; the node itself without one.
pub(crate) fn resolved<'a>(root: &'a Value, node: &'a Value) -> (&'a Value, String) {
    match node["$ref"].as_str() {
        Some(path) => {
            let name = path.rsplit('/').next().unwrap_or_default();
            (&root["$defs"][name], name.to_owned())
        }
        None => (node, String::new()),
    }
}

/// The name of a type without the number that tells its quantity: `RampSpec2` is a ramp.
pub(crate) fn base(name: &str) -> String {
    name.trim_end_matches(|c: char| c.is_ascii_digit())
        .to_owned()
}

/// Examples by type and key.
pub(crate) struct Examples(BTreeMap<(String, String), String>);

impl Examples {
    /// Of the kept files the shortest ones, and those of the list for other keys.
    pub(crate) fn kept() -> Self {
        let mut all = Self(BTreeMap::new());
        let folders = [
            "problems/scenes",
            "problems",
            "problems/studies",
            "problems/sweeps",
        ];
        for ((name, _, schema), folder) in schemas().iter().zip(folders) {
            let entries = fs::read_dir(folder).expect("kept files");
            let mut paths: Vec<_> = entries
                .map(|entry| entry.expect("an entry").path())
                .collect();
            paths.sort();
            for path in paths {
                let text = path.to_string_lossy().into_owned();
                if text.ends_with(".json") && !text.ends_with(".schema.json") {
                    let value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
                    all.visit(schema, schema, &value, name);
                }
            }
        }
        let list = fs::read_to_string("tests/files/reference_examples.json").unwrap();
        let list: Value = serde_json::from_str(&list).unwrap();
        for (name, keys) in list.as_object().unwrap() {
            for (key, value) in keys.as_object().unwrap() {
                let place = (name.clone(), key.clone());
                all.0.entry(place).or_insert_with(|| value.to_string());
                assert!(is_known(name, key, value), "{name}: {key}: {value}");
            }
        }
        all
    }

    /// The example of a key.
    pub(crate) fn of(&self, name: &str, key: &str) -> Option<&String> {
        self.0.get(&(name.to_owned(), key.to_owned()))
    }

    fn visit(&mut self, root: &Value, node: &Value, value: &Value, name: &str) {
        let (node, other) = resolved(root, node);
        let name = if other.is_empty() {
            name.to_owned()
        } else {
            base(&other)
        };
        let branches = ["anyOf", "oneOf"]
            .into_iter()
            .flat_map(|key| node[key].as_array());
        for branch in branches.flatten() {
            if fits(root, branch, value) {
                return self.visit(root, branch, value, &name);
            }
        }
        match value {
            Value::Object(entries) => {
                for (key, value) in entries {
                    let inside = &node["properties"][key];
                    match inside.is_null() {
                        true => self.visit(root, &node["additionalProperties"], value, &name),
                        false => {
                            self.keep(&name, key, first(value));
                            self.visit(root, inside, value, &name);
                        }
                    }
                }
            }
            Value::Array(list) => {
                let items = &node["items"];
                list.iter()
                    .for_each(|value| self.visit(root, items, value, &name));
            }
            _ => {}
        }
    }

    /// Keeps the shorter one.
    fn keep(&mut self, name: &str, key: &str, text: String) {
        let kept = self
            .0
            .entry((name.to_owned(), key.to_owned()))
            .or_insert_with(|| text.clone());
        if text.len() < kept.len() {
            *kept = text;
        }
    }
}

/// The text of a value; of a list of objects only the first one.
fn first(value: &Value) -> String {
    match value.as_array().map(Vec::as_slice) {
        Some([one @ Value::Object(_), ..]) => format!("[{one}]"),
        _ => value.to_string(),
    }
}

/// Returns true if a type of a schema has a key that takes a value.
fn is_known(name: &str, key: &str, value: &Value) -> bool {
    schemas().iter().any(|(root_name, _, root)| {
        let defs = root["$defs"].as_object().unwrap();
        let named = defs
            .iter()
            .filter(|(other, _)| base(other) == name)
            .map(|(_, node)| node);
        let own = (*root_name == name).then_some(root);
        named.chain(own).any(|node| {
            let variants = node["oneOf"].as_array().into_iter().flatten();
            let mut all = [node]
                .into_iter()
                .chain(variants)
                .map(|node| &node["properties"][key]);
            all.any(|node| !node.is_null() && fits(root, node, value))
        })
    })
}

/// Returns true if a value is of the kind of a node.
fn fits(root: &Value, node: &Value, value: &Value) -> bool {
    let (node, _) = resolved(root, node);
    for key in ["anyOf", "oneOf"] {
        if let Some(branches) = node[key].as_array() {
            return branches.iter().any(|branch| fits(root, branch, value));
        }
    }
    if !node["const"].is_null() {
        return node["const"] == *value;
    }
    let kinds = match &node["type"] {
        Value::String(kind) => vec![kind.as_str()],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => return true,
    };
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let is_kind = kinds.contains(&kind) || (kind == "number" && kinds.contains(&"integer"));
    let (Value::Object(entries), Some(known)) = (value, node["properties"].as_object()) else {
        let list = value.as_array().filter(|_| node["items"].is_object());
        return is_kind
            && list.is_none_or(|list| list.iter().all(|v| fits(root, &node["items"], v)));
    };
    let required = node["required"].as_array().into_iter().flatten();
    let mut required = required.filter_map(Value::as_str);
    let fit = |(key, value): (&String, &Value)| {
        known.get(key).is_some_and(|node| fits(root, node, value))
    };
    is_kind && required.all(|key| entries.contains_key(key)) && entries.iter().all(fit)
}

/// All keys of objects in a schema.
fn keys(node: &Value, found: &mut BTreeSet<String>) {
    match node {
        Value::Object(entries) => {
            if let Some(properties) = entries.get("properties").and_then(Value::as_object) {
                found.extend(properties.keys().cloned());
            }
            entries.values().for_each(|value| keys(value, found));
        }
        Value::Array(list) => list.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

/// Returns true if a text has a key, in backticks or quotes, alone or as a part of a path.
fn names(text: &str, key: &str) -> bool {
    let ends = |before: &str, after: &str| {
        let opens = before.ends_with(['`', '"', '.']);
        opens && after.starts_with(['`', '"', '.', '['])
    };
    let mut found = text.match_indices(key);
    found.any(|(at, _)| ends(&text[..at], &text[at + key.len()..]))
}

#[test]
fn every_key_is_told_in_its_document() {
    let read = |name: &str| fs::read_to_string(format!("docs/{name}.md")).unwrap();
    let scenes = read("scenes");
    for (name, _, schema) in schemas() {
        let documents = match name {
            // Functions of time are those of problems.
            "SceneSpec" | "ProblemSpec" => read("problems") + &scenes,
            "StudySpec" => read("accuracy"),
            _ => read("sweeps"),
        };
        let mut all = BTreeSet::new();
        keys(&schema, &mut all);
        assert!(all.len() > 9, "{name}");
        let missing: Vec<_> = all.iter().filter(|key| !names(&documents, key)).collect();
        assert!(missing.is_empty(), "{name}: {missing:?}");
    }
}

/// The JSON text of the blocks of a document.
fn blocks(text: &str) -> Vec<Value> {
    let parts = text.split("```json\n").skip(1);
    let texts = parts.filter_map(|part| part.split_once("\n```"));
    texts
        .filter_map(|(json, _)| serde_json::from_str(json).ok())
        .collect()
}

#[test]
fn json_of_the_documents_is_that_of_the_files_they_point_to() {
    let kept = fs::read_to_string("problems/elephant_trunk.json").unwrap();
    let mut kept: Value = serde_json::from_str(&kept).unwrap();
    kept.as_object_mut().unwrap().remove("$schema");
    let mut scenes = Vec::new();
    for path in ["README.md", "docs/scenes.md", "docs/problems.md"] {
        let all = blocks(&fs::read_to_string(path).unwrap());
        assert!(!all.is_empty(), "{path}");
        for block in &all {
            if block.get("control").is_some() {
                assert_eq!(*block, kept, "{path}");
            }
            if block.get("bodies").is_some() {
                scenes.push(block.clone());
            }
        }
    }
    // The scene of the first pages is one, and is right.
    assert!(scenes.len() == 2 && scenes[0] == scenes[1]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    fs::write(&path, scenes[0].to_string()).unwrap();
    let system = proboscis::files::read_scene(&path).unwrap();
    assert_eq!((system.bodies.len(), system.muscles.len()), (1, 1));
}
