//! Imports go downwards, or stay in their own folder; serde is a matter of files, unsafe code of the bindings of C.

use std::fs;
use std::path::{Path, PathBuf};

/// From the ground up; folders of one line do not know each other.
const FLOORS: [&[&str]; 12] = [
    &["math", "mesh", "sparse", "nlp"],
    &["energy", "ipopt"],
    &["kinematics", "element"],
    &["functional"],
    &["reduction"],
    &["model"],
    &["dynamics"],
    &["control"],
    &["scene"],
    &["report"],
    &["run"],
    &["study"],
];

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

fn floor(name: &str) -> usize {
    let floor = FLOORS.iter().position(|floor| floor.contains(&name));
    floor.unwrap_or_else(|| panic!("src/{name} stands on no floor"))
}

/// Files in folders of `src`, with the folder, their name, and their lines without comments.
fn files() -> Vec<(String, String, Vec<String>)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    sources(&src, &mut paths);
    let read = |path: PathBuf| {
        let name = path
            .strip_prefix(&src)
            .unwrap()
            .to_str()
            .unwrap()
            .replace('\\', "/");
        let (folder, _) = name.split_once('/')?;
        let text = fs::read_to_string(&path).unwrap();
        let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned();
        Some((
            folder.to_owned(),
            name.clone(),
            text.lines().map(code).collect(),
        ))
    };
    paths.into_iter().filter_map(read).collect()
}

#[test]
fn imports_go_downwards() {
    let mut seen = 0;
    for (folder, name, lines) in files() {
        let here = floor(&folder);
        for line in lines {
            for import in line.split("crate::").skip(1) {
                let target: String = import
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                assert!(!target.is_empty(), "{name} imports by a list: {line}");
                let below = target == folder || floor(&target) < here;
                assert!(below, "{name} imports {target}, which is not below it");
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen} imports");
}

/// The interactive figures of the page, which are JSON.
const FIGURES: [&str; 3] = [
    "report/page.rs",
    "report/animation.rs",
    "report/plotly/mod.rs",
];

#[test]
fn words_stay_in_their_place() {
    let mut seen = [0, 0];
    for (folder, name, lines) in files() {
        for line in lines {
            if line.contains("serde") {
                assert!(
                    ["scene", "run", "study"].contains(&folder.as_str())
                        || FIGURES.contains(&name.as_str()),
                    "{name}: {line}"
                );
                seen[0] += 1;
            }
            if line
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == "unsafe")
            {
                let bindings = ["ipopt/ffi.rs", "sparse/mumps/ffi.rs"];
                assert!(bindings.contains(&name.as_str()), "{name}: {line}");
                seen[1] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
}
