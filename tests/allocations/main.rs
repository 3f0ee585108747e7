//! Evaluating a program, and solving it again, allocates nothing after the first time; threads leave no memory behind.

#[path = "../common/mod.rs"]
mod common;
mod controllers;

use common::cases::{all_limits, control, hold, rest_to_rest};
use common::counting::{ASKED, BEGUN, Counting, IS_OURS, KEPT, MOST};
use common::systems::branched;
use common::tracked::{energies, tracked};
use common::{boxes, sought, trunk};
use controllers::{allocations_of_a_controller, allocations_of_a_law};
use proboscis::control::problem::{BoundaryState, Control, Duration, Objective, Rest};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::ipopt::{self, Options, Start};
use proboscis::kkt::{Plan, Solver, Unknown};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::nlp::Nlp;
use proboscis::workflow::parallel_map;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::{fs, iter, thread, time};

#[global_allocator]
static HEAP: Counting = Counting;

/// Fewest allocations of the five answers at new points, objective to Hessian, after the first round: what an answer
/// allocates it allocates in every round, whereas other threads of the test do so now and then.
fn allocations(system: &System, control: &Control) -> [usize; 5] {
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let mut x = program.start(&initial).x;
    let rows = program.constraints().lower.len();
    let mut grad = vec![0.0; x.len()];
    let mut g = vec![0.0; rows];
    let costates = vec![0.5; rows];
    let mut jacobian = vec![0.0; program.jacobian_structure().rows.len()];
    let mut hessian = vec![0.0; program.hessian_structure().rows.len()];
    let mut fewest = [usize::MAX; 5];
    for round in 0..20 {
        let mut counts = [0; 5];
        x.iter_mut().for_each(|v| *v += 1e-3);
        let mut last = ASKED.load(Ordering::Relaxed);
        let mut since = || {
            let now = ASKED.load(Ordering::Relaxed);
            now - std::mem::replace(&mut last, now)
        };
        program.objective(&x);
        counts[0] = since();
        program.gradient(&x, &mut grad);
        counts[1] = since();
        program.constraint(&x, &mut g);
        counts[2] = since();
        program.jacobian(&x, &mut jacobian);
        counts[3] = since();
        program.hessian(&x, 1.0, &costates, &mut hessian);
        counts[4] = since();
        if round > 0 {
            fewest = std::array::from_fn(|i| fewest[i].min(counts[i]));
        }
    }
    fewest
}

/// Unknowns with rows and columns of the entries.
type Pattern = (Vec<Unknown>, Vec<u32>, Vec<u32>);

/// Variables and equations that couple neighbouring stages.
fn horizon() -> Pattern {
    let (stages, width) = (40, 6_usize);
    let variables = stages * width;
    let (mut rows, mut cols) = (Vec::new(), Vec::new());
    for row in 0..2 * variables {
        for col in 0..=row {
            let (i, j) = (row % variables, col % variables);
            let is_near = (i / width).abs_diff(j / width) < 2;
            if is_near && (col < variables || row == col) {
                rows.push(row as u32);
                cols.push(col as u32);
            }
        }
    }
    let variable = |i: usize| Unknown::Variable((i / width) as u32);
    let mut unknowns: Vec<Unknown> = (0..variables).map(variable).collect();
    unknowns.resize(2 * variables, Unknown::Equality);
    (unknowns, rows, cols)
}

/// Coordinates, inputs and multipliers, balances and constraints of each stage.
fn constrained() -> Pattern {
    let mut kinds = Vec::new();
    for k in 0..20 {
        let of_stage = [
            ('q', Unknown::Variable(2 * k), 6),
            ('u', Unknown::Variable(2 * k + 1), 2),
            ('l', Unknown::Multiplier(2 * k + 2), 4),
            ('b', Unknown::Equality, 6),
            ('c', Unknown::Equality, 4),
        ];
        for (letter, unknown, count) in of_stage {
            kinds.extend(vec![(letter, k, unknown); count]);
        }
    }
    let (mut rows, mut cols) = (Vec::new(), Vec::new());
    for (row, &(a, i, _)) in kinds.iter().enumerate() {
        for (col, &(b, j, _)) in kinds[..=row].iter().enumerate() {
            let is_entry = match (a.min(b), a.max(b)) {
                ('q', 'q') | ('b', 'q') => i.abs_diff(j) < 2,
                ('q', 'u') | ('b', 'u') | ('l', 'q') | ('b', 'l') | ('c', 'q') => i == j,
                _ => row == col,
            };
            if is_entry {
                rows.push(row as u32);
                cols.push(col as u32);
            }
        }
    }
    let unknowns = kinds.into_iter().map(|(_, _, unknown)| unknown).collect();
    (unknowns, rows, cols)
}

/// The i-th of numbers between −½ and ½ that look random: SplitMix64.
fn number(i: usize) -> f64 {
    let z = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / 2.0_f64.powi(53) - 0.5
}

/// Factoring and solving a system again, with other numbers: fewest allocations of all rounds but the first, and how many were condensed.
/// In every second round multipliers of constraints have a diagonal.
fn allocations_of_factors((unknowns, rows, cols): Pattern) -> (usize, usize) {
    let mut solver = Solver::new(Plan::new(unknowns.len(), &rows, &cols, Some(&unknowns)));
    let mut entries = vec![0.0; rows.len()];
    let mut fewest = usize::MAX;
    for round in 0..20 {
        for (e, entry) in entries.iter_mut().enumerate() {
            let unknown = unknowns[rows[e] as usize];
            let is_zero = match unknown {
                _ if rows[e] != cols[e] => false,
                Unknown::Multiplier(_) => round % 2 == 0,
                _ => unknown == Unknown::Equality,
            };
            *entry = if is_zero {
                0.0
            } else {
                number(e + round * rows.len())
            };
        }
        let mut x = vec![1.0; unknowns.len()];
        let before = ASKED.load(Ordering::Relaxed);
        let inertia = solver.factor(&entries);
        solver.solve(&mut x);
        let asked = ASKED.load(Ordering::Relaxed) - before;
        assert!(inertia.negative > 0 && inertia.zero == 0, "{inertia:?}");
        if round > 1 {
            fewest = fewest.min(asked);
        }
    }
    (fewest, solver.statistics().condensed)
}

/// Solving a trunk again after the weights of its objective have changed there and back: fewest allocations of a solve, Ipopt's own not counted.
fn allocations_of_solves() -> usize {
    let h = 10.0;
    let rest = |voltages| BoundaryState::RestAtVoltages(voltages, Rest::Everything);
    let objectives = [0.5, 0.1].map(|rate| Objective {
        effort: 1.0,
        rate,
        ..Objective::default()
    });
    let control = Control {
        start: rest(hold(3).iter().map(|v| 0.1 * v).collect()),
        goal: rest(hold(3)),
        objective: objectives[1].clone(),
        ..rest_to_rest(3, 20, 20.0 * h)
    };
    let (model, boundary) = BoundaryConditions::resolve(&trunk(3), &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let point = program.start(&initial);
    let mut go_on = |_: &_, _: &ipopt::Reached<'_>| ControlFlow::Continue(());
    let mut solver = ipopt::Solver::new(program, Options::default());
    let found = solver.solve(&point, &mut go_on).unwrap();
    assert!(found.status.is_solved());
    solver.set_options(Options {
        start: Start::PrimalDual,
        ..Options::default()
    });
    let mut fewest = usize::MAX;
    for round in 0..6 {
        let before = ASKED.load(Ordering::Relaxed);
        solver.program_mut().weigh(&objectives[round % 2]);
        let found = solver.solve_again(&mut go_on).unwrap();
        let asked = ASKED.load(Ordering::Relaxed) - before;
        assert!(found.status.is_solved() && found.iterations.len() > 2);
        if round > 1 {
            fewest = fewest.min(asked);
        }
    }
    fewest
}

/// Fewest allocations of a solution by multigrid with new grids, the coarsest of which is factorised, and of one with kept grids, after the first round.
fn allocations_of_iterations() -> [usize; 2] {
    let mut size = 0;
    let grids = [boxes::grid([6, 5, 20], &mut size)];
    let mut solver = boxes::solver(size as usize, &grids);
    let mut rhs: Vec<f64> = (0..size).map(f64::from).collect();
    let mut fewest = [usize::MAX; 2];
    for round in 0..8 {
        for (kept, fewest) in fewest.iter_mut().enumerate() {
            solver.values_mut().fill(0.0);
            for place in 0..size as usize {
                let slot = solver.slot(place, place).unwrap();
                solver.values_mut()[slot] = 1.0 + place as f64;
            }
            if kept == 0 {
                solver.forget();
            }
            let before = ASKED.load(Ordering::Relaxed);
            solver.take_values().unwrap();
            solver.solve(&mut rhs, 1e-8, &|| false).unwrap().unwrap();
            let asked = ASKED.load(Ordering::Relaxed) - before;
            if round > 1 {
                *fewest = asked.min(*fewest);
            }
        }
    }
    fewest
}

/// Threads of this process, where the system tells; none elsewhere.
fn threads() -> usize {
    fs::read_dir("/proc/self/task").map_or(0, Iterator::count)
}

/// Bytes that a thread leaves behind which evaluates a horizon long enough for both cores, after those before it have left theirs.
fn bytes_left_by_a_thread() -> isize {
    let others = threads();
    let rounds = iter::repeat_with(|| {
        let before = KEPT.load(Ordering::Relaxed);
        let work = || allocations(&trunk(3), &rest_to_rest(3, 160, 1500.0));
        parallel_map::begin(work).unwrap().join().expect("no panic");
        // Threads of a pool end some time after it.
        while threads() > others {
            thread::sleep(time::Duration::from_millis(1));
        }
        KEPT.load(Ordering::Relaxed) - before
    });
    // What a pool has not yet freed in one round is freed in a later one, so that the middle one counts.
    let mut left: Vec<isize> = rounds.skip(2).take(5).collect();
    left.sort_unstable();
    left[2]
}

/// The only test of its binary: the count belongs to the process.
#[test]
fn evaluations_allocate_nothing_and_reading_takes_little() {
    BEGUN.store(true, Ordering::SeqCst);
    IS_OURS.set(Some(true));
    evaluations_allocate_nothing();
    reading_takes_the_memory_that_is_counted_on();
}

fn evaluations_allocate_nothing() {
    assert_eq!(allocations_of_factors(horizon()), (0, 0), "factors");
    assert_eq!(allocations_of_factors(constrained()), (0, 20), "condensed");
    assert_eq!(allocations_of_solves(), 0, "solves of a kept program");
    assert_eq!(allocations_of_a_controller(), 0, "steps of a controller");
    assert_eq!(allocations_of_a_law(), 0, "samples of a law");
    let [new, kept] = allocations_of_iterations();
    assert!(new < 10 && kept == 0, "multigrid: {new}, {kept}");
    let before = ASKED.load(Ordering::Relaxed);
    drop(std::hint::black_box(vec![0_u8; 100]));
    assert!(
        ASKED.load(Ordering::Relaxed) > before,
        "the allocator counts"
    );
    let more = vec![0_u8; 1 << 20];
    let with = KEPT.load(Ordering::Relaxed);
    drop(std::hint::black_box(more));
    let without = KEPT.load(Ordering::Relaxed);
    assert_eq!(with - without, 1 << 20, "and knows what is in use");
    assert_eq!(bytes_left_by_a_thread(), 0, "bytes left by a thread");
    let free = Duration::Free {
        min: 10.0,
        max: 1e3,
        guess: 100.0,
    };
    let every = Objective {
        effort: 1.0,
        rate: 0.1,
        duration: 1.0,
        energies: energies(&[(0, 1.0), (3, 2.0)], &[(3, 1.0), (4, 1.0)]),
        ..Objective::default()
    };
    let followed = Objective {
        rate: 0.1,
        ..tracked(&[0, 1], &[(0, true), (1, false)])
    };
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut plain = rest_to_rest(3, 10, 100.0);
        plain.coordinates = Some(coordinates);
        let mut long = rest_to_rest(3, 64, 600.0);
        long.coordinates = Some(coordinates);
        let timed = Control {
            duration: free,
            objective: every.clone(),
            ..plain.clone()
        };
        let mut limited = control(&branched(), 6);
        limited.coordinates = Some(coordinates);
        limited.limits = all_limits();
        let both = Control {
            duration: free,
            objective: followed.clone(),
            ..limited.clone()
        };
        let mut follows = control(&branched(), 40);
        follows.coordinates = Some(coordinates);
        follows.objective = followed.clone();
        let seeks = Control {
            coordinates: Some(coordinates),
            ..sought::problem(&sought::robot(), true, None)
        };
        for (name, system, control) in [
            ("free parameters, free time", sought::robot(), seeks),
            ("trunk", trunk(3), plain),
            ("trunk, long horizon", trunk(3), long),
            ("trunk, free time", trunk(3), timed),
            ("branched, limits", branched(), limited),
            ("branched, limits, follows, free time", branched(), both),
            ("branched, follows, long horizon", branched(), follows),
        ] {
            let counts = allocations(&system, &control);
            assert_eq!(counts, [0; 5], "{name} in {coordinates:?} coordinates");
        }
    }
}

/// Peak of memory, in bytes for each byte of a problem file with a table of this many intervals.
fn bytes_of_a_byte(intervals: usize, voltage: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.json");
    let scene = format!("{}/problems/scenes/pair.json", env!("CARGO_MANIFEST_DIR"));
    let times: Vec<String> = (0..=intervals)
        .map(|i| format!("{:.6}", 1e-6 * i as f64))
        .collect();
    let values = vec![voltage; intervals].join(", ");
    let text = format!(
        "{{ \"scene\": \"{scene}\", \"simulate\": {{ \"duration\": 1, \"step\": 0.01, \"voltages\": {{ \"time\": [{}], \"voltages\": {{ \"muscle2\": [{values}] }} }} }} }}",
        times.join(", ")
    );
    fs::write(&path, &text).unwrap();
    let size = text.len() as f64;
    drop(text);
    let before = KEPT.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    proboscis::files::read_problem(&path, &[]).unwrap();
    (MOST.load(Ordering::Relaxed) - before) as f64 / size
}

fn reading_takes_the_memory_that_is_counted_on() {
    for voltage in ["0.25", "\"0.25 kV\""] {
        let bytes = bytes_of_a_byte(150_000, voltage);
        // The text itself is there, and what the scene takes, whatever the length of the table.
        assert!(bytes > 1.0 && bytes < 17.0, "{voltage}: {bytes}");
    }
}
