//! Limits of the tension of muscles: kept in the middle of every interval, active, the same in both coordinates and where the duration is free,
//! and refused where they make no sense.

use crate::drivers::{Table, pair};
use crate::limits::run;
use serde_json::{Value, json};

/// The pair with ideal dielectrics in a short time, with limits.
pub(crate) fn problem(limits: Value, coordinates: &str, is_free: bool) -> Value {
    let mut problem = pair(&Value::Null, limits, coordinates);
    problem["control"]["duration"] = match is_free {
        true => json!({ "min": 0.02, "max": 0.4, "guess": 0.1 }),
        false => json!("0.06 s"),
    };
    if is_free {
        problem["control"]["objective"] = json!({ "effort": 0.01, "duration": 1.0 });
    }
    problem
}

/// Tension in N in the middle of an interval of the muscle from (−15, −20) mm on the ground to (−15, 20) mm on a segment that
/// turns about the origin by two angles within a time in s, at a voltage in V: of its length, written out.
pub(crate) fn tension([from, to]: [f64; 2], time: f64, voltage: f64) -> f64 {
    const LENGTH: f64 = 40e-3;
    let span = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        [
            -15e-3 * cos - 20e-3 * sin + 15e-3,
            -15e-3 * sin + 20e-3 * cos + 20e-3,
        ]
    };
    let (a, b) = (span(from), span(to));
    let middle = [0, 1].map(|i| 0.5 * (a[i] + b[i]));
    let length = middle[0].hypot(middle[1]);
    let rate = (middle[0] * (b[0] - a[0]) + middle[1] * (b[1] - a[1])) / (time * length);
    let stretch = length / LENGTH;
    let section = 100e-6;
    let elastic = 100e3 * section * (stretch - stretch.powi(-2));
    let field = voltage / 50e-6;
    let electric = 3.0 * 8.8541878128e-12 * field * field * section / stretch.powi(3);
    let viscous = 1.5 * 1e3 * section * LENGTH * rate / (length * length);
    elastic + electric + viscous
}

/// Tensions of the left muscle in the middle of the intervals, those of the table at the instants between them, and the objective.
fn solved(problem: &Value) -> (Vec<f64>, Vec<f64>, f64) {
    let ran = run("solve", problem, &[]);
    ran.is_solved();
    let [motion, controls] = ["trajectory.csv", "controls.csv"].map(|name| Table::read(&ran, name));
    let (times, angles) = (motion.column("time"), motion.column("joint1"));
    let voltages = controls.column("muscle2").into_iter().enumerate();
    let of = |(k, voltage): (usize, f64)| {
        let time = 1e-3 * (times[k + 1] - times[k]);
        tension([angles[k], angles[k + 1]], time, voltage)
    };
    let objective = ran.read("summary.json")["objective"].as_f64().unwrap();
    (
        voltages.map(of).collect(),
        motion.column("muscle2_tension"),
        objective,
    )
}

pub(crate) fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_muscle_pulls_no_more_than_its_limit() {
    // How near to the bound the motion comes follows from the multiplier, which is small where time counts.
    for (is_free, near) in [(false, 1e-6), (true, 1e-3)] {
        let (tensions, _, cheap) = solved(&problem(json!([]), "reduced", is_free));
        assert!(greatest(&tensions) > 8.0, "{tensions:?}");
        let bound = 0.8 * greatest(&tensions);
        let limit = json!([{ "tension": { "muscles": "all", "max": bound } }]);
        let both = ["reduced", "redundant"]
            .map(|coordinates| solved(&problem(limit.clone(), coordinates, is_free)));
        for (tensions, columns, objective) in &both {
            let most = greatest(tensions) / bound;
            assert!(most < 1.0 + 1e-6 && most > 1.0 - near, "{most}");
            assert!(*objective > cheap * (1.0 + 1e-7), "{objective} {cheap}");
            // The column of an instant is the mean of both intervals beside it.
            for (pair, column) in tensions.windows(2).zip(&columns[1..]) {
                let mean = 0.5 * (pair[0] + pair[1]);
                assert!((mean - column).abs() < 1e-6 * bound, "{mean} {column}");
            }
        }
        let [one, other] = both.map(|(_, _, objective)| objective);
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}

#[test]
fn limits_of_tensions_that_make_no_sense_are_refused() {
    let refused = |limit: Value, words: &[&str]| {
        let limits = json!([{ "tension": limit }]);
        run("solve", &problem(limits, "reduced", false), &[]).is_refused(words);
    };
    let place = "limits[0].tension";
    refused(json!({ "muscle": "muscle1" }), &[place, "no bound"]);
    refused(json!({ "max": 1 }), &[place, "muscle"]);
    refused(
        json!({ "muscle": "muscle7", "max": 1 }),
        &[place, "muscle7"],
    );
    let crossed = json!({ "muscle": "muscle1", "min": "2 N", "max": "1 N" });
    refused(crossed, &[place, "crossed"]);
    let unit = json!({ "muscle": "muscle1", "max": "1 kPa" });
    refused(unit, &[place, "1 kPa", "a force"]);
    // The goal holds the segment with 1.86 N.
    let low = json!({ "muscles": "all", "max": "1.5 N" });
    refused(
        low,
        &["control.goal", "tension of muscle1", "1.8610 N", "1.5"],
    );
    let mut meshed = problem(
        json!([{ "tension": { "muscles": "all", "max": 9 } }]),
        "reduced",
        false,
    );
    let muscles = &mut meshed["scene"]["chain"]["muscles"];
    muscles["model"] = json!("finite_elements");
    muscles["elements"] = json!([1, 1, 2]);
    run("solve", &meshed, &[]).is_refused(&[place, "no lumped muscle"]);
    meshed["control"]["limits"] = json!([{ "tension": { "muscle": "muscle1", "max": 9 } }]);
    run("solve", &meshed, &[]).is_refused(&[place, "of finite elements", "a lumped muscle"]);
}
