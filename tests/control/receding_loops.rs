//! The controller of a receding horizon of a closed loop against the gains of its regulator and optima found to the end.

use crate::common::receding::{horizon, problem};
use crate::common::robot::Robot;
use proboscis::control::problem::{Control, Regulator};
use proboscis::dynamics::Independent;
use proboscis::model::{Coordinates, Model, Role, System};
use proboscis::workflow::receding::{Horizon, RecedingHorizon, Source};

/// A four-bar in the joint coordinates of its tree that its muscle carries from rest under one voltage to rest under another.
fn four_bar(from: &str, to: &str) -> (System, Control) {
    let rest = |place: &str, volts: &str| {
        format!(r#"control.{place}={{"rest_at_voltages": {{"muscle1": "{volts}"}}}}"#)
    };
    let (start, goal) = (rest("start", from), rest("goal", to));
    let changes = [
        r#"scene="scenes/four_bar.json""#,
        r#"control.coordinates="reduced""#,
        r#"control.objective={"rate": 1.0}"#,
        &start,
        &goal,
    ];
    problem("pair.json", &changes)
}

fn model(system: &System, h: f64) -> Model {
    Model::new(system.clone(), Some(Coordinates::Reduced), h, &[]).unwrap()
}

/// Places of the coordinates of a horizon's state among those of a model.
fn state_of(horizon: &Horizon, model: &Model) -> Vec<usize> {
    let all = model.variables.with(Role::Coordinate);
    let places = horizon.law().measured.iter().filter(|one| !one.is_rate);
    let place = |name: &str| all.iter().position(|one| one.name == name).unwrap();
    places.map(|one| place(&one.name)).collect()
}

#[test]
fn gains_of_the_regulator_for_small_deviations() {
    let problem = four_bar("1.9 kV", "1.9 kV");
    for (n, step) in [(1, 10.0), (6, 2.5)] {
        let task = Regulator {
            step,
            ..Regulator::default()
        };
        let horizon = horizon(&problem, &task, n);
        let point = horizon.law().at(0.0);
        // One degree of freedom.
        assert_eq!(point.state.len(), 2);
        for (angle, rate) in [(1e-4, 0.0), (0.0, 1e-5)] {
            let [there, back] = [1.0, -1.0].map(|sign| {
                let state = [point.state[0] + sign * angle, point.state[1] + sign * rate];
                let mut controller = RecedingHorizon::new(&horizon);
                let answer = controller.step(0.0, Some(&state));
                assert_eq!(answer.source, Source::Plan);
                answer.inputs[0]
            });
            let found = 0.5 * (there.powi(2) - back.powi(2));
            let wanted = -point.gain[(0, 0)] * angle - point.gain[(0, 1)] * rate;
            println!("{n}: {found} V² against {wanted} V²");
            assert!(wanted.abs() > 100.0);
            assert!((found - wanted).abs() < 1e-5 * wanted.abs());
        }
    }
}

/// Pushed far from its motion, the plan comes to the optimum from the state that is measured, and the loop to its goal.
#[test]
fn a_pushed_loop_comes_to_its_goal_by_optimal_inputs() {
    let problem = four_bar("0.5 kV", "1.9 kV");
    let horizon = horizon(&problem, &Regulator::default(), 8);
    let law = horizon.law();
    let model = model(&problem.0, law.h);
    let mut robot = Robot::new(&model, 10);
    let coordinates = state_of(&horizon, &model);
    let mut controller = RecedingHorizon::new(&horizon);
    let start = &law.at(0.0).state;
    let mut z = model.reference_coordinates();
    let mut rates = vec![0.0; model.coordinate_count()];
    z[coordinates[0]] = start[0];
    Independent::of(&model, coordinates.clone()).close(&model, &mut z, &mut rates);
    robot.z = z;
    let (push, last) = (12, 60);
    let mut differences = Vec::new();
    for k in 0..last {
        let all = robot.measure();
        let rates = &all[model.coordinate_count()..];
        let state = [all[coordinates[0]], rates[coordinates[0]]];
        let answer = controller.step(law.h * k as f64, Some(&state));
        assert_eq!(answer.source, Source::Plan, "{k}");
        let inputs = answer.inputs.to_vec();
        controller.prepare();
        if k < push + 8 {
            let (best, status) = horizon.optimum(k, &state).unwrap();
            assert!(status.is_solved());
            differences.push((inputs[0].powi(2) - best[0].powi(2)).abs() / 9e6);
        }
        robot.go(law.h, &inputs);
        if k + 1 == push {
            robot.momentum[coordinates[0]] += 300.0;
        }
    }
    println!("{differences:.6?}");
    let (before, after) = differences.split_at(push);
    assert!(before.iter().all(|one| *one < 1e-3));
    assert!(after[4..].iter().all(|one| *one < 1e-3));
    let goal = &law.at(1e4).state;
    let away = (robot.z[coordinates[0]] - goal[0]).abs();
    let way = (start[0] - goal[0]).abs();
    println!("{away} of {way}");
    assert!(away < 1e-2 * way);
}
