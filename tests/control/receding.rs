//! The controller of a receding horizon against the gains of the regulator and optima found to the end, and under faults.

use crate::common::receding::{horizon, problem};
use crate::common::robot::Robot;
use proboscis::control::problem::Regulator;
use proboscis::feedback::{Controller, Law};
use proboscis::model::Model;
use proboscis::prelude::*;
use proboscis::workflow::receding::{RecedingHorizon, Source};

/// The robot of a horizon at the start of its motion, in steps of a tenth of an interval.
fn robot(model: &Model) -> Robot<'_> {
    Robot::new(model, 10)
}

/// Both muscles of the pair hold its goal between their bounds, so that no bound is near.
const BETWEEN: [&str; 3] = [
    "control.start={\"rest_at_voltages\": {\"muscle1\": \"1.9 kV\", \"muscle2\": \"2.2 kV\"}}",
    "control.goal={\"rest_at_voltages\": {\"muscle1\": \"1.9 kV\", \"muscle2\": \"2.2 kV\"}}",
    "control.objective={\"rate\": 1.0}",
];

/// Without bounds the plan is that of the linear-quadratic regulator, whatever the length of the horizon: its cost at the end is that of all time. So it is
/// where rates cost.
#[test]
fn gains_of_the_regulator_for_small_deviations() {
    let pair = problem("pair.json", &BETWEEN);
    let mut first = Vec::new();
    for (n, step, rates) in [(1, 1.0, 0.0), (6, 2.5, 0.0), (1, 1.0, 5.0), (6, 2.5, 5.0)] {
        let task = Regulator {
            step,
            rates,
            ..Regulator::default()
        };
        let horizon = horizon(&pair, &task, n);
        let law = horizon.law();
        let point = law.at(0.0);
        first.push(point.gain[(0, 0)]);
        assert!(point.inputs.iter().all(|voltage| *voltage > 1100.0));
        // To first order: half the difference of the inputs of opposite deviations.
        for (angle, rate) in [(1e-4, 0.0), (0.0, 1e-5)] {
            let [there, back] = [1.0, -1.0].map(|sign| {
                let mut state = point.state.clone();
                state[0] += sign * angle;
                state[1] += sign * rate;
                let mut controller = RecedingHorizon::new(&horizon);
                let answer = controller.step(0.0, Some(&state));
                assert_eq!(answer.source, Source::Plan);
                answer.inputs.to_vec()
            });
            for i in 0..2 {
                let found = 0.5 * (there[i].powi(2) - back[i].powi(2));
                let wanted = -point.gain[(i, 0)] * angle - point.gain[(i, 1)] * rate;
                println!("{n} {i}: {found} V² against {wanted} V²");
                assert!(wanted.abs() > 100.0);
                assert!(
                    (found - wanted).abs() < 1e-6 * wanted.abs(),
                    "{found} {wanted}"
                );
            }
        }
    }
    // Rates that cost change the gains.
    assert!((first[2] / first[0] - 1.0).abs() > 0.05, "{first:?}");
}

/// One iteration a step comes to the optima from the states that are measured, which Ipopt finds to the end.
#[test]
fn iterations_approach_the_optimum() {
    let pair = problem("pair.json", &[]);
    let horizon = horizon(&pair, &Regulator::default(), 8);
    let law = horizon.law();
    let model = Model::new(pair.0, None, law.h, &[]).unwrap();
    let mut robot = robot(&model);
    let mut controller = RecedingHorizon::new(&horizon);
    let (push, range) = (22, 3000.0_f64.powi(2));
    let mut differences = Vec::new();
    let mut optima = Vec::new();
    for k in 0..push + 8 {
        let state = robot.measure();
        let answer = controller.step(law.h * k as f64, Some(&state));
        assert_eq!(answer.source, Source::Plan);
        let inputs = answer.inputs.to_vec();
        controller.prepare();
        let (best, status) = horizon.optimum(k, &state).unwrap();
        assert!(status.is_solved());
        let squares = inputs
            .iter()
            .zip(&best)
            .map(|(a, b)| (a * a - b * b).abs() / range);
        differences.push(squares.fold(0.0, f64::max));
        optima.push(best);
        robot.go(law.h, &inputs);
        if k + 1 == push {
            robot.momentum[0] += 600.0;
        }
    }
    println!("{differences:.6?}");
    // The barrier keeps squares of inputs away from zero by the root of 1e-7.
    let (before, after) = differences.split_at(push);
    assert!(before.iter().all(|one| *one < 1e-3));
    let inputs = [&optima[push - 1], &optima[push]];
    let is_off = |voltage: f64| voltage < 10.0;
    assert!(
        (0..2).any(|i| is_off(inputs[0][i]) != is_off(inputs[1][i])),
        "the push asks for another set of active bounds: {inputs:?}"
    );
    assert!(after[4..].iter().all(|one| *one < 1e-3));
}

/// Distances in mm of the tip of the trunk from the motion that it follows, interval by interval, under pushes.
fn pushed(
    model: &Model,
    law: &Law,
    controller: &mut dyn FnMut(f64, &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let mut robot = robot(model);
    let mut distances = Vec::new();
    for k in 0..75 {
        let time = law.h * k as f64;
        let place = law.place(&law.markers[0].1, time);
        let there = model.action.map.placed(&robot.z).x[model.markers[0]];
        distances.push((there - nalgebra::Vector3::from(place)).norm());
        let inputs = controller(time, &robot.measure());
        assert!(inputs.iter().all(|v| (0.0..=3000.0).contains(v)));
        robot.go(law.h, &inputs);
        if k == 15 || k == 45 {
            let kick = [4.0, -3.0, 2.0, 2.0, -1.0, 1.0];
            let all = robot.momentum.iter_mut().zip(kick);
            all.for_each(|(p, kick)| *p += 1000.0 * kick);
        }
    }
    distances
}

/// The trunk comes back from pushes on its way and at its goal, no farther off than under the law of the regulator.
#[test]
fn trunk_under_pushes() {
    let trunk = problem("elephant_trunk.json", &["control.intervals=40"]);
    let task = Regulator {
        step: 4.0,
        ..Regulator::default()
    };
    let horizon = horizon(&trunk, &task, 20);
    let law = horizon.law();
    let model = Model::new(trunk.0, None, law.h, &[]).unwrap();
    let mut receding = RecedingHorizon::new(&horizon);
    let distances = pushed(&model, law, &mut |time, state| {
        let answer = receding.step(time, Some(state));
        assert_eq!(answer.source, Source::Plan, "{time}");
        let inputs = answer.inputs.to_vec();
        receding.prepare();
        inputs
    });
    let mut regulator = Controller::new(law, law.h, 0.0);
    let regulated = pushed(&model, law, &mut |time, state| {
        let mut inputs = vec![0.0; law.inputs.len()];
        regulator.sample(time, state);
        regulator.inputs(time, time, &mut inputs);
        inputs
    });
    println!("{distances:.2?}\n{regulated:.2?}");
    let greatest = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
    assert!(greatest(&distances[16..20]) > 3.0 && greatest(&distances[46..50]) > 3.0);
    assert!(greatest(&distances[36..45]) < 0.3 && greatest(&distances[66..]) < 0.1);
    let [own, other] = [&distances, &regulated].map(|list| list.iter().map(|d| d * d).sum::<f64>());
    assert!(own < other, "{own} {other}");
}

/// Every step has an answer within bounds, and says where it comes from.
#[test]
fn faults() {
    let pair = problem("pair.json", &[]);
    let horizon = horizon(&pair, &Regulator::default(), 5);
    let law = horizon.law();
    let model = Model::new(pair.0, None, law.h, &[]).unwrap();
    let mut robot = robot(&model);
    let mut controller = RecedingHorizon::new(&horizon);
    let mut sources = Vec::new();
    let mut step = |time: f64, measured: Option<&[f64]>| {
        let answer = controller.step(time, measured);
        assert!(answer.inputs.iter().all(|v| (0.0..=3000.0).contains(v)));
        let out = (answer.source, answer.inputs.to_vec());
        controller.prepare();
        out
    };
    for k in 0..60 {
        let state = robot.measure();
        let time = law.h * k as f64;
        let (source, inputs) = match k {
            5 => step(time, Some(&[f64::NAN, 0.0])),
            8 => step(time, Some(&[state[0], f64::INFINITY])),
            11..=13 => step(time, None),
            16 => step(time, Some(&[state[0] + 2.0, state[1]])),
            _ => step(time, Some(&state)),
        };
        // Asked again in the same interval, it gives the same inputs.
        assert_eq!(
            step(time + 0.4 * law.h, Some(&state)),
            (source, inputs.clone())
        );
        sources.push(source);
        robot.go(law.h, &inputs);
        let off = robot.z[0] - law.at(law.h * (k + 1) as f64).state[0];
        assert!(off.abs() < 5e-3, "{k}: {off}");
    }
    for (k, source) in sources.iter().enumerate() {
        let expected = match k {
            5 | 8 | 16 => Source::Unusable,
            11..=13 => Source::Late,
            _ => Source::Plan,
        };
        assert_eq!(*source, expected, "{k}");
    }
    // A robot that is held elsewhere: measurements that no plan predicts are believed after a while.
    let mut far = law.at(600.0).state.clone();
    far[0] += 2.0;
    let sources: Vec<Source> = (60..70)
        .map(|k| step(law.h * k as f64, Some(&far)).0)
        .collect();
    println!("{sources:?}");
    assert_eq!(sources[..3], [Source::Unusable; 3]);
    assert!(sources.contains(&Source::Regulator));
    // Steps that were left out altogether.
    let (source, _) = step(law.h * 1000.0, Some(&law.at(1e4).state));
    assert_eq!(source, Source::Plan);
}

/// A wrong time stamp has inputs within bounds: the first controller has some, and goes on as the second one.
#[test]
fn wrong_times() {
    let pair = problem("pair.json", &[]);
    for delay in [0.0, 20.0] {
        let task = Regulator {
            delay,
            ..Regulator::default()
        };
        let horizon = horizon(&pair, &task, 5);
        let law = horizon.law();
        let mut controllers = [(); 2].map(|()| RecedingHorizon::new(&horizon));
        let stamps = [f64::INFINITY, f64::NAN, -5.0, 1e33, 1e9 * law.h, f64::MAX];
        let mut largest = 0.0_f64;
        for k in 0..18 {
            let time = law.h * f64::from(k);
            let mut state = law.at(time).state.clone();
            state[0] += 1e-3;
            if k % 3 == 1 {
                let stamp = stamps[k as usize / 3];
                let before = controllers[0].step(time - law.h, None).inputs.to_vec();
                let answer = controllers[0].step(stamp, Some(&state));
                assert!(answer.inputs.iter().all(|v| (0.0..=3000.0).contains(v)));
                let is_far = stamp.is_finite() && stamp > time;
                assert_eq!(answer.inputs != before, is_far, "{stamp}");
                controllers[0].prepare();
            }
            let [stamped, plain] = controllers.each_mut().map(|controller| {
                let answer = controller.step(time, Some(&state));
                let out = (answer.source, answer.inputs.to_vec());
                controller.prepare();
                out
            });
            assert_eq!([stamped.0, plain.0], [Source::Plan; 2], "{k}");
            largest = plain.1.iter().fold(largest, |most, v| most.max(*v));
            // A plan that begins anew needs some iterations.
            let both = stamped.1.iter().zip(&plain.1);
            let distance = both.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(distance < 200.0, "{k}: {stamped:?} {plain:?}");
        }
        assert!(largest > 100.0, "{largest}");
    }
}

/// Rates that no plan predicts are not taken in, however plausible their angles; in the end they are believed, the gains act, and a new plan begins.
#[test]
fn implausible_rates() {
    let pair = problem("pair.json", &[]);
    let horizon = horizon(&pair, &Regulator::default(), 5);
    let law = horizon.law();
    let mut controller = RecedingHorizon::new(&horizon);
    let goal = law.at(1e4).state.clone();
    let mut step = |k: usize, rate: f64| {
        let answer = controller.step(law.h * k as f64, Some(&[goal[0], rate]));
        assert!(answer.inputs.iter().all(|v| (0.0..=3000.0).contains(v)));
        let source = answer.source;
        controller.prepare();
        source
    };
    assert_eq!(step(30, 0.0), Source::Plan);
    for (k, rate) in [(31, 1e200), (33, -1e200), (35, 1.1), (37, 1e308)] {
        assert_eq!(step(k, rate), Source::Unusable, "{rate}");
        assert_eq!(step(k + 1, 0.0), Source::Plan);
    }
    assert_eq!(step(39, 0.01), Source::Plan);
    assert!((40..50).all(|k| step(k, 0.0) == Source::Plan));
    let sources: Vec<Source> = (50..55).map(|k| step(k, 1e308)).collect();
    let [unusable, acts] = [Source::Unusable, Source::Regulator];
    assert_eq!(sources, [unusable, unusable, unusable, acts, acts]);
    assert!((55..60).all(|k| step(k, 0.0) == Source::Plan));
}

/// An arm between two rubber bands by Gent's law that a motor turns; the bands tear before it has turned by a radian.
const MOTOR: [&str; 8] = [
    "scene.materials.silicone.law={\"gent\": {\"limit\": 0.05}}",
    "scene.materials.silicone.relative_permittivity=null",
    "scene.materials.silicone.viscosity=\"100 Pa s\"",
    "scene.loads=[{\"name\": \"motor\", \"joint\": \"joint1\"}]",
    "control.start={\"joint_angles\": {\"joint1\": \"6 deg\"}}",
    "control.goal={\"rest_at_voltages\": {}}",
    "control.load_bounds={\"motor\": [\"-1 N m\", \"1 N m\"]}",
    "control.objective={\"effort\": 1.0}",
];

/// A measurement that is no error by its size is taken in. The plan behind it tears a band, so that its matrix is not finite and has no factors: it is followed as it
/// was, then the gains act, and the new plan has factors.
#[test]
fn factors_that_fail() {
    let arm = problem("pair.json", &MOTOR);
    let horizon = horizon(&arm, &Regulator::default(), 5);
    let law = horizon.law();
    let (fault, fails) = (30, 31..35);
    let [mut controller, mut unmeasured] = [0, 1].map(|_| RecedingHorizon::new(&horizon));
    for k in 0..45 {
        let time = law.h * k as f64;
        let point = law.at(time);
        let off = match k {
            _ if k == fault => [0.9, 0.2],
            _ if fails.contains(&k) => [1e-4, 1e-5],
            _ => [0.0; 2],
        };
        let state: Vec<f64> = point
            .state
            .iter()
            .zip(off)
            .map(|(x, off)| x + off)
            .collect();
        let residual = controller.residual().equations;
        let has_factors = residual.is_finite();
        assert_eq!(has_factors, !fails.contains(&k), "{k}: {residual}");
        let answer = controller.step(time, Some(&state));
        let (source, input) = (answer.source, answer.inputs[0]);
        assert!(input.abs() <= 1000.0);
        match k {
            31..=33 => {
                assert_eq!(source, Source::Kept);
                // The plan goes on as where nothing is measured.
                let answer = unmeasured.step(time, None);
                assert_eq!((answer.source, answer.inputs[0]), (Source::Late, input));
                assert!(input.abs() > 100.0, "{input}");
            }
            34 => {
                assert_eq!(source, Source::Regulator);
                let gains = point.gain[(0, 0)] * off[0] + point.gain[(0, 1)] * off[1];
                let wanted = point.inputs[0] - gains;
                println!("{input} {wanted}");
                assert!(gains.abs() > 1e-3 && (input - wanted).abs() < 1e-9 * gains.abs());
            }
            _ => {
                assert_eq!(source, Source::Plan, "{k}");
                unmeasured.step(time, Some(&state));
            }
        }
        controller.prepare();
        unmeasured.prepare();
    }
    assert!(controller.residual().equations < 1e-6);
}

/// A robot built part by part is held at its goal.
#[test]
fn a_robot_of_parts() {
    let silicone = Material::elastomer(kpa(100.0)).density(kg_per_m3(1000.0));
    let silicone = silicone.relative_permittivity(3.0).viscosity(pa_s(1000.0));
    let mut arm = System::new("arm");
    let link = Body::cylinder(mm(50.0), mm(20.0)).mass(g(30.0));
    let link = arm.add(link.at(Y * mm(25.0)).along(Y));
    arm.add(Joint::revolute(Z).between(GROUND, link));
    let [right, _] = [X, -X].map(|side| {
        let end = |y: f64| side * mm(15.0) + Y * mm(y);
        let muscle = Muscle::of(&silicone).section(mm(10.0), mm(10.0));
        let muscle = muscle.layer(um(50.0)).from(GROUND, end(-20.0));
        arm.add(muscle.to(link, end(20.0)))
    });
    let problem = Control::over(s(0.2), 20).goal(State::rest_at([(right, kv(1.5))]));
    let problem = problem.voltage_bounds(0.0, kv(3.0)).effort(1.0);
    let horizon = problem.horizon(&arm, 5).unwrap();
    let mut controller = RecedingHorizon::new(&horizon);
    let goal = horizon.law().at(1e4).state.clone();
    assert!(goal[0] < -0.05, "{goal:?}");
    let held = controller.step(1e4, Some(&goal));
    assert_eq!(held.source, Source::Plan);
    assert!((held.inputs[0] - 1500.0).abs() < 5.0 && held.inputs[1] < 100.0);
    let none = problem.horizon(&arm, 0).unwrap_err().to_string();
    assert!(none.contains("0 intervals"), "{none}");
    let open = problem
        .goal(State::Free)
        .horizon(&arm, 5)
        .unwrap_err()
        .to_string();
    assert!(open.contains("not held"), "{open}");
}
