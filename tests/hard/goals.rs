//! Goals that cannot be reached, and muscles that share one.

use crate::page::{Case, Verdict};
use crate::program::{difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

#[test]
fn a_goal_out_of_reach_is_told_with_its_distance() {
    let scene = trunk(6, silicone());
    let goal = json!({ "markers": { "tip": ["0 mm", "400 mm", "0 mm"] } });
    let found = run(&scene, &control("0.6 s", 20, goal));
    assert_eq!((found.exit, found.status()), (1, "infeasible"));
    // The trunk is 300 mm long.
    assert!(
        found
            .err
            .contains("goal y of marker tip: violated by 100.0 mm"),
        "{}",
        found.err
    );
    let path = found.column("tip_y");
    assert!((largest(&path) - 300.0).abs() < 1e-3);
    let across = found.column("tip_x");
    let reach = (-60..=60).map(|degrees| f64::from(degrees).to_radians());
    let reach = reach.map(|a| [300.0 * a.sin(), 300.0 * a.cos()]).collect();
    Case {
        name: "unreachable-goal",
        title: "A goal 100 mm out of reach",
        law: "The trunk is 300 mm long; asked to 400 mm the problem is infeasible, the row that misses 100 mm is named, and the closest motion is kept.",
        verdict: Verdict::Refusal,
        seen: vec![found.err.trim().replace('\n', "; ")],
        x: Axis::linear("tip x [mm]", Extent::Padded),
        y: Axis::linear("tip y [mm]", Extent::Padded),
        curves: vec![
            Series::curve("reach of the trunk", reach, hue(0)),
            Series::curve("closest motion, its last instant", vec![[across[20], path[20]]], hue(1)).marked(Mark::Disc).unjoined(),
            Series::curve("goal", vec![[0.0, 400.0]], hue(2)).marked(Mark::Ring).unjoined(),
        ],
    }
    .record();
}

/// The pair written out, each muscle in `parts` equal parts of its cross-section at one place.
fn pair(parts: usize) -> Value {
    let muscle = |m: usize, part: usize| {
        let x = if m == 1 { 0.015 } else { -0.015 };
        json!({
            "name": format!("muscle{m}_{part}"), "material": "silicone",
            "cross_section": [0.01, 0.01 / parts as f64], "layer_thickness": "50 um",
            "from": { "body": "ground", "at": [x, -0.02, 0] }, "to": { "body": "segment1", "at": [x, 0.02, 0] },
        })
    };
    let muscles: Vec<Value> = [1, 2]
        .into_iter()
        .flat_map(|m| (1..=parts).map(move |p| muscle(m, p)))
        .collect();
    json!({
        "name": "pair in parts", "materials": { "silicone": silicone() },
        "bodies": [{
            "name": "segment1", "mass": "30 g", "position": [0, 0.025, 0],
            "cylinder": { "length": 0.05, "radius": 0.02, "axis": [0, 1, 0] },
        }],
        "joints": [{ "name": "joint1", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "segment1", "at": [0, 0, 0] }],
        "muscles": muscles,
    })
}

#[test]
fn duplicated_muscles_share_their_work() {
    let at = |parts: usize| {
        let voltages: serde_json::Map<String, Value> = (1..=parts)
            .map(|p| (format!("muscle2_{p}"), json!("1.7 kV")))
            .collect();
        run(
            &pair(parts),
            &control("0.2 s", 20, json!({ "rest_at_voltages": voltages })),
        )
        .solved()
    };
    let single = at(1);
    let one = single.number(&["objective"]);
    let whole = single.voltages("muscle2_1");
    let (mut curves, mut seen) = (
        Vec::new(),
        vec![format!("one part: objective {one:.9} kV² s")],
    );
    let starts = single.voltages("start");
    curves.push(Series::curve("one part", points(&starts, &whole), hue(0)).marked(Mark::Ring));
    for parts in [2, 3] {
        let found = at(parts);
        let objective = found.number(&["objective"]);
        let ratio = objective / one;
        assert!((ratio - parts as f64).abs() < 1e-6, "{parts}: {ratio}");
        // Voltages of parts count by the sum of their squares alone.
        let mean: Vec<f64> = (0..whole.len())
            .map(|k| {
                let squares =
                    (1..=parts).map(|p| found.voltages(&format!("muscle2_{p}"))[k].powi(2));
                (squares.sum::<f64>() / parts as f64).sqrt()
            })
            .collect();
        assert!(
            largest(&whole) > 1e3 && difference(&mean, &whole) < 5.0,
            "{}",
            difference(&mean, &whole)
        );
        let [a, b] = [&single, &found].map(|run| run.column("joint1"));
        assert!(largest(&a) > 0.1 && difference(&a, &b) < 1e-6);
        seen.push(format!(
            "{parts} parts: objective {objective:.9} kV² s, {ratio:.9} times as much"
        ));
        let name = format!("root mean square of {parts}");
        curves
            .push(Series::curve(name, points(&starts, &mean), hue(parts - 1)).dashed(Dash::Dashed));
    }
    Case {
        name: "duplicated-muscles",
        title: "Muscles written two and three times at one place",
        law: "In n parts at one place only the sum of the squared voltages acts: optimal voltages are not unique. The solver ends all the same, at n times \
              the objective of the whole muscle, to 1e-6, with the same motion.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("voltage of muscle2 [V]", Extent::FromZero),
        curves,
    }
    .record();
}
