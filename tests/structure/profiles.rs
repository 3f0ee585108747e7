//! The Python package is compiled like the program: a workspace of its own does not inherit how.

use std::fs;

/// The profiles of a manifest, from the first one to the lints.
fn profiles(manifest: &str) -> String {
    let path = format!("{}/{manifest}", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).unwrap();
    let (_, profiles) = text.split_once("[profile.dev]").unwrap();
    profiles.split_once("[lints.rust]").unwrap().0.to_owned()
}

#[test]
fn the_python_package_has_the_profiles_of_the_program() {
    let own = profiles("Cargo.toml");
    assert!(own.contains("[profile.release.package]") && own.contains("opt-level = 2"));
    assert_eq!(profiles("python/Cargo.toml"), own);
}
