//! One thread and several give the same bits, and answer each for itself.

mod common;

use common::cases::{control, open_end, rest_to_rest};
use common::random_goals::{self, Goals, Kind, Solved, solved};
use common::solid::{DRIVEN, electrode, held};
use common::systems::blocks;
use common::trunk;
use nalgebra::Vector3;
use proboscis::control::problem::{Combined, Control};
use proboscis::control::{BoundaryConditions, Motion, Motions, Transcription, guess};
use proboscis::dynamics::{Start, simulate};
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{Potential, System};
use proboscis::nlp::Nlp;
use proboscis::sparse::{Backend, Direct, Symmetry};
use proboscis::workflow::parallel_map::{cores, parallel_map};
use proboscis::workflow::{Iterate, Optimum, SolveRequest, optimise_together};
use serde_json::json;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Barrier;
use std::thread;

/// Rows, Jacobian and Hessian of the trunk at a point between guess and noise: of so many intervals that both halves are evaluated at once.
fn values() -> [Vec<f64>; 3] {
    let (intervals, duration) = (800, 7500.0);
    let control = rest_to_rest(3, intervals, duration);
    of_program(&trunk(3), &control, duration / intervals as f64)
}

fn of_program(system: &System, control: &Control, h: f64) -> [Vec<f64>; 3] {
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    assert!(model.action.layout().values(control.intervals) > 50_000);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let mut x = program.start(&initial).x;
    for (i, value) in x.iter_mut().enumerate() {
        *value += 0.01 * (i as f64).sin();
    }
    let costates: Vec<f64> = (0..program.constraints().lower.len())
        .map(|i| (i as f64).cos())
        .collect();
    let mut rows = vec![0.0; costates.len()];
    let mut jacobian = vec![0.0; program.jacobian_structure().rows.len()];
    let mut hessian = vec![0.0; program.hessian_structure().rows.len()];
    program.constraint(&x, &mut rows);
    program.jacobian(&x, &mut jacobian);
    program.hessian(&x, 0.7, &costates, &mut hessian);
    [rows, jacobian, hessian]
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let pair = thread::spawn(values).join().unwrap();
    // A thread that belongs to a pool already gets no helper.
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap()
        .install(values);
    assert!(pair.iter().all(|list| list.iter().any(|v| v.abs() > 1e-3)));
    for (a, b) in pair.iter().flatten().zip(alone.iter().flatten()) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
}

/// A clamped block of 320 elements: more than one stretch of elements that a thread takes.
fn large() -> System {
    let size = Vector3::new(16.0, 16.0, 10.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [8, 8, 5]).mesh();
    let mut solid = common::solid::block(mesh, blocks().muscles[0].material);
    let mesh = &solid.mesh;
    solid.supports = vec![held(mesh, "z_min", [true; 3])];
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        electrode(mesh, "top", 10.0, DRIVEN),
    ];
    common::solid::system(vec![solid])
}

#[test]
fn a_large_block_has_the_same_bits_on_one_thread_and_two() {
    let motion = || {
        let model = Model::new(large(), None, 0.5, &[]).unwrap();
        let start = Start::at_rest(&model, model.coordinates_at(&[]));
        let (discrete, failure) = simulate(
            &model,
            &start,
            0.5,
            3,
            |_, _| vec![2e5],
            |_| ControlFlow::Continue(()),
        );
        assert_eq!(failure, None);
        let z = |k: usize| discrete.z[k].iter().zip(&discrete.z[0]).map(|(a, b)| a - b);
        [
            z(3).collect(),
            discrete.momenta[3].clone(),
            discrete.scalars[2].clone(),
        ]
    };
    let program = || {
        let system = large();
        let control = Control {
            goal: open_end(),
            ..control(&system, 2)
        };
        of_program(&system, &control, 10.0)
    };
    let runs: [&(dyn Fn() -> [Vec<f64>; 3] + Sync); 2] = [&motion, &program];
    for run in runs {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(run)
        });
        let sizes = one
            .iter()
            .map(|list| list.iter().filter(|v| v.abs() > 1e-9).count());
        assert!(
            sizes.clone().all(|count| count > 100),
            "{:?}",
            sizes.collect::<Vec<_>>()
        );
        for (a, b) in one.iter().flatten().zip(two.iter().flatten()) {
            assert_eq!(a.to_bits(), b.to_bits());
        }
    }
}

/// Kept problems with random goals: files and changes.
fn goals() -> Vec<(PathBuf, Vec<String>)> {
    let kept = |name: &str| format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let mut goals = Goals::new(12);
    let mut all = Vec::new();
    for round in 0..4 {
        for (kind, intervals) in [(Kind::Rest, 10), (Kind::Tip, 14)] {
            let goal = goals.draw(kind).json;
            let duration = [0.6, 0.25][round % 2];
            let changes = vec![
                format!("control.goal={goal}"),
                format!("control.intervals={intervals}"),
                format!("control.duration={duration} s"),
            ];
            all.push((random_goals::trunk(), changes));
        }
        for name in ["pair", "pair_time"] {
            let goal = json!({ "rest_at_voltages": { "muscle2": 900 + 271 * round } });
            let changes = vec![format!("control.goal={goal}")];
            all.push((kept(name).into(), changes));
        }
    }
    // Long enough that a thread that is alone evaluates both halves at once.
    let goal = goals.draw(Kind::Rest).json;
    let changes = ["control.intervals=120", "control.solver.max_iterations=4"].map(str::to_owned);
    let goal = format!("control.goal={goal}");
    all.push((
        random_goals::trunk(),
        changes.into_iter().chain([goal]).collect(),
    ));
    all
}

#[test]
fn random_goals_in_four_threads_are_solved_to_the_same_bits() {
    let goals = goals();
    let solve = |(problem, changes): &(PathBuf, Vec<String>)| solved(problem, changes);
    let alone: Vec<Solved> = goals.iter().map(solve).collect();
    let words = alone.iter().filter(|one| one.word == "solved");
    assert!(words.count() >= 12, "{alone:?}");
    let driven = alone.iter().filter(|one| one.voltage > 100).count();
    assert!(driven >= 12, "{driven}");
    let ways: BTreeSet<usize> = alone.iter().map(|one| one.iterations).collect();
    assert!(ways.len() >= 5, "{ways:?}");
    let together = parallel_map(&goals, 4, solve, |_, _| {});
    for ((one, other), goal) in alone.iter().zip(&together).zip(&goals) {
        assert!(other.as_ref() == Ok(one), "{goal:?}");
    }
}

/// The point, multipliers and costates of five motions that were optimised together.
fn of_motions() -> Vec<u64> {
    let system = trunk(1);
    let motion = |k: usize| Motion {
        name: format!("motion{k}"),
        system: system.clone(),
        control: rest_to_rest(1, 20 + k, 200.0),
    };
    let motions = Motions {
        list: (0..5).map(motion).collect(),
        shared_inputs: Vec::new(),
        combined: Combined::Sum,
    };
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = optimise_together(&motions.task(), SolveRequest::default(), go_on).unwrap();
    let of = |one: &Optimum| {
        assert!(one.solution.status.is_solved());
        let costates = &one.solution.costates.constraints;
        [&one.solution.x[..], costates, &[one.solution.objective]].concat()
    };
    let numbers: Vec<f64> = found.optima.iter().flat_map(of).collect();
    numbers.into_iter().map(f64::to_bits).collect()
}

#[test]
fn several_motions_have_the_same_bits_on_one_thread_and_two() {
    let pair = thread::spawn(of_motions).join().unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1);
    let alone = alone.build().unwrap().install(of_motions);
    assert!(pair.len() > 100);
    assert_eq!(pair, alone);
}

#[test]
fn a_panic_is_the_end_of_one_answer_alone() {
    let items: Vec<i32> = (0..20).collect();
    let mut heard = Vec::new();
    let square = |&i: &i32| match i {
        3 => panic!("three is no number"),
        i => i * i,
    };
    let told = |index: usize, answered: &Result<i32, String>| {
        heard.push((index, answered.clone()));
    };
    let answers = parallel_map(&items, 3, square, told);
    assert_eq!(answers.len(), 20);
    for (i, answer) in answers.iter().enumerate() {
        match answer {
            Ok(square) => assert!(i != 3 && *square == (i * i) as i32),
            Err(message) => assert!(i == 3 && message.contains("three is no number")),
        }
    }
    heard.sort_by_key(|(index, _)| *index);
    let heard: Vec<_> = heard.into_iter().map(|(_, answer)| answer).collect();
    assert_eq!(heard, answers);
    let none: [i32; 0] = [];
    assert!(parallel_map(&none, 3, square, |_, _| {}).is_empty());
}

#[test]
fn answers_are_found_at_once_each_on_its_share_of_the_cores() {
    // Three who wait for each other come together only if they run at once.
    let meeting = Barrier::new(3);
    let here = thread::current().id();
    let answer = |_: &i32| {
        meeting.wait();
        (rayon::current_num_threads(), thread::current().id())
    };
    let answers = parallel_map(&[1, 2, 3], 3, answer, |_, _| {
        assert_eq!(thread::current().id(), here);
    });
    let answers: Vec<_> = answers.into_iter().map(Result::unwrap).collect();
    let share = (cores() / 3).max(1);
    assert!(answers.iter().all(|(threads, _)| *threads == share));
    let all = [here]
        .into_iter()
        .chain(answers.into_iter().map(|(_, id)| id));
    assert_eq!(
        all.map(|id| format!("{id:?}"))
            .collect::<BTreeSet<_>>()
            .len(),
        4
    );
}

/// The solution with a large symmetric matrix, of a grid of 28 × 28 × 28 points with its neighbours.
fn of_large_matrix() -> Vec<f64> {
    const N: usize = 28;
    let at = |i: usize, j: usize, k: usize| (i * N + j) * N + k;
    let (mut entries, mut values) = (Vec::new(), Vec::new());
    let mut add = |row: usize, col: usize, value: f64| {
        entries.push((row.max(col), row.min(col)));
        values.push(value);
    };
    for (i, j, k) in (0..N * N * N).map(|p| (p / (N * N), p / N % N, p % N)) {
        let here = at(i, j, k);
        add(here, here, 6.5 + (here as f64).sin());
        for (i, j, k) in [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)] {
            if i < N && j < N && k < N {
                add(at(i, j, k), here, -1.0);
            }
        }
    }
    let faer = Some(Backend::Faer);
    let mut solver = Direct::with(N * N * N, &entries, Symmetry::Symmetric, faer);
    solver.factor(&values).unwrap();
    assert_eq!(solver.method(), "faer LDLᵀ");
    let mut x: Vec<f64> = (0..N * N * N).map(|i| (i as f64).cos()).collect();
    solver.solve(&mut x);
    x
}

#[test]
fn the_order_of_a_large_matrix_and_its_solution_are_the_same_every_time() {
    let first = of_large_matrix();
    assert!(first.iter().any(|value| value.abs() > 0.1));
    for _ in 0..4 {
        assert_eq!(first, of_large_matrix());
    }
}
