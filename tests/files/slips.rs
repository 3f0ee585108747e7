//! Slips of a first file: words for what is not offered, methods of other programs, units that no robot has.

use crate::reference::schemas;
use crate::scene::{PROBLEM, SCENE, mistake};
use serde_json::Value;
use std::collections::BTreeSet;

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
        ("collision", "\"contacts\" are pairs that a scene names"),
        ("collisions", "\"contacts\" are pairs that a scene names"),
        ("Stiction", "which creeps where it sticks"),
        ("temperature", "there is no temperature"),
        ("obstacles", "keep markers out of regions"),
        ("drag", "there is no fluid"),
        ("shells", "elements are hexahedra"),
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
    // A slip of the pen is none of these.
    let scene = SCENE.replacen("\"joints\"", "\"joint\"", 1);
    assert_words(
        &scene,
        PROBLEM,
        &["did you mean \"joints\""],
        &["not offered"],
    );
}

/// Keys and words of all schemas, and words for what these offer.
fn known_words() -> BTreeSet<String> {
    fn walk(node: &Value, into: &mut BTreeSet<String>) {
        match node {
            Value::Object(entries) => {
                let properties = entries.get("properties").and_then(Value::as_object);
                into.extend(properties.into_iter().flat_map(|list| list.keys().cloned()));
                for key in ["enum", "const"] {
                    let words = entries.get(key).into_iter();
                    let words = words.flat_map(|one| {
                        one.as_array().map_or(vec![one], |all| all.iter().collect())
                    });
                    into.extend(words.filter_map(|word| Some(word.as_str()?.to_owned())));
                }
                entries.values().for_each(|value| walk(value, into));
            }
            Value::Array(list) => list.iter().for_each(|value| walk(value, into)),
            _ => {}
        }
    }
    let mut words = BTreeSet::new();
    schemas()
        .iter()
        .for_each(|(_, _, schema)| walk(schema, &mut words));
    let others = "stl urdf motor torque servo force pressure circuit resistor current leakage maxwell creep gent feedback controller observer noise hinge ball slider weld rk4 euler newmark tendon cable voltage charge";
    words.extend(others.split(' ').map(str::to_owned));
    words
}

#[test]
fn what_is_offered_is_never_called_absent() {
    let words = known_words();
    assert!(
        words.len() > 200 && words.contains("resistance"),
        "{words:?}"
    );
    for word in words {
        let scene = SCENE.replacen('{', &format!("{{ \"{word}\": [[[]]], "), 1);
        let error = mistake(&scene, PROBLEM, &[]).to_string();
        assert!(!error.contains("not offered"), "{word}: {error}");
    }
}

fn simulate(integrator: &str) -> String {
    format!(
        r#"{{ "scene": "scene.json", "simulate": {{ "duration": "1 s", "step": "10 ms", "integrator": {integrator} }} }}"#
    )
}

#[test]
fn methods_of_other_programs_are_answered_with_those_here() {
    for word in ["rk4", "verlet", "newmark"] {
        let words = [word, "\"generalised_alpha\"", "an object with \"galerkin\""];
        let problem = simulate(&format!("\"{word}\""));
        assert_words(SCENE, &problem, &words, &["not offered"]);
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
