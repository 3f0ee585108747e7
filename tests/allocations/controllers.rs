//! Allocations of controllers: of a receding horizon, and of a law with and without an observer.

use crate::common::counting::ASKED;
use crate::common::receding;
use crate::number;
use nalgebra::DMatrix;
use proboscis::control::problem::{Observation, Regulator};
use proboscis::feedback::{Controller, Filter, Law, Observer, Reading};
use proboscis::workflow::receding::{RecedingHorizon, Source};
use std::sync::atomic::Ordering;

/// Most allocations of a step of a receding horizon with its preparation, of states that are measured, missing and wrong: of the whole state, and
/// with a delay and an observer that finds constant disturbances.
pub(crate) fn allocations_of_a_controller() -> usize {
    let whole = Regulator {
        step: 5.0,
        ..Regulator::default()
    };
    let observed = Regulator {
        delay: 20.0,
        observer: Some(observation()),
        ..whole.clone()
    };
    most_allocations(&whole, 2).max(most_allocations(&observed, 1))
}

fn observation() -> Observation {
    Observation {
        joints: vec![(0, 1e-3)],
        markers: Vec::new(),
        inputs: 0.05,
        rates: 0.1,
        lasting: Some(0.02),
    }
}

fn most_allocations(task: &Regulator, readings: usize) -> usize {
    let horizon = receding::horizon(&receding::problem("pair.json", &[]), task, 6);
    let law = horizon.law();
    assert_eq!(law.readings(), readings);
    let mut controller = RecedingHorizon::new(&horizon);
    let states: Vec<Vec<f64>> = (0..80)
        .map(|k| {
            let at = &law.at(law.h * k as f64).state;
            at.iter()
                .enumerate()
                .map(|(i, x)| x + 1e-2 * number(2 * k + i))
                .collect()
        })
        .collect();
    let mut sources = Vec::with_capacity(states.len());
    let mut most = 0;
    for (k, state) in states.iter().enumerate() {
        let before = ASKED.load(Ordering::Relaxed);
        let measured = match k {
            30 => None,
            31 | 60..70 => Some(&[10.0, 0.0][..readings]),
            40 => Some(&[f64::NAN; 2][..readings]),
            _ => Some(&state[..readings]),
        };
        sources.push(controller.step(law.h * k as f64, measured).source);
        controller.prepare();
        if k > 10 {
            most = most.max(ASKED.load(Ordering::Relaxed) - before);
        }
    }
    let all = [
        Source::Plan,
        Source::Late,
        Source::Unusable,
        Source::Regulator,
    ];
    assert!(
        all.iter().all(|source| sources.contains(source)),
        "{sources:?}"
    );
    most
}

/// Allocations of samples of a law, of the whole state and with an observer.
pub(crate) fn allocations_of_a_law() -> usize {
    let task = Regulator {
        step: 5.0,
        ..Regulator::default()
    };
    let horizon = receding::horizon(&receding::problem("pair.json", &[]), &task, 6);
    let mut observed = horizon.law().clone();
    let filter = Filter {
        readings: vec![0.0],
        by_state: DMatrix::identity(2, 2) * 0.5,
        by_inputs: DMatrix::zeros(2, 2),
        output: DMatrix::identity(1, 2),
        gain: DMatrix::from_element(2, 1, 0.5),
    };
    observed.observer = Some(Observer {
        readings: vec![Reading::State(0)],
        points: vec![filter],
        held: None,
        jump: Vec::new(),
        lasting: None,
    });
    let lasting = Regulator {
        observer: Some(observation()),
        ..task
    };
    let other = receding::horizon(&receding::problem("pair.json", &[]), &lasting, 6);
    let laws = [(horizon.law(), 2), (&observed, 1), (other.law(), 1)];
    let of = |(law, readings): (&Law, usize)| {
        let mut controller = Controller::new(law, law.h, 2.0 * law.h);
        let mut inputs = [0.0; 2];
        let before = ASKED.load(Ordering::Relaxed);
        for k in 0..40 {
            let time = law.h * f64::from(k);
            controller.sample(time, &[0.01, 1e-4][..readings]);
            controller.inputs(time, time + 0.5 * law.h, &mut inputs);
        }
        let open = law.at(0.0).inputs[1];
        assert!(inputs[1] != open && inputs[1] > 0.0, "{inputs:?}");
        ASKED.load(Ordering::Relaxed) - before
    };
    laws.into_iter().map(of).sum()
}
