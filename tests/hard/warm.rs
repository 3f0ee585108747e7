//! Starts from earlier solutions: of another goal, grid, duration or mesh.

use crate::page::{Case, Verdict};
use crate::program::{Run, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::{Value, json};

/// The trunk of two segments with smooth voltages, from rest to a rest under a voltage.
fn smooth(intervals: usize, duration: &str, voltage: &str) -> Value {
    let goal = json!({ "rest_at_voltages": { "muscle1": voltage, "muscle3": "1.6 kV" } });
    let mut problem = control(duration, intervals, goal);
    problem["control"]["objective"] = json!({ "effort": 1.0, "rate": 0.0005 });
    problem
}

/// The problem started from the solution of a run.
fn from(earlier: &Run, mut problem: Value) -> Value {
    let path = earlier.results().join("solution.json");
    problem["control"]["guess"] = json!({ "solution": path.to_str().unwrap() });
    problem
}

/// Solves cold and from an earlier solution; iterations of both, and the later run.
fn both(scene: &Value, problem: Value, earlier: &Run) -> ([f64; 2], Run) {
    let cold = run(scene, &problem).solved();
    let warm = run(scene, &from(earlier, problem)).solved();
    let [a, b] = [&cold, &warm].map(|run| run.number(&["objective"]));
    assert!((a - b).abs() < 1e-6 * a, "{a} against {b}");
    ([&cold, &warm].map(|run| run.number(&["iterations"])), warm)
}

#[test]
fn an_earlier_solution_saves_iterations() {
    let scene = trunk(2, silicone());
    let first = run(&scene, &smooth(20, "0.3 s", "1.7 kV")).solved();
    let mut rows: Vec<(String, [f64; 2])> = Vec::new();
    let (own, _) = both(&scene, smooth(20, "0.3 s", "1.7 kV"), &first);
    assert!(own[1] <= 2.0, "{own:?}");
    rows.push(("its own problem".to_owned(), own));
    for voltage in ["1.65 kV", "1.5 kV"] {
        let (moved, _) = both(&scene, smooth(20, "0.3 s", voltage), &first);
        assert!(moved[1] <= 12.0, "{voltage}: {moved:?}");
        rows.push((format!("goal at {voltage} in place of 1.7 kV"), moved));
    }
    let (longer, _) = both(&scene, smooth(20, "0.33 s", "1.7 kV"), &first);
    rows.push(("0.33 s in place of 0.3 s".to_owned(), longer));
    let mut earlier = first;
    for intervals in [40, 80, 160] {
        let (finer, warm) = both(&scene, smooth(intervals, "0.3 s", "1.7 kV"), &earlier);
        assert!(finer[1] <= 14.0, "{intervals}: {finer:?}");
        rows.push((format!("{intervals} intervals from half as many"), finer));
        earlier = warm;
    }
    let [cold, warm] = [0, 1].map(|i| rows.iter().map(|row| row.1[i]).sum::<f64>());
    assert!(2.0 * warm < cold, "{warm} and {cold} iterations");
    let curve = |name: &str, i: usize| {
        let points = rows.iter().enumerate();
        let points = points.map(|(k, row)| [k as f64 + 1.0, row.1[i]]).collect();
        Series::curve(name, points, hue(i)).marked(Mark::Disc)
    };
    let curves = vec![curve("from the guess", 0), curve("from a solution", 1)];
    let told = |(k, (what, [cold, warm])): (usize, &(String, [f64; 2]))| {
        format!(
            "{}: {what}: {cold} iterations from the guess, {warm} from the solution",
            k + 1
        )
    };
    Case {
        name: "warm-start",
        title: "A start from a solution of another goal, duration or grid",
        law: "The trunk of two segments with smooth voltages has the same optimum from the guess and from a solution of a related problem, to \
              1e-6. The solution itself needs two iterations at most, another goal 12, the next grid 14, and all of them less than half.",
        verdict: Verdict::Answer,
        seen: rows.iter().enumerate().map(told).collect(),
        x: Axis::linear("problem, as listed", Extent::Padded),
        y: Axis::linear("iterations", Extent::FromZero),
        curves,
    }
    .record();
}

/// The bending block with so many elements along and across, two driven layers of it.
fn beam(elements: [usize; 3]) -> Value {
    json!({
        "name": "bending block", "materials": { "silicone": silicone() },
        "solids": [{
            "name": "beam", "material": "silicone",
            "box": { "size": ["30 mm", "4 mm", "2 mm"], "elements": elements },
            "electrodes": [
                { "name": "lower", "face": "z_min", "potential": "driven" },
                { "name": "middle", "plane": { "z": "1 mm" }, "potential": "grounded" },
                { "name": "upper", "face": "z_max", "potential": "driven" },
            ],
            "fixed": [
                "x_min",
                { "face": "y_min", "directions": ["y"] },
                { "face": "y_max", "directions": ["y"] },
            ],
        }],
        "markers": [{ "name": "tip", "solid": "beam", "at": ["30 mm", 0, "1 mm"] }],
    })
}

/// Motion from rest to where the tip rests under 16 kV on one layer and 1 kV on the other.
fn bend(scene: &Value, intervals: usize) -> Value {
    let hold = json!({ "beam.lower": "16 kV", "beam.upper": "1 kV" });
    let rest = run(scene, &equilibrium(hold.clone())).solved();
    let mut problem = control(
        "0.4 s",
        intervals,
        json!({
            "markers": rest.summary["markers"], "rest": "markers", "hold": hold,
        }),
    );
    let task = &mut problem["control"];
    task["voltage_bounds"] = json!(["0 V", "25 kV"]);
    task["objective"] = json!({ "effort": 1.0, "rate": 0.002 });
    task["guess"] = json!({ "simulate": { "voltages": hold } });
    problem
}

#[test]
fn potentials_between_electrodes_are_steered_along_and_a_mesh_starts_another() {
    let (coarse, fine) = (beam([3, 1, 2]), beam([3, 1, 4]));
    let first = run(&coarse, &bend(&coarse, 8)).solved();
    // All nodes of the coarse mesh lie on electrodes; between those of the fine one are two layers of nodes.
    assert_eq!(first.number(&["blocks", "beam", "potentials"]), 0.0);
    let problem = bend(&fine, 8);
    let cold = run(&fine, &problem).solved();
    assert_eq!(cold.number(&["blocks", "beam", "potentials"]), 16.0);
    let warm = run(&fine, &from(&first, problem)).solved();
    let [a, b] = [&cold, &warm].map(|run| run.number(&["objective"]));
    assert!((a - b).abs() < 1e-6 * a, "{a} against {b}");
    // The simulation solves Gauss's law in every step, the optimum all of them at once.
    let deviation = cold.number(&["resimulation", "deviation", "length"]);
    assert!(deviation < 1e-10, "{deviation:e}");
    let told = |name: &str, run: &Run| {
        format!(
            "{name}: {} potentials, {} variables, objective {:.6}, {} iterations",
            run.number(&["blocks", "beam", "potentials"]),
            run.number(&["variables"]),
            run.number(&["objective"]),
            run.number(&["iterations"]),
        )
    };
    let curve = |name: &str, run: &Run, colour| {
        let points = crate::program::points(&run.column("time"), &run.column("tip_z"));
        Series::curve(name, points, hue(colour)).marked(Mark::Disc)
    };
    let curves = vec![
        curve("3 × 1 × 2 elements", &first, 0),
        curve("3 × 1 × 4 elements", &cold, 1),
    ];
    Case {
        name: "potentials-between-electrodes",
        title: "A bending block steered with potentials between its electrodes, and a start from a coarser mesh",
        law: "With two elements a layer the nodes between electrodes have potentials of their own, unknowns of every interval. A simulation \
              under the optimal voltages, which solves Gauss's law step by step, repeats the optimum to 1e-10 m, and started with \
              the voltages of the coarser mesh, whose nodes all lie on electrodes, the optimum is the same to 1e-6.",
        verdict: Verdict::Answer,
        seen: vec![
            told("coarse", &first),
            told("fine, from a simulation", &cold),
            told("fine, from the coarse solution", &warm),
        ],
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("tip z [mm]", Extent::Padded),
        curves,
    }
    .record();
}
