//! Files to start from: an elephant trunk of any number of segments and its rest-to-rest problem.

/// A scene and a problem of a trunk; the problem reads the scene from `scene.json` next to it.
///
/// Each joint is bent by one muscle of its pair at the goal: 1.7 kV towards −x, 1.6 kV towards +z.
pub fn new_trunk(segments: usize) -> (String, String) {
    (scene(segments), problem(segments))
}

fn scene(segments: usize) -> String {
    format!(
        r#"{{
  "$schema": "scene.schema.json",
  "name": "trunk of {segments}",
  "materials": {{
    "silicone": {{
      "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "400 kPa",
      "relative_permittivity": 3.0, "viscosity": "1000 Pa s"
    }}
  }},
  "chain": {{
    "segments": {segments}, "length": "50 mm", "radius": "20 mm", "mass": "30 g",
    "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
    "muscles": {{
      "material": "silicone", "arm": "15 mm", "rest_length": "40 mm",
      "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um"
    }},
    "tip_marker": "tip"
  }}
}}
"#
    )
}

fn problem(segments: usize) -> String {
    let hold: Vec<String> = (1..=segments)
        .map(|joint| match joint % 2 {
            1 => format!("\"muscle{}\": \"1.7 kV\"", 2 * joint),
            _ => format!("\"muscle{}\": \"1.6 kV\"", 2 * joint - 1),
        })
        .collect();
    let lines: Vec<String> = hold.chunks(4).map(|line| line.join(", ")).collect();
    format!(
        r#"{{
  "$schema": "problem.schema.json",
  "scene": "scene.json",
  "control": {{
    "duration": "0.6 s",
    "intervals": 40,
    "start": {{ "rest_at_voltages": {{}} }},
    "goal": {{
      "rest_at_voltages": {{
        {hold}
      }}
    }},
    "voltage_bounds": ["0 V", "3 kV"],
    "objective": {{ "effort": 1.0 }},
    "coordinates": "reduced",
    "guess": "interpolate",
    "solver": {{ "max_iterations": 500 }}
  }}
}}
"#,
        hold = lines.join(",\n        ")
    )
}
