//! Times of the steps of a receding horizon on the trunk, and its memory over many of them.
//!
//! `cargo bench --bench receding_horizon -- [--write] [--minutes 60]`: the trunk of `problems/elephant_trunk.json` is planned anew over 20 intervals in each
//! of them, on its way and at its goal, under random pushes. With `--write` the page goes to `results/gallery/receding_horizon.md`. With
//! `--minutes` the same loop runs for that time of the robot instead, and its memory is printed ten times.

#[path = "../tests/common/random.rs"]
#[expect(dead_code, unreachable_pub, reason = "tests draw vectors too")]
mod random;
#[path = "../tests/common/robot.rs"]
#[expect(unreachable_pub, reason = "tests share it")]
mod robot;

use proboscis::control::problem::{Ahead, Regulator, Task};
use proboscis::feedback::Controller;
use proboscis::files::read_problem;
use proboscis::model::Model;
use proboscis::workflow::receding::{Horizon, RecedingHorizon, Source};
use random::Random;
use robot::Robot;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// Intervals of the horizon.
const INTERVALS: usize = 20;
/// Steps that are timed under pushes, and after these the steps by which memory is compared.
const STEPS: usize = 20_000;
const MORE: usize = 100_000;
/// Lines on the memory of a long run.
const LINES: usize = 10;
/// Intervals between pushes, and their greatest size in g mm²/ms about each joint.
const BETWEEN: usize = 60;
const PUSH: f64 = 3000.0;
const SEED: u64 = 35;

fn main() {
    let is_given = |option: &str| std::env::args().any(|argument| argument == option);
    if let Some(minutes) = std::env::args().skip_while(|one| one != "--minutes").nth(1) {
        return long_run(minutes.parse().expect("a number of minutes"));
    }
    let writes = is_given("--write");
    let text = page();
    println!("{text}");
    if writes {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery/receding_horizon.md");
        fs::write(file, text).expect("a written file");
    }
}

fn ahead(step: f64) -> Ahead {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let loaded = read_problem(&path, &[]).expect("a kept problem");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    Ahead {
        system: loaded.system,
        control: *control,
        regulator: Regulator {
            step,
            ..Regulator::default()
        },
        intervals: INTERVALS,
    }
}

fn push(robot: &mut Robot<'_>, random: &mut Random) {
    let push = |p: &mut f64| *p += random.between(-PUSH, PUSH);
    robot.momentum.iter_mut().for_each(push);
}

/// Squared distances of joints from the motion in degrees², a mean over steps, under inputs by a controller.
fn followed(
    horizon: &Horizon,
    model: &Model,
    inputs: &mut dyn FnMut(f64, &[f64]) -> Vec<f64>,
) -> f64 {
    let law = horizon.law();
    let mut robot = Robot::new(model, 4);
    let mut random = Random(SEED);
    let mut sum = 0.0;
    for k in 0..STEPS {
        let time = law.h * k as f64;
        let state = robot.measure();
        let reference = &law.at(time).state;
        let joints = robot.z.iter().zip(reference);
        sum += joints
            .map(|(a, b)| (a - b).to_degrees().powi(2))
            .sum::<f64>();
        robot.go(law.h, &inputs(time, &state));
        if k % BETWEEN == BETWEEN - 1 {
            push(&mut robot, &mut random);
        }
    }
    sum / STEPS as f64
}

/// Numbers of times in bins that are a hundredth wide, from a microsecond on: no more memory for more of them.
struct Times {
    bins: Vec<usize>,
    greatest: f64,
}

impl Times {
    fn new() -> Self {
        Self {
            bins: vec![0; 2000],
            greatest: 0.0,
        }
    }

    /// Takes a time in s.
    fn add(&mut self, time: f64) {
        let bin = (time / 1e-6).max(1.0).ln() / 1.01_f64.ln();
        let last = self.bins.len() - 1;
        self.bins[(bin as usize).min(last)] += 1;
        self.greatest = self.greatest.max(time);
    }

    /// The time in ms that a part of them does not exceed, upwards to a hundredth of it.
    fn at(&self, part: f64) -> f64 {
        let all: usize = self.bins.iter().sum();
        let mut count = 0;
        let within = self.bins.iter().position(|bin| {
            count += bin;
            count as f64 >= part * all as f64
        });
        1e-3 * 1.01_f64.powi(within.map_or(0, |bin| bin as i32 + 1))
    }
}

/// The closed loop for a number of minutes of the robot.
fn long_run(minutes: f64) {
    let horizon = Horizon::solved(&ahead(2.4)).expect("a horizon");
    let law = horizon.law();
    let model = Model::new(ahead(2.4).system, None, law.h, &[]).expect("a model");
    let mut controller = RecedingHorizon::new(&horizon);
    let mut robot = Robot::new(&model, 4);
    let mut random = Random(SEED);
    let mut times = [Times::new(), Times::new(), Times::new()];
    let steps = (60_000.0 * minutes / law.h).round() as usize;
    let part = steps.div_ceil(LINES);
    let mut others = 0;
    let told = |k: usize| {
        let minutes = law.h * k as f64 / 60_000.0;
        match memory("VmRSS") {
            Some(memory) => println!("{minutes:.1} min of the robot, {k} steps: {memory} kB"),
            None => println!("{minutes:.1} min of the robot, {k} steps: unknown memory"),
        }
    };
    let began = Instant::now();
    for k in 0..steps {
        // The first second has what is built once.
        if k == 417 || k % part == 0 {
            told(k);
        }
        let time = law.h * k as f64;
        let state = robot.measure();
        let before = Instant::now();
        let answer = controller.step(time, Some(&state));
        let step = before.elapsed().as_secs_f64();
        others += usize::from(answer.source != Source::Plan);
        robot.go(law.h, answer.inputs);
        let before = Instant::now();
        controller.prepare();
        let preparation = before.elapsed().as_secs_f64();
        for (times, time) in times
            .iter_mut()
            .zip([step, preparation, step + preparation])
        {
            times.add(time);
        }
        if k % BETWEEN == BETWEEN - 1 {
            push(&mut robot, &mut random);
        }
    }
    told(steps);
    println!(
        "greatest memory {:?} kB, {others} of {steps} inputs are not those of the plan, {:.0} s",
        memory("VmHWM"),
        began.elapsed().as_secs_f64()
    );
    for (name, times) in ["step", "preparation", "both"].iter().zip(&times) {
        println!(
            "{name}, ms: median {:.3}, 99 % {:.3}, 99.9 % {:.3}, greatest {:.3}",
            times.at(0.5),
            times.at(0.99),
            times.at(0.999),
            1e3 * times.greatest
        );
    }
}

/// Resident memory in kB by its name, where the system tells.
fn memory(name: &str) -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(name))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn page() -> String {
    let mut text = format!(
        "# Steps of a receding horizon\n\nWritten by `cargo bench --bench receding_horizon -- --write`.\n\n\
         The trunk of [`elephant_trunk`](../../problems/elephant_trunk.json) is planned anew over {INTERVALS} of its intervals of 2.4 ms, \
         at the start of each of {STEPS} of them; a random push of up to {PUSH} g mm²/ms about each joint comes every {BETWEEN} intervals. \
         A step is what passes from a measurement to its inputs; then the next one is prepared. Where other work runs on the same core, the \
         greatest times are those of the scheduler: these are of `chrt -f 50 taskset -c 1` on a shared machine of two cores. \
         Linux takes a core for 50 ms of each second from such a process, which never waits (`/proc/sys/kernel/sched_rt_runtime_us`).\n\n\
         | steps of an interval | part | median, ms | 99 % | 99.9 % | greatest |\n|--:|:--|--:|--:|--:|--:|\n"
    );
    let mut costs = String::new();
    for step in [2.4, 1.2] {
        let horizon = Horizon::solved(&ahead(step)).expect("a horizon");
        let law = horizon.law();
        let model = Model::new(ahead(step).system, None, law.h, &[]).expect("a model");
        let mut controller = RecedingHorizon::new(&horizon);
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        let mut others = 0;
        let planned = followed(&horizon, &model, &mut |time, state| {
            let began = Instant::now();
            let answer = controller.step(time, Some(state));
            let answered = began.elapsed().as_secs_f64();
            others += usize::from(answer.source != Source::Plan);
            let inputs = answer.inputs.to_vec();
            let began = Instant::now();
            controller.prepare();
            let prepared = began.elapsed().as_secs_f64();
            for (list, time) in times
                .iter_mut()
                .zip([answered, prepared, answered + prepared])
            {
                list.push(1e3 * time);
            }
            inputs
        });
        let mut regulator = Controller::new(law, law.h, 0.0);
        let regulated = followed(&horizon, &model, &mut |time, state| {
            let mut inputs = vec![0.0; law.inputs.len()];
            regulator.sample(time, state);
            regulator.inputs(time, time, &mut inputs);
            inputs
        });
        let parts = (law.h / step).round();
        for (part, list) in ["step", "preparation", "both"].iter().zip(&mut times) {
            list.sort_by(f64::total_cmp);
            let at = |part: f64| list[(part * (list.len() - 1) as f64).round() as usize];
            text.push_str(&format!(
                "| {parts} | {part} | {:.3} | {:.3} | {:.3} | {:.3} |\n",
                at(0.5),
                at(0.99),
                at(0.999),
                at(1.0)
            ));
        }
        costs.push_str(&format!(
            "Steps of an interval {parts}: {others} of {STEPS} inputs are not those of the plan, and joints are {:.2} degrees from the motion in \
             the mean square, {:.2} under the gains of the regulator. ",
            planned.sqrt(),
            regulated.sqrt()
        ));
        if step == 2.4 {
            let before = memory("VmRSS");
            let state = law.at(1e4).state.clone();
            let mut state_off = state.clone();
            for k in STEPS..STEPS + MORE {
                state_off[k % 6] = state[k % 6] + 1e-3 * (k % 7) as f64;
                controller.step(law.h * k as f64, Some(&state_off));
                controller.prepare();
            }
            let grown = memory("VmRSS")
                .zip(before)
                .map(|(after, before)| after - before);
            costs.push_str(&format!(
                "After {MORE} more steps the memory of the process has grown by {} kB. ",
                grown.map_or("an unknown number of".to_owned(), |size| size.to_string())
            ));
        }
    }
    text.push('\n');
    text.push_str(costs.trim_end());
    text.push('\n');
    text
}
