//! Limits of a receding horizon that its motion reaches.

use crate::common::receding::{horizon, problem};
use crate::common::robot::Robot;
use proboscis::control::problem::Regulator;
use proboscis::model::Model;
use proboscis::workflow::receding::{RecedingHorizon, Source};

/// A rate at its limit along the whole motion is kept by a robot that is the model, and the plan is followed.
#[test]
fn a_limit_that_is_reached() {
    let bound = 0.9e-3;
    let limit =
        "control.limits=[{\"joint_rate\": {\"joint\": \"joint1\", \"max\": \"0.9 rad/s\"}}]";
    let pair = problem("pair.json", &[limit]);
    for n in [4, 10] {
        let horizon = horizon(&pair, &Regulator::default(), n);
        let law = horizon.law();
        let angle = |k: i32| law.at(law.h * f64::from(k)).state[0];
        let rates = (0..19).map(|k| (angle(k + 1) - angle(k)) / law.h);
        let fastest = rates.fold(0.0, f64::max);
        assert!((fastest / bound - 1.0).abs() < 0.15, "{fastest}");
        let model = Model::new(pair.0.clone(), None, law.h, &[]).unwrap();
        let mut robot = Robot::new(&model, 10);
        let mut controller = RecedingHorizon::new(&horizon);
        for k in 0..60 {
            let (time, state) = (law.h * f64::from(k), robot.measure());
            let answer = controller.step(time, Some(&state));
            assert_eq!(answer.source, Source::Plan, "{n} {k}");
            let inputs = answer.inputs.to_vec();
            controller.prepare();
            robot.go(law.h, &inputs);
            let off = robot.z[0] - angle(k + 1);
            assert!(off.abs() < 6e-3, "{n} {k}: {off} rad");
            let rate = (robot.z[0] - state[0]) / law.h;
            assert!(rate < 1.15 * bound, "{n} {k}: {rate} rad/ms");
        }
    }
}
