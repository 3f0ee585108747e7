//! Materials with published constants on the command line, and the warning beyond their range.

use crate::refusals::refused_run;
use crate::runs::{read, run, workshop};
use std::fs;

#[test]
fn materials_are_listed_and_printed() {
    let folder = workshop();
    let (status, out, _) = run(folder.path(), &["materials"]);
    assert!(
        status == 0 && out.lines().any(|name| name == "vhb_4910"),
        "{out}"
    );
    let (status, out, _) = run(folder.path(), &["materials", "vhb_4910"]);
    assert!(status == 0 && out.contains("\"source\""), "{out}");
    let wrong = ["materials", "vhb"];
    refused_run(
        folder.path(),
        &wrong,
        &["found \"vhb\"", "sylgard_184, vhb_4910"],
    );
}

#[test]
fn a_stretch_beyond_the_range_of_a_material_is_a_warning() {
    let folder = workshop();
    let path = folder.path();
    fs::write(
        path.join("hung.json"),
        r#"{
  "scene": {
    "name": "hung",
    "bodies": [ { "name": "weight", "mass": "50 g", "sphere": { "radius": "5 mm" }, "position": [0, 0, "-40 mm"] } ],
    "joints": [ { "name": "guide", "prismatic": { "axis": [0, 0, 1] }, "parent": "ground", "child": "weight", "at": [0, 0, "-40 mm"] } ],
    "muscles": [ { "name": "band", "material": "ecoflex_00_30", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "1 mm",
      "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "weight", "at": [0, 0, "-40 mm"] } } ],
    "gravity": [0, 0, "-9.81 m/s^2"]
  },
  "equilibrium": {}
}"#,
    )
    .unwrap();
    let code = |mass: &str| -> Vec<String> {
        let set = format!("scene.bodies[0].mass=\"{mass}\"");
        let arguments = ["equilibrium", "hung.json", "--set", &set, "-o", "out"];
        let (status, _, err) = run(path, &arguments);
        assert_eq!(status, 0, "{err}");
        let summary = read(path.join("out/summary.json"));
        let remarks = summary["notes"].as_array().cloned().unwrap_or_default();
        let beyond = remarks.iter().filter(|one| one["code"] == "outside_range");
        beyond
            .map(|one| one["text"].as_str().unwrap().to_owned())
            .collect()
    };
    assert!(code("50 g").is_empty());
    let [text] = &code("800 g")[..] else {
        panic!("one warning")
    };
    assert!(
        text.contains("band has a stretch of") && text.contains("from 1 to 3"),
        "{text}"
    );
}
