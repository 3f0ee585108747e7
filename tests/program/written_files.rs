//! Files are written whole or not at all, and those of one result together.

use std::fs;

use proboscis::report::atomic;
use proboscis::report::file_set::FileSet;

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let entries = || fs::read_dir(folder.path()).unwrap().count();
    let path = folder.path().join("table.csv");
    atomic::write(&path, b"old").unwrap();
    atomic::write(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(entries(), 1);

    // The name is taken by a folder that is not empty: the last step fails.
    let taken = folder.path().join("taken");
    fs::create_dir(&taken).unwrap();
    fs::write(taken.join("old"), "old").unwrap();
    let failure = atomic::write(&taken, b"new").unwrap_err();
    assert_eq!(entries(), 2);
    assert_eq!(fs::read(taken.join("old")).unwrap(), b"old");
    let message = failure.to_string();
    assert!(message.contains("taken") && message.contains(&failure.cause.to_string()));

    let nowhere = folder.path().join("missing").join("table.csv");
    assert!(atomic::write(&nowhere, b"new").is_err());
    assert_eq!(entries(), 2);
}

#[test]
fn a_set_of_files_has_no_summary_before_all_others_have_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let read = |name: &str| fs::read_to_string(at(name)).unwrap();
    let written = |names: [&str; 3]| {
        let mut files = FileSet::in_folder(folder.path());
        for name in names {
            files.add(name, name.as_bytes()).unwrap();
        }
        files.remove("old");
        files
    };
    for name in ["old", "first", "summary.json"] {
        fs::write(at(name), "of an earlier result").unwrap();
    }
    // Nothing changes before all are written.
    drop(written(["first", "second", "summary.json"]));
    assert_eq!(read("summary.json"), "of an earlier result");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    // A folder in the place of a file stops the set after its first file.
    fs::create_dir(at("taken")).unwrap();
    let stopped = written(["first", "taken", "summary.json"]).finish();
    assert_eq!(stopped.unwrap_err().path, at("taken"));
    assert_eq!(read("first"), "first");
    assert!(!at("summary.json").exists() && !at("old").exists());
    written(["first", "second", "summary.json"])
        .finish()
        .unwrap();
    assert_eq!(
        ["first", "second", "summary.json"].map(read),
        ["first", "second", "summary.json"]
    );
}
