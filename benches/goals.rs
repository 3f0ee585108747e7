//! Random goals of the elephant trunk: how many are solved, how fast, and what several starting points add.
//!
//! `cargo bench --bench goals -- [GOALS] [--before PROGRAM] [--write]`: so many goals of rest, 200 where not said, half as many places of the tip
//! and an eighth as many goals on a short horizon, also by an earlier program where one is named; with `--write` tables and figure go to
//! `results/gallery/random_goals/`. Each solve is a process, as a user starts it.

#[path = "../tests/common/random_goals.rs"]
mod random_goals;

use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{LinePlot, Series};
use proboscis::report::origin::Origin;
use proboscis::report::style;
use proboscis::workflow::parallel_map::{cores, parallel_map};
use random_goals::{Goal, Goals, Kind, trunk};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Seed of the goals.
const SEED: u64 = 1;
/// Starting points of what is solved from several.
const STARTS: usize = 8;
/// Goals solved at once that are solved from several starting points too.
const SAMPLE: usize = 10;
/// Iterations that a solve may take.
const ITERATIONS: usize = 200;
/// Width of a bin of the histogram in iterations.
const BIN: usize = 10;

/// Goals that are told together.
#[derive(Debug)]
struct Group {
    name: &'static str,
    kind: Kind,
    /// Final time in s.
    duration: f64,
    /// One of so many goals of the first group.
    part: usize,
}

const GROUPS: [Group; 3] = [
    Group {
        name: "rest",
        kind: Kind::Rest,
        duration: 0.6,
        part: 1,
    },
    Group {
        name: "tip",
        kind: Kind::Tip,
        duration: 0.6,
        part: 2,
    },
    Group {
        name: "short horizon",
        kind: Kind::Rest,
        duration: 0.15,
        part: 8,
    },
];

/// This program.
const PROGRAM: &str = env!("CARGO_BIN_EXE_proboscis");
/// With the linear solver along the horizon, and with the one beside which it is measured.
const SOLVERS: [Way<'_>; 2] = [
    Way {
        program: PROGRAM,
        linear_solver: Some("stages"),
        starts: 1,
    },
    Way {
        program: PROGRAM,
        linear_solver: Some("mumps"),
        starts: 1,
    },
];

/// End of a solve of a goal.
#[derive(Clone, Debug)]
struct Ended {
    group: &'static str,
    goal: usize,
    status: String,
    is_solved: bool,
    objective: f64,
    iterations: usize,
    seconds: f64,
    /// Greatest deviation in rad when the voltages are simulated forward.
    deviation: f64,
    /// Several starting points: how many solved, and how many optima.
    starts: Option<(usize, usize)>,
}

fn main() {
    let mut count = 200;
    let mut writes = false;
    let mut before = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--write" => writes = true,
            "--before" => before = Some(arguments.next().expect("a program after --before")),
            "--bench" => {}
            number => count = number.parse().expect("a number of goals, or --write"),
        }
    }
    let mut goals = Goals::new(SEED);
    let plan: Vec<(&Group, usize, Goal)> = GROUPS
        .iter()
        .flat_map(|group| (1..=count / group.part).map(move |number| (group, number)))
        .map(|(group, number)| (group, number, goals.draw(group.kind)))
        .collect();
    let mut ways = SOLVERS.to_vec();
    ways.extend(before.as_deref().map(|program| Way {
        program,
        linear_solver: None,
        starts: 1,
    }));
    // All ways in turn, so that what else the machine does meets each.
    let all = in_parallel(&plan, |(group, goal, it)| {
        let each = ways.iter().map(|way| solve(group, *goal, it, way));
        each.collect::<Vec<_>>()
    });
    let of_way = |way: usize| -> Vec<Ended> { all.iter().map(|each| each[way].clone()).collect() };
    let once = of_way(0);
    let mut chosen = Vec::new();
    for group in &GROUPS {
        let of_group = |solved: bool| {
            let ended = once.iter().enumerate();
            ended.filter(move |(_, one)| one.group == group.name && one.is_solved == solved)
        };
        chosen.extend(of_group(false).map(|(index, _)| index));
        chosen.extend(of_group(true).map(|(index, _)| index).take(SAMPLE));
    }
    // Starts run as many at once as there are cores.
    let several: Vec<Ended> = chosen
        .iter()
        .map(|&index| {
            let (group, goal, it) = &plan[index];
            let way = Way {
                starts: STARTS,
                ..SOLVERS[0]
            };
            solve(group, *goal, it, &way)
        })
        .collect();
    let mut text = report(&once, &several, &chosen);
    text += "\n## Beside MUMPS\n\n\
         The same goals from the guess of the problem, both linear solvers in turn; seconds of all goals together, solved or not, without the start of a process.\n\n";
    text += &beside(&once, "with MUMPS", &of_way(1));
    if before.is_some() {
        text += "\n## Beside an earlier program\n\nThe same goals in the same run by the program that `--before` names.\n\n";
        text += &beside(&once, "the earlier program", &of_way(2));
    }
    println!("{text}");
    if writes {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery/random_goals");
        fs::create_dir_all(&folder).expect("a folder");
        let write = |name: &str, text: String| {
            fs::write(folder.join(name), text).expect("a written file");
        };
        write("random_goals.md", text);
        write("goals.csv", table(&once));
        write("starts.csv", table(&several));
        write("iterations.svg", histogram(&once));
    }
}

/// Answers about each item, on all cores, in their order.
fn in_parallel<T: Sync, A: Send>(items: &[T], answer: impl Fn(&T) -> A + Sync) -> Vec<A> {
    let answers = parallel_map(items, cores(), answer, |_, _| ());
    answers
        .into_iter()
        .map(|one| one.expect("no panic"))
        .collect()
}

/// Method of the solve of a goal.
#[derive(Clone, Copy, Debug)]
struct Way<'a> {
    program: &'a str,
    /// The linear solver, where the program can be told.
    linear_solver: Option<&'a str>,
    /// Number of starting points.
    starts: usize,
}

/// Solves the trunk problem for a goal in a process.
fn solve(group: &Group, goal: usize, it: &Goal, way: &Way<'_>) -> Ended {
    let starts = way.starts;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("out");
    let mut command = Command::new(way.program);
    command.arg("solve").arg(trunk());
    command
        .arg("--set")
        .arg(format!("control.goal={}", it.json));
    let duration = format!("control.duration={} s", group.duration);
    command.arg("--set").arg(duration);
    if let Some(name) = way.linear_solver {
        command
            .arg("--set")
            .arg(format!("control.solver.linear_solver={name:?}"));
    }
    command.arg("--max-iterations").arg(ITERATIONS.to_string());
    command.arg("-o").arg(&output).arg("--quiet");
    if starts > 1 {
        command.arg("--starts").arg(starts.to_string());
    }
    let done = command.output().expect("the program can be run");
    let text = fs::read_to_string(output.join("summary.json")).ok();
    let summary: Option<Value> = text.and_then(|text| serde_json::from_str(&text).ok());
    let Some(summary) = summary else {
        let told = String::from_utf8_lossy(&done.stderr);
        assert_ne!(
            done.status.code(),
            Some(2),
            "not the goal is refused: {told}"
        );
        let word = if told.contains("no equilibrium") {
            "no_equilibrium"
        } else {
            "failed"
        };
        return Ended {
            group: group.name,
            goal,
            status: word.to_owned(),
            is_solved: false,
            objective: f64::NAN,
            iterations: 0,
            seconds: 0.0,
            deviation: f64::NAN,
            starts: None,
        };
    };
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let count = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok());
    let of_starts = &summary["starts"];
    let several = count(&of_starts["solved"]).zip(count(&of_starts["distinct_optima"]));
    Ended {
        group: group.name,
        goal,
        status: summary["status"].as_str().unwrap_or("failed").to_owned(),
        is_solved: done.status.success(),
        objective: number(&summary["objective"]),
        iterations: count(&summary["iterations"]).unwrap_or_default(),
        seconds: match starts {
            1 => number(&summary["seconds"]["total"]),
            _ => number(&of_starts["seconds"]),
        },
        deviation: number(&summary["resimulation"]["deviation"]["angle"]),
        starts: several,
    }
}

/// The least value of the upper nine tenths of a list, the median, that of the last tenth, and the greatest, in digits.
fn quantiles(mut values: Vec<f64>, digits: usize) -> String {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    let at = |part: f64| values.get((part * last).round() as usize);
    let told = [0.1, 0.5, 0.9, 1.0].map(|part| match at(part) {
        Some(value) => format!("{value:.digits$}"),
        None => "-".to_owned(),
    });
    told.join(", ")
}

/// Median of the iterations of what is solved.
fn median<'a>(all: impl Iterator<Item = &'a Ended>) -> Option<usize> {
    let solved = all.filter(|one| one.is_solved).map(|one| one.iterations);
    let mut solved: Vec<usize> = solved.collect();
    solved.sort_unstable();
    solved.get(solved.len() / 2).copied()
}

/// Conclusion of the tables: goals that are solved from the guess of the problem, and those that several starts add.
fn conclusion(once: &[Ended], several: &[Ended], chosen: &[usize]) -> String {
    let each = GROUPS.iter().map(|group| {
        let of_group: Vec<&Ended> = once.iter().filter(|one| one.group == group.name).collect();
        let solved = of_group.iter().filter(|one| one.is_solved).count();
        let median = median(of_group.iter().copied())
            .map_or(String::new(), |n| format!(" (median {n} iterations)"));
        let more = (chosen.iter().zip(several))
            .filter(|(index, now)| {
                now.group == group.name && now.is_solved && !once[**index].is_solved
            })
            .count();
        let more = match more {
            0 => String::new(),
            more => format!(" and {more} more from {STARTS} starting points"),
        };
        format!(
            "{solved} of {} goals of {}{median}{more}",
            of_group.len(),
            group.name
        )
    });
    let each: Vec<_> = each.collect();
    let solved = once.iter().filter(|one| one.is_solved);
    let worst = solved.map(|one| one.deviation).fold(0.0, f64::max);
    format!(
        "From the guess of the problem the program solves {}. Simulated forward, solved motions deviate by at most {worst:.0e} rad.",
        each.join(", ")
    )
}

fn report(once: &[Ended], several: &[Ended], chosen: &[usize]) -> String {
    let mut out = format!(
        "# Random goals of the elephant trunk\n\n**Conclusion.** {}\n\n\
         Written by `cargo bench --bench goals -- --write`. The trunk of `problems/elephant_trunk_effort.json`, 40 intervals, voltages from 0 to 3 kV, at most\n\
         200 iterations.\n\n\
         * *rest*: equilibria under twelve random voltages within the bounds, in 0.6 s;\n\
         * *tip*: places of the tip in such equilibria, to be reached at rest in any posture, in 0.6 s;\n\
         * *short horizon*: goals of rest in 0.15 s: whether there is an answer is not known.\n\n\
         Every solve is a process; as many ran at once as there are cores, on a machine that other programs shared.\n\n\
         ## From the guess of the problem\n\n\
         | goals | solved | others, by their word | iterations: 10 %, median, 90 %, most | seconds: 10 %, median, 90 %, most | deviation simulated forward, rad |\n\
         |:--|--:|:--|--:|--:|--:|\n",
        conclusion(once, several, chosen)
    );
    for group in &GROUPS {
        let of_group: Vec<&Ended> = once.iter().filter(|one| one.group == group.name).collect();
        let solved: Vec<&&Ended> = of_group.iter().filter(|one| one.is_solved).collect();
        let mut others: BTreeMap<&str, usize> = BTreeMap::new();
        for one in of_group.iter().filter(|one| !one.is_solved) {
            *others.entry(&one.status).or_default() += 1;
        }
        let others: Vec<_> = others
            .iter()
            .map(|(word, n)| format!("{n} {}", word.replace('_', " ")))
            .collect();
        let iterations = quantiles(solved.iter().map(|one| one.iterations as f64).collect(), 0);
        let seconds = quantiles(solved.iter().map(|one| one.seconds).collect(), 2);
        let worst = solved.iter().map(|one| one.deviation).fold(0.0, f64::max);
        writeln!(
            out,
            "| {} {} | {} ({:.0} %) | {} | {iterations} | {seconds} | {worst:.0e} |",
            of_group.len(),
            group.name,
            solved.len(),
            100.0 * solved.len() as f64 / of_group.len() as f64,
            if others.is_empty() {
                "none".to_owned()
            } else {
                others.join(", ")
            },
        )
        .expect("a text grows");
    }
    writeln!(
        out,
        "\n![Iterations of the solved goals](iterations.svg)\n\n## From {STARTS} starting points\n\n\
         `--starts {STARTS}` for all that failed and for the first {SAMPLE} solved ones of each sort: the guess of the problem and simulations under\n\
         random constant voltages.\n\n\
         | goals | of these solved before | solved now | starts solved | goals with more than one optimum | most optima | objective lowered by, at most | rate of all |\n\
         |:--|--:|--:|--:|--:|--:|--:|--:|"
    )
    .expect("a text grows");
    for group in &GROUPS {
        let pairs: Vec<(&Ended, &Ended)> = chosen
            .iter()
            .zip(several)
            .map(|(&index, now)| (&once[index], now))
            .filter(|(_, now)| now.group == group.name)
            .collect();
        let before = pairs.iter().filter(|(one, _)| one.is_solved).count();
        let now = pairs.iter().filter(|(_, now)| now.is_solved).count();
        let starts: usize = pairs
            .iter()
            .filter_map(|(_, now)| Some(now.starts?.0))
            .sum();
        let optima: Vec<usize> = pairs
            .iter()
            .filter_map(|(_, now)| Some(now.starts?.1))
            .collect();
        let several_optima = optima.iter().filter(|&&count| count > 1).count();
        let lowered = pairs
            .iter()
            .filter(|(one, now)| one.is_solved && now.is_solved)
            .map(|(one, now)| 1.0 - now.objective / one.objective)
            .fold(0.0, f64::max);
        let all = once.iter().filter(|one| one.group == group.name);
        let (total, solved) = all.fold((0, 0), |(n, s), one| {
            (n + 1, s + usize::from(one.is_solved))
        });
        writeln!(
            out,
            "| {} {} | {before} | {now} | {starts} of {} | {several_optima} | {} | {:.1} % | {:.1} % → {:.1} % |",
            pairs.len(),
            group.name,
            STARTS * pairs.len(),
            optima.iter().max().copied().unwrap_or_default(),
            100.0 * lowered,
            100.0 * solved as f64 / total as f64,
            100.0 * (solved + now - before) as f64 / total as f64,
        )
        .expect("a text grows");
    }
    out
}

/// Times of two methods for the same goals, whole processes: the first, and another one with its name.
fn beside(ours: &[Ended], name: &str, theirs: &[Ended]) -> String {
    let mut out = format!(
        "| goals | solved, {name} | median of iterations, {name} | seconds, {name} | ratio |\n\
         |:--|--:|--:|--:|--:|\n"
    );
    for group in &GROUPS {
        let of = |all: &[Ended]| {
            let all = all.iter().filter(|one| one.group == group.name);
            all.fold((0, 0.0), |(solved, seconds), one| {
                (solved + usize::from(one.is_solved), seconds + one.seconds)
            })
        };
        let median = |all: &[Ended]| median(all.iter().filter(|one| one.group == group.name));
        let medians = [median(ours), median(theirs)].map(|n| n.unwrap_or_default());
        let [(ours, fast), (theirs, slow)] = [of(ours), of(theirs)];
        let [few, many] = medians;
        let ratio = slow / fast;
        let name = group.name;
        writeln!(
            out,
            "| {name} | {ours}, {theirs} | {few}, {many} | {fast:.1}, {slow:.1} | {ratio:.2} |"
        )
        .expect("a text grows");
    }
    out
}

fn table(all: &[Ended]) -> String {
    let mut out = "goal,number,status,objective,iterations,seconds [s],deviation [rad],starts solved,optima\n".to_owned();
    for one in all {
        let number = |value: f64| {
            if value.is_finite() {
                format!("{value:?}")
            } else {
                String::new()
            }
        };
        let (solved, optima) = one
            .starts
            .map_or_else(Default::default, |(s, o)| (s.to_string(), o.to_string()));
        writeln!(
            out,
            "{},{},{},{},{},{:.3},{},{solved},{optima}",
            one.group,
            one.goal,
            one.status,
            number(one.objective),
            one.iterations,
            one.seconds,
            number(one.deviation),
        )
        .expect("a text grows");
    }
    out
}

/// Number of solved goals by iterations, as steps.
fn histogram(once: &[Ended]) -> String {
    let colours = [style::BODY, style::INK, style::MUTED];
    let series = GROUPS.iter().zip(colours).map(|(group, colour)| {
        let solved: Vec<usize> = once
            .iter()
            .filter(|one| one.group == group.name && one.is_solved)
            .map(|one| one.iterations / BIN)
            .collect();
        let bins = solved.iter().max().map_or(0, |last| last + 1);
        let mut points = vec![[0.0, 0.0]];
        for bin in 0..bins {
            let height = solved.iter().filter(|&&other| other == bin).count() as f64;
            points.push([(bin * BIN) as f64, height]);
            points.push([((bin + 1) * BIN) as f64, height]);
        }
        points.push([(bins * BIN) as f64, 0.0]);
        Series::curve(group.name, points, colour)
    });
    let plot = LinePlot::new(
        Axis::linear("iterations", Extent::FromZero),
        Axis::linear("solved goals", Extent::FromZero),
        series.collect(),
    );
    plot.svg(&Origin {
        command: "cargo bench --bench goals -- --write".to_owned(),
        input: "problems/elephant_trunk_effort.json".to_owned(),
        version: Origin::program(),
        ..Origin::default()
    })
}
