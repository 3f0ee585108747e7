//! The controller between a plant and its law: a delay that is predicted acts like none, and an observer finds the state.

use nalgebra::{DMatrix, DVector};
use proboscis::feedback::{
    Controller, Filter, Integral, Law, LawInput, Measured, Observer, Point, Reading,
};

const H: f64 = 10.0;

/// A plant that grows without feedback.
fn plant() -> [DMatrix<f64>; 2] {
    let a = DMatrix::from_row_slice(2, 2, &[1.02, 0.3, 0.1, 0.95]);
    [a, DMatrix::from_row_slice(2, 1, &[0.0, 0.5])]
}

/// A law about rest whose one input stays within bounds.
fn law(gain: DMatrix<f64>, delay: usize, bounds: [f64; 2], observer: Option<Observer>) -> Law {
    let measured = |name: &str| Measured {
        name: name.into(),
        is_rate: false,
        is_length: true,
        memory: None,
    };
    let point = Point {
        state: vec![0.0; 2],
        inputs: vec![0.0],
        gain,
        offset: Vec::new(),
    };
    Law {
        measured: vec![measured("x"), measured("y")],
        inputs: vec![LawInput {
            name: "push".into(),
            is_squared: false,
            bounds,
        }],
        integral: Integral::default(),
        h: H,
        delay,
        points: vec![point.clone()],
        held: Some(point),
        observer,
        markers: Vec::new(),
    }
}

/// States of the plant and the inputs of the controller, from a state.
fn run(
    law: &Law,
    steps: usize,
    read: impl Fn(&DVector<f64>) -> Vec<f64>,
) -> Vec<(DVector<f64>, f64)> {
    let [a, b] = plant();
    let mut controller = Controller::new(law, H, H * law.delay as f64);
    let mut x = DVector::from_vec(vec![1.0, -0.2]);
    let mut out = Vec::new();
    for k in 0..steps {
        let time = H * k as f64;
        controller.sample(time, &read(&x));
        let mut input = [0.0];
        controller.inputs(time, time + 0.5 * H, &mut input);
        out.push((x.clone(), input[0]));
        x = &a * x + &b * input[0];
    }
    out
}

/// `u = −K x` with the state x of its own interval, whatever the delay, once there was time for it.
#[test]
fn a_predicted_delay_acts_like_none() {
    let [a, b] = plant();
    let k = DMatrix::from_row_slice(1, 2, &[0.9, 1.1]);
    let whole = |x: &DVector<f64>| x.as_slice().to_vec();
    for delay in [0, 1, 3] {
        // K over the state, then over the inputs until then.
        let power = |n: usize| (0..n).fold(DMatrix::identity(2, 2), |p, _| &a * p);
        let mut gain = DMatrix::zeros(1, 2 + delay);
        gain.columns_mut(0, 2).copy_from(&(&k * power(delay)));
        for i in 0..delay {
            gain[(0, 2 + i)] = (&k * power(delay - 1 - i) * &b)[(0, 0)];
        }
        for bounds in [[-50.0, 50.0], [-0.5, 0.5]] {
            let law = law(gain.clone(), delay, bounds, None);
            let motion = run(&law, 40, whole);
            let mut at_bound = 0;
            for (number, (x, u)) in motion.iter().enumerate() {
                let wanted = match number < delay {
                    true => 0.0,
                    false => -(&k * x)[(0, 0)],
                };
                at_bound += usize::from(wanted.clamp(bounds[0], bounds[1]) != wanted);
                let kept = wanted.clamp(bounds[0], bounds[1]);
                assert!((u - kept).abs() < 1e-10, "{delay} {number}: {u} {kept}");
            }
            assert_eq!(at_bound > 0, bounds[1] < 1.0, "{at_bound}");
            let size = motion.last().unwrap().0.norm();
            assert!(size < 0.1, "{size}");
        }
    }
}

/// Inputs stay numbers, and are those of the state before where nothing was measured.
#[test]
fn a_measurement_that_is_no_number_is_not_taken_in() {
    let k = DMatrix::from_row_slice(1, 2, &[0.9, 1.1]);
    let law = law(k, 0, [-5.0, 5.0], None);
    let mut controller = Controller::new(&law, H, 0.0);
    let mut inputs = |time: f64, measured: [f64; 2]| {
        controller.sample(time, &measured);
        let mut input = [0.0];
        controller.inputs(time, time + 0.5 * H, &mut input);
        input[0]
    };
    assert!((inputs(0.0, [1.0, 2.0]) + 3.1).abs() < 1e-12);
    assert!((inputs(H, [f64::NAN, 1.0]) + 2.0).abs() < 1e-12);
    assert!((inputs(2.0 * H, [f64::INFINITY, f64::NAN]) + 2.0).abs() < 1e-12);
    assert!(inputs(3.0 * H, [0.0, 0.0]).abs() < 1e-12);
}

/// The error of the estimate shrinks as (A − A M C) says, and the loop under it comes to rest.
#[test]
fn an_observer_finds_the_state_from_one_of_its_parts() {
    let [a, b] = plant();
    let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
    let m = DMatrix::from_row_slice(2, 1, &[0.8, 0.7]);
    let filter = Filter {
        readings: vec![0.0],
        by_state: a.clone(),
        by_inputs: b,
        output: c.clone(),
        gain: m.clone(),
    };
    let observer = Observer {
        readings: vec![Reading::State(0)],
        points: vec![filter.clone()],
        held: Some(filter),
        jump: Vec::new(),
        lasting: None,
    };
    let k = DMatrix::from_row_slice(1, 2, &[0.9, 1.1]);
    let law = law(k.clone(), 0, [-0.6, 0.6], Some(observer));
    let motion = run(&law, 60, |x| vec![x[0]]);
    // The estimate begins at the motion.
    let mut error = motion[0].0.clone();
    for (number, (x, u)) in motion.iter().enumerate() {
        let after = &error - &m * (&c * &error);
        let wanted = -(&k * (x - &after))[(0, 0)];
        assert!(
            (u - wanted.clamp(-0.6, 0.6)).abs() < 1e-10,
            "{number}: {u} {wanted}"
        );
        error = &a * after;
    }
    assert!(error.norm() < 1e-6, "{error}");
    assert!(motion[0].1.abs() > 0.1 && motion.last().unwrap().0.norm() < 1e-3);
}
