//! Materials with published constants: texts, names, and the law of a source.

use crate::scene::{folder, mistake};
use proboscis::ElasticLaw;
use proboscis::files::{expand, named_materials, read_scene};
use proboscis::model::System;
use std::fs;

/// A scene of one muscle of this material, with these materials of its own.
fn scene(material: &str, own: &str) -> String {
    format!(
        r#"{{ "name": "stack", "materials": {own},
  "bodies": [ {{ "name": "plate", "mass": "20 g", "sphere": {{ "radius": "5 mm" }}, "position": [0, 0, "40 mm"] }} ],
  "joints": [ {{ "name": "guide", "prismatic": {{ "axis": [0, 0, 1] }}, "parent": "ground", "child": "plate", "at": [0, 0, "40 mm"] }} ],
  "muscles": [ {{ "name": "muscle", "material": "{material}", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
    "from": {{ "body": "ground", "at": [0, 0, 0] }}, "to": {{ "body": "plate", "at": [0, 0, "40 mm"] }} }} ] }}"#
    )
}

fn read(text: &str) -> System {
    let (folder, _) = folder(text, "{}");
    let read = read_scene(&folder.path().join("scene.json"));
    read.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn each_material_has_a_source_and_is_used_by_its_name() {
    let mut count = 0;
    for (name, text) in named_materials() {
        let written: serde_json::Value = serde_json::from_str(text).unwrap();
        for key in ["source", "conditions"] {
            let told = written[key].as_str().unwrap();
            assert!(told.len() > 60, "{name}: {told}");
        }
        let material = read(&scene(name, "{}")).muscles[0].material;
        let [low, high] = material.stretch_range.unwrap();
        assert!(low <= 1.0 && high > 1.0, "{name}");
        // The text of the command is an entry of a scene.
        let copied = scene("copy", &format!(r#"{{ "copy": {text} }}"#));
        assert_eq!(read(&copied).muscles[0].material, material, "{name}");
        count += 1;
    }
    assert_eq!(count, 8);
}

#[test]
fn a_name_of_the_scene_comes_first_and_a_wrong_one_is_told_with_all() {
    let own = r#"{ "vhb_4910": { "shear_modulus": "1 MPa" } }"#;
    let material = read(&scene("vhb_4910", own)).muscles[0].material;
    assert_eq!((material.shear_modulus, material.law), (1.0, None));
    let problem = r#"{ "scene": "scene.json", "simulate": { "duration": 1, "step": 1 } }"#;
    let message = mistake(&scene("vbh_4910", own), problem, &[]).to_string();
    for told in [
        "muscles[0].material",
        "\"vbh_4910\"",
        "\"ecoflex_00_30\", \"ecoflex_00_50\"",
        "did you mean \"vhb_4910\"",
    ] {
        assert!(message.contains(told), "{told} in {message}");
    }
    let wrong = r#"{ "rubber": { "shear_modulus": "1 MPa", "stretch_range": [1.2, 2] } }"#;
    let message = mistake(&scene("rubber", wrong), problem, &[]).to_string();
    let told = "materials.rubber.stretch_range";
    assert!(
        message.contains(told) && message.contains("[1.2, 2]"),
        "{message}"
    );
}

#[test]
fn an_expanded_scene_has_the_constants() {
    let (folder, _) = folder(&scene("vhb_4910", "{}"), "{}");
    let path = folder.path().join("scene.json");
    let system = read_scene(&path).unwrap();
    let written = expand(&path).unwrap();
    assert!(
        written.contains("\"15.36 kPa\"") && written.contains("D. L. Henann"),
        "{written}"
    );
    fs::write(&path, written).unwrap();
    assert_eq!(read_scene(&path).unwrap(), system);
}

/// The law of the source of VHB 4910 is that of Arruda and Boyce, with the inverse Langevin function by Cohen's formula: the ratio of its
/// stress to a neo-Hookean one. Gent's law has the ratio J/(J − (I₁ − 3)).
#[test]
fn the_law_of_vhb_is_near_that_of_its_source() {
    let material = read(&scene("vhb_4910", "{}")).muscles[0].material;
    let Some(ElasticLaw::Gent { limit }) = material.law else {
        panic!("{:?}", material.law)
    };
    let [low, high] = material.stretch_range.unwrap();
    let locking: f64 = 5.99;
    let mut largest: f64 = 0.0;
    for i in 0..=200 {
        let stretch = low + (high - low) * f64::from(i) / 200.0;
        let i1 = stretch.powi(2) + 2.0 / stretch;
        let z = (i1 / 3.0).sqrt() / locking;
        let source = (3.0 - z * z) / (1.0 - z * z) / 3.0;
        let ours = limit / (limit - (i1 - 3.0));
        largest = largest.max((ours / source - 1.0).abs());
    }
    assert!((0.02..0.06).contains(&largest), "{largest}");
}
