//! Limits of currents, powers and voltage rates of sources without resistors: kept, active, the same in both coordinates and where the
//! duration is free, and those of the table.

use crate::drivers::{Table, capacitance, pair};
use crate::limits::{Ran, run};
use serde_json::{Value, json};

/// What flows at the instants, from the voltages of the intervals and the capacitances at the instants alone.
struct Flow {
    /// Currents in A between the middles of neighbouring intervals, then from the start and to the end, of half an interval.
    currents: Vec<f64>,
    powers: Vec<f64>,
    /// Rates of the voltage in V/s.
    rates: Vec<f64>,
    /// Columns of the table at the instants between two intervals.
    columns: [Vec<f64>; 2],
    /// Stored energy in J after the end.
    stored: f64,
    objective: f64,
}

/// The second muscle of a solved problem.
fn solved(problem: &Value) -> Flow {
    let ran = run("solve", problem, &[]);
    ran.is_solved();
    flow(&ran, "muscle2", 1700.0)
}

/// A muscle of a result, from no voltage to that of the goal.
fn flow(ran: &Ran, muscle: &str, goal: f64) -> Flow {
    let [motion, controls] = ["trajectory.csv", "controls.csv"].map(|name| Table::read(ran, name));
    let stretches = motion.column(&format!("{muscle}_stretch"));
    let c: Vec<f64> = stretches.into_iter().map(capacitance).collect();
    let v = controls.column(muscle);
    let last = v.len() - 1;
    let step = 1e-3 * motion.column("time")[1];
    let charge = |k: usize| 0.5 * (c[k] + c[k + 1]) * v[k];
    let energy = |k: usize, v: f64| 0.5 * c[k] * v * v;
    let between = |of: &dyn Fn(usize) -> f64, ends: [f64; 2]| {
        let inner = (1..=last).map(|k| of(k) / step);
        inner
            .chain(ends.map(|end| 2.0 * end / step))
            .collect::<Vec<f64>>()
    };
    let column = |name: &str| motion.column(name)[1..=last].to_vec();
    Flow {
        currents: between(
            &|k| charge(k) - charge(k - 1),
            [charge(0), c[last + 1] * goal - charge(last)],
        ),
        powers: between(
            &|k| energy(k + 1, v[k]) - energy(k - 1, v[k - 1]),
            [
                energy(1, v[0]),
                energy(last + 1, goal) - energy(last, v[last]),
            ],
        ),
        rates: between(&|k| v[k] - v[k - 1], [v[0], goal - v[last]]),
        columns: ["current", "power"].map(|name| column(&format!("{muscle}_{name}"))),
        stored: energy(last + 1, goal),
        objective: ran.read("summary.json")["objective"].as_f64().unwrap(),
    }
}

fn problem(limits: Value, coordinates: &str, is_free: bool) -> Value {
    let mut problem = pair(&Value::Null, limits, coordinates);
    problem["control"]["duration"] = json!("0.12 s");
    if is_free {
        problem["control"]["duration"] = json!({ "min": 0.05, "max": 0.4, "guess": 0.1 });
        problem["control"]["objective"] = json!({ "effort": 0.1, "duration": 1.0 });
    }
    problem
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Greatest difference of a column and the flow between intervals at the same instants, relative to the greatest flow.
fn distance(column: &[f64], flow: &[f64]) -> f64 {
    let pairs = column.iter().zip(flow);
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    most / greatest(&flow[..column.len()])
}

#[test]
fn sources_without_resistors_keep_their_limits() {
    type Read = fn(&Flow) -> &Vec<f64>;
    let kinds: [(&str, Read, f64); 3] = [
        ("current", |flow| &flow.currents, 0.02),
        ("power", |flow| &flow.powers, 20.0),
        ("voltage_rate", |flow| &flow.rates, 5e5),
    ];
    for is_free in [false, true] {
        let free = solved(&problem(json!([]), "reduced", is_free));
        for (kind, read, least) in kinds {
            let most = greatest(read(&free));
            assert!(most > least, "{kind}: {most}");
            let bound = 0.5 * most;
            let limit = json!([{ kind: { "sources": "all", "min": -3.0 * bound, "max": bound } }]);
            let both = ["reduced", "redundant"]
                .map(|coordinates| solved(&problem(limit.clone(), coordinates, is_free)));
            for flow in &both {
                let found = greatest(read(flow)) / bound;
                assert!((found - 1.0).abs() < 1e-6, "{kind}: {found}");
                assert!(flow.objective > 1.001 * free.objective, "{kind}");
                let columns = [(0, &flow.currents), (1, &flow.powers)];
                for (column, flow) in columns {
                    println!(
                        "{is_free} {kind} {column} {}",
                        distance(&free.columns[column], flow)
                    );
                }
            }
            let [one, other] = both.map(|flow| flow.objective);
            assert!((one / other - 1.0).abs() < 1e-6, "{kind}: {one} {other}");
        }
    }
}

#[test]
fn power_is_the_stored_energy_and_the_work_on_the_motion() {
    let limit = json!([{ "power": { "sources": "all", "max": "12 W" } }]);
    let ran = run("solve", &problem(limit, "reduced", false), &[]);
    ran.is_solved();
    let step = 1e-3 * Table::read(&ran, "trajectory.csv").column("time")[1];
    let flows = [("muscle1", 0.0), ("muscle2", 1700.0)].map(|(name, goal)| flow(&ran, name, goal));
    // Each power lasts an interval, the first and the last half of one.
    let supplied = flows.iter().map(|flow| {
        let ends = flow.powers.len() - 2;
        let (inner, ends) = flow.powers.split_at(ends);
        step * (inner.iter().sum::<f64>() + 0.5 * ends.iter().sum::<f64>())
    });
    let supplied = supplied.sum::<f64>();
    let stored: f64 = flows.iter().map(|flow| flow.stored).sum();
    let energies = &ran.read("summary.json")["energies"];
    let [electrical, work] =
        ["electrical_energy", "mechanical_work"].map(|key| energies[key].as_f64().unwrap());
    assert!(
        work.abs() > 1e-3 * stored && stored > 0.05,
        "{work} {stored}"
    );
    assert!((supplied - stored - work).abs() < 1e-9 * stored);
    // What the sources lose by charging in steps does not count.
    assert!(electrical > 1.01 * supplied, "{electrical} {supplied}");
}
