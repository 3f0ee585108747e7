//! Voltages whose squares are the unknowns of a solve: where they may be, and that nobody else notices.

use proboscis::control::problem::{Control, Task};
use proboscis::control::{BoundaryConditions, Column, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::ipopt::{self, OptionValue, Options, SolverResult};
use proboscis::model::system::System;
use proboscis::nlp::{Bounds, Entries, Nlp, Stage};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::Path;

/// A problem of control with changes, a kept one or one in a file.
fn problem(name: &str, changes: &[&str]) -> (System, Control) {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let path = if kept.exists() { kept } else { name.into() };
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let loaded = read_problem(&path, &changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("{name} is a problem of control");
    };
    (loaded.system, *control)
}

/// Evaluates the program of a kept problem, with its guess.
fn of_program<A>(
    name: &str,
    changes: &[&str],
    ask: impl FnOnce(&mut Transcription<'_>, Vec<f64>) -> A,
) -> A {
    let (system, control) = problem(name, changes);
    let h = control.duration.first() / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let point = program.start(&initial).x;
    ask(&mut program, point)
}

/// f and g.
fn values(program: &mut Transcription<'_>, x: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; program.constraints().lower.len() + 1];
    all[0] = program.objective(x);
    program.constraint(x, &mut all[1..]);
    all
}

/// Problems in which voltages are squares: effort, tracking, a free duration, limits of fields.
const SQUARES: [(&str, &[&str]); 5] = [
    ("elephant_trunk_effort", &["control.intervals=4"]),
    (
        "elephant_trunk_figure_eight",
        &["control.intervals=4", "control.objective.rate=0"],
    ),
    ("pair", &["control.intervals=4"]),
    ("pair_time", &["control.intervals=4"]),
    (
        "pair",
        &[
            "control.intervals=4",
            "control.limits=[{\"electric_field\":{\"muscles\":\"all\",\"max\":\"80 V/um\"}}]",
        ],
    ),
];

#[test]
fn what_is_called_a_square_enters_by_its_square_to_the_first_power() {
    for (name, changes) in SQUARES {
        of_program(name, changes, |program, mut x| {
            let squares = program.squares();
            assert!(squares.len() >= 8, "{name}: {squares:?}");
            let upper = program.variables().upper.clone();
            // A point at which no voltage is at its bounds, and coordinates are those of no motion.
            for (i, x) in x.iter_mut().enumerate() {
                *x += 0.01 * (1.7 * i as f64).sin();
            }
            for &i in &squares {
                x[i] = upper[i] * (0.4 + 0.1 * (i as f64).cos());
            }
            for &i in &squares {
                let mut at = |square: f64| {
                    let mut x = x.clone();
                    x[i] = upper[i] * square.sqrt();
                    values(program, &x)
                };
                let (none, half, whole) = (at(0.0), at(0.5), at(1.0));
                let sizes = none.iter().zip(&whole).map(|(a, b)| (a - b).abs());
                let size = sizes.fold(0.0, f64::max);
                assert!(
                    size > 1e-6,
                    "{name}: {} does nothing",
                    program.variable_name(i)
                );
                for ((none, half), whole) in none.iter().zip(&half).zip(&whole) {
                    let bend = none + whole - 2.0 * half;
                    let rounding = none.abs().max(whole.abs());
                    assert!(bend.abs() < 1e-11 * (size + rounding), "{name}: {bend}");
                }
            }
        });
    }
}

#[test]
fn voltages_that_enter_otherwise_are_no_squares() {
    let small = "control.intervals=4";
    let none: [(&str, &[&str]); 5] = [
        // Its rate is paid for.
        ("elephant_trunk", &[small]),
        ("elephant_trunk_smooth", &[small]),
        // Energy from the sources couples the voltages of neighbouring intervals.
        ("pair_energy", &[small]),
        // Potentials of nodes are linear in voltages.
        ("fe_bending_control", &[small]),
        // A constant is sought on which the muscle depends.
        ("codesign_pair", &[small]),
    ];
    for (name, changes) in none {
        let squares = of_program(name, changes, |program, _| program.squares());
        assert!(squares.is_empty(), "{name}: {squares:?}");
    }
    of_program("pair", &[small], |program, _| {
        let squares = program.squares();
        let columns = program.unknowns().columns.clone();
        let are_of_intervals = |&i: &usize| matches!(columns[i], Column::Interval { .. });
        assert!(!squares.is_empty() && squares.iter().all(are_of_intervals));
    });
}

#[test]
fn beside_a_muscle_of_finite_elements_only_the_voltages_of_the_lumped_one_are_squares() {
    let muscle = |name: &str, x: f64, more: Value| {
        let ends = [("from", "ground", -20), ("to", "segment1", 20)];
        let mut muscle = json!({
            "name": name, "material": "silicone",
            "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
        });
        for (end, body, y) in ends {
            muscle[end] = json!({ "body": body, "at": [x, f64::from(y) * 1e-3, 0.0] });
        }
        for (key, value) in more.as_object().unwrap() {
            muscle[key] = value.clone();
        }
        muscle
    };
    let meshed = json!({ "model": "finite_elements", "elements": [1, 1, 2] });
    let problem = json!({
        "scene": {
            "name": "one of each",
            "materials": { "silicone": {
                "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "400 kPa",
                "relative_permittivity": 3.0, "viscosity": "1000 Pa s",
            } },
            "bodies": [ {
                "name": "segment1", "mass": "30 g", "position": ["0 mm", "25 mm", "0 mm"],
                "cylinder": { "length": "50 mm", "radius": "20 mm", "axis": [0, 1, 0] },
            } ],
            "joints": [ {
                "name": "joint1", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "segment1",
                "at": [0, 0, 0],
            } ],
            "muscles": [muscle("lumped", 15e-3, json!({})), muscle("meshed", -15e-3, meshed)],
        },
        "control": {
            "duration": "0.2 s", "intervals": 4, "start": { "rest_at_voltages": {} },
            "goal": "free", "voltage_bounds": ["0 V", "3 kV"],
            "objective": { "effort": 1.0 }, "guess": "interpolate",
        },
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.json");
    std::fs::write(&path, problem.to_string()).unwrap();
    of_program(path.to_str().unwrap(), &[], |program, _| {
        let squares = program.squares();
        let names = squares.iter().map(|&i| program.variable_name(i));
        let names: Vec<String> = names.collect();
        assert_eq!(names.len(), 4, "{names:?}");
        assert!(
            names.iter().all(|name| name.contains("lumped")),
            "{names:?}"
        );
    });
}

/// The same program without a word about squares.
struct Plain<'a, 'm>(&'a mut Transcription<'m>);

impl Nlp for Plain<'_, '_> {
    fn variables(&self) -> &Bounds {
        self.0.variables()
    }
    fn constraints(&self) -> &Bounds {
        self.0.constraints()
    }
    fn jacobian_structure(&self) -> Entries {
        self.0.jacobian_structure()
    }
    fn hessian_structure(&self) -> Entries {
        self.0.hessian_structure()
    }
    fn objective(&mut self, x: &[f64]) -> f64 {
        self.0.objective(x)
    }
    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.0.gradient(x, grad);
    }
    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.0.constraint(x, g);
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.0.jacobian(x, values);
    }
    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        self.0.hessian(x, sigma, costates, values);
    }
    fn objective_scale(&self) -> f64 {
        self.0.objective_scale()
    }
    fn stages(&self) -> Option<Vec<Stage>> {
        self.0.stages()
    }
}

/// Solves, and looks at every iterate that the observer is shown.
fn solved(program: &mut dyn Nlp, x: &[f64], extra: &[(&str, OptionValue)]) -> SolverResult {
    let start = ipopt::StartingPoint {
        x: x.to_vec(),
        costates: None,
    };
    let options = Options {
        tolerance: 1e-10,
        extra: extra
            .iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone()))
            .collect(),
        ..Options::default()
    };
    let bounds = program.variables().clone();
    let mut shown = 0;
    let result = ipopt::solve(program, &start, &options, &mut |_, reached| {
        let before = reached.before.as_ref();
        for x in [Some(reached.x), before.map(|before| before.x)]
            .into_iter()
            .flatten()
        {
            assert!(bounds.violation(x) < 1e-6, "an iterate outside its bounds");
            shown += 1;
        }
        ControlFlow::Continue(())
    });
    assert!(shown > 10);
    result.unwrap()
}

#[test]
fn an_optimum_in_squares_is_the_one_in_voltages() {
    let kept = [("bound_relax_factor", OptionValue::Integer(0))];
    let wider = [("bound_relax_factor", OptionValue::Number(1e-6))];
    for (name, changes, extra, apart) in [
        ("pair", "control.intervals=20", &[][..], 1e-7),
        ("elephant_trunk_effort", "control.intervals=10", &[], 1e-7),
        // Of bounds that are not relaxed those at zero stay there.
        ("pair", "control.intervals=20", &kept, 2e-8),
        ("elephant_trunk_effort", "control.intervals=10", &kept, 2e-8),
        ("pair", "control.intervals=20", &wider, 1e-5),
    ] {
        of_program(name, &[changes], |program, x| {
            assert!(!program.squares().is_empty());
            let plain = solved(&mut Plain(program), &x, extra);
            let squared = solved(program, &x, extra);
            assert!(plain.status.is_solved() && squared.status.is_solved());
            let part = squared.objective / plain.objective - 1.0;
            assert!(part.abs() < apart, "{name}: {part}");
            let deviations = plain.x.iter().zip(&squared.x).map(|(a, b)| (a - b).abs());
            let deviation = deviations.fold(0.0, f64::max);
            // Voltages near zero are found to the root of what their squares are found to.
            assert!(deviation < 1e-2, "{name}: {deviation}");
            let [many, few] = [&plain, &squared].map(|result| result.iterations.len());
            assert!(
                4 * few < 3 * many,
                "{name}: {few} against {many} iterations"
            );
            stationary(program, &squared);
        });
    }
}

/// The multipliers are those of voltages: ∇f + ∇gᵀ y − z_L + z_U = 0.
fn stationary(program: &mut Transcription<'_>, found: &SolverResult) {
    let mut residual = vec![0.0; found.x.len()];
    program.gradient(&found.x, &mut residual);
    let entries = program.jacobian_structure();
    let mut values = vec![0.0; entries.rows.len()];
    program.jacobian(&found.x, &mut values);
    let costates = &found.costates;
    for ((&row, &col), value) in entries.rows.iter().zip(&entries.cols).zip(&values) {
        residual[col as usize] += value * costates.constraints[row as usize];
    }
    for (i, residual) in residual.iter_mut().enumerate() {
        *residual += costates.upper[i] - costates.lower[i];
    }
    let at_bounds = program
        .squares()
        .into_iter()
        .filter(|&i| costates.lower[i] > 1e-9);
    assert!(at_bounds.count() > 3, "no multiplier of a voltage at zero");
    let greatest = residual.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
    assert!(greatest * program.objective_scale() < 1e-7, "{greatest}");
}
