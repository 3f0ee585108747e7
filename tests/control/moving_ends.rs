//! Motions that end with given rates.

use crate::phases::{cart, read};
use crate::verdicts::output_of;
use proboscis::control::Solution;
use proboscis::tasks::solve_motions;
use proboscis::workflow::{Iterate, SolveRequest};
use serde_json::{Value, json};
use std::fs;
use std::ops::ControlFlow;
use tempfile::tempdir;

/// The objective of a problem that is solved, and its motion.
fn solved(problem: &Value) -> (f64, Solution) {
    let loaded = read(problem).unwrap();
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let task = loaded.task.motions(&loaded.system).unwrap();
    let found = solve_motions(&task, SolveRequest::default(), go_on).unwrap();
    assert!(found.verdict.is_solved, "{:?}", found.verdict);
    let one = found.list.into_iter().next().unwrap();
    (found.whole.objective, one.optimum.motion)
}

/// A. E. Bryson, W. F. Denham, S. E. Dreyfus, AIAA J. 1, 1963: x(0) = x(1) = 0, ẋ(0) = 1 = −ẋ(1), x ≤ l ≤ 1/6, least ½ ∫ ẍ² dt = 4/(9 l).
#[test]
fn a_bounded_place_between_opposite_rates_costs_what_the_closed_form_says() {
    let l = 1.0 / 9.0;
    let exact = 2.0 * 4.0 / (9.0 * l);
    let errors = [30, 60, 120].map(|intervals| {
        let (objective, motion) = solved(&cart(&json!({
            "start": { "joint_angles": {}, "joint_rates": { "rail": "1 m/s" } },
            "goal": { "joint_angles": { "rail": 0 }, "joint_rates": { "rail": "-1 m/s" } },
            "duration": "1 s",
            "intervals": intervals,
            "limits": [{ "joint_angle": { "joint": "rail", "max": format!("{l:?} m") } }],
        })));
        let most = motion.z.iter().map(|z| z[0]).fold(0.0, f64::max);
        assert!((most - 1e3 * l).abs() < 1e-4, "{most} mm");
        // 1 kg at −1 m/s, in g mm/ms.
        let momentum = motion.momentum[0];
        assert!((momentum + 1e3).abs() < 1e-6, "{momentum}");
        (objective - exact).abs()
    });
    let orders = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
    println!("{exact} by {errors:?}, orders {orders:?}");
    assert!(
        orders.iter().all(|order| (order - 2.0).abs() < 0.1),
        "{orders:?}"
    );
}

/// Two coupled links, whose momenta depend on both rates.
fn links(intervals: usize, coordinates: &str) -> (f64, Solution) {
    let text = fs::read_to_string("problems/scenes/pair.json").unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    scene["chain"]["segments"] = json!(2);
    solved(&json!({
        "scene": scene,
        "control": {
            "duration": "0.1 s",
            "intervals": intervals,
            "start": { "joint_angles": {} },
            "goal": {
                "joint_angles": { "joint1": "2 deg", "joint2": "-3 deg" },
                "joint_rates": { "joint1": "1 rad/s", "joint2": "-0.5 rad/s" },
            },
            "voltage_bounds": ["0 V", "4 kV"],
            "objective": { "effort": 1, "rate": 0.01 },
            "coordinates": coordinates,
        },
    }))
}

#[test]
fn coupled_links_end_with_their_rates_in_both_coordinates() {
    let found = ["reduced", "redundant"].map(|coordinates| links(40, coordinates));
    let apart = (found[1].0 / found[0].0 - 1.0).abs();
    assert!(apart < 1e-7, "{apart:e}");
    // The parabola through the last three instants.
    let errors = [20, 40].map(|intervals| {
        let (_, motion) = links(intervals, "reduced");
        let (n, h) = (intervals, motion.times[1]);
        let rate = |i: usize| {
            let at = |back: usize| motion.joints[n - back][i];
            1e3 * (1.5 * at(0) - 2.0 * at(1) + 0.5 * at(2)) / h
        };
        (rate(0) - 1.0).abs().max((rate(1) + 0.5).abs())
    });
    println!("{errors:?}");
    assert!(
        errors[1] < 0.02 && errors[1] < 0.4 * errors[0],
        "{errors:?}"
    );
}

#[test]
fn a_motion_goes_on_from_an_end_in_motion() {
    let folder = tempdir().unwrap();
    let problem = folder.path().join("throw.json");
    let text = cart(&json!({
        "goal": { "joint_angles": { "rail": "1 m" }, "joint_rates": { "rail": "2 m/s" } },
        "duration": "1 s",
        "intervals": 20,
    }));
    fs::write(&problem, text.to_string()).unwrap();
    let out = folder.path().join("out");
    let ended = output_of(&problem, &[], &out);
    assert!(ended.is_solved, "{:?}", ended.notes);
    // It is neither held nor said to leave its goal.
    assert!(
        !ended.notes.iter().any(|note| note.contains("hold")),
        "{:?}",
        ended.notes
    );
    let on = folder.path().join("on.json");
    let text = json!({
        "scene": text["scene"],
        "simulate": { "duration": "0.5 s", "step": "10 ms", "start": { "end_of": out } },
    });
    fs::write(&on, text.to_string()).unwrap();
    let after = folder.path().join("after");
    output_of(&on, &[], &after);
    let table = fs::read_to_string(after.join("trajectory.csv")).unwrap();
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = names.iter().position(|name| *name == "rail [mm]").unwrap();
    let last: f64 = lines
        .next_back()
        .unwrap()
        .split(',')
        .nth(column)
        .unwrap()
        .parse()
        .unwrap();
    assert!((last - 2000.0).abs() < 1e-6, "{last}");
}

#[test]
fn ends_whose_momenta_are_not_known_are_refused() {
    let cases = [
        (
            json!({ "joint_rates": { "rail": "1 m/s" } }),
            "joint_angles",
        ),
        (
            json!({ "joint_angles": { "rail": "1 m" }, "joint_rates": { "rail": "1 m/s" }, "hold": "find" }),
            "a state in motion is not held",
        ),
    ];
    for (goal, words) in cases {
        let error = read(&cart(&json!({ "goal": goal, "duration": "1 s" }))).map(|_| ());
        let error = error.unwrap_err();
        println!("{error}");
        assert!(error.contains(words), "{error}");
    }
    let loaded = read(&cart(&json!({
        "goal": { "joint_angles": { "rail": "1 m" }, "joint_rates": { "rail": "1 m/s" } },
        "duration": "1 s",
        "free": { "bodies[0].mass": { "min": "0.5 kg", "max": "2 kg" } },
    })));
    let loaded = loaded.unwrap();
    let task = loaded.task.motions(&loaded.system).unwrap();
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let error = solve_motions(&task, SolveRequest::default(), go_on).unwrap_err();
    assert!(error.to_string().contains("for given masses"), "{error}");
}
