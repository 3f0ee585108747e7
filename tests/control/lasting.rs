//! Constant disturbances: an observer finds a torque that acts, and gains and plans hold the goal against it, with and without a delay.

use crate::common::receding::{horizon, problem};
use crate::common::robot::Robot;
use proboscis::control::problem::{Observation, Regulator};
use proboscis::feedback::{Estimate, Law};
use proboscis::model::Model;
use proboscis::workflow::receding::{Horizon, RecedingHorizon, Source};

/// An observer of the angle, or of the tip.
fn observation(of_tip: bool) -> Observation {
    Observation {
        joints: if of_tip { vec![] } else { vec![(0, 1e-4)] },
        markers: if of_tip { vec![(0, 1e-2)] } else { vec![] },
        inputs: 0.05,
        rates: 0.1,
        lasting: Some(0.05),
    }
}

fn regulator(delay: f64) -> Regulator {
    Regulator {
        delay,
        observer: Some(observation(false)),
        ..Regulator::default()
    }
}

/// Goes on by an interval under inputs and a torque in N mm, in ten steps with half of it on either side.
fn go(robot: &mut Robot<'_>, h: f64, inputs: &[f64], torque: f64) {
    for _ in 0..10 {
        robot.momentum[0] += 0.05 * h * torque;
        robot.go(0.1 * h, inputs);
        robot.momentum[0] += 0.05 * h * torque;
    }
}

/// A torque on the robot of a law, at its goal under the inputs that hold it, is found.
#[test]
fn a_torque_is_found() {
    let pair = problem("pair.json", &[]);
    for of_tip in [false, true] {
        let task = Regulator {
            observer: Some(observation(of_tip)),
            ..Regulator::default()
        };
        let horizon = horizon(&pair, &task, 1);
        let law = horizon.law();
        let model = Model::new(pair.0.clone(), None, law.h, &[]).unwrap();
        let mut robot = Robot::new(&model, 1);
        let goal = law.held.as_ref().unwrap();
        robot.z[..1].copy_from_slice(&goal.state[..1]);
        let mut estimate = Estimate::new(law).unwrap();
        let torque = 1.0;
        for k in 20..80 {
            let tip = model.action.map.placed(&robot.z).x[model.markers[0]];
            let readings = if of_tip {
                tip.as_slice()
            } else {
                &robot.z[..1]
            };
            estimate.correct(k, readings);
            estimate.expect(k, &[0.0; 2]);
            go(&mut robot, law.h, &goal.inputs, torque);
        }
        let [angle, _, found] = estimate.state() else {
            panic!("{:?}", estimate.state());
        };
        println!("{found} N mm, {angle} rad, {:?} V²", estimate.against());
        assert!(angle.abs() > 1e-3);
        assert!((found - torque).abs() < 1e-2 * torque, "{found}");
        // What is against it holds the angle of the goal, and neither square is below zero.
        let mut robot = Robot::new(&model, 1);
        robot.z[..1].copy_from_slice(&goal.state[..1]);
        let all = goal.inputs.iter().zip(estimate.against());
        let inputs: Vec<f64> = all.map(|(v, more)| (v * v + more).sqrt()).collect();
        assert!(inputs.iter().all(|v| *v >= 0.0), "{inputs:?}");
        (0..60).for_each(|_| go(&mut robot, law.h, &inputs, torque));
        let off = robot.z[0] - goal.state[0];
        assert!(off.abs() < 1e-2 * angle.abs(), "{off}");
    }
}

/// Inputs that act in interval k of those that were sent, before these those of the motion.
fn acting(horizon: &Horizon, sent: &[Vec<f64>], k: usize) -> Vec<f64> {
    let law = horizon.law();
    match k.checked_sub(horizon.delay()) {
        Some(of) => sent[of].clone(),
        None => law.at(law.h * k as f64).inputs.clone(),
    }
}

/// Inputs of a controller interval by interval, of a stiffer robot with a torque; then its angle and that of the goal.
fn stiffer(horizon: &Horizon, torque: f64, steps: usize) -> (Vec<Vec<f64>>, [f64; 2]) {
    let (stiff, _) = problem(
        "pair.json",
        &["scene.materials.silicone.shear_modulus=\"110 kPa\""],
    );
    let law = horizon.law();
    let model = Model::new(stiff, None, law.h, &[]).unwrap();
    let mut robot = Robot::new(&model, 1);
    let mut controller = RecedingHorizon::new(horizon);
    let mut sent = Vec::new();
    for k in 0..steps {
        let answer = controller.step(law.h * k as f64, Some(&robot.z[..1]));
        assert_eq!(answer.source, Source::Plan);
        sent.push(answer.inputs.to_vec());
        controller.prepare();
        let acting = acting(horizon, &sent, k);
        go(&mut robot, law.h, &acting, torque);
    }
    let goal = law.held.as_ref().unwrap();
    (sent, [robot.z[0], goal.state[0]])
}

/// A robot that is 10 % stiffer and loaded ends at the goal, with a delay too; without constant disturbances it does not.
#[test]
fn plans_end_at_the_goal() {
    let pair = problem("pair.json", &[]);
    for (delay, intervals) in [(0.0, 0), (15.0, 2)] {
        let with = horizon(&pair, &regulator(delay), 6);
        assert_eq!(with.delay(), intervals);
        let mut task = regulator(delay);
        task.observer.as_mut().unwrap().lasting = None;
        let without = horizon(&pair, &task, 6);
        let [with, without] = [with, without].map(|horizon| {
            let (_, [angle, goal]) = stiffer(&horizon, 0.3, 150);
            (angle - goal).abs()
        });
        println!("{with} against {without} rad");
        assert!(without > 3e-3, "{without}");
        assert!(with < 1e-6, "{with}");
    }
}

/// A delay over which the whole measured state is predicted acts like none, once there was time for it.
#[test]
fn a_delay_of_the_whole_state() {
    let pair = problem("pair.json", &[]);
    let run = |delay: f64| {
        let task = Regulator {
            delay,
            ..Regulator::default()
        };
        let horizon = horizon(&pair, &task, 6);
        let law = horizon.law();
        assert_eq!(law.readings(), 2);
        let model = Model::new(pair.0.clone(), None, law.h, &[]).unwrap();
        let mut robot = Robot::new(&model, 10);
        let mut controller = RecedingHorizon::new(&horizon);
        let mut sent: Vec<Vec<f64>> = Vec::new();
        let mut off = Vec::new();
        for k in 0..40_usize {
            let answer = controller.step(law.h * k as f64, Some(&robot.measure()));
            assert_eq!(answer.source, Source::Plan);
            sent.push(answer.inputs.to_vec());
            controller.prepare();
            let acting = acting(&horizon, &sent, k);
            off.push(robot.z[0] - law.at(law.h * k as f64).state[0]);
            robot.go(law.h, &acting);
            if k == 22 {
                robot.momentum[0] += 300.0;
            }
        }
        off
    };
    let [prompt, late] = [0.0, 20.0].map(run);
    println!("{prompt:.4?}\n{late:.4?}");
    // Two intervals more pass before the push is answered, and both come back.
    let greatest = |part: &[f64]| part.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(greatest(&prompt[..23]) < 1e-3 && greatest(&late[..23]) < 1e-3);
    assert!(prompt[24].abs() > 1e-4 && greatest(&late[24..27]) > 2e-2);
    assert!(late[25..27] != prompt[25..27] && greatest(&late[28..]) < 5e-3);
}

/// Both muscles hold start and goal between their bounds, so that no bound is near.
const BETWEEN: [&str; 3] = [
    "control.start={\"rest_at_voltages\": {\"muscle1\": \"1.2 kV\", \"muscle2\": \"1.9 kV\"}}",
    "control.goal={\"rest_at_voltages\": {\"muscle1\": \"1.6 kV\", \"muscle2\": \"1.7 kV\"}}",
    "control.objective={\"rate\": 1.0}",
];

/// Changes by gains of the squares of inputs for an estimate.
fn by_gains(law: &Law, estimate: &Estimate<'_>, k: usize) -> Vec<f64> {
    let all = estimate.state().iter().chain(estimate.against());
    let deviation: Vec<f64> = all.copied().collect();
    let mut out = vec![0.0; law.inputs.len()];
    law.correct(law.h * k as f64, &deviation, &mut out);
    out
}

/// Under a constant disturbance, too, the plan is that of the gains for small deviations, whatever the length of the horizon.
#[test]
fn gains_of_the_regulator_under_a_lasting_force() {
    let pair = problem("pair.json", &BETWEEN);
    for (n, rates) in [(1, 0.0), (6, 0.0), (1, 0.5), (6, 0.5)] {
        let task = Regulator {
            rates,
            ..regulator(0.0)
        };
        let horizon = horizon(&pair, &task, n);
        let law = horizon.law();
        let model = Model::new(pair.0.clone(), None, law.h, &[]).unwrap();
        let mut robot = Robot::new(&model, 1);
        let start = &law.at(0.0).state;
        robot.z[..1].copy_from_slice(&start[..1]);
        let mut controller = RecedingHorizon::new(&horizon);
        let mut estimate = Estimate::new(law).unwrap();
        let mut most: f64 = 0.0;
        for k in 0..14 {
            let answer = controller.step(law.h * k as f64, Some(&robot.z[..1]));
            let inputs = answer.inputs.to_vec();
            controller.prepare();
            // The plan knows the force of the sample before.
            estimate.correct(k, &robot.z[..1]);
            let wanted = by_gains(law, &estimate, k);
            let given = &law.at(law.h * k as f64).inputs;
            let found = inputs.iter().zip(given).map(|(a, b)| a * a - b * b);
            let found: Vec<f64> = found.collect();
            println!("{n} {rates} {k}: {found:.1?} {wanted:.1?}");
            estimate.expect(k, &found);
            if k > 8 {
                most = wanted.iter().fold(most, |a, b| a.max(b.abs()));
                for (found, wanted) in found.iter().zip(&wanted) {
                    assert!((found - wanted).abs() < 2e-2 * most, "{n} {rates} {k}");
                }
            }
            go(&mut robot, law.h, &inputs, 0.1);
        }
        assert!(most > 1e3);
    }
}
