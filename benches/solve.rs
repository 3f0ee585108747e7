//! Whole solves of the trunk problem and tables of what they cost.
//!
//! Without arguments the tables go to standard output, with `--write` also into `benches/README.md`. One solve with
//! options of Ipopt: `--one redundant 40 linear_solver=mumps mumps_pivot_order=3`. Numbers are the least of a few runs, which other
//! programs on the machine disturb least.

mod trunk;

use proboscis::ipopt::{self, OptionValue, Options, SolverResult};
use proboscis::model::Coordinates::{self, Reduced, Redundant};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Instant;
use trunk::{Callbacks, at_rest, march, with_program};

/// Grids of the reduced form, with the number of runs of each.
const GRIDS: [(usize, usize); 5] = [(40, 15), (80, 9), (160, 7), (320, 5), (640, 3)];
/// Steps of a forward motion, and how often it is repeated.
const MARCH: (usize, usize) = (100, 20);
/// Lines of `README.md` between which the tables stand.
const MARKS: [&str; 2] = ["<!-- tables -->", "<!-- end of tables -->"];

// Targets and rivals, microseconds on one core; benches/README.md says where they come from.
const JACOBIAN: f64 = 12.0;
const HESSIAN: f64 = 25.0;
const STEP: f64 = 60.0;
const CASADI_JACOBIAN: f64 = 27.0;
const CASADI_HESSIAN: f64 = 60.0;
const CASADI_STEP: f64 = 1900.0;
const EXUDYN_STEP: f64 = 360.0;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(at) = arguments.iter().position(|a| a == "--one") {
        return one(&arguments[at + 1..]);
    }
    let tables = tables();
    println!("{tables}");
    if arguments.iter().any(|a| a == "--write") {
        write(&tables);
    }
}

fn write(tables: &str) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/README.md");
    let text = std::fs::read_to_string(path).expect("benches/README.md can be read");
    let (before, rest) = text.split_once(MARKS[0]).expect("a begin of the tables");
    let (_, after) = rest.split_once(MARKS[1]).expect("an end of the tables");
    let text = format!("{before}{}\n\n{tables}\n{}{after}", MARKS[0], MARKS[1]);
    std::fs::write(path, text).expect("benches/README.md can be written");
}

/// Cost of a solve: seconds of the whole, microseconds per interval and call of the callbacks.
#[derive(Clone, Copy, Debug)]
struct Cost {
    intervals: usize,
    iterations: usize,
    total: f64,
    solver: f64,
    callbacks: f64,
    constraint: f64,
    jacobian: f64,
    hessian: f64,
}

/// The least cost of `runs` solves, each number for itself.
fn cost(coordinates: Coordinates, intervals: usize, runs: usize) -> Cost {
    with_program(intervals, coordinates, |program, start| {
        let mut least: Option<Cost> = None;
        for _ in 0..runs {
            let solution = solve(program, start, BTreeMap::new());
            let cost = of_solution(&solution, intervals);
            least = Some(least.map_or(cost, |l| Cost {
                total: l.total.min(cost.total),
                solver: l.solver.min(cost.solver),
                callbacks: l.callbacks.min(cost.callbacks),
                constraint: l.constraint.min(cost.constraint),
                jacobian: l.jacobian.min(cost.jacobian),
                hessian: l.hessian.min(cost.hessian),
                ..cost
            }));
        }
        least.expect("one run at least")
    })
}

fn solve(
    program: &mut proboscis::control::Transcription<'_>,
    start: &ipopt::StartingPoint,
    extra: BTreeMap<String, OptionValue>,
) -> SolverResult {
    let options = Options {
        extra,
        ..Options::default()
    };
    ipopt::solve(program, start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .expect("Ipopt can be called")
}

fn of_solution(solution: &SolverResult, intervals: usize) -> Cost {
    let (seconds, calls) = (&solution.seconds, &solution.evaluations);
    let per_interval = |seconds: f64, calls: usize| 1e6 * seconds / (calls * intervals) as f64;
    Cost {
        intervals,
        iterations: solution.iterations.len() - 1,
        total: seconds.total,
        solver: seconds.solver,
        callbacks: seconds.total - seconds.solver,
        constraint: per_interval(seconds.constraints, calls.constraints),
        jacobian: per_interval(seconds.jacobian, calls.jacobian),
        hessian: per_interval(seconds.hessian, calls.hessian),
    }
}

/// Microseconds of a forward step, the least over a few motions, and its Newton iterations.
fn step(coordinates: Coordinates) -> (f64, f64) {
    let (model, start, scalars) = at_rest(coordinates);
    let (steps, runs) = MARCH;
    let run = |_| {
        let clock = Instant::now();
        march(&model, &start, &scalars, steps);
        1e6 * clock.elapsed().as_secs_f64() / steps as f64
    };
    let least = (0..runs).map(run).fold(f64::INFINITY, f64::min);
    let iterations = march(&model, &start, &scalars, steps).iterations;
    (least, iterations as f64 / steps as f64)
}

/// Microseconds per interval of constraint, Jacobian and Hessian outside a solve.
fn callbacks(coordinates: Coordinates, intervals: usize) -> [f64; 3] {
    with_program(intervals, coordinates, |program, start| {
        let mut callbacks = Callbacks::new(program, start);
        let parts: [fn(&mut Callbacks<'_, '_>); 3] =
            [|c| c.constraint(), |c| c.jacobian(), |c| c.hessian()];
        parts.map(|part| {
            let run = |_| {
                let clock = Instant::now();
                part(&mut callbacks);
                1e6 * clock.elapsed().as_secs_f64() / intervals as f64
            };
            (0..50).map(run).fold(f64::INFINITY, f64::min)
        })
    })
}

fn tables() -> String {
    let costs: Vec<Cost> = GRIDS
        .iter()
        .map(|&(intervals, runs)| cost(Reduced, intervals, runs))
        .collect();
    let mut out = String::from(
        "Whole solves, reduced coordinates. Growth: total time per interval and iteration over that of the row above.\n\n\
         |   N | iterations | total, ms | Ipopt, ms | callbacks / Ipopt | constraint, µs | Jacobian, µs | Hessian, µs | growth |\n\
         |----:|-----------:|----------:|----------:|------------------:|---------------:|-------------:|------------:|-------:|\n",
    );
    let unit = |c: &Cost| c.total / (c.intervals * c.iterations) as f64;
    let mut before = unit(&costs[0]);
    for c in &costs {
        writeln!(
            out,
            "| {:3} | {:10} | {:9.1} | {:9.1} | {:17.2} | {:14.1} | {:12.1} | {:11.1} | {:6.2} |",
            c.intervals,
            c.iterations,
            1e3 * c.total,
            1e3 * c.solver,
            c.callbacks / c.solver,
            c.constraint,
            c.jacobian,
            c.hessian,
            unit(c) / before,
        )
        .expect("a text grows");
        before = unit(c);
    }
    let reduced = callbacks(Reduced, 40);
    let redundant = callbacks(Redundant, 40);
    let [(reduced_step, newton), (redundant_step, _)] = [step(Reduced), step(Redundant)];
    let ratio = costs[0].callbacks / costs[0].solver;
    out.push_str(
        "\nAgainst targets and rivals on one core, as ratios; below 1 is faster. Callbacks here use two cores where there are two.\n\n\
         | N = 40                          | reduced | / target | / rival          | redundant | redundant / reduced |\n\
         |:--------------------------------|--------:|---------:|-----------------:|----------:|--------------------:|\n",
    );
    let mut row = |name: &str, ours: [f64; 2], target: Option<f64>, rival: &str| {
        let target = target.map_or(String::new(), |t| format!("{:.2}", ours[0] / t));
        writeln!(
            out,
            "| {name:<31} | {:7.1} | {target:>8} | {rival:>16} | {:9.1} | {:19.1} |",
            ours[0],
            ours[1],
            ours[1] / ours[0]
        )
        .expect("a text grows");
    };
    row(
        "constraint, µs per interval",
        [reduced[0], redundant[0]],
        None,
        "",
    );
    let casadi = |ours: f64, theirs: f64| format!("CasADi C {:.2}", ours / theirs);
    row(
        "Jacobian, µs per interval",
        [reduced[1], redundant[1]],
        Some(JACOBIAN),
        &casadi(reduced[1], CASADI_JACOBIAN),
    );
    row(
        "Hessian, µs per interval",
        [reduced[2], redundant[2]],
        Some(HESSIAN),
        &casadi(reduced[2], CASADI_HESSIAN),
    );
    row(
        "forward step of 10 ms, µs",
        [reduced_step, redundant_step],
        Some(STEP),
        &format!(
            "Exudyn {:.2}/{:.2}",
            reduced_step / EXUDYN_STEP,
            redundant_step / EXUDYN_STEP
        ),
    );
    writeln!(
        out,
        "\nA forward step has {newton:.1} Newton iterations and takes {:.3} of CasADi's. Callbacks take {ratio:.2} of the time \
         inside Ipopt.",
        reduced_step / CASADI_STEP
    )
    .expect("a text grows");
    out
}

/// One line about one solve: `reduced|redundant`, N, and options of Ipopt as `name=value`.
fn one(arguments: &[String]) {
    let [form, intervals, options @ ..] = arguments else {
        panic!("--one reduced|redundant N [option=value]…");
    };
    let coordinates = if form == "redundant" {
        Redundant
    } else {
        Reduced
    };
    let intervals = intervals.parse().expect("a number of intervals");
    let extra = options
        .iter()
        .filter_map(|option| option.split_once('='))
        .map(|(name, value)| (name.to_owned(), option_value(value)))
        .collect();
    let solution = with_program(intervals, coordinates, |program, start| {
        solve(program, start, extra)
    });
    let cost = of_solution(&solution, intervals);
    println!(
        "{form} {intervals} {}: {:?}, {} iterations, objective {:.9}, Ipopt {:.4} s ({:.2} ms per iteration), callbacks {:.4} s",
        options.join(" "),
        solution.status,
        cost.iterations,
        solution.objective,
        cost.solver,
        1e3 * cost.solver / cost.iterations.max(1) as f64,
        cost.callbacks,
    );
}

fn option_value(text: &str) -> OptionValue {
    if let Ok(value) = text.parse() {
        OptionValue::Integer(value)
    } else if let Ok(value) = text.parse() {
        OptionValue::Number(value)
    } else {
        OptionValue::Text(text.to_owned())
    }
}
