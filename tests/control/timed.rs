//! Free durations with inputs and joints that are functions of time: closed forms, and given durations.

use crate::common::cases::rest_to_rest;
use crate::common::trunk;
use crate::loads::{cart, solved};
use crate::optimality::cold;
use crate::prescribed::carried;
use proboscis::System;
use proboscis::control::problem::{BoundaryState, Control, Duration, Objective, Waypoint};
use proboscis::control::{BoundaryConditions, Row, Solution, Transcription, guess};
use proboscis::math::Signal;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::nlp::Status;
use proboscis::workflow::{Optimum, Shortest, SolveLimits, optimise};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Price of time in N² (s per s).
const PRICE: f64 = 40.0;

/// The same with a free duration around 1 s, where effort and time cost something.
fn freed(mut control: Control) -> Control {
    control.duration = Duration::Free {
        min: 300.0,
        max: 4000.0,
        guess: 1000.0,
    };
    control.objective = Objective {
        effort: 1.0,
        duration: PRICE,
        ..Objective::default()
    };
    control
}

/// The cart of 1 kg that a motor moves by 1 m from rest to rest, and a wind pushes with 3 N/s t.
fn pushed(intervals: usize, coordinates: &str) -> (System, Control) {
    let (mut system, mut control) = cart(intervals, &[], coordinates);
    let motor = &system.components.loads[0];
    assert!(matches!(motor.on, LoadPlace::Joint(0)));
    system.components.loads.push(Load {
        name: "wind".into(),
        on: motor.on.clone(),
    });
    let wind = Signal::ramp(0.0, 30.0, 10_000.0);
    let source = system.sources().len() - 1;
    control.given.insert(source, wind);
    (system, freed(control))
}

/// The least value of a function between two arguments, and where it is: thirds of the interval.
fn least(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> (f64, f64) {
    while high - low > 1e-9 {
        let third = (high - low) / 3.0;
        match f(low + third) < f(high - third) {
            true => high -= third,
            false => low += third,
        }
    }
    (low, f(low))
}

/// Least effort and time of the pushed cart with the duration T: the motor force is α + β t, and the wind costs nothing.
fn pushed_cost(t: f64) -> f64 {
    let a = 3.0;
    let [speed, place] = [-a * t * t / 2.0, 1.0 - a * t.powi(3) / 6.0];
    // ∫(α + β t) dt = αT + βT²/2 = speed, ∫(T − t)(α + β t) dt = αT²/2 + βT³/6 = place.
    let beta = (speed * t / 2.0 - place) * 12.0 / t.powi(3);
    let alpha = speed / t - beta * t / 2.0;
    let motor = alpha * alpha * t + alpha * beta * t * t + beta * beta * t.powi(3) / 3.0;
    motor + PRICE * t
}

/// Deviations of the duration in s and of the objective from a closed form for two numbers of intervals: of order two.
fn assert_of_order_two(of: impl Fn(usize) -> (System, Control), cost: impl Fn(f64) -> f64) {
    let (time, value) = least(cost, [0.4, 1.6]);
    assert!(time > 0.5 && time < 1.5, "{time} s");
    let errors = [20, 40].map(|intervals| {
        let (system, control) = of(intervals);
        let optimum = solved(&system, &control);
        assert_eq!(optimum.solution.status, Status::Solved);
        let verified = optimum.resimulation.as_ref().expect("it is simulated");
        assert_eq!((&verified.failure, &verified.cause), (&None, &None));
        let found = duration(&optimum) / 1e3;
        println!(
            "{intervals}: {found} s of {time} s, {} of {value}",
            optimum.solution.objective
        );
        [found - time, optimum.solution.objective - value]
    });
    for i in 0..2 {
        let [coarse, fine] = errors.map(|error| error[i]);
        assert!(coarse.abs() < 0.3 && fine.abs() > 1e-6, "{errors:?}");
        assert!((coarse / fine - 4.0).abs() < 0.3, "{errors:?}");
    }
}

/// In ms.
fn duration(optimum: &Optimum) -> f64 {
    optimum.motion.times[optimum.motion.intervals()]
}

/// The optimum of a free duration, and that of its own duration given, are one.
fn assert_as_given(system: &System, control: &Control) -> Optimum {
    let free = solved(system, control);
    let mut given = control.clone();
    given.duration = Duration::Given(duration(&free));
    let given = solved(system, &given);
    assert_eq!(
        [free.solution.status, given.solution.status],
        [Status::Solved; 2]
    );
    let [a, b] = [&free, &given].map(|optimum| optimum.solution.objective);
    assert!((a - b).abs() < 1e-8 * b, "{a} {b}");
    for (a, b) in free.motion.joints.iter().zip(&given.motion.joints) {
        let sizes = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(sizes.fold(0.0, f64::max) < 1e-8 * 1000.0, "{a:?} {b:?}");
    }
    for (a, b) in free.motion.voltages.iter().zip(&given.motion.voltages) {
        let sizes = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(sizes.fold(0.0, f64::max) < 1e-6, "{a:?} {b:?}");
    }
    free
}

#[test]
fn a_cart_in_a_growing_wind_takes_the_time_of_its_closed_form() {
    for coordinates in ["reduced", "redundant"] {
        assert_of_order_two(|intervals| pushed(intervals, coordinates), pushed_cost);
    }
}

#[test]
fn a_wind_in_time_is_that_of_the_duration_given() {
    let (system, control) = pushed(20, "reduced");
    let free = assert_as_given(&system, &control);
    for (k, row) in free.motion.voltages.iter().enumerate() {
        let time = (k as f64 + 0.5) / 20.0 * duration(&free);
        assert!((row[1] - 3e-3 * time).abs() < 1e-9, "{row:?} at {time} ms");
    }
}

/// The cart on a belt that swings by 0.4 m with a period of 2 s, and leads to 1 m along it at the end, in motion.
fn swung(intervals: usize, coordinates: &str) -> (System, Control) {
    let swing = Signal::Sine {
        mean: 0.0,
        amplitude: 400.0,
        frequency: 1.0 / 2000.0,
        phase: 0.0,
    };
    let (system, mut control) = carried(intervals, coordinates, swing);
    control.goal = BoundaryState::Free;
    control.waypoints = vec![Waypoint {
        part: 1.0,
        name: "end".to_owned(),
        angles: BTreeMap::from([(0, 1000.0)]),
        ..Waypoint::default()
    }];
    (system, freed(control))
}

/// Of the cart in space x(0) = 0, ẋ(0) = Ṡ(0), x(T) = 1 + S(T): the motor force is β (T − t).
fn swung_cost(t: f64) -> f64 {
    let (size, turns) = (0.4, TAU / 2.0);
    let way = 1.0 + size * (turns * t).sin() - size * turns * t;
    3.0 * way * way / t.powi(3) + PRICE * t
}

#[test]
fn a_cart_on_a_swinging_belt_takes_the_time_of_its_closed_form() {
    for coordinates in ["reduced", "redundant"] {
        assert_of_order_two(|intervals| swung(intervals, coordinates), swung_cost);
    }
    let (system, control) = swung(20, "reduced");
    let free = assert_as_given(&system, &control);
    for (k, joints) in free.motion.joints.iter().enumerate() {
        let time = k as f64 / 20.0 * duration(&free);
        let swing = 400.0 * (TAU * time / 2000.0).sin();
        assert!((joints[1] - swing).abs() < 1e-7, "{joints:?} at {time} ms");
    }
}

#[test]
fn a_voltage_in_time_leads_to_the_best_of_a_scan() {
    let system = trunk(2);
    let mut control = rest_to_rest(2, 20, 150.0);
    let voltage = Signal::Sine {
        mean: 300.0,
        amplitude: 250.0,
        frequency: 1.0 / 80.0,
        phase: 0.3,
    };
    control.given.insert(0, voltage);
    control.objective = Objective {
        rate: 1.0,
        duration: 2000.0,
        ..Objective::default()
    };
    let mut free = control.clone();
    free.duration = Duration::Free {
        min: 12.0,
        max: 600.0,
        guess: 150.0,
    };
    let best = cold(&system, &free);
    let (time, value) = (best.discrete.times[20], best.solution.objective);
    println!("{time} ms, {value}");
    assert!(time > 13.0 && time < 590.0);
    for factor in [0.9, 0.99, 1.0, 1.01, 1.1] {
        control.duration = Duration::Given(factor * time);
        let other = cold(&system, &control).solution.objective;
        println!("{factor}: {other}");
        match factor == 1.0 {
            true => assert!((other - value).abs() < 1e-8 * value, "{other} {value}"),
            false => assert!(other > value * (1.0 + 1e-5), "{factor}: {other} {value}"),
        }
    }
}

/// The number of iterations and the objective of a solve, from an earlier motion where there is one.
fn iterations(system: &System, control: &Control, earlier: Option<&Solution>) -> (usize, f64) {
    let limits = SolveLimits::default();
    let found = optimise(system, control, earlier, limits, &mut |_| {
        ControlFlow::Continue(())
    });
    let solution = found.unwrap().solution;
    assert_eq!(solution.status, Status::Solved);
    (solution.iterations.len(), solution.objective)
}

#[test]
fn costates_of_functions_of_time_are_carried_to_a_finer_grid() {
    for of in [pushed, swung] {
        let (system, control) = of(40, "reduced");
        let coarse = solved(&system, &control);
        let (system, control) = of(80, "reduced");
        let fine = solved(&system, &control);
        let h = duration(&coarse) / 80.0;
        let (model, boundary) = BoundaryConditions::resolve(&system, &control, h).unwrap();
        let initial = guess(&model, &boundary, &control, h, Some(&coarse.motion));
        let program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
        let rows = program.unknowns().rows.iter().enumerate();
        let rows = rows.filter(|(_, row)| matches!(row, Row::Time { .. }));
        let known = fine.motion.costates.as_ref().unwrap();
        let carried = initial.costates.as_ref().unwrap();
        let (mut apart, mut size, mut count) = (0.0, 0.0, 0);
        for (r, _) in rows {
            apart += (carried.rows[r] - known.rows[r]).powi(2);
            size += known.rows[r].powi(2);
            count += 1;
        }
        let apart = f64::sqrt(apart / size);
        let [cold, warm] =
            [None, Some(&coarse.motion)].map(|earlier| iterations(&system, &control, earlier));
        println!(
            "{count} of size {}, apart by {apart}; {cold:?} {warm:?}",
            size.sqrt()
        );
        assert!(count == 80 && size > 1e-12 && apart < 0.15);
        assert!(warm.0 < cold.0 && (warm.1 - cold.1).abs() < 1e-8 * cold.1);
    }
}

#[test]
fn a_motion_that_is_too_short_is_told_the_least_time_in_its_wind() {
    // The motor pushes with 10 N until s and brakes then; the wind is 8 N/s t.
    let (limit, a) = (10.0, 8.0);
    let place = |t: f64| {
        let s = t / 2.0 - a * t * t / (4.0 * limit);
        limit * (s * t - s * s / 2.0 - (t - s).powi(2) / 2.0) + a * t.powi(3) / 6.0
    };
    let (exact, _) = least(|t| (place(t) - 1.0).powi(2), [0.3, 1.0]);
    let in_calm = 2.0 / f64::sqrt(limit);
    assert!((place(exact) - 1.0).abs() < 1e-6 && (exact / in_calm - 1.0).abs() > 0.03);
    let (system, mut control) = pushed(40, "reduced");
    control.duration = Duration::Given(400.0);
    control.load_bounds.insert(0, [-limit, limit]);
    control.given.insert(1, Signal::ramp(0.0, 80.0, 10_000.0));
    let found = solved(&system, &control);
    println!("{exact} s, {in_calm} s in calm: {:?}", found.shortest);
    let Shortest::Longer(time) = found.shortest else {
        panic!("{:?}", found.shortest);
    };
    assert!((time / 1e3 / exact - 1.0).abs() < 3e-3, "{time} ms");
}

#[test]
fn a_goal_rests_behind_the_end_of_a_ramp_and_not_within_it() {
    // The corners of the ramp lie between two instants.
    let (system, control) = carried(20, "reduced", Signal::ramp(0.0, 500.0, 480.0));
    let mut control = freed(control);
    control.duration = Duration::Free {
        min: 480.0,
        max: 4000.0,
        guess: 1000.0,
    };
    let free = assert_as_given(&system, &control);
    let h = duration(&free) / 20.0;
    assert!(h > 30.0 && (480.0 / h).fract() > 0.05 && (480.0 / h).fract() < 0.95);
    for (k, joints) in free.motion.joints.iter().enumerate() {
        let belt = f64::min(500.0, k as f64 * h / 480.0 * 500.0);
        assert!((joints[1] - belt).abs() < 1e-7, "{joints:?} at instant {k}");
    }
}
