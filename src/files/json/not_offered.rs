//! Words for physics that is not offered, and the messages about them. What a file can say, in whatever words, is none of these.

/// Place of the list of the limits.
const LIMITS: &str = "docs/accuracy.md#limits-of-validity";

/// Words in the singular, in lower case with underscores, and what is said of them.
const TABLE: [(&[&str], &str); 6] = [
    (
        &["contact", "collision", "impact", "restitution", "obstacle"],
        "there is no contact; \"limits\" of a \"control\" keep markers out of regions",
    ),
    (
        &["friction", "coulomb_friction", "stiction"],
        "there is no friction; \"damping\" and \"viscosity\" are viscous",
    ),
    (
        &["fluid", "drag", "aerodynamics", "buoyancy"],
        "there is no fluid",
    ),
    (
        &["temperature", "thermal_expansion", "heat"],
        "there is no temperature",
    ),
    (
        &[
            "plasticity",
            "yield_stress",
            "damage",
            "fatigue",
            "fracture",
        ],
        "materials are elastic and viscous; they neither yield nor break",
    ),
    (
        &["shell", "membrane", "beam", "cloth", "tet4", "tet10"],
        "elements are hexahedra",
    ),
];

/// Returns the message about a word that stands for a feature that is not offered.
pub(super) fn not_offered(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace([' ', '-'], "_");
    let is_meant = |known: &&str| *known == word || word.strip_suffix('s') == Some(known);
    let (_, said) = TABLE.iter().find(|(words, _)| words.iter().any(is_meant))?;
    Some(format!("which is not offered ({said}: {LIMITS})"))
}
