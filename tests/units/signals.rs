//! Values of functions of time.

use proboscis::Signal;

#[test]
fn signals_are_what_they_say() {
    let ramp = Signal::Ramp {
        from: 100.0,
        to: 300.0,
        start: 10.0,
        duration: 20.0,
    };
    let table = Signal::Table {
        times: vec![10.0, 30.0],
        values: vec![100.0, 300.0],
    };
    for (time, expected) in [
        (0.0, 100.0),
        (10.0, 100.0),
        (15.0, 150.0),
        (30.0, 300.0),
        (99.0, 300.0),
    ] {
        assert_eq!(ramp.at(time), expected);
        assert_eq!(table.at(time), expected);
    }
    let step = Signal::ramp(0.0, 5.0, 0.0);
    assert_eq!([step.at(-1.0), step.at(0.0)], [0.0, 5.0]);
    let sine = Signal::Sine {
        mean: 2.0,
        amplitude: 3.0,
        frequency: 0.25,
        phase: 0.0,
    };
    assert!((sine.at(1.0) - 5.0).abs() < 1e-12 && (sine.at(3.0) + 1.0).abs() < 1e-12);
    assert!(ramp.is_sound() && !Signal::ramp(0.0, f64::NAN, 1.0).is_sound());
    let unsorted = Signal::Table {
        times: vec![1.0, 1.0],
        values: vec![0.0, 0.0],
    };
    assert!(!unsorted.is_sound() && unsorted.is_zero());
}

#[test]
fn functions_know_their_jumps_and_where_they_are_constant() {
    let ramp = |duration: f64| Signal::Ramp {
        from: 1.0,
        to: 3.0,
        start: 10.0,
        duration,
    };
    assert_eq!([ramp(0.0).jump(), ramp(5.0).jump()], [Some(10.0), None]);
    assert_eq!(Signal::ramp(2.0, 2.0, 0.0).jump(), None);
    let table = Signal::Table {
        times: vec![10.0, 12.0, 15.0],
        values: vec![1.0, 5.0, 1.0],
    };
    for (function, range, expected) in [
        (ramp(5.0), [0.0, 10.0], Some(1.0)),
        (ramp(5.0), [9.0, 10.5], None),
        (ramp(5.0), [15.0, 99.0], Some(3.0)),
        (table.clone(), [9.0, 16.0], None),
        (table, [15.0, 16.0], Some(1.0)),
        (Signal::Constant(4.0), [0.0, 9.0], Some(4.0)),
    ] {
        assert_eq!(function.constant_within(range), expected, "{range:?}");
    }
    // A whole period apart, and not the same between.
    let sine = |amplitude: f64| Signal::Sine {
        mean: 2.0,
        amplitude,
        frequency: 0.25,
        phase: 0.0,
    };
    assert_eq!(sine(3.0).constant_within([0.0, 4.0]), None);
    assert_eq!(sine(0.0).constant_within([0.0, 4.0]), Some(2.0));
}
