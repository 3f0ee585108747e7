//! Files to start from: an elephant trunk of any number of segments and its rest-to-rest problem.

use crate::math::significant;

/// Length of a segment in m and its mass in kg.
const LENGTH: f64 = 0.05;
const MASS: f64 = 0.03;
/// Shear modulus and first Lamé constant of the muscles in Pa.
const SHEAR_MODULUS: f64 = 1e5;
const LAME_LAMBDA: f64 = 4e5;
/// Arm, length and edge of the cross-section of a muscle in m.
const ARM: f64 = 0.015;
const REST_LENGTH: f64 = 0.04;
const EDGE: f64 = 0.01;

/// Shortest motion in s, and the part of the period of the slowest mode that a motion lasts at least.
const SHORTEST: f64 = 0.6;
const OF_PERIOD: f64 = 0.5;
/// First root β of cos β cosh β = −1: the slowest mode of a clamped beam has the angular frequency (β/L)² √(EI/m).
const CLAMPED: f64 = 1.875_104;
/// Weight of `rate` as a part of the square of the duration, where the slowest mode gives it: without it voltages excite faster ones.
const RATE: f64 = 0.01;
/// Fewest intervals, those of a trunk of few segments, which vibrate several times in the shortest motion (in 80 intervals its deviation
/// was 6 % of the path), and intervals for each segment.
const FEWEST: usize = 40;
const OF_FEW: usize = 120;
const FEW: usize = 4;
const OF_SEGMENT: f64 = 1.4;
/// Number of segments; a trunk with more bends as far as one with these as a whole.
const BENT: f64 = 12.0;

/// A scene and a problem of a trunk; the problem reads the scene from `scene.json` beside it.
///
/// Each joint is bent by one muscle of its pair at the goal: 1.7 kV towards −x, 1.6 kV towards +z, less where there are many. Duration and
/// intervals follow from the slowest mode.
pub fn new_trunk(segments: usize) -> (String, String) {
    (scene(segments), problem(segments))
}

/// Period of the slowest mode in s, as that of a clamped beam.
fn period(segments: usize) -> f64 {
    let modulus =
        SHEAR_MODULUS * (3.0 * LAME_LAMBDA + 2.0 * SHEAR_MODULUS) / (LAME_LAMBDA + SHEAR_MODULUS);
    // Of a joint with two muscles; every other joint bends in a plane.
    let stiffness = 2.0 * modulus * EDGE * EDGE / REST_LENGTH * ARM * ARM;
    let bending = stiffness * 2.0 * LENGTH;
    let of_length = CLAMPED / (LENGTH * segments as f64);
    std::f64::consts::TAU / (of_length * of_length * (bending * LENGTH / MASS).sqrt())
}

fn scene(segments: usize) -> String {
    format!(
        r#"{{
  "$schema": "scene.schema.json",
  "name": "trunk of {segments}",
  "materials": {{
    "silicone": {{
      "density": "1000 kg/m^3", "shear_modulus": "{shear} kPa", "lame_lambda": "{lame} kPa",
      "relative_permittivity": 3.0, "viscosity": "1000 Pa s"
    }}
  }},
  "chain": {{
    "segments": {segments}, "length": "{length} mm", "radius": "20 mm", "mass": "{mass} g",
    "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
    "muscles": {{
      "material": "silicone", "arm": "{arm} mm", "rest_length": "{rest} mm",
      "cross_section": ["{edge} mm", "{edge} mm"], "layer_thickness": "50 um"
    }},
    "tip_marker": "tip"
  }}
}}
"#,
        shear = 1e-3 * SHEAR_MODULUS,
        lame = 1e-3 * LAME_LAMBDA,
        length = 1e3 * LENGTH,
        mass = 1e3 * MASS,
        arm = 1e3 * ARM,
        rest = 1e3 * REST_LENGTH,
        edge = 1e3 * EDGE,
    )
}

fn problem(segments: usize) -> String {
    let duration = (10.0 * OF_PERIOD * period(segments)).ceil() / 10.0;
    let (duration, objective) = match duration > SHORTEST {
        true => {
            let rate = significant(RATE * duration * duration, 2);
            (duration, format!("\"effort\": 1.0, \"rate\": {rate}"))
        }
        false => (SHORTEST, "\"effort\": 1.0".to_owned()),
    };
    let fewest = if segments > FEW { FEWEST } else { OF_FEW };
    let intervals = (OF_SEGMENT * segments as f64).ceil() as usize;
    // A bend goes with the square of its voltage.
    let less = (BENT / segments as f64).sqrt().min(1.0);
    let [left, front] = [1.7, 1.6].map(|voltage| (100.0 * less * voltage).round() / 100.0);
    let hold: Vec<String> = (1..=segments)
        .map(|joint| match joint % 2 {
            1 => format!("\"muscle{}\": \"{left} kV\"", 2 * joint),
            _ => format!("\"muscle{}\": \"{front} kV\"", 2 * joint - 1),
        })
        .collect();
    let lines: Vec<String> = hold.chunks(4).map(|line| line.join(", ")).collect();
    format!(
        r#"{{
  "$schema": "problem.schema.json",
  "scene": "scene.json",
  "control": {{
    "duration": "{duration} s",
    "intervals": {intervals},
    "start": {{ "rest_at_voltages": {{}} }},
    "goal": {{
      "rest_at_voltages": {{
        {hold}
      }}
    }},
    "voltage_bounds": ["0 V", "3 kV"],
    "objective": {{ {objective} }},
    "coordinates": "reduced",
    "guess": "interpolate",
    "solver": {{ "max_iterations": 500 }}
  }}
}}
"#,
        intervals = intervals.max(fewest),
        hold = lines.join(",\n        ")
    )
}
