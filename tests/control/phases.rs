//! Phases of one motion: two in which nothing changes, times that are sought, a mass that is picked up, and what is refused.

use nalgebra::{DMatrix, DVector};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::files::{Loaded, read_problem_text};
use proboscis::nlp::joined::{Joined, SharedRow, SharedVariable};
use proboscis::nlp::{Nlp, differences};
use proboscis::tasks::{MotionsResult, solve_motions};
use proboscis::workflow::{Iterate, SolveRequest};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::Path;

pub(crate) fn read(problem: &Value) -> Result<Loaded, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/phases.json");
    let read = read_problem_text(&path, &problem.to_string(), &[]);
    read.map_err(|error| error.to_string())
}

/// The motions of a problem, which are solved.
pub(crate) fn solved(problem: &Value) -> MotionsResult {
    let loaded = read(problem).unwrap();
    let task = loaded.task.motions(&loaded.system).unwrap();
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve_motions(&task, SolveRequest::default(), go_on).unwrap();
    assert!(found.verdict.is_solved, "{:?}", found.verdict);
    found
}

/// A cart of 1 kg on a rail along x, which a force drives; from rest to rest over 1 m in 1 s.
pub(crate) fn cart(control: &Value) -> Value {
    let mut problem = json!({
        "scene": {
            "name": "cart",
            "bodies": [{ "name": "cart", "mass": "1 kg", "position": [0, 0, 0], "box": { "size": ["50 mm", "50 mm", "50 mm"] } }],
            "joints": [{ "name": "rail", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart", "at": [0, 0, 0] }],
            "loads": [{ "name": "drive", "joint": "rail" }, { "name": "wind", "joint": "rail" }],
        },
        "control": {
            "start": { "joint_angles": {} },
            "goal": { "joint_angles": { "rail": "1 m" } },
            "load_bounds": { "drive": ["-1 kN", "1 kN"] },
            "objective": { "effort": 1 },
        },
    });
    for (key, value) in control.as_object().unwrap() {
        problem["control"][key] = value.clone();
    }
    problem
}

/// Forces on the cart in all intervals of the phases, and the objective.
fn forces(found: &MotionsResult) -> Vec<f64> {
    let rows = found
        .list
        .iter()
        .flat_map(|one| &one.optimum.motion.voltages);
    rows.map(|row| row[0]).collect()
}

#[test]
fn two_phases_in_which_nothing_changes_are_one_motion() {
    let pair = std::fs::read_to_string("problems/pair.json").unwrap();
    let mut one: Value = serde_json::from_str(&pair).unwrap();
    let mut two = one.clone();
    one["control"]["motions"] = json!([{ "name": "whole" }]);
    two["control"]["phases"] = json!([
        { "name": "first", "duration": "0.08 s", "intervals": 8 },
        { "name": "second", "duration": "0.12 s", "intervals": 12 },
    ]);
    let [one, two] = [one, two].map(|problem| solved(&problem));
    let apart = (two.whole.objective / one.whole.objective - 1.0).abs();
    println!(
        "objectives {} and {}",
        one.whole.objective, two.whole.objective
    );
    assert!(apart < 1e-9, "{apart:e}");
    let voltages = |found: &MotionsResult| -> Vec<Vec<f64>> {
        let rows = found
            .list
            .iter()
            .flat_map(|one| one.optimum.motion.voltages.clone());
        rows.collect()
    };
    let [a, b] = [&one, &two].map(voltages);
    assert_eq!((a.len(), b.len()), (20, 20));
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 0.01, "{most} V");
    // The second phase is simulated from the end of the first one.
    let [first, second] = [0, 1].map(|i| &two.list[i].optimum);
    assert_eq!(first.motion.z[8], second.motion.z[0]);
    assert_eq!(first.motion.momentum, second.boundary.start.momentum);
}

#[test]
fn a_junction_in_motion_changes_nothing() {
    let trunk = std::fs::read_to_string("problems/elephant_trunk_effort.json").unwrap();
    let mut one: Value = serde_json::from_str(&trunk).unwrap();
    one["control"]["solver"]["tolerance"] = json!(1e-12);
    let mut two = one.clone();
    one["control"]["motions"] = json!([{ "name": "whole" }]);
    two["control"]["phases"] = json!([
        { "name": "first", "duration": "0.36 s", "intervals": 24 },
        { "name": "second", "duration": "0.24 s", "intervals": 16 },
    ]);
    let [one, two] = [one, two].map(|problem| solved(&problem));
    let apart = (two.whole.objective / one.whole.objective - 1.0).abs();
    assert!(apart < 1e-9, "{apart:e}");
    let [whole, first, second] =
        [&one.list[0], &two.list[0], &two.list[1]].map(|result| &result.optimum.motion.joints);
    // It moves there, by rad in an interval.
    let way = (whole[25][0] - whole[23][0]).abs();
    assert!(way > 0.01, "{way}");
    let phases = first.iter().chain(&second[1..]);
    let pairs = whole.iter().zip(phases).flat_map(|(a, b)| a.iter().zip(b));
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("objectives {apart:e} apart, joints {most:e} rad of {way}");
    assert!(most < 1e-6, "{most:e}");
}

#[test]
fn a_place_at_a_time_that_is_sought_is_that_of_the_closed_form() {
    // Rest to rest over 1 m in 1 s by way of 1.5 m at a free time, least ∫ a² dt.
    let (time, objective) = ((3.0 - 3.0_f64.sqrt()) / 2.0, 167.138_438_76);
    let found = [10, 20, 40].map(|intervals| {
        let part = |guess: &str| json!({ "min": "0.1 s", "max": "0.9 s", "guess": guess });
        let found = solved(&cart(&json!({
            "duration": "1 s",
            "phases": [
                { "name": "there", "duration": part("0.5 s"), "intervals": intervals,
                  "waypoints": [{ "part": 1, "joint_angles": { "rail": "1.5 m" } }] },
                { "name": "back", "duration": part("0.5 s"), "intervals": intervals },
            ],
        })));
        let lasts = |i: usize| {
            let motion = &found.list[i].optimum.motion;
            motion.times[motion.intervals()] / 1e3
        };
        assert!((lasts(0) + lasts(1) - 1.0).abs() < 1e-9);
        [lasts(0), found.whole.objective]
    });
    // The discrete problem has the same best time.
    let errors = found.map(|values| (values[0] - time).abs());
    println!("{time} s by {errors:?}");
    assert!(errors.iter().all(|error| *error < 1e-8), "{errors:?}");
    let errors = found.map(|values| (values[1] - objective).abs());
    let limit = found[2][1] + (found[2][1] - found[1][1]) / 3.0;
    println!("{objective} by {errors:?}, limit {limit}");
    let order = (errors[1] / errors[2]).log2();
    assert!((order - 2.0).abs() < 0.1, "{order}");
    assert!((limit - objective).abs() < 1e-5 * objective, "{limit}");
}

#[test]
fn a_mass_that_is_picked_up_keeps_the_momentum() {
    let [early, late, h] = [8.0, 12.0, 0.05];
    let phase = |name: &str, intervals: f64, mass: &str| {
        json!({ "name": name, "duration": format!("{} s", intervals * h), "intervals": intervals as usize,
                "set": { "scene.bodies[0].mass": mass } })
    };
    let phases = [phase("empty", early, "1 kg"), phase("loaded", late, "3 kg")];
    let found = solved(&cart(&json!({ "phases": phases })));
    // Place and momentum at the end of a point mass under forces, by the midpoint rule.
    let ends = |forces: &[f64]| {
        let (mut x, mut momentum) = (0.0, 0.0);
        for (k, force) in forces.iter().enumerate() {
            let mass = if k < early as usize { 1.0 } else { 3.0 };
            // The impulse of an interval counts by halves at its ends.
            momentum += 0.5 * h * force;
            x += h * momentum / mass;
            momentum += 0.5 * h * force;
        }
        [x, momentum]
    };
    let count = (early + late) as usize;
    let columns = (0..count).map(|k| {
        let mut unit = vec![0.0; count];
        unit[k] = 1.0;
        DVector::from_column_slice(&ends(&unit))
    });
    let a = DMatrix::from_columns(&columns.collect::<Vec<_>>());
    let inverse = (&a * a.transpose()).try_inverse().unwrap();
    let least = a.transpose() * inverse * DVector::from_vec(vec![1.0, 0.0]);
    let exact = h * least.norm_squared();
    let apart = (found.whole.objective / exact - 1.0).abs();
    println!("objective {} for {exact}", found.whole.objective);
    assert!(apart < 1e-8, "{apart:e}");
    let pairs = forces(&found).into_iter().zip(&least);
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 1e-5 * least.amax(), "{most}");
}

#[test]
fn the_program_of_phases_has_right_derivatives() {
    let free = json!({ "min": "0.1 s", "max": "0.9 s", "guess": "0.4 s" });
    let phases = json!([
        { "name": "a", "duration": free, "intervals": 3 },
        { "name": "b", "duration": free, "intervals": 4, "set": { "scene.bodies[0].mass": "2 kg" } },
    ]);
    let loaded = read(&cart(&json!({ "duration": "1 s", "phases": phases }))).unwrap();
    let task = loaded.task.motions(&loaded.system).unwrap();
    let each = task.motions.iter().map(|motion| {
        let h = motion.control.duration.first() / motion.control.intervals as f64;
        (
            BoundaryConditions::resolve(motion.system, motion.control, h).unwrap(),
            h,
        )
    });
    let each: Vec<_> = each.collect();
    let pairs = task.motions.iter().zip(&each);
    let (programs, points): (Vec<_>, Vec<_>) = pairs
        .map(|(motion, ((model, boundary), h))| {
            let initial = guess(model, boundary, motion.control, *h, None);
            let program = Transcription::new(model, boundary, motion.control, &initial).unwrap();
            let x = program.encode(&initial.discrete, initial.h);
            ((motion.name.to_owned(), program), x)
        })
        .unzip();
    let [a, b] = [&programs[0].1, &programs[1].1];
    let place = [a.unknowns().unknown(3, 0), b.unknowns().unknown(0, 0)].map(Option::unwrap);
    let row = [a.unknowns().row(3, 0), b.unknowns().row(0, 0)].map(Option::unwrap);
    let variable = SharedVariable(vec![Some((place[0], 1.0)), Some((place[1], 0.7))]);
    let balance = SharedRow(vec![(0, row[0], 1.0), (1, row[1], 1.3)]);
    let counts = [a, b].map(|one| [one.variables().count(), one.constraints().count()]);
    let horizons = [a, b].map(|one| one.unknowns().horizon().unwrap());
    let joined = Joined::with_rows(programs, &[variable], &[balance]);
    let x = joined.places().values(&[&points[0], &points[1]]);
    let terms = [0, 1].map(|number| (joined.places().variable_of(number, horizons[number]).0, 2.0));
    let mut joined = joined.with_sum("sum", terms.to_vec(), 1.0);
    let rows = joined.constraints();
    let last = rows.count() - 1;
    assert_eq!(x.len(), counts[0][0] + counts[1][0] - 1);
    assert_eq!(rows.count(), counts[0][1] + counts[1][1] - 1 + 1);
    // Each balance alone is no equation, both together are one.
    let (lower, upper) = (&rows.lower, &rows.upper);
    assert!((0..rows.count()).all(|row| lower[row] == upper[row] && lower[row].is_finite()));
    let noisy = x.iter().zip(0..).map(|(x, i)| x + 0.1 * f64::from(i).sin());
    let x: Vec<f64> = noisy.collect();
    let report = differences::check(&mut joined, &x, 3);
    assert!(report.is_consistent(), "{report}");
    assert_eq!(joined.constraint_name(last), "sum");
}

#[test]
fn what_makes_no_phases_is_refused() {
    let phases = |list: Value| cart(&json!({ "duration": "1 s", "phases": list }));
    let half = |name: &str| json!({ "name": name, "duration": "0.5 s", "intervals": 4 });
    let with = |key: &str, value: Value| {
        let mut phase = half("second");
        phase[key] = value;
        phases(json!([half("first"), phase]))
    };
    let cases = [
        (phases(json!([half("first")])), "one phase"),
        (with("duration", json!("0.6 s")), "1.1 s"),
        (with("goal", json!("free")), "the key \"goal\" in a phase"),
        (
            with("start", json!({ "joint_angles": {} })),
            "the key \"start\" in a phase",
        ),
        (
            with(
                "loads",
                json!({ "wind": { "sine": { "amplitude": "1 N", "period": "1 s" } } }),
            ),
            "as a function of time",
        ),
        (
            cart(&json!({ "phases": [half("a"), half("b")], "combine": "worst" })),
            "combine",
        ),
    ];
    for (problem, words) in cases {
        let error = read(&problem).map(|_| ()).unwrap_err();
        println!("{error}");
        assert!(error.contains(words), "{error}");
    }
}
