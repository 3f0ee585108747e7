//! Limits of currents and powers of sources, and of fields of charged muscles: kept, active, the same in both coordinates, and refused where
//! they make no sense.

use crate::limits::{Ran, run};
use serde_json::{Value, json};
use std::path::Path;

/// The pair in 0.2 s with ideal dielectrics behind circuits, with limits.
pub(crate) fn pair(circuit: &Value, limits: Value, coordinates: &str) -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let kept = |name: &str| -> Value {
        let text = std::fs::read_to_string(root.join(name)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let mut problem = kept("problems/pair.json");
    problem["scene"] = kept("problems/scenes/pair.json");
    problem["scene"]["materials"]["silicone"]["dielectric"] = json!("ideal");
    if !circuit.is_null() {
        problem["scene"]["chain"]["muscles"]["circuit"] = circuit.clone();
    }
    problem["control"]["coordinates"] = json!(coordinates);
    problem["control"]["limits"] = limits;
    problem
}

/// A table of a result, columns by their names without units.
pub(crate) struct Table {
    head: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn read(ran: &Ran, name: &str) -> Self {
        let text = std::fs::read_to_string(ran.folder.path().join("p").join(name)).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let head = lines.next().unwrap().split(',');
        let head = head.map(|name| name.split(' ').next().unwrap().to_owned());
        let number = |cell: &str| cell.parse().unwrap_or(f64::NAN);
        Self {
            head: head.collect(),
            rows: lines
                .map(|line| line.split(',').map(number).collect())
                .collect(),
        }
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let place = self.head.iter().position(|head| head == name);
        let place = place.unwrap_or_else(|| panic!("{name} in {:?}", self.head));
        self.rows.iter().map(|row| row[place]).collect()
    }
}

/// Capacitance in F of a stack of 40 mm of an ideal dielectric at a stretch.
pub(crate) fn capacitance(stretch: f64) -> f64 {
    3.0 * 8.8541878128e-12 * 100e-6 * 40e-3 / 50e-6_f64.powi(2) / (stretch * stretch)
}

/// What the source of a muscle does.
struct Seen {
    /// Mean current in A and power in W in each interval.
    currents: Vec<f64>,
    powers: Vec<f64>,
    /// Charge in C at each instant.
    charges: Vec<f64>,
    /// Greatest field at the instants in V/um.
    field: f64,
    objective: f64,
}

/// A solved problem, whose current follows from the charges of its muscle and the resistances in Ω of resistor and leak.
fn solved(problem: &Value, muscle: &str, [series, leak]: [f64; 2]) -> Seen {
    let ran = run("solve", problem, &[]);
    ran.is_solved();
    let [motion, controls] = ["trajectory.csv", "controls.csv"].map(|name| Table::read(&ran, name));
    let volts = motion.column(&format!("{muscle}_voltage"));
    let stretches = motion.column(&format!("{muscle}_stretch"));
    let charge = |(volts, stretch): (&f64, &f64)| volts * capacitance(*stretch);
    let charges: Vec<f64> = volts.iter().zip(&stretches).map(charge).collect();
    let step = 1e-3 * motion.column("time")[1];
    let sources = controls.column(muscle);
    // R (i − Q̇) − R_L Q̇' … of the loop through the leak: V = R i + R_L (i − Q̇).
    let current = |(source, charge): (&f64, &[f64])| match leak.is_finite() {
        true => (source + leak * (charge[1] - charge[0]) / step) / (series + leak),
        false => (charge[1] - charge[0]) / step,
    };
    let currents: Vec<f64> = sources
        .iter()
        .zip(charges.windows(2))
        .map(current)
        .collect();
    let powers = currents.iter().zip(&sources).map(|(i, v)| i * v).collect();
    let fields = volts.iter().zip(&stretches);
    let field = fields.map(|(volts, stretch)| volts / (50.0 * stretch));
    Seen {
        currents,
        powers,
        charges,
        field: field.fold(0.0, f64::max),
        objective: ran.read("summary.json")["objective"].as_f64().unwrap(),
    }
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_source_gives_no_more_than_its_limits() {
    const SERIES: f64 = 200e3;
    let resistor = json!({ "resistance": SERIES });
    let of = |limits: Value, coordinates: &str| {
        let mut problem = pair(&resistor, limits, coordinates);
        problem["control"]["duration"] = json!("0.12 s");
        solved(&problem, "muscle2", [SERIES, f64::INFINITY])
    };
    let free = of(json!([]), "reduced");
    let (current, power) = (greatest(&free.currents), greatest(&free.powers));
    assert!(current > 3e-3 && power > 8.0, "{current} {power}");
    type Read = fn(&Seen) -> f64;
    let cases: [(Value, Read, f64); 2] = [
        (
            json!({ "current": { "sources": "all", "max": "1 mA" } }),
            |seen| 1e3 * greatest(&seen.currents),
            1.0,
        ),
        (
            json!({ "power": { "source": "muscle2", "max": "1.8 W" } }),
            |seen| greatest(&seen.powers),
            1.8,
        ),
    ];
    for (limit, read, bound) in cases {
        let both = ["reduced", "redundant"].map(|coordinates| of(json!([limit]), coordinates));
        for seen in &both {
            let found = read(seen);
            assert!((found / bound - 1.0).abs() < 1e-6, "{limit}: {found}");
            assert!(seen.objective > 1.0001 * free.objective, "{limit}");
        }
        let [one, other] = both.map(|seen| seen.objective);
        assert!((one / other - 1.0).abs() < 1e-6, "{limit}: {one} {other}");
    }
}

#[test]
fn a_muscle_behind_a_resistor_keeps_its_field() {
    let of = |limits: Value, coordinates: &str| {
        let mut problem = pair(&json!({ "resistance": 200e3 }), limits, coordinates);
        problem["control"]["duration"] = json!({ "min": 0.02, "max": 0.4, "guess": 0.1 });
        problem["control"]["objective"] = json!({ "effort": 0.01, "duration": 1.0 });
        solved(&problem, "muscle2", [200e3, f64::INFINITY])
    };
    let free = of(json!([]), "reduced");
    assert!(free.field > 45.0, "{}", free.field);
    let limit = json!([{ "electric_field": { "muscles": "all", "max": "40 V/um" } }]);
    let both = ["reduced", "redundant"].map(|coordinates| of(limit.clone(), coordinates));
    for seen in &both {
        assert!((seen.field / 40.0 - 1.0).abs() < 1e-6, "{}", seen.field);
        assert!(seen.objective > 1.0001 * free.objective);
    }
    let [one, other] = both.map(|seen| seen.objective);
    assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
}

#[test]
fn a_charge_falls_through_its_leak_alone_where_the_source_takes_nothing() {
    const PARTS: [f64; 2] = [100e3, 2e6];
    let circuit = json!({ "resistance": PARTS[0], "leakage": PARTS[1] });
    let of = |limits: Value| {
        let mut problem = pair(&circuit, limits, "reduced");
        problem["control"]["start"] = json!({ "rest_at_voltages": { "muscle1": "1.7 kV" } });
        solved(&problem, "muscle1", PARTS)
    };
    let least = |seen: &Seen| seen.currents.iter().copied().fold(f64::INFINITY, f64::min);
    let steepest = |seen: &Seen| {
        let falls = seen
            .charges
            .windows(2)
            .map(|q| (q[0] - q[1]) / (0.5 * (q[0] + q[1])));
        falls.filter(|fall| fall.is_finite()).fold(0.0, f64::max)
    };
    let free = of(json!([]));
    assert!(least(&free) < -1e-4, "{}", least(&free));
    let driven = of(json!([{ "current": { "sources": "all", "min": 0 } }]));
    assert!(least(&driven).abs() < 1e-9, "{}", least(&driven));
    // 10 ms over R_L C, where the stack may be longer than at rest and C smaller.
    let rate = 10e-3 / (PARTS[1] * capacitance(1.0));
    assert!(steepest(&free) > 2.0 * rate, "{} {rate}", steepest(&free));
    assert!(
        steepest(&driven) < 1.3 * rate,
        "{} {rate}",
        steepest(&driven)
    );
    assert!(driven.objective > free.objective);
}

#[test]
fn limits_of_a_source_hold_where_the_duration_is_free() {
    let resistor = json!({ "resistance": 200e3 });
    let limits = json!([{ "current": { "sources": "all", "min": "-0.8 mA", "max": "0.8 mA" } }]);
    let mut problem = pair(&resistor, limits, "reduced");
    problem["control"]["duration"] = json!({ "min": 0.1, "max": 0.4, "guess": 0.2 });
    problem["control"]["objective"] = json!({ "effort": 0.1, "duration": 1.0 });
    let seen = solved(&problem, "muscle2", [200e3, f64::INFINITY]);
    let most = greatest(&seen.currents);
    assert!((most / 0.8e-3 - 1.0).abs() < 1e-5, "{most}");
}

#[test]
fn a_voltage_changes_no_faster_than_its_limit() {
    // Steps of the voltages in V between the middles of intervals of 10 ms, and of half an interval from and to rest.
    let steps = |limits: Value, coordinates: &str| {
        let ran = run("solve", &pair(&Value::Null, limits, coordinates), &[]);
        ran.is_solved();
        let controls = Table::read(&ran, "controls.csv");
        let of = |muscle: &str, goal: f64| {
            let volts = controls.column(muscle);
            let last = volts.len() - 1;
            let ends = [2.0 * volts[0], 2.0 * (goal - volts[last])];
            let inner = volts.windows(2).map(|v| v[1] - v[0]);
            inner.chain(ends).collect::<Vec<f64>>()
        };
        let all = [of("muscle1", 0.0), of("muscle2", 1700.0)].concat();
        let objective = ran.read("summary.json")["objective"].as_f64().unwrap();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        ([least, greatest(&all)], objective)
    };
    let (free, cheap) = steps(json!([]), "reduced");
    assert!(free[1] > 300.0, "{free:?}");
    let limit =
        json!([{ "voltage_rate": { "sources": "all", "min": "-15 kV/s", "max": "20 kV/s" } }]);
    let both = ["reduced", "redundant"].map(|coordinates| steps(limit.clone(), coordinates));
    for ([least, most], objective) in &both {
        assert!((most / 200.0 - 1.0).abs() < 1e-6, "{most}");
        assert!(*least > -150.0 - 1e-3, "{least}");
        assert!(*objective > 1.001 * cheap, "{objective} {cheap}");
    }
    let [one, other] = both.map(|(_, objective)| objective);
    assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
}

#[test]
fn limits_of_sources_that_make_no_sense_are_refused() {
    let refused = |circuit: &Value, limit: Value, words: &[&str]| {
        run("solve", &pair(circuit, json!([limit]), "reduced"), &[]).is_refused(words);
    };
    let resistor = json!({ "resistance": 200e3 });
    let current = |limit: Value| json!({ "current": limit });
    let place = "limits[0].current";
    refused(
        &resistor,
        current(json!({ "source": "muscle1" })),
        &[place, "no bound"],
    );
    refused(&resistor, current(json!({ "max": 1 })), &[place, "source"]);
    refused(
        &resistor,
        current(json!({ "source": "muscle1", "max": "1 mV" })),
        &[place, "1 mV", "a current"],
    );
    refused(
        &resistor,
        current(json!({ "source": "muscle7", "max": 1 })),
        &[place, "muscle7"],
    );
    refused(
        &resistor,
        current(json!({ "source": "muscle1", "min": 2, "max": 1 })),
        &[place, "crossed"],
    );
    let power = json!({ "power": { "sources": "all", "max": "1 W" } });
    let leak = json!({ "leakage": 2e6 });
    refused(
        &leak,
        power,
        &["limits[0].power", "leaks and has no resistor"],
    );
    // At rest the goal takes 1.7 kV over 2.2 MΩ.
    let circuit = json!({ "resistance": 200e3, "leakage": 2e6 });
    let low = current(json!({ "sources": "all", "max": "0.1 mA" }));
    refused(
        &circuit,
        low,
        &["control.goal", "current of muscle2", "0.77273 mA"],
    );
}
