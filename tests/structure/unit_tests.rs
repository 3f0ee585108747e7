//! Tests of what files of `src` do not show stand in `tests/units`, and run there, as the library is built without them.

use crate::sources::sources;

#[test]
fn files_with_tests_are_compiled_with_them() {
    let all = sources("tests");
    let units = all
        .iter()
        .filter(|source| source.name.starts_with("units/"));
    let compiled: String = units.map(|source| source.text.as_str()).collect();
    let mut seen = 0;
    for source in sources("src") {
        if !source.code().any(|line| line == "#[cfg(test)]") {
            continue;
        }
        let folder = source.folder().unwrap_or_default();
        let is_compiled = [&source.name, &format!("{folder}/mod.rs")]
            .iter()
            .any(|name| compiled.contains(&format!("src/{name}\"")));
        assert!(is_compiled, "tests of {} run nowhere", source.name);
        seen += 1;
    }
    assert!(seen > 8, "{seen} files with tests");
}
