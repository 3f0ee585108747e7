//! Every column of a table has the order of its motion, and columns of one row belong to one state.

use crate::common::problem;
use proboscis::control::problem::{Simulation, Task};
use proboscis::dynamics::trajectory::{Column, Trajectory};
use proboscis::dynamics::{EnergyExchange, Integrator, observations};
use proboscis::model::system::{System, VACUUM_PERMITTIVITY};
use proboscis::workflow::integrate;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Length of the motions in s, and their number of steps.
const DURATION: f64 = 0.08;
const STEPS: usize = 32;
const FINE: usize = 512;
/// Period in ms of the inputs.
const PERIOD: f64 = 100.0;

/// A slider on a hinge with muscles under smooth inputs: of a source, of one that leaks, and with a given charge; where there is `memory` also
/// with a branch and behind a resistor.
fn robot(memory: bool) -> Value {
    let muscle = |name: &str, x: f64, material: &str| {
        json!({
            "name": name, "material": material, "cross_section": [0.01, 0.01], "layer_thickness": "50 um",
            "from": { "body": "ground", "at": [x, 0, 0] }, "to": { "body": "b", "at": [x, -0.04, 0.002] },
        })
    };
    let mut leaking = muscle("leaking", 0.012, "plain");
    leaking["circuit"] = json!({ "leakage": "200 MOhm" });
    let mut muscles = vec![
        muscle("direct", -0.012, "plain"),
        leaking,
        muscle("charged", 0.0, "plain"),
    ];
    if memory {
        let mut behind = muscle("behind", 0.006, "branched");
        behind["circuit"] = json!({ "resistance": "20 MOhm" });
        muscles.push(behind);
    }
    let sine = |mean: &str, amplitude: &str| json!({ "sine": { "mean": mean, "amplitude": amplitude, "period": "100 ms" } });
    let silicone = json!({ "shear_modulus": 1e5, "relative_permittivity": 3, "viscosity": 200, "density": 1000 });
    let mut branched = silicone.clone();
    branched["maxwell"] = json!([{ "shear_modulus": 3e4, "relaxation_time": 0.05 }]);
    let mut voltages =
        json!({ "direct": sine("1 kV", "500 V"), "leaking": sine("0.8 kV", "-300 V") });
    if memory {
        voltages["behind"] = sine("1 kV", "400 V");
    }
    json!({
        "scene": {
            "name": "columns", "materials": { "plain": silicone, "branched": branched },
            "bodies": [
                { "name": "a", "mass": 0.05, "position": [0, -0.02, 0.001], "box": { "size": [0.02, 0.02, 0.02] } },
                { "name": "b", "mass": 0.12, "position": [0.001, -0.05, 0], "box": { "size": [0.02, 0.01, 0.02] } },
            ],
            "joints": [
                { "name": "hinge", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "a", "at": [0, 0, 0], "damping": "1e-4 N m s/rad" },
                { "name": "slide", "prismatic": { "axis": [0, 1, 0] }, "parent": "a", "child": "b", "at": [0, -0.03, 0] },
            ],
            "muscles": muscles,
            "springs": [ { "name": "spring", "from": { "body": "ground", "at": [0.03, -0.02, 0] }, "to": { "body": "b", "at": [0.01, -0.05, 0] }, "stiffness": 40, "damping": 0.2 } ],
            "markers": [ { "name": "tip", "body": "b", "at": [0, -0.06, 0] } ],
            "loads": [
                { "name": "charge", "muscle": "charged" }, { "name": "motor", "joint": "hinge" },
                { "name": "push", "point": { "body": "b", "at": [0, -0.06, 0] }, "direction": [1, 0.2, 0] },
            ],
            "gravity": [0, -9.81, 0],
        },
        "simulate": {
            "duration": DURATION, "step": DURATION / STEPS as f64, "voltages": voltages,
            "loads": { "charge": sine("0.5 uC", "0.3 uC"), "motor": sine("0 N m", "2 mN m"), "push": sine("0.1 N", "50 mN") },
            "start": { "joint_rates": { "hinge": 1.0, "slide": "20 mm/s" } },
        }
    })
}

/// All columns of the motion of a problem by a method in a number of steps.
fn columns((system, task): (&System, &Simulation), by: Integrator, steps: usize) -> Vec<Column> {
    let mut task = task.clone();
    task.solving.integrator = by;
    task.step = task.duration / steps as f64;
    let run = integrate(system, &task, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!((run.failure, run.discrete.intervals()), (None, steps));
    let trajectory = Trajectory::from_discrete(&run.model, &run.discrete);
    let mut columns = observations(&run.model, &run.discrete).columns;
    columns.extend(EnergyExchange::new(system, &trajectory, [None, None]).columns());
    columns
}

fn simulation(problem_file: &Value) -> (System, Simulation) {
    let (system, task) = problem(problem_file);
    let Task::Simulate(task) = task else {
        panic!("a simulation")
    };
    (system, task)
}

/// Greatest difference of a column from a fine one at its rows, relative to its size.
fn error(coarse: &Column, fine: &Column) -> f64 {
    let parts = (fine.values.len() - 1) / (coarse.values.len() - 1);
    let of_fine = fine.values.iter().step_by(parts);
    let apart = coarse
        .values
        .iter()
        .zip(of_fine)
        .map(|(a, b)| (a - b).abs());
    let size = fine
        .values
        .iter()
        .fold(0.0_f64, |size, x| size.max(x.abs()));
    apart.fold(0.0, f64::max) / size
}

#[test]
fn every_column_has_the_order_of_its_motion() {
    let alpha = Integrator::GeneralisedAlpha {
        spectral_radius: 0.8,
    };
    for (memory, by, order, steps) in [
        (true, Integrator::Midpoint, 2.0, 64),
        (true, Integrator::ImplicitEuler, 1.0, 128),
        (true, alpha, 2.0, 128),
        (true, Integrator::Galerkin { degree: 2 }, 2.0, 32),
        (false, Integrator::Galerkin { degree: 2 }, 4.0, 16),
    ] {
        let (system, task) = simulation(&robot(memory));
        let of = (&system, &task);
        // Its own errors are far below those of the methods that are compared with it.
        let fine = columns(of, Integrator::Galerkin { degree: 3 }, FINE);
        let [coarse, finer] = [1, 4].map(|parts| columns(of, by, parts * steps));
        let names = |columns: &[Column]| columns.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
        // Reactions are those of the midpoint rule alone.
        let is_reaction =
            |column: &Column| column.name.contains("_force_") || column.name.contains("_torque_");
        let [coarse, finer] = [coarse, finer].map(|mut columns| {
            columns.retain(|column| !is_reaction(column));
            columns
        });
        assert_eq!(names(&coarse), names(&fine));
        let mut compared = 0;
        for ((coarse, finer), exact) in coarse.iter().zip(&finer).zip(&fine) {
            let name = &coarse.name;
            if !exact.values.iter().any(|x| x.abs() > 1e-12) || name == "constraint_violation" {
                continue;
            }
            let errors = [error(coarse, exact), error(finer, exact)];
            let observed = 0.5 * (errors[0] / errors[1]).log2();
            // Energies from the sources are sums of second order.
            let is_sum = ["_energy", "_work", "_heat"]
                .iter()
                .any(|end| name.ends_with(end))
                && !["total_energy", "kinetic_energy"].contains(&&**name);
            let order = if is_sum { f64::min(order, 2.0) } else { order };
            let is_exact = errors[1] < 1e-9;
            println!("{by:?} {name}: {errors:?} {observed:.2}");
            assert!(
                is_exact || observed > order - 0.35,
                "{by:?} {name}: {errors:?} {observed}"
            );
            compared += 1;
        }
        assert!(compared > 40, "{compared} columns");
    }
}

#[test]
fn columns_of_one_row_belong_to_one_state() {
    let (system, task) = simulation(&robot(false));
    for (by, steps, tolerance) in [
        // Methods whose columns are those at instants agree to rounding, those of the midpoint rule to its order.
        (Integrator::Galerkin { degree: 2 }, STEPS, 1e-12),
        (Integrator::ImplicitEuler, STEPS, 1e-12),
        (Integrator::Midpoint, 1024, 1e-4),
    ] {
        let columns = columns((&system, &task), by, steps);
        let of = |name: &str| {
            &columns
                .iter()
                .find(|column| column.name == name)
                .unwrap()
                .values
        };
        let sine =
            |mean: f64, amplitude: f64, time: f64| mean + amplitude * (TAU * time / PERIOD).sin();
        let muscle = &system.muscles[0];
        let capacitance = |stretch: f64| {
            // ε A/(n t) of the layers at constant volume, with the terms of first order in the deformation.
            let volume = muscle.volume() / muscle.layer_thickness.powi(2);
            let [c1, c2] = [-2.0, 1.0].map(|part| part * VACUUM_PERMITTIVITY);
            let invariant = stretch * stretch;
            -2.0 * volume * (c1 + c2 * invariant - VACUUM_PERMITTIVITY / (2.0 * invariant))
        };
        let near = |a: f64, b: f64, size: f64, what: &str| {
            assert!((a - b).abs() <= tolerance * size, "{by:?} {what}: {a} {b}");
        };
        for (k, &time) in of("time").iter().enumerate() {
            let voltage = sine(1000.0, 500.0, time);
            let stretch = of("direct_stretch")[k];
            let field = voltage / (muscle.layer_thickness * stretch) * 1e-3;
            near(of("direct_field")[k], field, 30.0, "field");
            let charge = of("direct_charge")[k];
            let ratio = charge / (capacitance(stretch) * voltage);
            near(
                ratio,
                of("direct_charge")[0] / (capacitance(of("direct_stretch")[0]) * 1000.0),
                1.0,
                "charge",
            );
            let power = of("direct_power")[k];
            near(power, voltage * of("direct_current")[k], 0.1, "power");
            let given = sine(5e-4, 3e-4, time);
            let across = of("charged_voltage")[k] * capacitance(of("charged_stretch")[k]);
            near(across / given, ratio, 1.0, "voltage of a given charge");
            let motor = sine(0.0, 2.0, time) * of("hinge_rate")[k];
            near(of("motor_power")[k], motor, 1e-2, "power of a motor");
        }
        let power: f64 = of("direct_power")
            .iter()
            .map(|p| p.abs())
            .fold(0.0, f64::max);
        assert!(power > 1e-4, "{power}");
    }
}
