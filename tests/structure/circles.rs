//! No file of a folder imports, by way of others, from itself.
//!
//! An import is a path that begins with `crate::` or `super::`, or in a `mod.rs` with the name of one of its files. It leads to
//! the file that owns what it names: re-exports are seen through, and count for nothing by themselves.

use crate::sources::{Source, sources};
use std::collections::{BTreeMap, BTreeSet};

/// A file or an item in it: `["files", "units", "unit", "Unit"]`.
type Path = Vec<String>;

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '*'
}

/// The paths that begin at a place of the text: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn paths(text: &str) -> Vec<Path> {
    let mut found = Vec::new();
    branch(text, &Path::new(), &mut found);
    found
}

/// Reads one branch of a tree of paths and returns what follows it.
fn branch<'t>(text: &'t str, before: &Path, found: &mut Vec<Path>) -> &'t str {
    let mut text = text.trim_start();
    if let Some(list) = text.strip_prefix('{') {
        text = list.trim_start();
        while text.starts_with(is_word) {
            text = branch(text, before, found).trim_start();
            text = text.strip_prefix(',').unwrap_or(text).trim_start();
        }
        return text.strip_prefix('}').unwrap_or(text);
    }
    let (word, rest) = text.split_at(text.find(|c| !is_word(c)).unwrap_or(text.len()));
    let path = [before.as_slice(), &[word.to_owned()]].concat();
    if let Some(rest) = rest.strip_prefix("::") {
        return branch(rest, &path, found);
    }
    found.push(path);
    match rest.strip_prefix(" as ") {
        Some(name) => name.trim_start_matches(is_word),
        None => rest,
    }
}

/// The path of a file as a module.
fn module(source: &Source) -> Path {
    let name = source.name.trim_end_matches(".rs");
    let name = name.trim_end_matches("/mod");
    name.split('/').map(str::to_owned).collect()
}

/// The code of a file apart from re-exports, and the re-exports, each without its keywords.
fn split(source: &Source) -> (String, Vec<String>) {
    let code: Vec<&str> = source.code().collect();
    let (mut rest, mut exports) = (String::new(), Vec::new());
    for statement in code.join("\n").split_inclusive(';') {
        let export = ["pub use ", "pub(crate) use ", "pub(super) use "]
            .iter()
            .find_map(|words| statement.split_once(words));
        match export {
            Some((before, export)) => {
                rest.push_str(before);
                exports.push(export.to_owned());
            }
            None => rest.push_str(statement),
        }
    }
    (rest, exports)
}

/// The file that owns what a path names.
fn owner(path: &[String], files: &BTreeSet<Path>, exported: &BTreeMap<Path, Path>) -> Option<Path> {
    let length = |holds: &dyn Fn(&[String]) -> bool| {
        (1..=path.len())
            .rev()
            .find(|&end| holds(&path[..end]))
            .unwrap_or(0)
    };
    let file = length(&|start| files.contains(start));
    let export = length(&|start| exported.contains_key(start));
    match (file, export) {
        (0, 0) => None,
        (file, export) if export > file => {
            let target = exported[&path[..export]].as_slice();
            owner(&[target, &path[export..]].concat(), files, exported)
        }
        (file, _) => Some(path[..file].to_vec()),
    }
}

/// The files of the same folder that each file of `src` imports from.
fn imports() -> BTreeMap<Path, BTreeSet<Path>> {
    let sources: Vec<Source> = sources("src")
        .into_iter()
        .filter(|source| source.folder().is_some())
        .collect();
    let files: BTreeSet<Path> = sources.iter().map(module).collect();
    let mut exported = BTreeMap::new();
    for source in &sources {
        let here = module(source);
        for path in split(source).1.iter().flat_map(|export| paths(export)) {
            // A macro of this file.
            if path.len() == 1 {
                continue;
            }
            let name = path[path.len() - 1].clone();
            let target = match path[0].as_str() {
                "crate" => path[1..].to_vec(),
                _ => [here.clone(), path].concat(),
            };
            exported.insert([here.clone(), vec![name]].concat(), target);
        }
    }
    let of = |source: &Source| {
        let here = module(source);
        let (code, _) = split(source);
        let mut found = Vec::new();
        for (at, word) in code.match_indices("crate::") {
            // `pub(in crate::control)` is no import.
            if code[..at].ends_with("(in ") {
                continue;
            }
            found.extend(paths(&code[at + word.len()..]));
        }
        let above = &here[..here.len() - 1];
        for (at, word) in code.match_indices("super::") {
            let below = paths(&code[at + word.len()..]).into_iter();
            found.extend(below.map(|path| [above, &path].concat()));
        }
        if source.name.ends_with("/mod.rs") {
            for file in files
                .iter()
                .filter(|f| f.len() == here.len() + 1 && f.starts_with(&here))
            {
                let name = format!("{}::", file[here.len()]);
                let begins =
                    |(at, _): (usize, &str)| !code[..at].ends_with(|c| is_word(c) || c == ':');
                if code.match_indices(&name).any(begins) {
                    found.push(file.clone());
                }
            }
        }
        let owners = found
            .iter()
            .filter_map(|path| owner(path, &files, &exported));
        let others = owners.filter(|owner| *owner != here && owner[0] == here[0]);
        (here.clone(), others.collect())
    };
    sources.iter().map(of).collect()
}

/// Goes on from the last file of `way`, depth first; where the way comes back to one of its files it is left as that circle.
fn closes(
    imports: &BTreeMap<Path, BTreeSet<Path>>,
    way: &mut Vec<Path>,
    done: &mut BTreeSet<Path>,
) -> bool {
    let here = way[way.len() - 1].clone();
    for next in &imports[&here] {
        if let Some(first) = way.iter().position(|file| file == next) {
            way.drain(..first);
            return true;
        }
        if !done.contains(next) {
            way.push(next.clone());
            if closes(imports, way, done) {
                return true;
            }
            way.pop();
        }
    }
    done.insert(here);
    false
}

#[test]
fn files_of_a_folder_form_no_circle() {
    let imports = imports();
    let count: usize = imports.values().map(BTreeSet::len).sum();
    assert!(count > 400, "{count} imports within folders");
    let (mut circles, mut done) = (BTreeMap::new(), BTreeSet::new());
    for file in imports.keys() {
        let mut way = vec![file.clone()];
        if !done.contains(file) && closes(&imports, &mut way, &mut done) {
            let files: Vec<String> = way.iter().map(|file| file.join("/")).collect();
            circles.insert(file[0].clone(), files.join(" -> "));
        }
    }
    assert!(circles.is_empty(), "circles by folder: {circles:#?}");
}
