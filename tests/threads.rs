//! One thread and two give the same bits.

mod common;

use common::cases::rest_to_rest;
use common::trunk;
use proboscis::control::{Boundary, Transcription, guess};
use proboscis::nlp::Nlp;

/// Rows, Jacobian and Hessian of the trunk at a point between guess and noise.
fn values() -> [Vec<f64>; 3] {
    let system = trunk(3);
    let (intervals, duration) = (64, 600.0);
    let control = rest_to_rest(3, intervals, duration);
    let h = duration / intervals as f64;
    let (model, boundary) = Boundary::resolve(&system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let mut x = program.start(&initial).x;
    for (i, value) in x.iter_mut().enumerate() {
        *value += 0.01 * (i as f64).sin();
    }
    let costates: Vec<f64> = (0..program.constraints().lower.len())
        .map(|i| (i as f64).cos())
        .collect();
    let mut rows = vec![0.0; costates.len()];
    let mut jacobian = vec![0.0; program.jacobian_structure().rows.len()];
    let mut hessian = vec![0.0; program.hessian_structure().rows.len()];
    program.constraint(&x, &mut rows);
    program.jacobian(&x, &mut jacobian);
    program.hessian(&x, 0.7, &costates, &mut hessian);
    [rows, jacobian, hessian]
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let pair = std::thread::spawn(values).join().unwrap();
    // A thread that belongs to a pool already gets no helper.
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap()
        .install(values);
    assert!(pair.iter().all(|list| list.iter().any(|v| v.abs() > 1e-3)));
    for (a, b) in pair.iter().flatten().zip(alone.iter().flatten()) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
}
