//! Gains and delay of the inputs of recordings, of an oscillator under a force that is switched on.

use crate::derivatives::{compare, pair};
use crate::oscillator::{
    DAMPING, STIFFNESS, joint, parameter, parameters, place, slide, system, task, times,
};
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::{Grid, Problem, Unknowns, identify};
use proboscis::math::Random;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::{Constant, Parameter, Quantity, System};

/// Force in N that recordings say, and the time in ms at which it sets in.
const FORCE: f64 = 1.5;
const ONSET: f64 = 10.0;
/// A time at which no grid has an instant.
const OFF_GRID: f64 = 10.314_159;
/// True gain and delay in ms.
const GAIN: f64 = 1.2;
const DELAY: f64 = 7.3;

fn pulled() -> System {
    let mut system = system();
    system.components.loads.push(Load {
        name: "force".into(),
        on: LoadPlace::Joint(0),
    });
    system
}

fn at_rest() -> BoundaryState {
    BoundaryState::RestAtVoltages(vec![0.0], Default::default())
}

fn step(onset: f64, deviation: f64, random: &mut Random) -> Recording {
    let force = Signal::Ramp {
        from: 0.0,
        to: FORCE,
        start: onset,
        duration: 0.0,
    };
    let still = GAIN * FORCE / STIFFNESS;
    let reading = |time: f64| {
        let since = time - onset - DELAY;
        let moved = match since > 0.0 {
            true => still + place(since, [STIFFNESS, DAMPING], [-still, 0.0]),
            false => 0.0,
        };
        Reading {
            time,
            value: moved + deviation * random.normal(),
            deviation,
        }
    };
    Recording {
        name: "step".into(),
        scene: None,
        regime: Regime::Motion,
        voltages: Voltages::from(vec![force]),
        start: at_rest(),
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels: vec![slide(
            times(81, 200.0).into_iter().map(reading).collect(),
            true,
        )],
    }
}

fn sought(recording: Recording) -> Identification {
    let delay = Parameter {
        lower: 0.0,
        upper: 40.0,
        ..parameter("delay", Constant::Delay(0), 1.0)
    };
    Identification {
        parameters: [
            parameters(),
            vec![parameter("gain", Constant::Gain(0), 1.0), delay],
        ]
        .concat(),
        ..task(vec![recording])
    }
}

#[test]
fn a_shifted_motion_depends_on_gain_and_delay_as_derivatives_say() {
    let mut recording = step(ONSET, 1.0, &mut Random::new(1));
    recording.voltages = Voltages::from(vec![Signal::ramp(0.3, FORCE, 90.0)]);
    recording.start = BoundaryState::RestAtVoltages(vec![0.3], Default::default());
    let unknowns = Unknowns::of_values(&[0.22, 0.5, 1.1, 6.17], &[&[]]);
    let largest = compare(&pulled(), &sought(recording), &unknowns);
    assert!(largest.iter().all(|size| *size > 0.1), "{largest:?}");
}

#[test]
fn gain_and_delay_of_a_force_are_recovered_with_stiffness_and_damping() {
    let recording = step(ONSET, 0.02, &mut Random::new(3));
    let found = identify(&pulled(), &sought(recording), &mut |_, _| {}).unwrap();
    let truth = [STIFFNESS, DAMPING, GAIN, DELAY];
    for (j, truth) in truth.into_iter().enumerate() {
        let error = found.information.covariance[(j, j)].sqrt();
        let value = found.fit.of_constants()[j];
        println!("{j}: {value} ± {error} of {truth}");
        assert!(error > 0.0 && error < 0.02 * truth, "{j}: {error}");
        assert!((value - truth).abs() < 3.5 * error, "{j}: {value} {truth}");
    }
    assert!(found.is_white() && found.bias.is_confirmed);
}

#[test]
fn a_force_that_sets_in_between_instants_leaves_no_bias_unseen() {
    let recording = step(OFF_GRID, 0.8, &mut Random::new(5));
    let found = identify(&pulled(), &sought(recording), &mut |_, _| {}).unwrap();
    let error = found.information.covariance[(3, 3)].sqrt();
    let value = found.fit.of_constants()[3];
    println!("{value} ± {error}, {:?}", found.bias);
    assert!(error < 0.2 * DELAY);
    assert!(found.bias.is_confirmed && (value - DELAY).abs() < 3.5 * error);
    // A grid whose steps are halved alone has the corner in the same part of an interval each time.
    let intervals = &found.grid.intervals;
    assert!(intervals.iter().all(|n| n % 2 == 1), "{intervals:?}");
}

#[test]
fn a_delayed_motion_from_any_start_depends_on_gain_and_delay_as_derivatives_say() {
    let base = || step(ONSET, 1.0, &mut Random::new(1));
    let moving = Recording {
        start: joint(0.0, 0.01),
        ..base()
    };
    let mut open = base();
    open.sought_start = SoughtStart::State;
    let mut rates = base();
    rates.channels[0].parts = vec![(1.0, Quantity::joint_rate(0))];
    let of_start: [&[f64]; 3] = [&[], &[0.1, 0.4], &[]];
    for (recording, of_start) in [moving, open, rates].into_iter().zip(of_start) {
        let unknowns = Unknowns::of_values(&[0.22, 0.5, 1.1, 6.17], &[of_start]);
        let largest = compare(&pulled(), &sought(recording), &unknowns);
        assert!(largest.iter().all(|size| *size > 1e-3), "{largest:?}");
    }
}

/// Two muscles beside a joint whose drivers have delays of their own; the second one is switched on.
fn of_two_drivers() -> (System, Identification) {
    let rest = BoundaryState::RestAtVoltages(vec![1200.0, 0.0], Default::default());
    let (system, mut task) = pair(rest, SoughtStart::Nothing, Regime::Motion);
    task.parameters.truncate(1);
    for source in 0..2 {
        task.parameters.push(Parameter {
            lower: 0.0,
            upper: 40.0,
            ..parameter("delay", Constant::Delay(source), 5.0 + 4.0 * source as f64)
        });
        task.parameters[1 + source].name = format!("delay {source}");
    }
    let switched = Signal::Ramp {
        from: 0.0,
        to: 900.0,
        start: 31.0,
        duration: 0.0,
    };
    task.recordings[0].voltages = Voltages::from(vec![Signal::ramp(1200.0, 300.0, 60.0), switched]);
    (system, task)
}

#[test]
fn each_driver_has_a_delay_of_its_own() {
    let (system, task) = of_two_drivers();
    let unknowns = Unknowns::of_values(&[0.11, 4.3, 9.6], &[&[]]);
    let largest = compare(&system, &task, &unknowns);
    assert!(largest.iter().all(|size| *size > 1e-3), "{largest:?}");
}

/// Readings of a motion under voltages that are delayed by hand.
fn by_hand(truth: [f64; 3]) -> (System, Identification) {
    let (system, mut task) = of_two_drivers();
    let mut known = task.clone();
    known.parameters.truncate(1);
    let table = |delay: f64| Signal::Table {
        times: vec![delay, delay + 60.0],
        values: vec![1200.0, 300.0],
    };
    let switched = Signal::Ramp {
        from: 0.0,
        to: 900.0,
        start: 31.0 + truth[2],
        duration: 0.0,
    };
    known.recordings[0].voltages = Voltages::from(vec![table(truth[1]), switched]);
    let unknowns = Unknowns::of_values(&truth[..1], &[&[]]);
    let mut grid = Grid::first(&known, &known.recordings);
    // Voltages switch at instants.
    grid.intervals = vec![3600];
    let seen = Problem {
        system: &system,
        task: &known,
    }
    .predict(&[0], &unknowns, &grid)
    .unwrap()
    .values;
    let channels = task.recordings[0].channels.iter_mut();
    let readings = channels.flat_map(|one| &mut one.readings);
    for (reading, value) in readings.zip(seen.iter()) {
        reading.value = *value;
        reading.deviation = 1e-3;
    }
    (system, task)
}

#[test]
fn delays_of_two_drivers_are_recovered() {
    let truth = [0.11, 6.7, 12.9];
    let (system, task) = by_hand(truth);
    let found = identify(&system, &task, &mut |_, _| {}).unwrap();
    for (j, truth) in truth.into_iter().enumerate() {
        let error = found.information.covariance[(j, j)].sqrt();
        let value = found.fit.of_constants()[j];
        println!("{j}: {value} ± {error} of {truth}");
        assert!(error > 0.0 && error < 0.05 * truth, "{j}: {error}");
        assert!(
            (value - truth).abs() < 0.2 * error,
            "{j}: {value} {truth} ± {error}"
        );
    }
    assert!(found.bias.is_confirmed, "{:?}", found.bias);
}

#[test]
fn a_switched_voltage_moves_a_muscle_later_by_its_square() {
    // The modulus of the muscle is sought too.
    let truth = [0.11, 6.7, 12.9];
    let values = |delay: f64| -> Vec<f64> {
        let (_, task) = by_hand([truth[0], truth[1], delay]);
        let readings = task.recordings[0]
            .channels
            .iter()
            .flat_map(|one| &one.readings);
        readings.map(|reading| reading.value).collect()
    };
    let [before, after] = [-0.3, 0.3].map(|change| values(truth[2] + change));
    let expected: Vec<f64> = after
        .iter()
        .zip(&before)
        .map(|(a, b)| (a - b) / 0.6)
        .collect();
    let (system, task) = of_two_drivers();
    let mut grid = Grid::first(&task, &task.recordings);
    grid.intervals = vec![301];
    let unknowns = Unknowns::of_values(&truth, &[&[]]);
    let found = Problem {
        system: &system,
        task: &task,
    }
    .predict(&[0], &unknowns, &grid)
    .unwrap();
    let largest = expected
        .iter()
        .fold(0.0, |most: f64, slope| most.max(slope.abs()));
    assert!(largest > 1e-4, "{largest}");
    for (own, expected) in found.derivatives.column(2).iter().zip(&expected) {
        assert!(
            (own - expected).abs() < 0.01 * largest,
            "{own} {expected} of {largest}"
        );
    }
}
