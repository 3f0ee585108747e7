//! Muscles that have a charge instead of the voltage of a source: given, or through the resistor of a circuit.

use crate::common::{motion, placed, runge_kutta};
use crate::component_files::read;
use crate::components::column;
use crate::maxwell::{BOTH, LENGTH, MODULUS, SECTION, internal, model, slider};
use nalgebra::Vector3;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{
    DiscreteTrajectory, EnergyExchange, Integrator, Solving, Start, simulate_by, stable_equilibrium,
};
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::{
    Circuit, ElectricConstants, MaxwellBranches, System, VACUUM_PERMITTIVITY,
};
use proboscis::model::{Coordinates, Model, Role};
use std::ops::ControlFlow;

/// Layers in mm, and the permittivity in N/V² (F/m are 1e0 N/V²).
pub(crate) const LAYER: f64 = 0.05;
const PERMITTIVITY: f64 = 3.0 * VACUUM_PERMITTIVITY;
const VOLUME: f64 = SECTION * LENGTH;
/// Capacitance at rest in mC/V.
pub(crate) const CAPACITANCE: f64 = PERMITTIVITY * VOLUME / (LAYER * LAYER);

/// Voltage `t √(μ/ε)` in V, and charge in mC, in which the closed forms count.
pub(crate) fn units() -> [f64; 2] {
    let voltage = LAYER * (MODULUS / PERMITTIVITY).sqrt();
    [voltage, CAPACITANCE * voltage]
}

pub(crate) fn plain(mass: f64) -> System {
    let mut system = slider(mass, MaxwellBranches::default());
    system.muscles[0].material.electric = Some(ElectricConstants::ideal(3.0));
    system
}

/// The slider behind a resistor with the time constant R C₀ in ms.
pub(crate) fn resisted(mass: f64, time: f64) -> System {
    let mut system = plain(mass);
    let resistance = time / CAPACITANCE;
    system.muscles[0].circuit = Some(Circuit {
        resistance: Some(resistance),
        leakage: None,
    });
    system
}

/// The slider whose charge is given.
pub(crate) fn charged(mass: f64) -> System {
    let mut system = plain(mass);
    system.components.loads.push(Load {
        name: "charge".into(),
        on: LoadPlace::Muscle(0),
    });
    system
}

fn at_rest(model: &Model) -> Start {
    Start::at_rest(model, model.coordinates_at(&[0.0]))
}

/// Inputs of each step, in turn.
pub(crate) fn driven(model: &Model, start: &Start, h: f64, rows: &[f64]) -> DiscreteTrajectory {
    let (discrete, failure) = simulate_by(
        Solving::default(),
        model,
        start,
        h,
        rows.len(),
        |from: f64, _: f64| vec![rows[(from / h).round() as usize]],
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    discrete
}

fn last(list: &[f64]) -> f64 {
    list[list.len() - 1]
}

#[test]
fn a_given_charge_holds_every_stretch_and_no_muscle_pulls_in() {
    // Λ = (1 + q̄²)^(−1/3) and V̄ = q̄ Λ², of which q̄ = √3 is where a voltage would pull in.
    let expected = [
        (1.0, 0.7937005260, 0.6299605249),
        (3.0_f64.sqrt(), 0.6299605249, 0.6873648185),
        (3.0, 0.4641588834, 0.6463304070),
        (10.0, 0.2147300748, 0.4610900503),
    ];
    let [volt, charge] = units();
    for coordinates in BOTH {
        let model = model(&charged(20.0), coordinates, 1.0);
        assert_eq!(model.variables.count(Role::Voltage), 0);
        for (q, stretch, voltage) in expected {
            let found = stable_equilibrium(&model, &at_rest(&model).z, &[q * charge]).unwrap();
            assert_eq!(found.unstable, Some(0), "{q}");
            let instant = placed(&model, &found.z);
            let place = 1.0 + model.joints(&instant, &[0.0])[0] / LENGTH;
            assert!((place - stretch).abs() < 1e-10, "{q}: {place}");
            let across = model.electrode_voltages(&instant, &found.scalars)[0] / volt;
            assert!((across - voltage).abs() < 1e-10, "{q}: {across}");
        }
    }
}

#[test]
fn a_cell_without_mass_charges_as_its_closed_form() {
    let expected = [
        (0.5, [0.3214875440, 0.5303434589]),
        (0.65, [0.4225609314, 0.7427071301]),
    ];
    let [volt, charge] = units();
    for coordinates in BOTH {
        for (voltage, exact) in expected {
            let of_steps = |count: usize| {
                let model = model(&resisted(1e-9, 100.0), coordinates, 1.0);
                let h = 100.0 / count as f64;
                let discrete = motion(&model, &at_rest(&model), h, 3 * count, &[voltage * volt]);
                let charges = &model.circuit_charges(&discrete.z)[&0];
                [1, 3].map(|time| charges[time * count] / charge)
            };
            let [coarse, fine] = [400, 800].map(of_steps);
            for i in 0..2 {
                let errors = [coarse[i], fine[i]].map(|q| q - exact[i]);
                let ratio = errors[0] / errors[1];
                assert!((3.9..4.1).contains(&ratio), "{coordinates:?}: {errors:?}");
                let limit = fine[i] + (fine[i] - coarse[i]) / 3.0;
                assert!((limit - exact[i]).abs() < 1e-8, "{limit} {}", exact[i]);
            }
        }
    }
}

/// Displacement, velocity and charge of the slider under a constant voltage by Runge and Kutta.
fn swing(mass: f64, resistance: f64, voltage: f64, time: f64) -> Vector3<f64> {
    let rate = |y: &Vector3<f64>| {
        let [x, v, q] = [y.x, y.y, y.z];
        let stretch = 1.0 + x / LENGTH;
        // Q²/(2C) with C = C₀/Λ² grows with Λ².
        let energy_rate = q * q / CAPACITANCE * stretch / LENGTH;
        let elastic = SECTION * MODULUS * (stretch - stretch.powi(-2));
        let across = q * stretch * stretch / CAPACITANCE;
        let force = -(elastic + energy_rate);
        Vector3::new(v, force / mass, (voltage - across) / resistance)
    };
    let steps = 20_000;
    (0..steps).fold(Vector3::zeros(), |y, _| {
        runge_kutta(&rate, &y, time / f64::from(steps))
    })
}

#[test]
fn a_swing_behind_a_resistor_is_that_of_another_method() {
    let system = resisted(20.0, 6.0);
    let resistance = system.muscles[0].circuit.unwrap().resistance.unwrap();
    let [volt, charge] = units();
    let voltage = 0.55 * volt;
    let exact = swing(20.0, resistance, voltage, 30.0);
    let [x, q] = [exact.x, exact.z];
    assert!(x < -1.0 && q > 0.3 * charge, "{x} {q}");
    let methods = [
        (Integrator::Midpoint, [0.2, 0.1], 3.8..4.2, 0.02),
        (
            Integrator::Galerkin { degree: 2 },
            [1.0, 0.5],
            13.0..19.0,
            1e-4,
        ),
    ];
    for coordinates in BOTH {
        for (integrator, steps, ratios, least) in methods.clone() {
            let errors = steps.map(|h| {
                let model = model(&system, coordinates, h);
                let solving = Solving {
                    integrator,
                    ..Solving::default()
                };
                let (discrete, failure) = simulate_by(
                    solving,
                    &model,
                    &at_rest(&model),
                    h,
                    (30.0 / h).round() as usize,
                    |_, _| vec![voltage],
                    |_| ControlFlow::Continue(()),
                );
                assert_eq!(failure, None);
                let instant = placed(&model, discrete.z.last().unwrap());
                let found = model.joints(&instant, &[0.0])[0];
                let charges = &model.circuit_charges(&discrete.z)[&0];
                ((found - x) / x).abs().max((last(charges) / q - 1.0).abs())
            });
            assert!(errors[0] < least, "{integrator:?}: {errors:?}");
            let ratio = errors[0] / errors[1];
            assert!(
                ratios.contains(&ratio),
                "{integrator:?}, {coordinates:?}: {errors:?}"
            );
        }
    }
}

#[test]
fn what_a_source_supplies_is_stored_works_and_heats_the_resistor() {
    let voltage = 0.55 * units()[0];
    let errors = [0.4, 0.2].map(|h| {
        let model = model(&resisted(20.0, 6.0), Coordinates::Reduced, h);
        let discrete = motion(&model, &at_rest(&model), h, (30.0 / h) as usize, &[voltage]);
        let of = |name: &str| last(&column(&model, &discrete, name));
        let [heat, stored] = ["dissipated_energy", "muscle_charges_energy"].map(of);
        // The potential of a constant voltage is −V Q.
        let total = column(&model, &discrete, "total_energy");
        let balance = (last(&total) + heat - total[0]).abs();
        let trajectory = Trajectory::from_discrete(&model, &discrete);
        let exchange = EnergyExchange::new(&model.system, &trajectory, [None, None]);
        let [supplied, work] = exchange.totals().unwrap().map(|sums| last(&sums));
        assert!(supplied > 1.0 && heat > 0.1 * supplied && work.abs() > 0.01 * supplied);
        let charges = &trajectory.charges[&0];
        assert!((supplied - voltage * last(charges)).abs() < 1e-12 * supplied);
        let across = column(&model, &discrete, "muscle_voltage");
        assert_eq!(across[0], 0.0);
        assert!(
            (0.5..1.5).contains(&(last(&across) / voltage)),
            "{}",
            last(&across)
        );
        [balance, (stored + work + heat - supplied).abs()].map(|error| error / supplied)
    });
    for i in 0..2 {
        assert!(errors[1][i] < 2e-3, "{errors:?}");
        assert!(errors[1][i] < 0.4 * errors[0][i], "{errors:?}");
    }
}

#[test]
fn charges_of_a_voltage_given_back_make_the_same_motion() {
    let voltages: Vec<f64> = (0..300)
        .map(|k| units()[0] * (0.3 + 0.2 * (0.05 * f64::from(k)).sin()))
        .collect();
    for coordinates in BOTH {
        let direct = model(&plain(20.0), coordinates, 0.1);
        let first = driven(&direct, &at_rest(&direct), 0.1, &voltages);
        let place = |model: &Model, z: &Vec<f64>| model.joints(&placed(model, z), &[0.0])[0];
        let places: Vec<f64> = first.z.iter().map(|z| place(&direct, z)).collect();
        assert!(places.iter().any(|x| *x < -0.5), "it moves");
        // C at the middle of an interval.
        let charge = |(k, voltage): (usize, &f64)| {
            let stretch = 1.0 + 0.5 * (places[k] + places[k + 1]) / LENGTH;
            voltage * CAPACITANCE / (stretch * stretch)
        };
        let charges: Vec<f64> = voltages.iter().enumerate().map(charge).collect();
        let given = model(&charged(20.0), coordinates, 0.1);
        let second = driven(&given, &at_rest(&given), 0.1, &charges);
        for (z, x) in second.z.iter().zip(&places) {
            assert!((place(&given, z) - x).abs() < 1e-10, "{x}");
        }
    }
}

#[test]
fn little_resistance_changes_little() {
    let voltage = 0.4 * units()[0];
    let place = |system: &System| {
        let model = model(system, Coordinates::Reduced, 0.01);
        let discrete = motion(&model, &at_rest(&model), 0.01, 2000, &[voltage]);
        model.joints(&placed(&model, &discrete.z[2000]), &[0.0])[0]
    };
    let without = place(&plain(20.0));
    assert!(without.abs() > 0.1, "{without}");
    let errors = [0.1, 0.05].map(|time| (place(&resisted(20.0, time)) - without).abs());
    assert!(
        errors[0] < 0.2 && (1.7..2.3).contains(&(errors[0] / errors[1])),
        "{errors:?}"
    );
}

#[test]
fn at_rest_no_current_flows() {
    let voltage = 0.5 * units()[0];
    let system = resisted(20.0, 50.0);
    let model = model(&system, Coordinates::Reduced, 1.0);
    let found = stable_equilibrium(&model, &at_rest(&model).z, &[voltage]).unwrap();
    let instant = placed(&model, &found.z);
    let across = model.electrode_voltages(&instant, &found.scalars)[0];
    assert!((across / voltage - 1.0).abs() < 1e-9, "{across}");
    // So a motion that starts there stays there.
    let start = Start::at_rest(&model, found.z.clone());
    let discrete = motion(&model, &start, 1.0, 100, &[voltage]);
    let moved = discrete.z[100].iter().zip(&found.z);
    assert!(moved.clone().all(|(a, b)| (a - b).abs() < 1e-8));
    assert_eq!(internal(&model).len(), 1);
    let names = model.variables.with(Role::Coordinate);
    assert_eq!(names[1].to_string(), "charge of muscle");
}

#[test]
fn a_muscle_without_a_circuit_has_no_unknown_and_no_term_of_it() {
    let [with, without] =
        [resisted(20.0, 5.0), plain(20.0)].map(|s| model(&s, Coordinates::Reduced, 1.0));
    assert_eq!(with.coordinate_count(), without.coordinate_count() + 1);
    for term in ["muscle charges", "circuit sources", "circuit resistance"] {
        let has = |model: &Model| model.present.iter().any(|p| p.term == term);
        assert!(has(&with) && !has(&without), "{term}");
    }
}

const SCENE: &str = r#"{ "name": "charge",
  "materials": { "rubber": { "shear_modulus": "100 kPa", "relative_permittivity": 3 }, "plain": { "shear_modulus": "100 kPa" } },
  "bodies": [{ "name": "b", "mass": "10 g", "sphere": { "radius": "5 mm" }, "position": ["40 mm", 0, 0] }],
  "joints": [{ "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": ["40 mm", 0, 0] }],
  "muscles": [{ "name": "m", "material": "rubber", "from": { "body": "ground", "at": [0, 0, 0] },
                "to": { "body": "b", "at": ["40 mm", 0, 0] }, "cross_section": ["10 mm", "10 mm"],
                "layer_thickness": "50 um"CIRCUIT }]LOADS }"#;

#[test]
fn files_name_circuits_and_charges() {
    let scene =
        |circuit: &str, loads: &str| SCENE.replace("CIRCUIT", circuit).replace("LOADS", loads);
    let resistor = r#", "circuit": { "resistance": "2 MOhm" }"#;
    let load = r#", "loads": [{ "name": "q", "muscle": "m" }]"#;
    let system = read(&scene(resistor, "")).unwrap();
    assert_eq!(system.muscles[0].circuit.unwrap().resistance, Some(2e6));
    let system = read(&scene("", load)).unwrap();
    assert!(system.is_charged(0) && !system.sources()[0].takes_voltage);
    let twice = r#", "loads": [{ "name": "q", "muscle": "m" }, { "name": "p", "muscle": "m" }]"#;
    for (text, words) in [
        (
            scene(&resistor.replace("2 M", "-2 M"), ""),
            "circuit.resistance",
        ),
        (
            scene(&resistor.replace("2 MOhm", "2 mF"), ""),
            "a resistance, such as",
        ),
        (
            scene(resistor, "").replace(r#""material": "rubber""#, r#""material": "plain""#),
            "muscles[0].circuit",
        ),
        (scene(resistor, load), "loads[0].muscle"),
        (
            scene("", load).replace(r#""material": "rubber""#, r#""material": "plain""#),
            "loads[0].muscle",
        ),
        (scene("", twice), "loads[1].muscle"),
        (
            scene(
                "",
                &load.replace(r#""m""#, r#""m", "direction": [1, 0, 0]"#),
            ),
            "a charge has no direction",
        ),
    ] {
        let refused = read(&text).expect_err(words);
        assert!(refused.to_string().contains(words), "{refused}");
    }
}
