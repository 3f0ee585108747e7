//! Circuits of electrodes of finite elements: the motion of a lumped muscle with the same circuit, the ideal source without resistance, a
//! balance of energies, states of rest, optima, and mistakes.

use crate::drivers::Table;
use crate::limits::{Ran, run};
use serde_json::{Value, json};

/// Capacitance in F of a plate of 1 cm² and 1 mm with the relative permittivity 3.
const CAPACITANCE: f64 = 3.0 * 8.8541878128e-12 * 1e-4 / 1e-3;
/// Ω.
const RESISTANCE: f64 = 7.5e9;
/// s.
const STEP: f64 = 1e-3;

fn materials() -> Value {
    json!({ "silicone": { "density": 1000, "shear_modulus": "100 kPa", "lame_lambda": "400 kPa",
        "relative_permittivity": 3.0, "dielectric": "ideal", "viscosity": 1000 } })
}

/// A plate of one element with a circuit, whose faces are held, the upper one in some directions.
fn plate(circuit: &Value, held: Value) -> Value {
    let mut driven = json!({ "name": "top", "face": "z_max", "potential": "driven" });
    if !circuit.is_null() {
        driven["circuit"] = circuit.clone();
    }
    json!({ "name": "plate", "materials": materials(), "solids": [{
        "name": "plate", "material": "silicone",
        "box": { "size": ["10 mm", "10 mm", "1 mm"], "elements": [1, 1, 1] },
        "electrodes": [{ "name": "bottom", "face": "z_min", "potential": "grounded" }, driven],
        "fixed": ["z_min", { "face": "z_max", "directions": held }] }] })
}

/// The same as a muscle between the ground and a body whose motion is prescribed: it rests.
fn muscle(circuit: &Value, model: &str, layer: &str) -> Value {
    let at = |body: &str, z: f64| json!({ "body": body, "at": [0, 0, z] });
    let still = json!({ "ramp": { "from": 0, "to": 0, "duration": 1 } });
    let mut muscle = json!({ "name": "plate", "material": "silicone", "from": at("ground", 0.0),
        "to": at("end", 1e-3), "cross_section": ["10 mm", "10 mm"],
        "layer_thickness": layer, "circuit": circuit });
    if model != "lumped" {
        muscle["model"] = json!(model);
        muscle["elements"] = json!([1, 1, 2]);
        muscle["layers"] = json!(2);
    }
    json!({ "name": "muscle", "materials": materials(),
        "bodies": [{ "name": "end", "mass": "1 g", "position": [0, 0, 1e-3],
            "box": { "size": ["1 mm", "1 mm", "1 mm"] } }],
        "joints": [{ "name": "rail", "prismatic": { "axis": [0, 0, 1] }, "parent": "ground",
            "child": "end", "at": [0, 0, 0], "motion": still }],
        "muscles": [muscle] })
}

fn simulated(scene: &Value, source: &str, voltage: &Value) -> Table {
    let mut problem = json!({ "scene": scene,
        "simulate": { "duration": 40.0 * STEP, "step": STEP, "voltages": {} } });
    problem["simulate"]["voltages"][source] = voltage.clone();
    let ran = run("simulate", &problem, &["--no-report"]);
    assert_eq!(ran.status, 0, "{}{}", ran.out, ran.err);
    Table::read(&ran, "trajectory.csv")
}

fn wave() -> Value {
    json!({ "sine": { "amplitude": "2 kV", "period": "30 ms", "mean": "1 kV" } })
}

#[test]
fn a_plate_that_does_not_move_is_charged_as_a_lumped_muscle() {
    let all = json!(["x", "y", "z"]);
    let circuits = [
        json!({ "resistance": RESISTANCE }),
        json!({ "resistance": RESISTANCE, "leakage": 2.0 * RESISTANCE }),
    ];
    for circuit in &circuits {
        let plate = simulated(&plate(circuit, all.clone()), "plate.top", &wave());
        let muscle = simulated(&muscle(circuit, "lumped", "1 mm"), "plate", &wave());
        for (quantity, unit) in [("charge", 1e-9), ("current", 1e-7), ("power", 1e-4)] {
            let one = plate.column(&format!("plate_top_{quantity}"));
            let other = muscle.column(&format!("plate_{quantity}"));
            let size = other
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            let scale = if quantity == "charge" {
                1e9 * unit
            } else {
                unit
            };
            assert!(size > scale, "{quantity}: {other:?}");
            // Rows of the ends are extrapolated.
            let inner = one.iter().zip(&other).take(40).skip(1);
            let [first, last] = [0, 40].map(|k| (one[k] - other[k]).abs() / size);
            assert!(first < 2e-3 && last < 2e-3, "{quantity}: {first} {last}");
            for (k, (a, b)) in inner.enumerate() {
                assert!((a - b).abs() < 1e-8 * size, "{quantity} {k}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_muscle_of_finite_elements_is_charged_as_a_lumped_one() {
    // Layers of 0.1 mm: a hundred times the capacitance. Little voltage, so that the elements hardly bulge.
    let circuit = json!({ "resistance": 1e-2 * RESISTANCE, "leakage": RESISTANCE });
    let voltage = json!({ "ramp": { "from": 0, "to": "1 V", "duration": "30 ms" } });
    let [one, other] = ["finite_elements", "lumped"]
        .map(|model| simulated(&muscle(&circuit, model, "0.1 mm"), "plate", &voltage));
    for quantity in ["charge", "current", "voltage", "power"] {
        let name = format!("plate_{quantity}");
        let [one, other] = [&one, &other].map(|table| table.column(&name));
        let size = other
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(size > 1e-12, "{quantity}: {other:?}");
        let (skipped, near) = match quantity {
            // That of the lumped muscle is read at the instants.
            "voltage" => (1, 1e-3),
            _ => (1, 1e-6),
        };
        for k in skipped..40 {
            let error = (one[k] - other[k]).abs();
            assert!(
                error < near * size,
                "{quantity} {k}: {} {}",
                one[k],
                other[k]
            );
        }
    }
}

#[test]
fn energy_from_the_source_is_stored_or_heats_the_resistor() {
    let circuit = json!({ "resistance": RESISTANCE });
    let all = json!(["x", "y", "z"]);
    let seen = simulated(&plate(&circuit, all), "plate.top", &json!("3 kV"));
    // The midpoint rule of R Q̇ + Q/C = V.
    let part = STEP / (RESISTANCE * CAPACITANCE);
    let full = 3e3 * CAPACITANCE;
    let step = |q: &f64| Some((q * (1.0 - 0.5 * part) + full * part) / (1.0 + 0.5 * part));
    let charges: Vec<f64> = std::iter::successors(Some(0.0), step).take(41).collect();
    let found = seen.column("plate_top_charge");
    let heat = seen.column("dissipated_energy");
    let [supply, own] = ["electrical_energy", "resistor_heat"]
        .map(|name| seen.column(&format!("plate_top_{name}")));
    let mut sum = 0.0;
    for k in 1..40 {
        // A column of charges has the means of the middles of both intervals, in nC.
        let mean = 0.25 * (charges[k - 1] + 2.0 * charges[k] + charges[k + 1]);
        assert!((1e-9 * found[k] / full - mean / full).abs() < 1e-8, "{k}");
        let charge = charges[k] - charges[k - 1];
        sum += RESISTANCE * charge * charge / STEP;
        let stored = 0.5 * charges[k] * charges[k] / CAPACITANCE;
        let supplied = 3e3 * charges[k];
        assert!((1e-3 * supply[k] / supplied - 1.0).abs() < 1e-8, "{k}");
        assert!(
            (1e-3 * own[k] / supplied - sum / supplied).abs() < 1e-8,
            "{k}"
        );
        // Heat in mJ, apart from that of the elements, which do not move.
        assert!(
            (1e-3 * heat[k] / supplied - sum / supplied).abs() < 1e-8,
            "{k}"
        );
        let taken = stored + 1e-3 * heat[k];
        assert!((taken / supplied - 1.0).abs() < 1e-8, "{k}");
    }
    assert!(sum > 5e-6, "{sum}");
}

#[test]
fn without_resistance_it_is_the_source() {
    let free = json!(["x", "y"]);
    let ideal = simulated(&plate(&Value::Null, free.clone()), "plate.top", &slow());
    let heights = |table: &Table| table.column("plate_top_charge")[30];
    let error = |resistance: f64| {
        let circuit = json!({ "resistance": resistance });
        let seen = simulated(&plate(&circuit, free.clone()), "plate.top", &slow());
        heights(&seen) - heights(&ideal)
    };
    let errors = [4e8, 2e8, 1e8].map(error);
    assert!(errors[0].abs() > 1e-3 * heights(&ideal), "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((ratio - 2.0).abs() < 0.1, "{errors:?}");
    }
}

/// A voltage that begins at zero with the rate zero.
fn slow() -> Value {
    let phase = -std::f64::consts::FRAC_PI_2;
    json!({ "sine": { "mean": "1.5 kV", "amplitude": "1.5 kV", "period": "80 ms", "phase": phase } })
}

fn solved(problem: &Value) -> Ran {
    let ran = run("solve", problem, &["--no-report"]);
    ran.is_solved();
    ran
}

#[test]
fn a_goal_of_rest_is_reached_through_a_resistor() {
    let circuit = json!({ "resistance": 2e9, "leakage": 2e10 });
    let scene = plate(&circuit, json!(["x", "y"]));
    let problem = json!({ "scene": scene, "control": {
        "duration": "40 ms", "intervals": 20, "start": { "rest_at_voltages": {} },
        "goal": { "rest_at_voltages": { "plate.top": "2 kV" } },
        "voltage_bounds": ["0 V", "5 kV"], "objective": { "effort": 1.0 } } });
    let ran = solved(&problem);
    let motion = Table::read(&ran, "trajectory.csv");
    let voltage = motion.column("plate_top_voltage");
    // The leak leaves ten elevenths of the voltage of the source.
    let rest = run(
        "equilibrium",
        &json!({ "scene": problem["scene"],
        "equilibrium": { "voltages": { "plate.top": "2 kV" } } }),
        &["--no-report"],
    );
    assert_eq!(rest.status, 0, "{}{}", rest.out, rest.err);
    let charge = |ran: &Ran| {
        *Table::read(ran, "trajectory.csv")
            .column("plate_top_charge")
            .last()
            .unwrap()
    };
    let rest = Table::read(&rest, "equilibrium.csv").column("plate_top_charge")[0];
    assert!(rest > 4.0, "{rest}");
    assert!(voltage.iter().any(|v| *v > 1e3), "{voltage:?}");
    assert!(
        (charge(&ran) / rest - 1.0).abs() < 0.02,
        "{} {rest}",
        charge(&ran)
    );
}

#[test]
fn circuits_of_electrodes_that_make_no_sense_are_refused() {
    let place = "solids[0].electrodes[";
    let simulate = |scene: Value| {
        json!({ "scene": scene,
        "simulate": { "duration": 1.0, "step": 0.1, "voltages": {} } })
    };
    let refused = |circuit: Value, at: usize, words: &[&str]| {
        let mut scene = plate(&Value::Null, json!(["x"]));
        scene["solids"][0]["electrodes"][at]["circuit"] = circuit;
        let ran = run("simulate", &simulate(scene), &[]);
        ran.is_refused(&[&[place, "circuit"], words].concat());
    };
    refused(json!({}), 1, &["without parts"]);
    refused(json!({ "resistance": 0 }), 1, &["resistance", "0"]);
    refused(json!({ "resistance": "1 V" }), 1, &["resistance"]);
    refused(json!({ "leakage": -1 }), 1, &["leakage"]);
    refused(
        json!({ "resistance": 1e9 }),
        0,
        &["does not charge", "a driven electrode"],
    );
    refused(json!({ "leakage": 1e9 }), 1, &["a leak without a resistor"]);
}
