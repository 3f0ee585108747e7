//! Limits of the force that a joint transmits: kept at all instants between intervals, active, the same in both coordinates and where the duration
//! is free, and refused where the balance of bodies does not tell it.

use crate::drivers::Table;
use crate::limits::run;
use crate::tension_limits::{greatest, problem};
use serde_json::{Value, json};

/// Forces of the joint along y at the instants between intervals, and the objective.
fn solved(problem: &Value) -> (Vec<f64>, f64) {
    let ran = run("solve", problem, &[]);
    ran.is_solved();
    let column = Table::read(&ran, "trajectory.csv").column("joint1_force_y");
    let forces = column[1..column.len() - 1].to_vec();
    let objective = ran.read("summary.json")["objective"].as_f64().unwrap();
    (forces, objective)
}

#[test]
fn a_joint_transmits_no_more_than_its_limit() {
    for is_free in [false, true] {
        let (forces, cheap) = solved(&problem(json!([]), "reduced", is_free));
        let bound = 0.9 * greatest(&forces);
        assert!(bound > 1.0, "{forces:?}");
        let limit =
            json!([{ "reaction_force": { "joint": "joint1", "along": [0, 2, 0], "max": bound } }]);
        let both = ["reduced", "redundant"]
            .map(|coordinates| solved(&problem(limit.clone(), coordinates, is_free)));
        for (forces, objective) in &both {
            let most = greatest(forces) / bound;
            assert!(most < 1.0 + 1e-6 && most > 1.0 - 1e-3, "{most}");
            assert!(*objective > cheap * (1.0 + 1e-7), "{objective} {cheap}");
        }
        let [one, other] = both.map(|(_, objective)| objective);
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}

/// In steps of half the length, by multipliers of the joint in redundant coordinates.
#[test]
fn a_reaction_that_is_passed_between_instants_is_told() {
    let limit = json!([{ "reaction_force": { "joint": "joint1", "along": [0, 1, 0], "max": 7 } }]);
    let ran = run("solve", &problem(limit, "reduced", false), &[]);
    ran.is_solved();
    let step = Table::read(&ran, "trajectory.csv").column("time")[1];
    let scene = problem(json!([]), "reduced", false)["scene"].clone();
    let voltages = ran.folder.path().join("p/solution.json");
    let simulated = run(
        "simulate",
        &json!({ "scene": scene, "simulate": {
            "duration": "0.06 s", "step": format!("{} ms", step / 2.0), "coordinates": "redundant",
            "voltages": { "solution": voltages }
        } }),
        &[],
    );
    simulated.is_solved();
    let column = Table::read(&simulated, "trajectory.csv").column("joint1_force_y");
    let most = greatest(&column[1..column.len() - 1]);
    assert!(most > 1.1 * 7.0, "{most}");
    let told = format!("a limit is passed, reaction force of joint1: {most:.3} N");
    assert!(ran.err.contains(&told), "no {told:?} in {}", ran.err);
}

#[test]
fn limits_of_reactions_that_make_no_sense_are_refused() {
    let refused = |limit: Value, words: &[&str]| {
        let limits = json!([{ "reaction_force": limit }]);
        run("solve", &problem(limits, "reduced", false), &[]).is_refused(words);
    };
    let place = "limits[0].reaction_force";
    let along = json!([0, 1, 0]);
    refused(
        json!({ "joint": "joint1", "along": along }),
        &[place, "no bound"],
    );
    refused(
        json!({ "joint": "joint9", "along": along, "max": 1 }),
        &[place, "joint9"],
    );
    refused(
        json!({ "joint": "joint1", "along": [0, 0, 0], "max": 1 }),
        &[place, "along"],
    );
    refused(
        json!({ "joint": "joint1", "along": along, "max": "1 Pa" }),
        &[place, "a force"],
    );
}
