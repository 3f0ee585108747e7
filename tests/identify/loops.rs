//! Recordings of closed loops: states of rest and unknown starts under constraints.

use crate::derivatives::{all, all_act_as_they_say, channel, of_pair_in, readings};
use crate::oscillator::{self, joint};
use nalgebra::DVector;
use proboscis::Signal;
use proboscis::control::problem::{BoundaryState, Identification, Recording, Regime, SoughtStart};
use proboscis::files::read_problem;
use proboscis::identify::{Grid, Problem, Unknowns};
use proboscis::model::system::ElectricConstants;
use proboscis::model::{Coordinates, MaterialConstant, Quantity, System};
use std::path::Path;

/// Crank, coupler and rocker, with muscles.
fn four_bar() -> System {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let loaded = read_problem(&root.join("problems/four_bar.json"), &[]).unwrap();
    loaded.system
}

/// Recordings of the four-bar with two muscles, at rest or in motion.
fn task(
    system: &System,
    (start, sought_start): (BoundaryState, SoughtStart),
    regime: Regime,
) -> Identification {
    let count = system.muscles.len();
    let sine = |mean: f64| Signal::Sine {
        mean,
        amplitude: 300.0,
        frequency: 0.012,
        phase: 0.3,
    };
    let of_joint =
        |joint: usize| channel(vec![(1.0, Quantity::joint(joint, 0.0))], readings(7, 80.0));
    let voltages = (0..system.sources().len()).map(|source| sine(900.0 - 100.0 * source as f64));
    Identification {
        parameters: vec![
            all("modulus", MaterialConstant::ShearModulus, count, 0.1),
            oscillator::permittivity(count, ElectricConstants::first_order, 3.2),
        ],
        recordings: vec![Recording {
            name: "linkage".into(),
            scene: None,
            regime,
            voltages: voltages.collect::<Vec<_>>().into(),
            start,
            sought_start,
            is_held_out: false,
            channels: vec![of_joint(0), of_joint(1)],
        }],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(5.0),
        coordinates: None,
    }
}

fn as_derivatives_say(start: (BoundaryState, SoughtStart), regime: Regime, of_start: &[f64]) {
    let system = four_bar();
    all_act_as_they_say(&system, &task(&system, start, regime), of_start);
}

#[test]
fn states_of_rest_of_a_loop_depend_on_constants_as_their_derivatives_say() {
    let nothing = SoughtStart::Nothing;
    as_derivatives_say((joint(0.0, 0.0), nothing), Regime::Rest, &[]);
    let rest = BoundaryState::RestAtVoltages(vec![1200.0, 0.0], Default::default());
    as_derivatives_say((rest, nothing), Regime::Motion, &[]);
}

#[test]
fn an_unknown_start_of_a_loop_moves_as_its_derivatives_say() {
    let start = (joint(0.0, 0.0), SoughtStart::State);
    as_derivatives_say(start, Regime::Motion, &[0.02, 3.0]);
}

#[test]
fn a_tree_in_redundant_coordinates_moves_as_its_derivatives_say() {
    let redundant = Some(Coordinates::Redundant);
    let still = joint(0.0, 0.0);
    let rest = BoundaryState::RestAtVoltages(vec![1200.0, 0.0], Default::default());
    of_pair_in(
        redundant,
        (still.clone(), SoughtStart::Nothing),
        Regime::Rest,
        &[],
    );
    of_pair_in(redundant, (rest, SoughtStart::Nothing), Regime::Motion, &[]);
    of_pair_in(
        redundant,
        (still, SoughtStart::State),
        Regime::Motion,
        &[0.3, 2.0],
    );
}

#[test]
fn both_coordinates_tell_the_same_of_states_of_rest() {
    let of = |coordinates| {
        let (system, mut task) =
            crate::derivatives::pair(joint(0.0, 0.0), SoughtStart::Nothing, Regime::Rest);
        task.coordinates = coordinates;
        let values: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
        let grid = Grid::first(&task, &task.recordings);
        let unknowns = Unknowns::of_values(&values, &[&[]]);
        Problem {
            system: &system,
            task: &task,
        }
        .predict(&[0], &unknowns, &grid)
        .unwrap()
    };
    let (reduced, redundant) = (of(None), of(Some(Coordinates::Redundant)));
    let distance = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax() / a.amax();
    assert!(reduced.values.amax() > 1e-3);
    assert!(distance(&reduced.values, &redundant.values) < 1e-9);
    for j in 0..reduced.derivatives.ncols() {
        let [a, b] = [&reduced, &redundant].map(|one| one.derivatives.column(j).into_owned());
        assert!(distance(&a, &b) < 1e-8, "{j}");
    }
}
