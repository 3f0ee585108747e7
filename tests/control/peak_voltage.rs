//! The least peak of the voltages: no bound below it leaves a motion, and one a little above it does.

use crate::limits::run;
use proboscis::control::BoundaryConditions;
use proboscis::control::problem::{self, Task};
use proboscis::files::read_problem;
use proboscis::prelude::*;
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::Path;

fn read(set: &[String]) -> (System, Box<problem::Control>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_peak.json");
    let loaded = read_problem(&file, set).unwrap();
    let Task::Control(control) = loaded.task else {
        unreachable!("the file asks for control");
    };
    (loaded.system, control)
}

#[test]
fn the_least_peak_is_the_least_bound_that_leaves_a_motion() {
    let solved = |set: &[String]| {
        let (system, control) = read(set);
        let limits = SolveLimits::default();
        let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
        optimise(&system, &control, None, limits, go_on).unwrap()
    };
    let found = solved(&[]);
    assert!(found.is_solved(), "{}", found.word());
    let [parameter] = &found.motion.parameters[..] else {
        panic!("{:?}", found.motion.parameters)
    };
    let peak = parameter.value;
    assert!(!parameter.is_at_bound && parameter.unit.symbol == "V");
    let voltages = found.motion.voltages.iter().flatten();
    let largest = voltages.fold(0.0_f64, |max, v| max.max(*v));
    // Least effort goes to the bound of 3 kV.
    assert!(
        peak < 2000.0 && (largest / peak - 1.0).abs() < 1e-6,
        "{peak} {largest}"
    );
    // The goal holds 1.7 kV, which are no part of the motion.
    let bounded = |part: f64| {
        let bound = part * peak;
        let goal = json!({ "joint_angles": { "joint1": angle() } });
        let set = [
            "control.objective={\"effort\": 1}".to_owned(),
            format!("control.voltage_bounds=[0, {bound}]"),
            format!("control.goal={goal}"),
        ];
        solved(&set).is_solved()
    };
    assert!(bounded(1.001));
    assert!(!bounded(0.999));
}

/// The coordinate of the state of rest under 1.7 kV.
fn angle() -> f64 {
    let (system, control) = read(&[]);
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, 2.5).unwrap();
    let goal = boundary.goal.rest.expect("a state of rest");
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(&goal.z);
    model.action.map.place(&mut instant);
    model.joints(&instant, &[0.0])[0]
}

/// A program gets what the file gets.
#[test]
fn a_program_minimises_the_peak() {
    let silicone = Material::elastomer(kpa(100.0))
        .relative_permittivity(3.0)
        .viscosity(pa_s(1000.0));
    let mut arm = System::new("arm");
    let link = arm.add(
        Body::cylinder(mm(50.0), mm(20.0))
            .mass(g(30.0))
            .at(Y * mm(25.0))
            .along(Y),
    );
    arm.add(Joint::revolute(Z).between(GROUND, link));
    let [right, left] = [X, -X].map(|side| {
        let end = |y: f64| side * mm(15.0) + Y * mm(y);
        let muscle = Muscle::of(&silicone)
            .section(mm(10.0), mm(10.0))
            .layer(um(50.0));
        arm.add(muscle.from(GROUND, end(-20.0)).to(link, end(20.0)))
    });
    let task = Control::over(s(0.1), 20)
        .goal(State::rest_at([(right, kv(1.5))]))
        .voltage_bounds(0.0, kv(3.0));
    let largest = |found: &Optimum| {
        let of = |muscle| found.motion.voltage(muscle).into_iter().map(|(_, v)| v);
        of(right).chain(of(left)).fold(0.0, f64::max)
    };
    let least = task.clone().effort(1.0).solve(&arm).unwrap();
    let found = task
        .clone()
        .peak_voltage(1.0)
        .effort(1e-4)
        .solve(&arm)
        .unwrap();
    assert!(found.is_solved(), "{}", found.status);
    let peak = found.parameters[0].value;
    assert!((largest(&found) / peak - 1.0).abs() < 1e-5);
    assert!(peak < 0.9 * largest(&least), "{peak} {}", largest(&least));
    let error = task.peak_voltage(-1.0).solve(&arm).unwrap_err();
    assert!(error.to_string().contains("-1"), "{error}");
}

#[test]
fn a_peak_of_no_voltage_is_refused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("problems/pair_peak.json")).unwrap();
    let mut problem: Value = serde_json::from_str(&text).unwrap();
    problem["scene"] = json!(root.join("problems/scenes/pair.json"));
    problem["control"]["objective"]["peak_voltage"] = json!(-1);
    run("solve", &problem, &[]).is_refused(&["objective.peak_voltage", "-1"]);
    problem["control"]["objective"]["peak_voltage"] = json!(1);
    problem["control"]["voltages"] = json!({ "muscle1": 0, "muscle2": 1000 });
    problem["control"]["free"] =
        json!({ "materials.silicone.viscosity": { "min": 500, "max": 2000 } });
    run("solve", &problem, &[]).is_refused(&["objective.peak_voltage", "voltage that is sought"]);
}
