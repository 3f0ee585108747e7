//! Similar oscillators with similar recordings have similar constants, intervals and verdicts.

use crate::oscillator::{DAMPING, MASS, STIFFNESS, joint, parameters, recording, slide, task};
use proboscis::control::problem::Reading;
use proboscis::identify::{Identified, identify};
use proboscis::math::Random;
use proboscis::prelude::{Body, GROUND, Joint, Spring, System, X, g, mm, n_per_m};

/// Factors of mass, length and time.
#[derive(Clone, Copy)]
struct Scales {
    mass: f64,
    length: f64,
    time: f64,
}

impl Scales {
    fn stiffness(self) -> f64 {
        self.mass / self.time.powi(2)
    }

    fn damping(self) -> f64 {
        self.mass / self.time
    }
}

fn found(by: Scales) -> Identified {
    let mut system = System::new("oscillator");
    let radius = mm(10.0 * by.length);
    let cart = system.add(Body::sphere(radius).mass(g(MASS * by.mass)));
    system.add(Joint::prismatic(X).between(GROUND, cart));
    let from = -X * mm(50.0 * by.length);
    let spring = Spring::between((GROUND, from), (cart, X * mm(0.0)));
    system.add(spring.stiffness(n_per_m(1e3 * STIFFNESS * by.stiffness())));
    system.joints[0].damping = Some(DAMPING * by.damping());
    let noise = Some((0.05, &mut Random::new(3)));
    let mut own = recording("free", [5.0, 0.0], (31, 150.0), noise);
    own.start = joint(5.0 * by.length, 0.0);
    let reading = |one: &Reading| Reading {
        time: by.time * one.time,
        value: by.length * one.value,
        deviation: by.length * one.deviation,
    };
    own.channels = vec![slide(own.readings().map(reading).collect(), true)];
    let mut task = task(vec![own]);
    task.parameters = parameters();
    let factors = [by.stiffness(), by.damping()];
    for (one, factor) in task.parameters.iter_mut().zip(factors) {
        let values = [&mut one.lower, &mut one.guess, &mut one.upper];
        values.into_iter().for_each(|value| *value *= factor);
    }
    identify(&system, &task, &mut |_, _| {}).unwrap()
}

/// From 1 mg, 1 mm and 1 ms to 10 kg, 1 m and 100 s.
#[test]
fn the_size_of_a_robot_changes_no_verdict() {
    let scales = |mass, length, time| Scales { mass, length, time };
    let one = found(scales(1.0, 1.0, 1.0));
    assert!(one.information.half(0) > 0.0 && one.bias.is_confirmed);
    let others = [
        scales(2e-5, 0.02, 0.01),
        scales(2e-5, 20.0, 1e3),
        scales(200.0, 0.02, 1e3),
        scales(200.0, 20.0, 0.01),
    ];
    for by in others {
        let other = found(by);
        assert_eq!(one.fit.steps, other.fit.steps);
        assert_eq!(one.grid, other.grid);
        let verdicts = |of: &Identified| {
            let information = &of.information;
            (
                information.is_determined.clone(),
                of.bias.is_confirmed,
                of.is_white(),
            )
        };
        assert_eq!(verdicts(&one), verdicts(&other));
        let pairs = [by.stiffness(), by.damping()];
        for (j, factor) in pairs.into_iter().enumerate() {
            let value = |of: &Identified| of.fit.of_constants()[j];
            let half = |of: &Identified| of.information.half(j);
            let same = |a: f64, b: f64| (a / (factor * b) - 1.0).abs() < 1e-9;
            assert!(same(value(&other), value(&one)), "{j}");
            assert!(same(half(&other), half(&one)), "{j}");
        }
        assert!((one.p.unwrap() - other.p.unwrap()).abs() < 1e-9);
    }
}
