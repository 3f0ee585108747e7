//! The writer of the systems that `recorded.rs` reads: it stands in the place of MA57, as `src/ipopt/ma57_adapter.rs` does.
//!
//! `cargo test --test solver -- --ignored --exact recorder::systems_are_recorded` writes the folder `systems` anew.

#![expect(unsafe_code, reason = "C interface of MA57")]

use crate::recorded::{Recording, folder};
use proboscis::control::problem::{Duration, Task};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::ipopt::{self, OptionValue, Options};
use proboscis::kkt::{Pattern, Plan, Solver, Unknown};
use proboscis::nlp::{Nlp, Stage};
use std::cell::RefCell;
use std::ffi::{c_int, c_void};
use std::ops::ControlFlow;
use std::{mem, slice};

/// Who solves, and what it was given.
struct Recorder {
    unknowns: Vec<Unknown>,
    solver: Option<Solver>,
    /// Entries, and what is worth to be seen: zero eigenvalues and delays.
    matrices: Vec<(Vec<f64>, [usize; 2])>,
}

thread_local! {
    static RECORDER: RefCell<Option<Recorder>> = const { RefCell::new(None) };
}

fn with_recorder<T>(work: impl FnOnce(&mut Recorder) -> T) -> T {
    RECORDER.with_borrow_mut(|recorder| work(recorder.as_mut().expect("a solve that is recorded")))
}

/// Answers without an error, and with further numbers counted from one.
///
/// # Safety
///
/// `info` points to 40 numbers.
unsafe fn answer(info: *mut c_int, first: c_int, others: &[(usize, usize)]) {
    // SAFETY: the caller vouches for it.
    let info = unsafe { slice::from_raw_parts_mut(info, 40) };
    info.fill(0);
    info[0] = first;
    for &(place, number) in others {
        info[place - 1] = number as c_int;
    }
}

unsafe extern "C" fn initialise(cntl: *mut f64, icntl: *mut c_int) {
    // SAFETY: arrays of these lengths.
    unsafe {
        slice::from_raw_parts_mut(cntl, 5).fill(0.0);
        slice::from_raw_parts_mut(icntl, 20).fill(0);
    }
}

unsafe extern "C" fn analyse(
    n: *mut c_int,
    entries: *mut c_int,
    rows: *const c_int,
    cols: *const c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    info: *mut c_int,
    _: *mut f64,
) {
    // SAFETY: Ipopt passes as many rows and columns as entries, counted from one.
    let [rows, cols] = [rows, cols].map(|list| unsafe {
        let list = slice::from_raw_parts(list, *entries as usize);
        list.iter().map(|i| *i as u32 - 1).collect::<Vec<_>>()
    });
    with_recorder(|recorder| {
        // SAFETY: Ipopt passes the order.
        let order = unsafe { *n as usize };
        assert_eq!(recorder.unknowns.len(), order, "no fixed variables");
        let plan = Plan::new(order, &rows, &cols, Some(&recorder.unknowns));
        recorder.solver = Some(Solver::new(plan));
    });
    // SAFETY: Ipopt passes place for the answer.
    unsafe { answer(info, 0, &[(9, 10), (10, 10)]) };
}

unsafe extern "C" fn factor(
    n: *mut c_int,
    entries: *mut c_int,
    values: *mut f64,
    _: *mut f64,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut f64,
    info: *mut c_int,
    _: *mut f64,
) {
    // SAFETY: Ipopt passes as many values as entries.
    let values = unsafe { slice::from_raw_parts(values, *entries as usize) };
    let inertia = with_recorder(|recorder| {
        let solver = recorder.solver.as_mut().expect("analysed first");
        let before = solver.statistics().delays;
        let inertia = solver.factor(values);
        let delays = solver.statistics().delays - before;
        let seen = [inertia.zero, delays];
        recorder.matrices.push((values.to_vec(), seen));
        inertia
    });
    // SAFETY: Ipopt passes the order and place for the answer.
    unsafe {
        let rank = *n as usize - inertia.zero;
        let first = if inertia.zero > 0 { 4 } else { 0 };
        answer(info, first, &[(24, inertia.negative), (25, rank)]);
    }
}

unsafe extern "C" fn solve(
    _: *mut c_int,
    n: *mut c_int,
    _: *mut f64,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    columns: *mut c_int,
    right: *mut f64,
    stride: *mut c_int,
    _: *mut f64,
    _: *mut c_int,
    _: *mut c_int,
    _: *mut c_int,
    info: *mut c_int,
) {
    // SAFETY: Ipopt passes so many right-hand sides, one behind the other, and place for the answer.
    unsafe {
        assert_eq!(*n, *stride);
        let right = slice::from_raw_parts_mut(right, (*n * *columns) as usize);
        with_recorder(|recorder| {
            let solver = recorder.solver.as_mut().expect("analysed first");
            right
                .chunks_exact_mut(*n as usize)
                .for_each(|x| solver.solve(x));
        });
        answer(info, 0, &[]);
    }
}

unsafe extern "C" fn enlarge() {
    unreachable!("there is always room");
}

type Initialise = unsafe extern "C" fn(*mut f64, *mut c_int);

/// Gives Ipopt these functions in the place of MA57.
fn install() {
    assert!(Options::default().run_at_once(), "an Ipopt that takes them");
    // SAFETY: the name ends in NUL, and the library is loaded.
    let symbol = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"LSL_setMA57".as_ptr()) };
    assert!(!symbol.is_null());
    // SAFETY: Ipopt stores pointers to functions and calls them with the arguments of MA57, as these take them.
    unsafe {
        let set: unsafe extern "C" fn(
            *const c_void,
            *const c_void,
            *const c_void,
            *const c_void,
            Initialise,
        ) = mem::transmute(symbol);
        set(
            analyse as *const c_void,
            factor as *const c_void,
            solve as *const c_void,
            enlarge as *const c_void,
            initialise,
        );
    }
}

/// The unknowns as Ipopt lists them.
fn unknowns(program: &Transcription<'_>) -> Vec<Unknown> {
    let stages = program.stages().expect("stages of a horizon");
    let variables = program.variables();
    let is_fixed = |&i: &usize| variables.lower[i] == variables.upper[i];
    let variable = |i: usize| match stages[i] {
        Stage::Of(stage) => Unknown::Variable(stage),
        Stage::Multiplier(stage) => Unknown::Multiplier(stage),
        Stage::Border => Unknown::Border,
    };
    let rows = program.constraints();
    let pairs = rows.lower.iter().zip(&rows.upper);
    let equalities = pairs.filter(|(low, high)| low == high).count();
    let inequalities = rows.lower.len() - equalities;
    let free = (0..stages.len()).filter(|i| !is_fixed(i));
    let mut list: Vec<Unknown> = free.map(variable).collect();
    for (kind, count) in [
        (Unknown::Slack, inequalities),
        (Unknown::Equality, equalities),
        (Unknown::Inequality, inequalities),
    ] {
        list.resize(list.len() + count, kind);
    }
    list
}

/// Solves a kept problem with changes, and keeps `kept` of the systems, singular and difficult ones first.
fn record(name: &str, problem: &str, changes: &[&str], kept: usize) -> usize {
    let path = format!("{}/{problem}.json", env!("CARGO_MANIFEST_DIR"));
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let loaded = read_problem(path.as_ref(), &changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&loaded.system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let start = program.start(&initial);
    let ma57 = OptionValue::Text("ma57".to_owned());
    let options = Options {
        tolerance: 1e-10,
        max_iterations: 60,
        extra: [("linear_solver".to_owned(), ma57)].into(),
        ..Options::default()
    };
    let unknowns = unknowns(&program);
    RECORDER.set(Some(Recorder {
        unknowns,
        solver: None,
        matrices: Vec::new(),
    }));
    let mut go_on = |_: &_, _: &ipopt::Reached<'_>| ControlFlow::Continue(());
    let solution = ipopt::solve(&mut program, &start, &options, &mut go_on).unwrap();
    let restored = solution.iterations.iter().filter(|i| i.restoration).count();
    let recorder = RECORDER.take().unwrap();
    let solver = recorder.solver.expect("a system");
    let Pattern { rows, cols } = solver.plan().pattern();
    // The first that a factorisation of the method itself meets is one of least squares.
    let mut order: Vec<usize> = (0..recorder.matrices.len()).collect();
    order.sort_by_key(|&i| {
        let [zero, delays] = recorder.matrices[i].1;
        (zero == 0, std::cmp::Reverse(delays), i)
    });
    let mut chosen = order[..kept.min(order.len())].to_vec();
    if let Some(last) = chosen.last_mut() {
        *last = recorder.matrices.len() - 1;
    }
    chosen.sort_unstable();
    chosen.dedup();
    for &i in &chosen {
        println!("  {i}: zeros and delays {:?}", recorder.matrices[i].1);
    }
    let recording = Recording {
        unknowns: recorder.unknowns,
        rows: rows.to_vec(),
        cols: cols.to_vec(),
        matrices: chosen
            .iter()
            .map(|&i| recorder.matrices[i].0.clone())
            .collect(),
    };
    let bytes = recording.to_bytes();
    println!(
        "{name}: order {}, {} entries, {} matrices, {} iterations, {restored} of restoration, {}, {} bytes, {:?}",
        recording.unknowns.len(),
        rows.len(),
        recorder.matrices.len(),
        solution.iterations.len(),
        solution.status,
        bytes.len(),
        solver.statistics(),
    );
    std::fs::write(folder().join(format!("{name}.bin")), &bytes).unwrap();
    bytes.len()
}

#[test]
#[ignore = "writes files of the repository"]
fn systems_are_recorded() {
    install();
    std::fs::create_dir_all(folder()).unwrap();
    let trunk = "problems/elephant_trunk_effort";
    let hurry =
        r#"control.goal={"rest_at_voltages":{"muscle2":2900,"muscle5":2500,"muscle9":2800}}"#;
    let far = r#"control.goal={"markers":{"tip":["0 mm","400 mm","0 mm"]}}"#;
    let field = r#"control.limits=[{"electric_field":{"muscles":"all","max":"40 V/um"}}]"#;
    let beam = "scene.solids[0].box.elements=[3,1,2]";
    // Cases of `tests/hard`: a plane loop of hinges, whose constraints depend on each other, and a goal out of reach.
    let hard = "tests/solver/systems/problems";
    let [chain, beyond] = ["loop", "out_of_reach"].map(|name| format!("{hard}/{name}"));
    let cases: [(&str, &str, &[&str], usize); 10] = [
        ("trunk", trunk, &["control.intervals=10"], 3),
        (
            "haste",
            trunk,
            &["control.intervals=10", "control.duration=0.1 s", hurry],
            3,
        ),
        ("restoration", trunk, &["control.intervals=6", far], 4),
        (
            "limits",
            "problems/pair",
            &["control.intervals=12", field],
            3,
        ),
        ("free_duration", "problems/pair_time", &[], 3),
        (
            "redundant",
            "problems/pair",
            &["control.coordinates=redundant", "control.intervals=8"],
            3,
        ),
        (
            "redundant_trunk",
            trunk,
            &["control.coordinates=redundant", "control.intervals=2"],
            1,
        ),
        (
            "elements",
            "problems/fe_bending_control",
            &["control.intervals=3", beam],
            2,
        ),
        ("loop", &chain, &["control.intervals=3"], 2),
        ("out_of_reach", &beyond, &["control.intervals=10"], 2),
    ];
    let sizes = cases.map(|(name, problem, changes, kept)| record(name, problem, changes, kept));
    let all: usize = sizes.iter().sum();
    println!("{all} bytes");
}
