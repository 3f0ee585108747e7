//! Evaluating a program allocates nothing after the first time.
#![expect(unsafe_code, reason = "a global allocator that counts")]

mod common;

use common::cases::{all_limits, control, rest_to_rest};
use common::sought;
use common::systems::branched;
use common::tracked::{energies, tracked};
use common::trunk;
use proboscis::control::problem::{Control, Duration, Objective};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::kkt::{Plan, Solver, Unknown};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::nlp::Nlp;
use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts what it is asked for.
struct Counting;

static ASKED: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the allocator of the system with unchanged arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as asked of this function.
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as asked of this function; the memory came from `Heap`.
        unsafe { Heap.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as asked of this function; the memory came from `Heap`.
        unsafe { Heap.realloc(memory, layout, size) }
    }
}

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

/// Factoring and solving a system along a horizon again, with other numbers: fewest allocations of all rounds but the first.
fn allocations_of_factors() -> usize {
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
    let mut solver = Solver::new(Plan::new(unknowns.len(), &rows, &cols, Some(&unknowns)));
    let mut entries = vec![0.0; rows.len()];
    let mut fewest = usize::MAX;
    for round in 0..20 {
        for (e, entry) in entries.iter_mut().enumerate() {
            let is_equation = rows[e] as usize >= variables && rows[e] == cols[e];
            *entry = if is_equation {
                0.0
            } else {
                ((7919 * e + 31 * round) % 1013) as f64 / 1013.0 - 0.5
            };
        }
        let mut x = vec![1.0; unknowns.len()];
        let before = ASKED.load(Ordering::Relaxed);
        let inertia = solver.factor(&entries);
        solver.solve(&mut x);
        let asked = ASKED.load(Ordering::Relaxed) - before;
        assert!(inertia.negative > 0 && inertia.zero == 0, "{inertia:?}");
        if round > 0 {
            fewest = fewest.min(asked);
        }
    }
    fewest
}

/// The only test of its binary: the count belongs to the process.
#[test]
fn evaluations_allocate_nothing() {
    assert_eq!(allocations_of_factors(), 0, "factors");
    let before = ASKED.load(Ordering::Relaxed);
    drop(std::hint::black_box(vec![0_u8; 100]));
    assert!(
        ASKED.load(Ordering::Relaxed) > before,
        "the allocator counts"
    );
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
            ("sought parameters, free time", sought::robot(), seeks),
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
