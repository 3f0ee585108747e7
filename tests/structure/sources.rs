//! Sources as text: the parts of them that this group of tests reads.

use std::fs;
use std::path::Path;

/// A file of Rust.
pub(crate) struct Source {
    /// Its path below the folder that was asked for, such as `energy/muscle.rs`.
    pub(crate) name: String,
    /// Its text.
    pub(crate) text: String,
}

/// All files of Rust below a folder of the repository.
pub(crate) fn sources(folder: &str) -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut found = Vec::new();
    collect(&root, "", &mut found);
    found
}

fn collect(folder: &Path, before: &str, out: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{before}{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            collect(&path, &format!("{name}/"), out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            out.push(Source { name, text });
        }
    }
}

impl Source {
    /// The folder of `src` that it is in; none of those above all folders.
    pub(crate) fn folder(&self) -> Option<&str> {
        self.name.split_once('/').map(|(folder, _)| folder)
    }

    /// Its lines without comments.
    pub(crate) fn code(&self) -> impl Iterator<Item = &str> {
        let code = |line| str::split(line, "//").next().unwrap_or_default();
        self.text.lines().map(code)
    }
}
