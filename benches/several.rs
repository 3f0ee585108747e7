//! Several solves of the trunk of `problems/elephant_trunk_effort.json` at once: in threads, and of several motions in one program.
//!
//! `cargo bench --bench several -- [GOALS]`: goals in one thread and in two, in turn, and how many more two solve in the same time.
//! `cargo bench --bench several -- --copies`: copies of one motion in one program, against one of them.
//! `cargo bench --bench several -- --constants`: one motion with ten free parameters of several kinds, against the same without.
//! `cargo bench --bench several -- --minutes 10`: goals in four threads against one thread, bit by bit, with the memory of the process.

#[path = "../tests/common/random_goals.rs"]
mod random_goals;

use proboscis::control::problem::{Combined, Task};
use proboscis::control::{Motion, Motions};
use proboscis::files::read_problem;
use proboscis::workflow::parallel_map::parallel_map;
use proboscis::workflow::{Iterate, SolveRequest, optimise_together};
use random_goals::{Goals, Kind, Solved, solved, trunk};
use std::fs;
use std::ops::ControlFlow;
use std::thread::{ThreadId, current};
use std::time::{Duration, Instant};

/// Seed of the goals.
const SEED: u64 = 3;
/// Goals that are solved in one thread, then in several.
const BATCH: usize = 8;

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let mut goals = Goals::new(SEED);
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => throughput(&mut goals, 64),
        ["--copies"] => copies(),
        ["--constants"] => constants(),
        [count] => throughput(&mut goals, count.parse().expect("a number of goals")),
        ["--minutes", length] => compare(&mut goals, length.parse().expect("minutes")),
        _ => panic!(
            "expected a number of goals, --copies, --constants, or --minutes and their number"
        ),
    }
}

/// The changes that make the next goals: on short horizons where they are many.
fn batch(goals: &mut Goals, intervals: &[usize]) -> Vec<Vec<String>> {
    let changes = (0..BATCH).map(|i| {
        let kind = [Kind::Rest, Kind::Tip][i % 2];
        let goal = goals.draw(kind).json;
        let intervals = intervals[i % intervals.len()];
        vec![
            format!("control.goal={goal}"),
            format!("control.intervals={intervals}"),
        ]
    });
    changes.collect()
}

/// Times of one solve in its thread.
struct Taken {
    solved: Solved,
    /// Seconds by the clock, less those in which the thread waited for a core.
    seconds: f64,
    /// Seconds on a core.
    busy: f64,
    thread: ThreadId,
}

fn timed(changes: &[String]) -> Taken {
    let (began, [busy, waited]) = (Instant::now(), schedule());
    let solved = solved(&trunk(), changes);
    let [busy_now, waited_now] = schedule();
    Taken {
        solved,
        seconds: began.elapsed().as_secs_f64() - (waited_now - waited),
        busy: busy_now - busy,
        thread: current().id(),
    }
}

/// Seconds that this thread was on a core, and those that it waited for one.
fn schedule() -> [f64; 2] {
    let text = fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let mut numbers = text
        .split_whitespace()
        .map(|n| n.parse::<f64>().expect("a number"));
    [(); 2].map(|()| numbers.next().expect("two numbers") / 1e9)
}

/// Random goals in one thread and in two, in turn.
fn throughput(goals: &mut Goals, count: usize) {
    let (mut wall, mut free, mut busy) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    for _ in 0..count.div_ceil(BATCH) {
        let goals = batch(goals, &[40]);
        let mut answers = [Vec::new(), Vec::new()];
        for (i, threads) in [1, 2].into_iter().enumerate() {
            let began = Instant::now();
            let taken = parallel_map(&goals, threads, |changes| timed(changes), |_, _| {});
            wall[i] += began.elapsed().as_secs_f64();
            let taken: Vec<Taken> = taken
                .into_iter()
                .map(|one| one.expect("no panic"))
                .collect();
            busy[i] += taken.iter().map(|one| one.busy).sum::<f64>();
            free[i] += taken.iter().map(|one| one.seconds).sum::<f64>() / threads as f64;
            let used = taken.iter().filter(|one| one.thread != taken[0].thread);
            assert_eq!(used.count() > 0, threads > 1, "threads that work");
            answers[i] = taken.into_iter().map(|one| one.solved).collect();
        }
        assert_eq!(answers[0], answers[1]);
    }
    println!("| | one thread | two threads | one over two |\n|:--|--:|--:|--:|");
    let row = |name: &str, [one, two]: [f64; 2]| {
        println!("| {name} | {one:.2} | {two:.2} | {:.2} |", one / two);
    };
    row("seconds by the clock", wall);
    row("the same without waits for a core", free);
    row("seconds on cores", busy);
}

/// Random goals in four threads against one, until the time is over.
fn compare(goals: &mut Goals, minutes: f64) {
    let end = Instant::now() + Duration::from_secs_f64(60.0 * minutes);
    let (mut count, mut different, mut unsolved) = (0, 0, 0);
    let mut next = Instant::now();
    while Instant::now() < end {
        let goals = batch(goals, &[10, 20, 40, 14]);
        let solve = |changes: &Vec<String>| solved(&trunk(), changes);
        let alone: Vec<Solved> = goals.iter().map(solve).collect();
        let together = parallel_map(&goals, 4, solve, |_, _| {});
        for (one, other) in alone.iter().zip(&together) {
            count += 1;
            different += usize::from(other.as_ref() != Ok(one));
            unsolved += usize::from(one.word != "solved");
        }
        if Instant::now() >= next {
            next += Duration::from_secs(60);
            println!(
                "{count} goals, {different} different, {unsolved} not solved, {}",
                memory()
            );
        }
    }
    println!(
        "{count} goals, {different} different, {unsolved} not solved, {}",
        memory()
    );
}

/// Memory of the process now.
fn memory() -> String {
    let text = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = text.lines().find(|line| line.starts_with("VmRSS"));
    line.unwrap_or_default()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// Least seconds of a few solves of motions together, and their iterations.
fn together(motions: &Motions, runs: usize) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..runs {
        let began = Instant::now();
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        let found = optimise_together(&motions.task(), SolveRequest::default(), go_on);
        let found = found.expect("a right problem");
        assert!(
            found
                .optima
                .iter()
                .all(|one| one.solution.status.is_solved())
        );
        let seconds = began.elapsed().as_secs_f64();
        if seconds < least[0] {
            least = [seconds, found.iterations as f64];
        }
    }
    least
}

/// The trunk with other constants, inputs or goals, as one motion.
fn motion(changes: &[String]) -> Motion {
    let loaded = read_problem(&trunk(), changes).expect("a kept problem");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    Motion {
        name: "trunk".to_owned(),
        system: loaded.system,
        control: *control,
    }
}

fn of(list: Vec<Motion>) -> Motions {
    Motions {
        list,
        shared_inputs: Vec::new(),
        combined: Combined::Sum,
    }
}

/// Copies of one motion in one program, which share a constant: seconds of all over those of as many single ones.
fn copies() {
    let free =
        r#"control.free={"materials.silicone.viscosity":{"min":"900 Pa s","max":"1100 Pa s"}}"#;
    let goal = r#"control.goal={"joint_angles":{"joint1":0.2,"joint3":0.1},"hold":"none"}"#;
    let one = motion(&[free.to_owned(), goal.to_owned()]);
    println!(
        "| copies | seconds | iterations | over as many single ones | an iteration over one of a single one |\n|--:|--:|--:|--:|--:|"
    );
    let [single, first] = together(&of(vec![one.clone()]), 5);
    for count in [1, 2, 4, 8, 16] {
        let copy = |k: usize| Motion {
            name: format!("copy{k}"),
            ..one.clone()
        };
        let [seconds, iterations] = together(&of((0..count).map(copy).collect()), 5);
        let times = seconds / (count as f64 * single);
        let each = times * first / iterations;
        println!("| {count} | {seconds:.3} | {iterations:.0} | {times:.2} | {each:.2} |");
    }
}

/// Ten constants of a kind, each with its bounds.
fn ten(path: impl Fn(usize) -> String, [min, max]: [&str; 2]) -> String {
    let entry = |k| format!(r#""{}":{{"min":"{min}","max":"{max}"}}"#, path(k));
    let entries: Vec<String> = (1..=10).map(entry).collect();
    format!("control.free={{{}}}", entries.join(","))
}

/// The arms of ten muscles at their lower ends: along x or z, on one side or the other.
fn arms() -> String {
    let entry = |k: usize| {
        let axis = [0, 2][(k - 1) / 2 % 2];
        let [min, max] = if k % 2 == 1 {
            ["14 mm", "16 mm"]
        } else {
            ["-16 mm", "-14 mm"]
        };
        format!(r#""muscles.muscle{k}.from.at[{axis}]":{{"min":"{min}","max":"{max}"}}"#)
    };
    let entries: Vec<String> = (1..=10).map(entry).collect();
    format!("control.free={{{}}}", entries.join(","))
}

/// Ten free parameters, each of one muscle, against the same motion without.
fn constants() {
    let goal = r#"control.goal={"joint_angles":{"joint1":0.2,"joint3":0.1},"hold":"none"}"#;
    let of_muscle = |what: &'static str| move |k: usize| format!("muscles.muscle{k}.{what}");
    let cases = [
        ("none", "control.free={}".to_owned()),
        (
            "layers of ten muscles",
            ten(of_muscle("layer_thickness"), ["48 um", "52 um"]),
        ),
        (
            "widths of ten muscles",
            ten(of_muscle("cross_section[0]"), ["9.5 mm", "10.5 mm"]),
        ),
        ("arms of ten muscles", arms()),
    ];
    println!(
        "| constants | iterations | seconds | over none | an iteration over none |\n|:--|--:|--:|--:|--:|"
    );
    let mut without = [0.0; 2];
    for (name, free) in cases {
        let [seconds, iterations] = together(&of(vec![motion(&[goal.to_owned(), free])]), 9);
        if name == "none" {
            without = [seconds, iterations];
        }
        let times = seconds / without[0];
        let each = times * without[1] / iterations;
        println!("| {name} | {iterations:.0} | {seconds:.3} | {times:.2} | {each:.2} |");
    }
}
