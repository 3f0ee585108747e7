//! One design for three goals of the trunk, and one history of inputs for robots that differ.
//!
//! `cargo bench --bench design -- [--write]`: the trunk of `problems/codesign_trunk.json` with the design of its scene and with the one that is
//! found; then the pair of `problems/robust_pair.json` under the inputs for its middle robot, for the sum and for the greatest of the objectives
//! of its three robots, each on a thousand robots that no optimisation has seen. With `--write` the page goes to `results/gallery/designs.md`.

#[path = "../tests/common/random.rs"]
#[expect(dead_code, unreachable_pub, reason = "tests draw vectors too")]
mod random;

use proboscis::control::Motions;
use proboscis::control::problem::{Combined, Task};
use proboscis::dynamics::{Start, simulate};
use proboscis::files::read_problem;
use proboscis::model::{Model, System};
use proboscis::tasks::{MotionsResult, SolveRequest, solve_motions};
use proboscis::workflow::{Iterate, Optimum};
use random::Random;
use std::fmt::Write as _;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// Number of robots that are drawn, and the seed.
const SAMPLES: usize = 1000;
const SEED: u64 = 36;
/// Range of shear modulus and viscosity of these robots, as parts of those of the scene.
const RANGE: [f64; 2] = [0.8, 1.2];
/// Angle of the joint that the pair is to end near, in rad, and the weight of the square of the deviation.
const ANGLE: f64 = 0.1;
const WEIGHT: f64 = 1000.0;

/// Pictures that `make gallery` keeps.
const PICTURES: &str = "
Six instants of the motion to the right, with the design of the scene and with the one that was found: wide muscles at the
base, narrow ones at the tip, on longer arms.

![The trunk of the scene on its way to the right](codesign_trunk/given.svg)

![The trunk that was found on its way to the right, in 0.16 s in place of 0.26 s](codesign_trunk/found.svg)
";

fn main() {
    let writes = std::env::args().any(|argument| argument == "--write");
    let text = format!(
        "# Designs and robust inputs\n\nWritten by `cargo bench --bench design -- --write`.\n\n{}\n{}",
        trunk(),
        pair()
    );
    println!("{text}");
    if writes {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery/designs.md");
        fs::write(file, text).expect("a written file");
    }
}

fn motions(problem: &str, changes: &[&str]) -> Motions {
    let file = format!("problems/{problem}.json");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let changes: Vec<String> = changes.iter().map(|one| one.to_string()).collect();
    match read_problem(&path, &changes).expect("a kept problem").task {
        Task::Motions(motions) => *motions,
        other => panic!("{other:?}"),
    }
}

fn solved(motions: &Motions) -> MotionsResult {
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found =
        solve_motions(&motions.task(), SolveRequest::default(), go_on).expect("a right problem");
    assert!(found.verdict.is_solved, "{:?}", found.verdict);
    found
}

/// Σ h V² in kV² s, and the duration in s.
fn effort(optimum: &Optimum) -> [f64; 2] {
    let motion = &optimum.motion;
    let steps = motion.times.windows(2).zip(&motion.voltages);
    let square = |(two, row): (&[f64], &Vec<f64>)| {
        (two[1] - two[0]) * row.iter().map(|v| v * v).sum::<f64>() * 1e-9
    };
    let duration = motion.times[motion.intervals()] / 1e3;
    [steps.map(square).sum(), duration]
}

fn trunk() -> String {
    let given = solved(&motions("codesign_trunk", &["control.free={}"]));
    let motions = motions("codesign_trunk", &[]);
    let found = solved(&motions);
    let mut text = String::from(
        "## One design of the trunk for three goals\n\n\
         The tip of the trunk reaches three places, from rest to rest, each in a time of its own, with weights of effort and \
         time ([problem](../../problems/codesign_trunk.json)). Arm and length of the muscles and the widths of the two at each \
         joint are sought, with no more silicone than the trunk of the scene has, 48 g. Each motion is verified by \
         a simulation; the last columns are its estimated error as a part of the path.\n\n\
         | | effort, kV² s: given | found | time, s: given | found | objective: given | found | error: given | found |\n\
         |:--|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let error = |optimum: &Optimum| {
        optimum
            .resimulation
            .as_ref()
            .and_then(|r| r.error)
            .map_or(f64::NAN, |error| 100.0 * error)
    };
    for ((motion, a), b) in motions.list.iter().zip(&given.list).zip(&found.list) {
        let [[ea, ta], [eb, tb]] = [a, b].map(|one| effort(&one.optimum));
        let [oa, ob] = [a, b].map(|one| one.optimum.solution.objective);
        writeln!(
            text,
            "| {} | {ea:.2} | {eb:.2} | {ta:.3} | {tb:.3} | {oa:.2} | {ob:.2} | {:.1} % | {:.1} % |",
            motion.name,
            error(&a.optimum),
            error(&b.optimum)
        )
        .expect("text");
    }
    writeln!(
        text,
        "| all | | | | | {:.2} | {:.2} | | |\n\n{} iterations with the design of the scene, {} with the sought one.\n\n\
         | constant | in the scene, mm | found, mm |\n|:--|--:|--:|",
        given.whole.objective, found.whole.objective, given.iterations, found.iterations
    )
    .expect("text");
    let parameters = &motions.list[0].control.parameters;
    for (parameter, one) in parameters
        .iter()
        .zip(&found.list[0].optimum.motion.parameters)
    {
        let bound = if one.is_at_bound {
            ", at its bound"
        } else {
            ""
        };
        let size = match parameter.name.as_str() {
            // Its number is in m: no constant of a component is that length itself.
            "chain.muscles.rest_length" => 1e3,
            _ => 1.0,
        };
        writeln!(
            text,
            "| `{}` | {:.1} | {:.1}{bound} |",
            one.name,
            size * parameter.guess,
            size * one.value
        )
        .expect("text");
    }
    text + PICTURES
}

/// A robot of the scene with factors of shear modulus and viscosity.
fn robot(system: &System, [modulus, viscosity]: [f64; 2]) -> System {
    let mut system = system.clone();
    for muscle in &mut system.muscles {
        muscle.material.shear_modulus *= modulus;
        muscle.material.viscosity = muscle.material.viscosity.map(|one| viscosity * one);
    }
    system
}

/// Angle at the end of a robot under the inputs of an optimum.
fn angle(system: &System, optimum: &Optimum) -> f64 {
    let motion = &optimum.motion;
    let (h, intervals) = (motion.times[1], motion.intervals());
    let model = Model::new(system.clone(), None, h, &[]).expect("a model");
    let zero = vec![0.0; model.joint_readings.len()];
    let start = Start::at_rest(&model, model.coordinates_at(&zero));
    let scalars = |from: f64, to: f64| {
        let k = (0.5 * (from + to) / h) as usize;
        model.scalars(&motion.voltages[k.min(intervals - 1)])
    };
    let (discrete, failure) = simulate(&model, &start, h, intervals, scalars, |_| {
        ControlFlow::Continue(())
    });
    assert!(failure.is_none());
    let last = discrete.z.last().expect("an end");
    model.joints(&model.action.map.placed(last), &zero)[0]
}

fn pair() -> String {
    let three = motions("robust_pair", &[]);
    let alone = Motions {
        list: vec![three.list[1].clone()],
        ..three.clone()
    };
    let worst = Motions {
        combined: Combined::Worst,
        ..three.clone()
    };
    let mut random = Random(SEED);
    let mut draw = || [(); 2].map(|()| random.between(RANGE[0], RANGE[1]));
    let robots: Vec<[f64; 2]> = (0..SAMPLES).map(|_| draw()).collect();
    let scene = &alone.list[0].system;
    let mut text = format!(
        "## One history of voltages for robots that differ\n\n\
         A pair of muscles moves its segment to 0.1 rad in 0.2 s ([problem](../../problems/robust_pair.json)). The voltages are \
         those for the robot of the scene alone, those of the least sum of the objectives of three robots with 80, 100 and \
         120 % of its shear modulus, and those of their least greatest objective (`\"combine\": \"worst\"`). They act on {SAMPLES} robots \
         that no optimisation has seen: shear modulus and viscosity are drawn between {:.0} and {:.0} % of those of the scene, \
         independently. The objective counts effort, rate and {WEIGHT} times the squared deviation in rad.\n\n\
         | voltages for | effort and rate | objective of the three: mean | greatest | deviation of {SAMPLES}, mrad: median | 95 % | greatest | objective of {SAMPLES}: mean | greatest |\n\
         |:--|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        100.0 * RANGE[0],
        100.0 * RANGE[1]
    );
    for (name, motions) in [
        ("the robot of the scene", &alone),
        ("the sum of three", &three),
        ("the greatest of three", &worst),
    ] {
        let found = solved(motions);
        let optimum = &found.list[0].optimum;
        let own = angle(&motions.list[0].system, optimum) - ANGLE;
        let inputs = optimum.solution.objective - WEIGHT * own * own;
        let deviation = |system: &System| (angle(system, optimum) - ANGLE).abs();
        let objectives = |all: &[f64]| {
            let each = || all.iter().map(|d| inputs + WEIGHT * d * d);
            let mean = each().sum::<f64>() / all.len() as f64;
            [mean, each().fold(0.0, f64::max)]
        };
        let seen: Vec<f64> = three
            .list
            .iter()
            .map(|one| deviation(&one.system))
            .collect();
        let [mean_seen, most_seen] = objectives(&seen);
        let drawn = robots
            .iter()
            .map(|factors| deviation(&robot(scene, *factors)));
        let mut drawn: Vec<f64> = drawn.collect();
        drawn.sort_by(f64::total_cmp);
        let [mean, most] = objectives(&drawn);
        let part = |p: f64| 1e3 * drawn[(p * (SAMPLES - 1) as f64).round() as usize];
        writeln!(
            text,
            "| {name} | {inputs:.3} | {mean_seen:.3} | {most_seen:.3} | {:.2} | {:.2} | {:.2} | {mean:.3} | {most:.3} |",
            part(0.5),
            part(0.95),
            part(1.0)
        )
        .expect("text");
    }
    text
}
