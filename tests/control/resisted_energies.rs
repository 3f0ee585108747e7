//! Least electrical energy through resistors: the objective is what the sources supply, heat included, and less is drawn than by least effort.

use crate::drivers::{Table, capacitance, pair};
use crate::limits::run;
use serde_json::{Value, json};

/// Resistances in Ω of resistor and leak.
const PARTS: [f64; 2] = [200e3, 20e6];

/// A solved problem of the pair behind resistors: the objective, the energy of the summary, and that of currents through the sources in J.
fn solved(leak: bool, objective: Value, duration: Value, coordinates: &str) -> [f64; 3] {
    let circuit = match leak {
        true => json!({ "resistance": PARTS[0], "leakage": PARTS[1] }),
        false => json!({ "resistance": PARTS[0] }),
    };
    let mut problem = pair(&circuit, json!([]), coordinates);
    problem["control"]["objective"] = objective;
    problem["control"]["duration"] = duration;
    let ran = run("solve", &problem, &[]);
    ran.is_solved();
    let [motion, controls] = ["trajectory.csv", "controls.csv"].map(|name| Table::read(&ran, name));
    let step = 1e-3 * motion.column("time")[1];
    let supplied = ["muscle1", "muscle2"].map(|muscle| {
        let volts = motion.column(&format!("{muscle}_voltage"));
        let stretches = motion.column(&format!("{muscle}_stretch"));
        let charge = |(volts, stretch): (&f64, &f64)| volts * capacitance(*stretch);
        let charges: Vec<f64> = volts.iter().zip(&stretches).map(charge).collect();
        let sources = controls.column(muscle);
        let energy = sources.iter().zip(charges.windows(2)).map(|(source, q)| {
            let taken = q[1] - q[0];
            // Of V = R i + R_L (i − Q̇), over an interval.
            let through = match leak {
                true => (source * step + PARTS[1] * taken) / (PARTS[0] + PARTS[1]),
                false => taken,
            };
            source * through
        });
        energy.sum::<f64>()
    });
    let summary = ran.read("summary.json");
    let number = |value: &Value| value.as_f64().unwrap();
    [
        number(&summary["objective"]),
        number(&summary["energies"]["electrical_energy"]),
        supplied.iter().sum(),
    ]
}

#[test]
fn least_energy_through_resistors_draws_less_than_least_effort() {
    for leak in [false, true] {
        let of = |objective: Value, coordinates: &str| {
            solved(leak, objective, json!("0.12 s"), coordinates)
        };
        let [_, drawn, _] = of(json!({ "effort": 1 }), "reduced");
        assert!(drawn > 0.1, "{drawn}");
        let least = json!({ "electrical_energy": 2.0 });
        let both = ["reduced", "redundant"].map(|coordinates| of(least.clone(), coordinates));
        for [objective, summary, supplied] in both {
            println!("{drawn} {objective} {summary} {supplied}");
            assert!((objective / (2.0 * supplied) - 1.0).abs() < 1e-8);
            assert!((summary / supplied - 1.0).abs() < 1e-8);
            assert!(supplied < 0.98 * drawn, "{supplied} {drawn}");
        }
        assert!((both[0][0] / both[1][0] - 1.0).abs() < 1e-6, "{both:?}");
    }
}

#[test]
fn energy_through_resistors_counts_in_a_free_duration() {
    let free = json!({ "min": 0.05, "max": 0.4, "guess": 0.1 });
    let of = |energy: f64| {
        let objective = json!({ "effort": 0.01, "electrical_energy": energy, "duration": 1 });
        solved(true, objective, free.clone(), "reduced")
    };
    let [_, cheap, supplied] = of(0.1);
    let [_, dear, _] = of(2.0);
    println!("{cheap} {dear}");
    assert!((cheap / supplied - 1.0).abs() < 1e-8);
    assert!(dear < 0.98 * cheap, "{dear} {cheap}");
}

#[test]
fn energies_that_are_not_known_are_refused() {
    let refused = |circuit: Value, objective: Value, words: &[&str]| {
        let mut problem = pair(&circuit, json!([]), "reduced");
        problem["control"]["objective"] = objective;
        run("solve", &problem, &[]).is_refused(words);
    };
    let resistor = json!({ "resistance": PARTS[0] });
    let work = json!({ "mechanical_work": 1 });
    refused(
        resistor,
        work,
        &["objective.mechanical_work", "has a resistor"],
    );
    let leak = json!({ "leakage": PARTS[1] });
    let energy = json!({ "electrical_energy": 1 });
    refused(
        leak,
        energy,
        &["objective.electrical_energy", "leaks and has no resistor"],
    );
}
