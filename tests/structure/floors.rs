//! Imports go downwards, or stay in their own folder; serde is a matter of files, unsafe code of the bindings of C.

use crate::sources::sources;

/// Floors from the ground up; folders of one line do not know each other.
const FLOORS: [&[&str]; 16] = [
    &["math"],
    &["mesh", "sparse", "kkt", "nlp", "feedback"],
    &["stop"],
    &["energy", "ipopt"],
    &["kinematics", "element"],
    &["functional"],
    &["coordinates"],
    &["model"],
    &["dynamics"],
    &["control"],
    &["identify", "sensitivity"],
    &["workflow", "files"],
    &["tasks"],
    &["report", "interface"],
    &["app"],
    &["study", "sweep"],
];

fn floor(name: &str) -> usize {
    let floor = FLOORS.iter().position(|floor| floor.contains(&name));
    floor.unwrap_or_else(|| panic!("src/{name} stands on no floor"))
}

#[test]
fn imports_go_downwards() {
    let mut seen = 0;
    for source in sources("src") {
        let Some(folder) = source.folder() else {
            continue;
        };
        let (name, here) = (&source.name, floor(folder));
        for line in source.code() {
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

/// The data of the page and of glTF, which are JSON.
const FIGURES: [&str; 7] = [
    "report/gltf/document.rs",
    "report/page/mod.rs",
    "report/page/charts.rs",
    "report/page/compared.rs",
    "report/page/disturbance.rs",
    "report/page/scene.rs",
    "report/page/numbers.rs",
];

#[test]
fn words_stay_in_their_place() {
    let mut seen = [0, 0];
    for source in sources("src") {
        let Some(folder) = source.folder() else {
            continue;
        };
        let name = source.name.as_str();
        for line in source.code() {
            if line.contains("serde") {
                assert!(
                    ["files", "workflow", "tasks", "app", "study", "sweep"].contains(&folder)
                        || FIGURES.contains(&name),
                    "{name}: {line}"
                );
                seen[0] += 1;
            }
            if line
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == "unsafe")
            {
                let bindings = [
                    "ipopt/bindings_3_11.rs",
                    "ipopt/bindings_3_14.rs",
                    "ipopt/ffi.rs",
                    "ipopt/ma57_adapter.rs",
                    "sparse/mumps/ffi.rs",
                    "sparse/mumps/libraries.rs",
                    "sparse/mumps/mpi.rs",
                ];
                assert!(bindings.contains(&name), "{name}: {line}");
                seen[1] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
}
