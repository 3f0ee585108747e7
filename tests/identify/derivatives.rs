//! Derivatives of predictions against differences.

use crate::common::trunk;
use crate::oscillator::{self, joint, times};
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Channel, Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::{Grid, Problem, Unknowns};
use proboscis::model::system::ElectricConstants;
use proboscis::model::{
    Constant, Coordinates, Follower, MaterialConstant, MaxwellBranch, MaxwellBranches, Parameter,
    Quantity, System,
};

pub(crate) fn readings(count: usize, last: f64) -> Vec<Reading> {
    let reading = |time| Reading {
        time,
        value: 0.0,
        deviation: 1.0,
    };
    times(count, last).into_iter().map(reading).collect()
}

pub(crate) fn channel(parts: Vec<(f64, Quantity)>, readings: Vec<Reading>) -> Channel {
    Channel {
        name: format!("{parts:?}"),
        parts,
        unit: ("", 1.0),
        is_deviation_known: true,
        readings,
    }
}

/// Compares the derivatives by all unknowns with central differences, and returns the largest of each.
pub(crate) fn compare(system: &System, task: &Identification, unknowns: &Unknowns) -> Vec<f64> {
    let which: Vec<usize> = (0..task.recordings.len()).collect();
    let grid = Grid::first(task, &task.recordings);
    let at = |unknowns: &Unknowns| {
        Problem { system, task }
            .predict(&which, unknowns, &grid)
            .unwrap()
    };
    let found = at(unknowns);
    let mut largest = Vec::new();
    for j in 0..unknowns.values.len() {
        let size = unknowns.values[j].abs().max(0.1);
        let moved = |by: f64| {
            let mut moved = unknowns.clone();
            moved.values[j] += by;
            at(&moved).values
        };
        let step = 1e-4 * size;
        let slope = |h: f64| (moved(h) - moved(-h)) / (2.0 * h);
        // Of fourth order.
        let expected = (slope(0.5 * step) * 4.0 - slope(step)) / 3.0;
        let own = found.derivatives.column(j);
        largest.push(expected.amax() * size);
        // Each channel has a scale of its own.
        let mut row = 0;
        for channel in task.recordings.iter().flat_map(|one| &one.channels) {
            let count = channel.readings.len();
            let [own, expected] = [own.rows(row, count), expected.rows(row, count)];
            let values = found.values.rows(row, count).amax();
            let scale = expected.amax().max(0.1 * values / size);
            for (a, b) in own.iter().zip(expected.iter()) {
                let name = &channel.name;
                assert!(
                    (a - b).abs() <= 2e-7 * scale,
                    "{j}, {name}: {a} against {b}"
                );
            }
            row += count;
        }
    }
    largest
}

#[test]
fn an_oscillator_with_an_unknown_start_moves_as_its_derivatives_say() {
    let system = oscillator::system();
    let mut recording = oscillator::recording("free", [5.0, 0.1], (12, 200.0), None);
    recording.sought_start = SoughtStart::State;
    let rate = Quantity::joint_rate(0);
    recording
        .channels
        .push(channel(vec![(2.0, rate)], readings(7, 150.0)));
    let task = oscillator::task(vec![recording]);
    let unknowns = Unknowns::of_values(&[0.23, 0.5], &[&[0.3, -0.8]]);
    let largest = compare(&system, &task, &unknowns);
    assert!(largest.iter().all(|size| *size > 0.01), "{largest:?}");
}

pub(crate) fn all(name: &str, constant: MaterialConstant, count: usize, guess: f64) -> Parameter {
    Parameter {
        constants: (0..count)
            .map(|m| Follower::from(constant.of_muscle(m)))
            .collect(),
        ..oscillator::parameter(name, constant.of_muscle(0), guess)
    }
}

/// Two muscles beside a joint, under voltages that change, from a state of rest that depends on the constants.
pub(crate) fn pair(
    start: BoundaryState,
    sought_start: SoughtStart,
    regime: Regime,
) -> (System, Identification) {
    let mut system = trunk(1);
    for muscle in &mut system.muscles {
        muscle.material.density = None;
    }
    let count = system.muscles.len();
    let mut parameters = vec![
        all("modulus", MaterialConstant::ShearModulus, count, 0.1),
        oscillator::permittivity(count, ElectricConstants::first_order, 3.2),
    ];
    parameters.push(oscillator::parameter("gain", Constant::Gain(0), 0.9));
    if regime == Regime::Motion {
        parameters.push(all("viscosity", MaterialConstant::Viscosity, count, 0.8));
    }
    let sine = |mean: f64| Signal::Sine {
        mean,
        amplitude: 400.0,
        frequency: 0.012,
        phase: 0.3,
    };
    let mut channels = vec![channel(
        vec![(1.0, Quantity::joint(0, 0.0))],
        readings(9, 120.0),
    )];
    if !system.markers.is_empty() {
        let place = |axis| Quantity::marker_place(0, axis);
        channels.push(channel(
            vec![(0.6, place(0)), (0.8, place(1))],
            readings(5, 110.0),
        ));
    }
    let recording = Recording {
        name: "pair".into(),
        scene: None,
        regime,
        voltages: Voltages::from(vec![sine(900.0), sine(300.0)]),
        start,
        sought_start,
        is_held_out: false,
        channels,
    };
    let task = Identification {
        parameters,
        recordings: vec![recording],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(6.0),
        coordinates: None,
    };
    (system, task)
}

fn of_pair(start: BoundaryState, sought: SoughtStart, regime: Regime, of_start: &[f64]) {
    of_pair_in(None, (start, sought), regime, of_start);
}

/// The same in given coordinates.
pub(crate) fn of_pair_in(
    coordinates: Option<Coordinates>,
    (start, sought): (BoundaryState, SoughtStart),
    regime: Regime,
    of_start: &[f64],
) {
    let (system, mut task) = pair(start, sought, regime);
    task.coordinates = coordinates;
    all_act_as_they_say(&system, &task, of_start);
}

/// Compares the derivatives of a task of one recording beside its guesses, by all of which it has some.
pub(crate) fn all_act_as_they_say(system: &System, task: &Identification, of_start: &[f64]) {
    let values: Vec<f64> = task.parameters.iter().map(|p| 1.1 * p.guess).collect();
    let unknowns = Unknowns::of_values(&values, &[of_start]);
    let largest = compare(system, task, &unknowns);
    println!("{largest:?}");
    assert!(largest.iter().all(|size| *size > 1e-4), "{largest:?}");
}

#[test]
fn muscles_move_as_their_derivatives_say() {
    of_pair(joint(0.1, 0.0), SoughtStart::Nothing, Regime::Motion, &[]);
    of_pair(
        joint(0.1, 2e-3),
        SoughtStart::State,
        Regime::Motion,
        &[0.02, 90.0],
    );
}

#[test]
fn a_motion_from_rest_depends_on_constants_by_its_start_too() {
    let rest = BoundaryState::RestAtVoltages(vec![1200.0, 0.0], Default::default());
    of_pair(rest.clone(), SoughtStart::Nothing, Regime::Motion, &[]);
    of_pair(rest, SoughtStart::Coordinates, Regime::Motion, &[0.05]);
}

/// What muscles with branches remember at rest depends on their lengths and ends.
#[test]
fn muscles_that_creep_from_rest_depend_on_their_prestretch_and_ends() {
    let rest = BoundaryState::RestAtVoltages(vec![1200.0, 0.0], Default::default());
    let (mut system, mut task) = pair(rest, SoughtStart::Nothing, Regime::Motion);
    let branch = MaxwellBranch {
        shear_modulus: 0.04,
        relaxation_time: 25.0,
    };
    for muscle in &mut system.muscles {
        muscle.prestretch = Some(1.2);
        muscle.material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    }
    task.parameters.extend([
        oscillator::parameter("prestretch", Constant::Prestretch(1), 1.2),
        oscillator::parameter("end", Constant::End(0, 1, 0), 15.0),
    ]);
    all_act_as_they_say(&system, &task, &[]);
}

#[test]
fn states_of_rest_depend_on_constants_as_their_derivatives_say() {
    of_pair(joint(0.0, 0.0), SoughtStart::Nothing, Regime::Rest, &[]);
}
