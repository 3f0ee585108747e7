//! The linear solver along the horizon beside MUMPS: systems of optima of the trunk, and whole solves.
//!
//! A system is that of the last iterate: Hessian, what the bounds add to it, Jacobian. Analysis, factorisation and solution are those of
//! [`kkt`](proboscis::kkt) and of MUMPS as [`sparse`](proboscis::sparse) calls it; both try their factors on a right-hand side, and the
//! second scales the matrix first. Numbers are the least of runs in turn. `--write` puts the table into `benches/README.md`; names of rows
//! as arguments choose some of them.

use proboscis::control::problem::{Duration, Task};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::ipopt::{self, LinearSolver, Options, SolverResult, StartingPoint};
use proboscis::kkt::{Plan, Solver, Unknown};
use proboscis::nlp::{Nlp, Stage};
use proboscis::sparse::{Backend, Direct, Symmetry};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Instant;

/// Rows of the table: name, problem, changes.
const ROWS: [(&str, &str, &[&str]); 6] = [
    ("trunk, N = 20", TRUNK, &["control.intervals=20"]),
    ("trunk, N = 40", TRUNK, &["control.intervals=40"]),
    ("trunk, N = 80", TRUNK, &["control.intervals=80"]),
    ("trunk, N = 160", TRUNK, &["control.intervals=160"]),
    ("trunk, N = 320", TRUNK, &["control.intervals=320"]),
    ("trunk, N = 640", TRUNK, &["control.intervals=640"]),
];
const TRUNK: &str = "elephant_trunk_effort";
/// Lines of `README.md` between which the table stands.
const MARKS: [&str; 2] = ["<!-- linear solvers -->", "<!-- end of linear solvers -->"];
/// Seconds spent on one quantity, and the runs that it has at least.
const PATIENCE: (f64, usize) = (1.0, 3);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&String> = arguments.iter().filter(|a| !a.starts_with("--")).collect();
    let is_asked = |name: &str| names.is_empty() || names.iter().any(|part| name.contains(*part));
    let mut table = String::from(
        "| system | unknowns | analysis | factorisation | solution | inside Ipopt | iterations |\n\
         |:--|--:|--:|--:|--:|--:|--:|\n",
    );
    for (name, problem, changes) in ROWS.into_iter().filter(|row| is_asked(row.0)) {
        let row = row(name, problem, changes);
        print!("{row}");
        table.push_str(&row);
    }
    if arguments.iter().any(|a| a == "--write") {
        write(&table);
    }
}

fn write(table: &str) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/README.md");
    let text = std::fs::read_to_string(path).expect("benches/README.md can be read");
    let (before, rest) = text.split_once(MARKS[0]).expect("a begin of the table");
    let (_, after) = rest.split_once(MARKS[1]).expect("an end of the table");
    let text = format!("{before}{}\n\n{table}\n{}{after}", MARKS[0], MARKS[1]);
    std::fs::write(path, text).expect("benches/README.md can be written");
}

fn row(name: &str, problem: &str, changes: &[&str]) -> String {
    let path = format!("{}/problems/{problem}.json", env!("CARGO_MANIFEST_DIR"));
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let loaded = read_problem(path.as_ref(), &changes).expect("a kept problem");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) =
        BoundaryConditions::resolve(&loaded.system, &control, h).expect("states of rest exist");
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial)
        .expect("there are enough unknowns");
    let start = program.start(&initial);
    let solvers = [LinearSolver::Mumps, LinearSolver::Stages];
    let [(mumps, by_mumps), (stages, by_stages)] =
        in_turn(solvers.map(|one| (one, &start)), |(one, start)| {
            let solution = solve(&mut program, start, *one);
            (solution.seconds.solver, solution)
        });
    assert_eq!(by_mumps.status, by_stages.status);
    let system = System::of_optimum(&mut program, &by_stages);
    let parts = system.seconds();
    let mut out = format!("| {name} | {} ", system.unknowns.len());
    for [mumps, ours] in parts.into_iter().chain([[mumps, stages]]) {
        let [ratio, mumps, ours] = [mumps / ours, 1e3 * mumps, 1e3 * ours];
        write!(out, "| {mumps:.3} / {ours:.3} = {ratio:.1} ").expect("a text grows");
    }
    let iterations = [&by_mumps, &by_stages].map(|one| one.iterations.len() - 1);
    writeln!(out, "| {}, {} |", iterations[0], iterations[1]).expect("a text grows");
    out
}

fn solve(
    program: &mut Transcription<'_>,
    start: &StartingPoint,
    linear_solver: LinearSolver,
) -> SolverResult {
    let options = Options {
        linear_solver,
        ..Options::default()
    };
    ipopt::solve(program, start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .expect("Ipopt can be called")
}

/// The least seconds of two ways, run in turn, with what they found last.
fn in_turn<W, T>(mut ways: [W; 2], mut run: impl FnMut(&mut W) -> (f64, T)) -> [(f64, T); 2] {
    let began = Instant::now();
    let mut least = ways.each_mut().map(&mut run);
    let mut runs = 1;
    while runs < PATIENCE.1 || began.elapsed().as_secs_f64() < PATIENCE.0 {
        for (way, (seconds, found)) in ways.iter_mut().zip(&mut least) {
            let (again, found_again) = run(way);
            *seconds = seconds.min(again);
            *found = found_again;
        }
        runs += 1;
    }
    least
}

/// A symmetric system with what its unknowns are.
struct System {
    unknowns: Vec<Unknown>,
    rows: Vec<u32>,
    cols: Vec<u32>,
    entries: Vec<f64>,
}

impl System {
    /// That of a program without inequalities and fixed variables at the end of a solve.
    fn of_optimum(program: &mut Transcription<'_>, solution: &SolverResult) -> Self {
        let stages = program.stages().expect("stages of a horizon");
        let equations = program.constraints().lower.len();
        let kind = |stage: &Stage| match *stage {
            Stage::Of(stage) => Unknown::Variable(stage),
            Stage::Multiplier(stage) => Unknown::Multiplier(stage),
            Stage::Border => Unknown::Border,
        };
        let mut unknowns: Vec<Unknown> = stages.iter().map(kind).collect();
        let variables = unknowns.len();
        unknowns.resize(variables + equations, Unknown::Equality);
        let hessian = program.hessian_structure();
        let jacobian = program.jacobian_structure();
        let all = 0..unknowns.len() as u32;
        let below = jacobian.rows.iter().map(|row| row + variables as u32);
        let rows = hessian.rows.iter().copied().chain(all.clone()).chain(below);
        let cols = hessian.cols.iter().copied().chain(all);
        let mut entries = vec![0.0; hessian.rows.len()];
        let multipliers = &solution.costates;
        let scale = program.objective_scale();
        let costates: Vec<f64> = multipliers.constraints.iter().map(|y| scale * y).collect();
        program.hessian(&solution.x, scale, &costates, &mut entries);
        let bounds = program.variables();
        for (i, x) in solution.x.iter().enumerate() {
            assert!(bounds.lower[i] < bounds.upper[i], "no fixed variables");
            let of_bound = |z: f64, gap: f64| scale * z / gap.max(1e-12);
            let lower = of_bound(multipliers.lower[i], x - bounds.lower[i]);
            entries.push(lower + of_bound(multipliers.upper[i], bounds.upper[i] - x));
        }
        entries.resize(entries.len() + equations, 0.0);
        let begin = entries.len();
        entries.resize(begin + jacobian.rows.len(), 0.0);
        program.jacobian(&solution.x, &mut entries[begin..]);
        Self {
            unknowns,
            rows: rows.collect(),
            cols: cols.chain(jacobian.cols).collect(),
            entries,
        }
    }

    /// Seconds of analysis, factorisation and solution, MUMPS first.
    fn seconds(&self) -> [[f64; 2]; 3] {
        let order = self.unknowns.len();
        let pairs = self.rows.iter().zip(&self.cols);
        let places: Vec<(usize, usize)> = pairs.map(|(&i, &j)| (i as usize, j as usize)).collect();
        let direct = || Direct::with(order, &places, Symmetry::Symmetric, Some(Backend::Mumps));
        let plan = || Plan::new(order, &self.rows, &self.cols, Some(&self.unknowns));
        let [(mumps, mut direct), (ours, plan)] = in_turn([false, true], |is_ours| {
            let began = Instant::now();
            let made = match *is_ours {
                true => (None, Some(plan())),
                false => (Some(direct()), None),
            };
            (began.elapsed().as_secs_f64(), made)
        });
        let direct = direct.0.as_mut().expect("made by the first way");
        let mut solver = Solver::new(plan.1.expect("made by the second way"));
        let analysis = [mumps, ours];
        let mut timed = |work: &mut dyn FnMut(&mut Direct, &mut Solver, bool)| {
            let times = in_turn([false, true], |is_ours| {
                let began = Instant::now();
                work(direct, &mut solver, *is_ours);
                (began.elapsed().as_secs_f64(), ())
            });
            times.map(|(seconds, ())| seconds)
        };
        let factorisation = timed(&mut |direct, solver, is_ours| match is_ours {
            true => assert_eq!(solver.factor(&self.entries).zero, 0),
            false => direct.factor(&self.entries).expect("a regular matrix"),
        });
        let mut x: Vec<f64> = (0..order).map(|i| (i as f64).sin()).collect();
        let solution = timed(&mut |direct, solver, is_ours| {
            x.iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x = (i as f64).sin());
            match is_ours {
                true => solver.solve(&mut x),
                false => direct.solve(&mut x),
            }
        });
        [analysis, factorisation, solution]
    }
}
