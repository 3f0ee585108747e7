//! Places of joints, bodies and markers as free parameters.

use crate::common::trunk;
use crate::derivatives::{channel, compare, readings};
use crate::forces::converged;
use crate::oscillator::{self, DAMPING, STIFFNESS, joint, parameter};
use nalgebra::Vector3;
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Identification, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::Unknowns;
use proboscis::model::system::{Attachment, Marker, System};
use proboscis::model::{Constant, Parameter, Quantity};

/// A place between bounds on both sides of it.
fn place(name: &str, constant: Constant, guess: f64) -> Parameter {
    Parameter {
        lower: guess - 20.0,
        upper: guess + 20.0,
        ..parameter(name, constant, guess)
    }
}

/// The places of the tip of two segments under voltages that change, by a joint, the marker and an end of a muscle.
fn task(
    start: BoundaryState,
    (sought_start, regime): (SoughtStart, Regime),
) -> (System, Identification) {
    let mut system = trunk(2);
    for muscle in &mut system.muscles {
        muscle.material.density = None;
    }
    let tip = system.markers.len() - 1;
    let sine = |mean: f64, phase: f64| Signal::Sine {
        mean,
        amplitude: 0.4 * mean,
        frequency: 0.012,
        phase,
    };
    let voltages = [(900.0, 0.3), (1200.0, 1.0), (1100.0, 2.0), (600.0, 0.0)];
    let of_tip = |axis| Quantity::marker_place(tip, axis);
    let turned = Quantity::joint(1, 0.0);
    let recording = Recording {
        name: "tip".into(),
        scene: None,
        regime,
        voltages: Voltages::from(voltages.map(|(mean, phase)| sine(mean, phase)).to_vec()),
        start,
        sought_start,
        is_held_out: false,
        channels: vec![
            channel(vec![(0.6, of_tip(0)), (0.8, of_tip(1))], readings(7, 90.0)),
            channel(vec![(1.0, turned)], readings(5, 80.0)),
        ],
    };
    let at = system.joints[1].at;
    let marker = system.markers[tip].point.at;
    let arm = system.muscles[0].to.at;
    let task = Identification {
        parameters: vec![
            place("joint", Constant::JointPlace(1, 2), at[2]),
            place("along", Constant::JointPlace(1, 1), at[1]),
            place("marker", Constant::MarkerPlace(tip, 0), marker[0]),
            place("arm", Constant::End(0, 1, 0), arm[0]),
        ],
        recordings: vec![recording],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(5.0),
        coordinates: None,
    };
    (system, task)
}

fn moved((system, task): &(System, Identification), of_start: &[f64]) {
    let values: Vec<f64> = task.parameters.iter().map(|p| p.guess + 1.5).collect();
    let largest = compare(system, task, &Unknowns::of_values(&values, &[of_start]));
    println!("{largest:?}");
    assert!(largest.iter().all(|size| *size > 1e-3), "{largest:?}");
}

#[test]
fn a_motion_depends_on_places_as_its_derivatives_say() {
    let given = (SoughtStart::Nothing, Regime::Motion);
    moved(&task(joint(0.1, 0.0), given), &[]);
    let rest = BoundaryState::RestAtVoltages(vec![900.0, 100.0, 0.0, 500.0], Default::default());
    moved(&task(rest, given), &[]);
}

#[test]
fn states_of_rest_depend_on_places_as_their_derivatives_say() {
    let still = (SoughtStart::Nothing, Regime::Rest);
    moved(&task(joint(0.0, 0.0), still), &[]);
}

/// A marker that stands 3 mm beside its place in the scene, on a cart whose motion is known in closed form.
#[test]
fn the_place_of_a_marker_comes_back_with_stiffness_and_damping() {
    const BESIDE: f64 = 3.0;
    let mut system = oscillator::system();
    system.markers.push(Marker {
        name: "mark".into(),
        point: Attachment {
            body: Some(0),
            at: Vector3::zeros(),
        },
        solid: None,
    });
    let mut recording = oscillator::recording("free", [5.0, 0.0], (60, 300.0), None);
    let channel = &mut recording.channels[0];
    channel.parts = vec![(1.0, Quantity::marker_place(0, 0))];
    for reading in &mut channel.readings {
        (reading.value, reading.deviation) = (reading.value + BESIDE, 1e-3);
    }
    let mut task = oscillator::task(vec![recording]);
    task.parameters
        .push(place("marker", Constant::MarkerPlace(0, 0), 0.0));
    let found = converged(&system, &task, 236);
    let truth = [STIFFNESS, DAMPING, BESIDE];
    for (value, truth) in found.of_constants().iter().zip(truth) {
        assert!((value / truth - 1.0).abs() < 1e-4, "{value} {truth}");
    }
}
