//! Constants of finite elements, recovered from the motion of a marker.

use crate::common::solid;
use crate::derivatives::compare;
use crate::oscillator::parameter;
use nalgebra::Vector3;
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Channel, Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::energy::ElasticLaw;
use proboscis::identify::{Ended, Grid, Problem, Unknowns, identify};
use proboscis::mesh::grid::Grid as Boxes;
use proboscis::model::system::{Attachment, ElectricConstants, Marker, Material, System};
use proboscis::model::{MaterialConstant, Parameter, Quantity, with_parameters};

/// Shear modulus in MPa and viscosity in MPa ms.
const TRUE: [f64; 2] = [0.12, 0.9];

/// A block of two layers between electrodes that shortens under a voltage.
fn block() -> System {
    let size = Vector3::new(10.0, 10.0, 4.0);
    let mesh = Boxes::uniform(Vector3::zeros(), size, [1, 1, 2]).mesh();
    let material = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(0.5),
        viscosity: Some(1.0),
        electric: Some(ElectricConstants::ideal(3.0)),
        ..Material::default()
    };
    let mut solid = solid::block(mesh, material);
    let ground = proboscis::model::system::Potential::Given(0.0);
    solid.supports = vec![solid::held(&solid.mesh, "z_min", [true; 3])];
    solid.electrodes = vec![
        solid::electrode(&solid.mesh, "low", 0.0, ground),
        solid::electrode(&solid.mesh, "high", 4.0, solid::DRIVEN),
    ];
    let mut system = solid::system(vec![solid]);
    system.markers.push(Marker {
        name: "top".into(),
        point: Attachment {
            body: None,
            at: Vector3::new(10.0, 10.0, 4.0),
        },
        solid: Some(0),
    });
    system
}

fn recording() -> Recording {
    let reading = |k: usize| Reading {
        time: 2.0 * k as f64,
        value: 0.0,
        deviation: 1e-5,
    };
    let start = BoundaryState::JointAngles {
        angles: [].into(),
        rates: [].into(),
        velocities: [].into(),
    };
    Recording {
        name: "step".into(),
        scene: None,
        regime: Regime::Motion,
        voltages: Voltages::from(vec![Signal::ramp(0.0, 60e3, 6.0)]),
        start,
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels: vec![Channel {
            name: "top".into(),
            parts: vec![(1.0, Quantity::marker_place(0, 2))],
            unit: ("m", 1e-3),
            is_deviation_known: true,
            readings: (0..16).map(reading).collect(),
        }],
    }
}

#[test]
fn modulus_and_viscosity_of_a_block_are_recovered_from_a_marker() {
    let system = block();
    let mut task = Identification {
        parameters: vec![
            parameter(
                "modulus",
                MaterialConstant::ShearModulus.of_block(0, 0),
                0.2,
            ),
            parameter("viscosity", MaterialConstant::Viscosity.of_block(0, 0), 0.4),
        ],
        recordings: vec![recording()],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(1.0),
        coordinates: None,
    };
    // Readings of the block of the true constants, which is built without sought ones, in steps 8 times as short.
    let truth = with_parameters(&system, &task.parameters, &TRUE);
    let nothing = Identification {
        parameters: Vec::new(),
        ..task.clone()
    };
    let unknowns = Unknowns::of_values(&[], &[&[][..]]);
    let grid = Grid {
        intervals: vec![240],
        meets_corners: vec![true; 8],
    };
    let problem = Problem {
        system: &truth,
        task: &nothing,
    };
    let values = problem.predict(&[0], &unknowns, &grid).unwrap().values;
    let way = values
        .iter()
        .fold(0.0_f64, |way, z| way.max((z - 4.0).abs()));
    assert!(way > 0.02, "the block moves by {way} mm");
    let readings = &mut task.recordings[0].channels[0].readings;
    for (reading, value) in readings.iter_mut().zip(values.iter()) {
        reading.value = *value;
    }
    let found = identify(&system, &task, &mut |_, _| {}).unwrap();
    assert_eq!(found.fit.ended, Ended::Converged);
    println!(
        "{:?} after {} steps",
        found.fit.of_constants(),
        found.fit.steps
    );
    for (value, truth) in found.fit.of_constants().iter().zip(TRUE) {
        assert!((value / truth - 1.0).abs() < 1e-4, "{value} {truth}");
    }
    assert!(found.fit.steps <= 10, "{} steps", found.fit.steps);
}

#[test]
fn states_of_rest_of_a_block_follow_the_constants_of_its_law() {
    use ElasticLaw::{Gent, MooneyRivlin, Yeoh};
    let laws = [
        (Gent { limit: 4.0 }, vec![("limit", 4.0)]),
        (MooneyRivlin { share: 0.3 }, vec![("share", 0.3)]),
        (
            Yeoh {
                c2: -5e-3,
                c3: 5e-3,
            },
            vec![("c2", -5e-3), ("c3", 5e-3)],
        ),
    ];
    for (law, constants) in laws {
        let mut system = block();
        system.solids[0].materials[0].law = Some(law);
        let of_block = |constant: MaterialConstant| constant.of_block(0, 0);
        let linear = [
            ("modulus", MaterialConstant::ShearModulus, 0.11),
            ("lambda", MaterialConstant::LameLambda, 0.6),
        ];
        let linear = linear.map(|(name, one, value)| parameter(name, of_block(one), value));
        let of_law = constants.iter().map(|&(name, value)| {
            let one = parameter(name, of_block(MaterialConstant::Law(name)), value);
            let [lower, upper] = [-0.1, 0.1].map(|change| value + change * value.abs());
            Parameter {
                lower,
                upper,
                ..one
            }
        });
        let parameters: Vec<Parameter> = linear.into_iter().chain(of_law).collect();
        let mut recording = recording();
        recording.regime = Regime::Rest;
        recording.channels[0].readings =
            [8, 15].map(|k| recording.channels[0].readings[k]).to_vec();
        recording.voltages = Voltages::from(vec![Signal::ramp(0.0, 180e3, 30.0)]);
        let values: Vec<f64> = parameters.iter().map(|one| one.guess).collect();
        let task = Identification {
            parameters,
            recordings: vec![recording],
            priors: Vec::new(),
            candidates: Vec::new(),
            step: Some(1.0),
            coordinates: None,
        };
        let largest = compare(&system, &task, &Unknowns::of_values(&values, &[&[]]));
        assert!(
            largest.iter().all(|size| *size > 1e-3),
            "{law:?}: {largest:?}"
        );
    }
}
