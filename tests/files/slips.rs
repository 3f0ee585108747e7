//! Slips of a first file: words for what is not offered, methods of other programs, units that no robot has.

use crate::scene::{PROBLEM, SCENE, mistake};

/// A mistake has these words, and no others.
fn assert_words(scene: &str, problem: &str, words: &[&str], silent: &[&str]) {
    let error = mistake(scene, problem, &[]);
    let text = error.to_string();
    words
        .iter()
        .for_each(|word| assert!(text.contains(word), "{word}: {text}"));
    silent
        .iter()
        .for_each(|word| assert!(!text.contains(word), "{word}: {text}"));
}

const LIMITS: &str = "docs/accuracy.md#limits-of-validity";

#[test]
fn what_is_not_offered_is_answered_so() {
    for (word, said) in [
        ("contact", "there is no contact"),
        ("contacts", "there is no contact"),
        ("Friction", "there is no friction"),
        ("motors", "is an entry of"),
        ("temperature", "there is no temperature"),
        ("obstacles", "kept out of a region by \"limits\""),
    ] {
        let scene = SCENE.replacen('{', &format!("{{ \"{word}\": [], "), 1);
        let words = [
            word,
            "which is not offered",
            said,
            LIMITS,
            "expected one of \"$schema\"",
        ];
        assert_words(&scene, PROBLEM, &words[..4], &["did you mean"]);
        assert!(
            mistake(&scene, PROBLEM, &[])
                .to_string()
                .contains("expected one of")
        );
    }
    let scene = SCENE.replacen("\"revolute\"", "\"helical\"", 1);
    assert_words(
        &scene,
        PROBLEM,
        &[
            "\"helical\"",
            "not offered",
            "\"universal\" (a Cardan or Hooke joint)",
        ],
        &["did you mean"],
    );
    // A slip of the pen is none of these.
    let scene = SCENE.replacen("\"joints\"", "\"joint\"", 1);
    assert_words(
        &scene,
        PROBLEM,
        &["did you mean \"joints\""],
        &["not offered"],
    );
}

fn simulate(integrator: &str) -> String {
    format!(
        r#"{{ "scene": "scene.json", "simulate": {{ "duration": "1 s", "step": "10 ms", "integrator": {integrator} }} }}"#
    )
}

#[test]
fn methods_of_other_programs_are_answered_with_those_here() {
    for (word, said) in [
        ("rk4", "of order 4 is { \"galerkin\": 2 }"),
        ("verlet", "\"midpoint\""),
        ("newmark", "\"generalised_alpha\""),
    ] {
        let words = [word, "not offered", said, "an object with \"galerkin\""];
        assert_words(
            SCENE,
            &simulate(&format!("\"{word}\"")),
            &words,
            &["did you mean"],
        );
    }
    let words = [
        "\"midpont\"",
        "did you mean \"midpoint\"",
        "an object with \"galerkin\"",
    ];
    assert_words(SCENE, &simulate("\"midpont\""), &words, &["not offered"]);
    let words = ["\"elsewhere\"", "expected \"midpoint\""];
    assert_words(
        SCENE,
        &simulate("\"elsewhere\""),
        &words,
        &["not offered", "\u{1f}"],
    );
}

#[test]
fn slips_of_units_are_refused() {
    let layer = SCENE.replacen("\"50 um\"", "50", 1);
    assert_words(
        &layer,
        PROBLEM,
        &[
            "muscles[0].layer_thickness",
            "found 50",
            "no thicker than the muscle is long",
            "mm",
        ],
        &[],
    );
    let wide = SCENE.replacen("[\"10 mm\", \"10 mm\"]", "[10, \"10 mm\"]", 1);
    assert_words(
        &wide,
        PROBLEM,
        &[
            "muscles[0].cross_section[0]",
            "found 10, 250 lengths",
            "100 lengths of the muscle",
        ],
        &[],
    );
    let dense = SCENE.replacen("\"1000 kg/m^3\"", "\"1000 g/cm^3\"", 1);
    assert_words(
        &dense,
        PROBLEM,
        &["density", "1000 g/cm^3", "below 1e5 kg/m^3"],
        &[],
    );
}
