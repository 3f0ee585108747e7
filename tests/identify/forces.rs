//! Forces, charges, currents and voltages as measured quantities: their derivatives, their values beside those of tables, and constants that
//! come back from them.

use crate::common::{self, trunk};
use crate::derivatives::{all, channel, compare, readings};
use crate::oscillator::{joint, parameter, permittivity};
use nalgebra::Vector3;
use proboscis::Signal;
use proboscis::control::problem::{
    Channel, Identification, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::dynamics::{observations, simulate};
use proboscis::identify::{Ended, Fit, Grid, Problem, Unknowns};
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::ElectricConstants;
use proboscis::model::{
    Constant, MaterialConstant, MaxwellBranch, MaxwellBranches, Model, Pulling, Quantity, Reaction,
    System, What, with_parameters,
};

/// A trunk of two segments with a spring, a damper and a tendon; a muscle with a Maxwell branch, one behind a resistor with a leak, one under a
/// voltage, and one with a given charge.
fn system() -> System {
    let mut system = common::systems::tied(trunk(2));
    let branch = MaxwellBranch {
        shear_modulus: 0.04,
        relaxation_time: 25.0,
    };
    system.muscles[0].material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    system.muscles[1] = system.muscles[1].clone().resistance(3e5).leakage(2e6);
    system.components.loads.push(Load {
        name: "charge".into(),
        on: LoadPlace::Muscle(3),
    });
    system
}

fn reaction(joint: usize, of: Reaction) -> Quantity {
    Quantity::jump(
        What::Reaction {
            joint,
            of,
            along: Vector3::new(0.6, 0.0, 0.8),
        },
        1.0,
        1.0,
    )
}

/// Every quantity, with its column in tables and the factor of the column.
fn quantities() -> Vec<(Quantity, Vec<(&'static str, f64)>)> {
    let tension = |muscle, column| {
        (
            Quantity::tension(Pulling::Muscle(muscle)),
            vec![(column, 1.0)],
        )
    };
    let step = Quantity::jump(What::MeanCharge(2), 1.0, 1.0);
    let current = Quantity::of(What::Current(1));
    vec![
        tension(0, "muscle1_tension"),
        tension(1, "muscle2_tension"),
        tension(2, "muscle3_tension"),
        tension(3, "muscle4_tension"),
        (
            Quantity::tension(Pulling::Tendon(0)),
            vec![("cord_tension", 1.0)],
        ),
        (
            Quantity::of(What::MeanCharge(2)),
            vec![("muscle3_charge", 1.0)],
        ),
        (step, vec![("muscle3_current", 1.0)]),
        (current, vec![("muscle2_current", 1.0)]),
        (
            Quantity::of(What::ElectrodeVoltage(1)),
            vec![("muscle2_voltage", 1.0)],
        ),
        (Quantity::power(1), vec![("muscle2_power", 1.0)]),
        (
            reaction(0, Reaction::Force),
            vec![("joint1_force_x", 0.6), ("joint1_force_z", 0.8)],
        ),
        (
            reaction(1, Reaction::Torque),
            vec![("joint2_torque_x", 0.6), ("joint2_torque_z", 0.8)],
        ),
    ]
}

/// Those that tables do not have: of a spring with a damper, and of a charge behind a resistor.
fn others() -> [Quantity; 3] {
    [
        Quantity::tension(Pulling::Spring(0)),
        Quantity::tension(Pulling::Spring(1)),
        Quantity::of(What::Charge(1)),
    ]
}

fn recording(channels: Vec<Channel>, regime: Regime) -> Recording {
    let sine = |mean: f64, phase: f64| Signal::Sine {
        mean,
        amplitude: 0.4 * mean,
        frequency: 0.012,
        phase,
    };
    let voltages = [(900.0, 0.3), (1200.0, 1.0), (1100.0, 2.0), (600.0, 0.0)];
    let signals = voltages.map(|(mean, phase)| sine(mean, phase)).to_vec();
    let signals = [&signals[..], &[sine(2e-3, 0.7)]].concat();
    Recording {
        name: "two segments".into(),
        scene: None,
        regime,
        voltages: Voltages::from(signals),
        start: joint(if regime == Regime::Rest { 0.0 } else { 0.1 }, 0.0),
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels,
    }
}

fn task(recording: Recording, is_of_motion: bool) -> Identification {
    let first =
        |name, constant: MaterialConstant, guess| parameter(name, constant.of_muscle(0), guess);
    let mut parameters = vec![
        all("modulus", MaterialConstant::ShearModulus, 4, 0.1),
        permittivity(4, ElectricConstants::first_order, 3.2),
        parameter("leak", Constant::Leakage(1), 2e6),
        parameter("layer", Constant::Layer(2), 0.05),
        parameter("arm", Constant::End(2, 1, 2), 15.0),
        parameter("stiffness", Constant::SpringStiffness(0), 0.02),
        parameter("length", Constant::SpringLength(0), 40.0),
        parameter("end", Constant::SpringEnd(0, 1, 1), 80.0),
        parameter("cord", Constant::TendonStiffness(0), 0.01),
        parameter("slack", Constant::TendonLength(0), 80.0),
        parameter("first gain", Constant::Gain(0), 1.1),
        parameter("gain behind a resistor", Constant::Gain(1), 0.9),
        parameter("third gain", Constant::Gain(2), 0.95),
        parameter("gain of the charge", Constant::Gain(4), 1.05),
    ];
    if is_of_motion {
        parameters.extend([
            all("viscosity", MaterialConstant::Viscosity, 4, 0.8),
            first("branch", MaterialConstant::BranchModulus(0), 0.04),
            first("time", MaterialConstant::RelaxationTime(0), 25.0),
            parameter("series", Constant::Resistance(1), 3e5),
            parameter("damping", Constant::SpringDamping(0), 0.4),
            parameter("mass", Constant::Mass(1), 30.0),
        ]);
    }
    Identification {
        parameters,
        recordings: vec![recording],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(5.0),
        coordinates: None,
    }
}

fn every(readings_of: impl Fn() -> Vec<proboscis::control::problem::Reading>) -> Vec<Channel> {
    let quantities = quantities().into_iter().map(|(quantity, _)| quantity);
    let all = quantities.chain(others());
    all.map(|quantity| channel(vec![(1.0, quantity)], readings_of()))
        .collect()
}

#[test]
fn forces_and_charges_depend_on_constants_as_their_derivatives_say() {
    let task = task(recording(every(|| readings(5, 40.0)), Regime::Motion), true);
    let values: Vec<f64> = task.parameters.iter().map(|p| 1.01 * p.guess).collect();
    let largest = compare(&system(), &task, &Unknowns::of_values(&values, &[&[]]));
    println!("{largest:?}");
    assert!(largest.iter().all(|size| *size > 1e-4), "{largest:?}");
}

#[test]
fn forces_at_rest_depend_on_constants_as_their_derivatives_say() {
    let task = task(recording(every(|| readings(3, 40.0)), Regime::Rest), false);
    let values: Vec<f64> = task.parameters.iter().map(|p| 1.01 * p.guess).collect();
    let largest = compare(&system(), &task, &Unknowns::of_values(&values, &[&[]]));
    println!("{largest:?}");
    assert!(largest.iter().all(|size| *size > 1e-4), "{largest:?}");
}

/// Tables have formulas and readings of their own.
#[test]
fn forces_and_charges_are_those_of_tables() {
    let (system, all) = (system(), quantities());
    let channels = all
        .iter()
        .map(|(quantity, _)| channel(vec![(1.0, quantity.clone())], readings(9, 80.0)));
    let mut task = task(recording(channels.collect(), Regime::Motion), true);
    task.parameters.clear();
    let grid = Grid {
        intervals: vec![160],
        meets_corners: vec![true; 8],
    };
    let unknowns = Unknowns::of_values(&[], &[&[]]);
    let found = Problem {
        system: &system,
        task: &task,
    }
    .predict(&[0], &unknowns, &grid)
    .unwrap();
    // A simulation in steps of 0.05 ms.
    let intervals = 1600;
    let model = Model::new(system.clone(), None, 0.05, &[]).unwrap();
    let of = &task.recordings[0];
    let start = proboscis::control::resolve_start(&model, &of.start).unwrap();
    let scalars = |a: f64, b: f64| model.scalars(&of.voltages.at(0.5 * (a + b)));
    let (discrete, failure) = simulate(&model, &start, 0.05, intervals, scalars, |_| {
        std::ops::ControlFlow::Continue(())
    });
    assert!(failure.is_none());
    let table = observations(&model, &discrete);
    for (c, (quantity, columns)) in all.iter().enumerate() {
        let value = |k: usize| {
            let part = |(name, factor): &(&str, f64)| {
                let column = table.columns.iter().find(|column| column.name == *name);
                factor * column.unwrap_or_else(|| panic!("{name}")).values[k]
            };
            columns.iter().map(part).sum::<f64>()
        };
        let expected: Vec<f64> = (0..9).map(|k| value(200 * k)).collect();
        let scale = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let change = expected.iter().map(|value| (value - expected[1]).abs());
        assert!(change.fold(0.0, f64::max) > 1e-3 * scale && scale > 0.0);
        // Table and prediction are extrapolated to both ends.
        for (k, expected) in expected.iter().enumerate().take(8).skip(1) {
            let own = found.values[9 * c + k];
            assert!(
                (own - expected).abs() < 2e-4 * scale,
                "{quantity:?} {k}: {own} {expected}"
            );
        }
    }
}

/// Recordings of a twin with other constants give them back: of forces alone, and of a circuit alone.
#[test]
fn constants_come_back_from_forces_and_from_circuits() {
    let pulls = [
        Quantity::tension(Pulling::Muscle(0)),
        Quantity::tension(Pulling::Spring(0)),
        Quantity::tension(Pulling::Tendon(0)),
    ];
    let circuit = [
        Quantity::of(What::Current(1)),
        Quantity::of(What::ElectrodeVoltage(1)),
        Quantity::of(What::MeanCharge(2)),
    ];
    let of_forces = [
        "modulus",
        "viscosity",
        "stiffness",
        "length",
        "damping",
        "cord",
    ];
    let of_circuits = ["permittivity", "leak", "series", "layer"];
    recovered(&pulls, &of_forces);
    recovered(&circuit, &of_circuits);
    recovered(&[reaction(0, Reaction::Force)], &["mass", "stiffness"]);
}

/// The fit of the constants to the only recording on a grid of intervals, from their guesses on.
pub(crate) fn converged(system: &System, task: &Identification, intervals: usize) -> Fit {
    let guesses: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
    let begin = Unknowns::of_values(&guesses, &[&[]]);
    let grid = Grid {
        intervals: vec![intervals],
        meets_corners: vec![true; 8],
    };
    let found = Problem { system, task }.fit(&[0], begin, 0, &grid).unwrap();
    assert_eq!(found.ended, Ended::Converged);
    found
}

fn recovered(quantities: &[Quantity], names: &[&str]) {
    let system = system();
    let channels = quantities.iter();
    let channels = channels.map(|q| channel(vec![(1.0, q.clone())], readings(20, 76.0)));
    let mut task = task(recording(channels.collect(), Regime::Motion), true);
    task.parameters.retain(|p| names.contains(&p.name.as_str()));
    assert_eq!(task.parameters.len(), names.len());
    let truth: Vec<f64> = task.parameters.iter().map(|p| 0.8 * p.guess).collect();
    let twin = with_parameters(&system, &task.parameters, &truth);
    let alone = Identification {
        parameters: Vec::new(),
        ..task.clone()
    };
    let grid = Grid {
        intervals: vec![304],
        meets_corners: vec![true; 8],
    };
    let unknowns = Unknowns::of_values(&[], &[&[]]);
    let values = Problem {
        system: &twin,
        task: &alone,
    }
    .predict(&[0], &unknowns, &grid)
    .unwrap()
    .values;
    let mut row = 0;
    for channel in &mut task.recordings[0].channels {
        let size = values.rows(row, channel.readings.len()).amax();
        for reading in &mut channel.readings {
            (reading.value, reading.deviation) = (values[row], 1e-3 * size);
            row += 1;
        }
    }
    let found = converged(&system, &task, 76);
    for (j, (value, truth)) in found.of_constants().iter().zip(&truth).enumerate() {
        println!("{} {value} {truth}", task.parameters[j].name);
        assert!(
            (value / truth - 1.0).abs() < 1e-4,
            "{} {value} {truth}",
            task.parameters[j].name
        );
    }
}
