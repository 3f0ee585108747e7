//! Materials with published constants, which a scene may name without writing them.

use crate::files::scene::spec_material::MaterialSpec;

macro_rules! kept {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../materials/", $name, ".json")))),*]
    };
}

/// Names and texts.
const KEPT: [(&str, &str); 8] = kept![
    "dragon_skin_10",
    "dragon_skin_20",
    "dragon_skin_30",
    "ecoflex_00_30",
    "ecoflex_00_50",
    "rtv_615",
    "sylgard_184",
    "vhb_4910",
];

/// Names of the materials, and their JSON texts with source, test conditions and range.
pub fn named_materials() -> impl Iterator<Item = (&'static str, &'static str)> {
    KEPT.into_iter()
}

/// A material by its name.
pub(crate) fn named_material(name: &str) -> Option<MaterialSpec> {
    let (_, text) = KEPT.into_iter().find(|(other, _)| *other == name)?;
    Some(serde_json::from_str(text).expect("a kept material is one"))
}
