//! Bytes, changes and overrides of any kind are answered without a panic.

use crate::scene::{PROBLEM, SCENE, folder};
use proboscis::files::read_problem;
use proptest::prelude::*;
use std::fs;

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let (folder, path) = folder(SCENE, PROBLEM);
        fs::write(folder.path().join("scene.json"), &bytes).expect("a written scene");
        let _ = read_problem(&path, &[]);
        fs::write(&path, &bytes).expect("a written problem");
        let _ = read_problem(&path, &[]);
    }

    #[test]
    fn mutated_files_never_panic(position in any::<proptest::sample::Index>(), length in 0..30_usize,
        insert in prop_oneof!["\\PC{0,6}".boxed(), "[\\[\\]{}\",:0-9e.-]{0,6}".boxed(), "null|true|\\{\\}|1e999|-1|\"x\"".boxed()], in_scene in any::<bool>()) {
        let base = if in_scene { SCENE } else { PROBLEM };
        let start = position.index(base.len());
        let end = (start + length).min(base.len());
        let text = format!("{}{insert}{}", &base[..start], &base[end..]);
        let (_folder, path) = if in_scene { folder(&text, PROBLEM) } else { folder(SCENE, &text) };
        if let Err(error) = read_problem(&path, &[]) {
            let length = text.len().max(SCENE.len());
            prop_assert!(error.span().is_none_or(|span| span.start <= span.end && span.end <= length));
            prop_assert!(!error.found().is_empty() && !error.expected().is_empty(), "{error}");
            // The marked excerpt is drawn too.
            let _ = error.excerpt();
        }
    }

    #[test]
    fn arbitrary_overrides_never_panic(text in "(control|scene|x)?[.\\[\\]a-z0-9]{0,12}=?\\PC{0,8}") {
        let (_folder, path) = folder(SCENE, PROBLEM);
        let _ = read_problem(&path, &[text]);
    }
}
