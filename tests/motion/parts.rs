//! Columns of parts in motion: rates, tensions, fields, currents and powers, against closed forms and balances.

use crate::charge::{CAPACITANCE, LAYER, charged, driven, plain, resisted, units};
use crate::common::{bare, body, column, joint, motion, runge_kutta};
use crate::loads::{hinge, jet, on, slide};
use crate::maxwell::{BOTH, LENGTH, branches, model};
use nalgebra::{Matrix3, Vector2, Vector3};
use proboscis::dynamics::trajectory::{Observations, Trajectory};
use proboscis::dynamics::{
    DiscreteTrajectory, EnergyExchange, Integrator, Solving, Start, observations, simulate_by,
    stable_equilibrium,
};
use proboscis::model::Model;
use proboscis::model::components::LoadPlace;
use proboscis::model::system::{Attachment, ElasticLaw, JointKind, Marker, System};
use std::ops::ControlFlow;

/// mm/ms².
const GRAVITY: f64 = 9.81e-3;

fn names(observed: &Observations) -> Vec<&str> {
    let columns = observed.columns.iter();
    columns.map(|column| column.name.as_str()).collect()
}

pub(crate) fn moved(
    integrator: Integrator,
    model: &Model,
    start: &Start,
    h: f64,
    n: usize,
    input: &[f64],
) -> DiscreteTrajectory {
    let solving = Solving {
        integrator,
        ..Solving::default()
    };
    let input = |_: f64, _: f64| input.to_vec();
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate_by(solving, model, start, h, n, input, go_on);
    assert_eq!(failure, None);
    discrete
}

fn at_rest(model: &Model) -> Start {
    Start::at_rest(model, model.coordinates_at(&[0.0]))
}

/// Sum of a column over time by trapezoids.
fn integral(times: &[f64], values: &[f64]) -> f64 {
    let both = times.windows(2).zip(values.windows(2));
    both.map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1])).sum()
}

#[test]
fn a_pendulum_turns_at_the_rate_of_another_method() {
    let (mass, arm, about) = (25.0, 40.0, 800.0);
    let inertia: f64 = about + mass * arm * arm;
    let bob = body(
        "bob",
        mass,
        [900.0, 500.0, about],
        -Vector3::y() * arm,
        Matrix3::identity(),
    );
    let hip = joint(
        "hip",
        JointKind::Revolute { axis: Vector3::z() },
        None,
        0,
        Vector3::zeros(),
    );
    let mut system = bare(vec![bob], vec![hip], Some(-Vector3::y() * GRAVITY));
    system.markers = [("tip", Some(0)), ("wall", None)]
        .map(|(name, body)| Marker {
            name: name.into(),
            point: Attachment {
                body,
                at: -Vector3::y() * arm,
            },
            solid: None,
        })
        .to_vec();
    let rate = |y: &Vector2<f64>| Vector2::new(y.y, -mass * GRAVITY * arm * y.x.sin() / inertia);
    let exact = |time: f64| {
        let start = Vector2::new(1.0, 2e-3);
        (0..4000)
            .fold(start, |y, _| runge_kutta(&rate, &y, time / 4000.0))
            .y
    };
    let exact = [100.0, 200.0].map(exact);
    assert!(exact.iter().all(|rate| rate.abs() > 1e-3), "{exact:?}");
    let methods = [
        (Integrator::Midpoint, [40, 80], 3.7..4.3),
        (Integrator::Galerkin { degree: 2 }, [10, 20], 14.0..18.0),
    ];
    for coordinates in BOTH {
        for (integrator, counts, ratios) in methods.clone() {
            let errors = counts.map(|count| {
                let model = model(&system, coordinates, 1.0);
                let rates = match model.coordinate_count() {
                    1 => vec![2e-3],
                    _ => model
                        .rates_at(&[1.0], &[2e-3], &Default::default())
                        .unwrap(),
                };
                let start = Start::with_rates(&model, model.coordinates_at(&[1.0]), &rates);
                let h = 200.0 / count as f64;
                let discrete = moved(integrator, &model, &start, h, count, &[]);
                let seen = observations(&model, &discrete);
                let rates = column(&seen, "hip_rate");
                assert!((rates[0] - 2e-3).abs() < 1e-15, "{}", rates[0]);
                let speeds = column(&seen, "tip_speed");
                assert!((speeds[0] - 2e-3 * arm).abs() < 1e-13, "{}", speeds[0]);
                assert!(!names(&seen).contains(&"wall_speed"));
                let at = [count / 2, count];
                let errors = [0, 1].map(|i| {
                    let speed = speeds[at[i]] - arm * exact[i].abs();
                    [rates[at[i]] - exact[i], speed / arm]
                });
                errors.as_flattened().to_vec()
            });
            for at in 0..4 {
                let ratio = errors[0][at] / errors[1][at];
                assert!(
                    ratios.contains(&ratio),
                    "{integrator:?}, {coordinates:?}: {errors:?}"
                );
            }
        }
    }
}

/// A mass that hangs along x on a muscle.
fn hanging(mut system: System) -> System {
    system.gravity = Some(Vector3::x() * GRAVITY);
    system
}

#[test]
fn a_muscle_pulls_with_the_weight_that_it_holds() {
    let (mass, [volt, charge]) = (300.0, units());
    let weight = mass * GRAVITY;
    for coordinates in BOTH {
        for (system, input) in [(plain(mass), 0.3 * volt), (charged(mass), 0.4 * charge)] {
            let model = model(&hanging(system), coordinates, 1.0);
            let found = stable_equilibrium(&model, &at_rest(&model).z, &[input]).unwrap();
            let start = Start::at_rest(&model, found.z.clone());
            let discrete = motion(&model, &start, 1.0, 5, &[input]);
            let seen = observations(&model, &discrete);
            let stretch = column(&seen, "muscle_stretch");
            assert!((stretch[0] - 1.0).abs() > 0.02, "{}", stretch[0]);
            let voltage = match names(&seen).contains(&"muscle_voltage") {
                true => column(&seen, "muscle_voltage")[0],
                false => input,
            };
            // 1000 V/mm are 1 V/µm.
            let field = 1e-3 * voltage / (LAYER * stretch[0]);
            assert!(field > 1.0, "{field}");
            for k in 0..=5 {
                let [tension, found] =
                    ["tension", "field"].map(|c| column(&seen, &format!("muscle_{c}"))[k]);
                assert!(
                    (tension - weight).abs() < 1e-9 * weight,
                    "{tension} {weight}"
                );
                assert!((found - field).abs() < 1e-9 * field, "{found} {field}");
            }
        }
    }
}

/// The mean of the tensions beside an instant changes the momentum there, whatever the muscle is made of.
#[test]
fn tensions_change_the_momentum_of_a_mass() {
    let (mass, h, steps) = (20.0, 0.2, 200);
    let [volt, charge] = units();
    let gent = Some(ElasticLaw::Gent { limit: 3.0 });
    let systems = [
        (plain(mass), 0.4 * volt, None),
        (plain(mass), 0.4 * volt, gent),
        (resisted(mass, 6.0), 0.5 * volt, None),
        (charged(mass), 0.5 * charge, gent),
    ];
    for coordinates in BOTH {
        for (mut system, input, law) in systems.clone() {
            system.muscles[0].material.law = law;
            let material = &mut system.muscles[0].material;
            material.viscosity = Some(0.3);
            material.maxwell = branches(&[[0.05, 10.0], [0.02, 2.0]]);
            let model = model(&hanging(system), coordinates, h);
            let discrete = motion(&model, &at_rest(&model), h, steps, &[input]);
            let seen = observations(&model, &discrete);
            let [place, tension] = ["slide", "muscle_tension"].map(|name| column(&seen, name));
            let mut largest = 0.0_f64;
            for k in 1..steps {
                let change = mass * (place[k + 1] - 2.0 * place[k] + place[k - 1]) / (h * h);
                largest = largest.max(change.abs());
                let force = mass * GRAVITY - change;
                assert!(
                    (tension[k] - force).abs() < 1e-8,
                    "{k}: {} {force}",
                    tension[k]
                );
            }
            assert!(largest > 0.1, "{largest}");
        }
    }
}

/// Stretch Λ: C = C₀/Λ².
fn capacitance(displacement: f64) -> f64 {
    CAPACITANCE / (1.0 + displacement / LENGTH).powi(2)
}

#[test]
fn currents_under_a_constant_voltage_have_the_order_of_the_method() {
    let (mass, voltage) = (20.0, 0.55 * units()[0]);
    let slope = |x: f64| -2.0 * CAPACITANCE / (LENGTH * (1.0 + x / LENGTH).powi(3));
    let elastic = |x: f64| {
        let stretch = 1.0 + x / LENGTH;
        crate::maxwell::stress(stretch, 0.0, 0.0) * crate::maxwell::SECTION
    };
    let rate = |y: &Vector2<f64>| {
        let force = 0.5 * voltage * voltage * slope(y.x) - elastic(y.x);
        Vector2::new(y.y, force / mass)
    };
    let state = (0..20_000).fold(Vector2::zeros(), |y, _| {
        runge_kutta(&rate, &y, 30.0 / 20_000.0)
    });
    let exact = voltage * slope(state.x) * state.y;
    assert!(exact.abs() > 1e-7, "{exact}");
    let methods = [
        (Integrator::Midpoint, [0.2, 0.1], 3.8..4.2),
        (Integrator::Galerkin { degree: 2 }, [1.0, 0.5], 13.0..19.0),
    ];
    for coordinates in BOTH {
        for (integrator, steps, ratios) in methods.clone() {
            let errors = steps.map(|h| {
                let model = model(&plain(mass), coordinates, h);
                let count = (30.0 / h).round() as usize;
                let discrete = moved(integrator, &model, &at_rest(&model), h, count, &[voltage]);
                let seen = observations(&model, &discrete);
                let [current, power] =
                    ["muscle_current", "muscle_power"].map(|c| column(&seen, c)[count]);
                assert!((power - voltage * current).abs() < 1e-14 * power.abs());
                current / exact - 1.0
            });
            let ratio = errors[0] / errors[1];
            assert!(
                ratios.contains(&ratio) && errors[1].abs() < 0.02,
                "{integrator:?}: {errors:?}"
            );
        }
    }
}

#[test]
fn currents_bring_the_charge_and_powers_the_energy() {
    let (mass, time) = (20.0, 30.0_f64);
    let volt = units()[0];
    let errors = [0.2, 0.1].map(|h| {
        let rows: Vec<f64> = (0..(time / h).round() as usize)
            .map(|k| volt * (0.3 + 0.2 * (0.2 * h * (k as f64 + 0.5)).sin()))
            .collect();
        let model = model(&plain(mass), BOTH[0], h);
        let discrete = driven(&model, &at_rest(&model), h, &rows);
        let seen = observations(&model, &discrete);
        let trajectory = Trajectory::from_discrete(&model, &discrete);
        let exchange = EnergyExchange::new(&model.system, &trajectory, [None, None]);
        let [_, work] = exchange.totals().unwrap();
        let [place, current, power] =
            ["slide", "muscle_current", "muscle_power"].map(|c| column(&seen, c));
        // From the middle of the first interval to that of the last one: at the ends voltages are held.
        let ends = [0, rows.len() - 1];
        let middle = |k: usize| (capacitance(0.5 * (place[k] + place[k + 1])), rows[k]);
        let [(c, u), (d, v)] = ends.map(middle);
        let sum = |column: &[f64]| column[1..rows.len()].iter().sum::<f64>() * h;
        let charge = d * v - c * u;
        let half = |k: usize| 0.5 * (work[k] + work[k + 1]);
        let energy = 0.5 * (d * v * v - c * u * u) + half(ends[1]) - half(0);
        assert!(
            charge.abs() > 1e-6 && energy.abs() > 1e-3,
            "{charge} {energy}"
        );
        [sum(current) / charge - 1.0, sum(power) / energy - 1.0]
    });
    for (coarse, fine) in errors[0].iter().zip(errors[1]) {
        assert!(fine.abs() < 2e-3, "{errors:?}");
        assert!((3.0..5.0).contains(&(coarse / fine)), "{errors:?}");
    }
}

#[test]
fn a_resistor_passes_what_the_charge_takes() {
    let voltage = 0.55 * units()[0];
    let system = resisted(20.0, 6.0);
    let resistance = system.muscles[0].circuit.unwrap().resistance.unwrap();
    for coordinates in BOTH {
        let errors = [0.4, 0.2].map(|h| {
            let model = model(&system, coordinates, h);
            let count = (30.0 / h) as usize;
            let discrete = motion(&model, &at_rest(&model), h, count, &[voltage]);
            let seen = observations(&model, &discrete);
            let [current, power] = ["muscle_current", "muscle_power"].map(|c| column(&seen, c));
            assert!((current[0] * resistance / voltage - 1.0).abs() < 1e-12);
            let charges = &model.circuit_charges(&discrete.z)[&0];
            let charge = charges[count];
            let passed = integral(&discrete.times, current);
            let supplied = integral(&discrete.times, power);
            assert!(charge > 0.3 * voltage * CAPACITANCE);
            [passed / charge - 1.0, supplied / (voltage * charge) - 1.0]
        });
        for (coarse, fine) in errors[0].iter().zip(errors[1]) {
            assert!(
                fine.abs() < 1e-3 && (3.5..4.5).contains(&(coarse / fine)),
                "{errors:?}"
            );
        }
    }
}

#[test]
fn a_load_has_the_power_of_its_force() {
    let motor = LoadPlace::Joint(0);
    // Mass 10 g; 600 g mm² and 10 g at 20 mm about the hinge. The jet pushes at 20 mm across.
    let turning = 600.0 + 10.0 * 400.0;
    let cases = [
        (on(slide(), None, motor.clone()), 1.0, 10.0),
        (on(hinge(), None, motor), 1.0, turning),
        (jet(), 20.0, turning),
    ];
    for coordinates in BOTH {
        for (system, lever, inertia) in &cases {
            let size = 0.6;
            for integrator in [Integrator::Midpoint, Integrator::Galerkin { degree: 2 }] {
                let model = model(system, coordinates, 1.0);
                let discrete = moved(integrator, &model, &at_rest(&model), 1.0, 30, &[size]);
                let seen = observations(&model, &discrete);
                let power = column(&seen, "push_power");
                for (k, found) in power.iter().enumerate() {
                    // (F ℓ)² t/J of a uniform acceleration.
                    let exact = (size * lever).powi(2) * k as f64 / inertia;
                    assert!(
                        (found - exact).abs() < 2e-3 * power[30],
                        "{k}: {found} {exact}"
                    );
                }
                assert!(power[30] > 1e-3, "{}", power[30]);
            }
        }
    }
}

#[test]
fn what_does_not_exist_has_no_column() {
    let of = |system: &System, inputs: &[f64]| -> Vec<String> {
        let model = model(system, BOTH[0], 1.0);
        let seen = observations(&model, &motion(&model, &at_rest(&model), 1.0, 2, inputs));
        let ends = ["_rate", "_tension", "_field", "_current", "_power"];
        let is = |name: &&str| ends.iter().any(|end| name.ends_with(end));
        names(&seen)
            .into_iter()
            .filter(is)
            .map(str::to_owned)
            .collect()
    };
    let mut passive = plain(20.0);
    passive.muscles[0].material.electric = None;
    assert_eq!(of(&passive, &[]), ["slide_rate", "muscle_tension"]);
    let sources = ["muscle_field", "muscle_current", "muscle_power"];
    let of_source = [&["slide_rate", "muscle_tension"][..], &sources].concat();
    assert_eq!(of(&plain(20.0), &[100.0]), of_source);
    assert_eq!(of(&resisted(20.0, 6.0), &[100.0]), of_source);
    let given = [&["slide_rate", "muscle_tension"][..], &sources[..1]].concat();
    assert_eq!(of(&charged(20.0), &[1e-6]), given);
    let pushed = on(slide(), None, LoadPlace::Joint(0));
    assert_eq!(of(&pushed, &[0.1]), ["joint_rate", "push_power"]);
}
