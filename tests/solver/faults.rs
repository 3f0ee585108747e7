//! Faults put into a solve and into a simulation, one at every call: each ends with a word or as if nothing had been.

use crate::common::cases::rest_to_rest;
use crate::common::{at_reference, trunk};
use proboscis::control::problem::Control;
use proboscis::control::{BoundaryConditions, InitialGuess, Transcription, guess};
use proboscis::dynamics::{DiscreteTrajectory, Start, StepError, simulate};
use proboscis::functional::{Coupling, Order, Output, Sample, Term, TermKind};
use proboscis::ipopt::{
    self, Iteration, LinearSolver, Options, Reached, SolverResult, StartingPoint,
};
use proboscis::math::Vector;
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::{Bounds, Entries, Nlp, Status};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Callback of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Callback {
    Objective,
    Gradient,
    Constraint,
    Jacobian,
    Hessian,
    Observer,
}

const CALLBACKS: [Callback; 6] = [
    Callback::Objective,
    Callback::Gradient,
    Callback::Constraint,
    Callback::Jacobian,
    Callback::Hessian,
    Callback::Observer,
];

/// Manner of its failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// No value exists, so that the solver is answered "false"; an observer asks to stop.
    False,
    /// One of the values is NaN.
    Nan,
    /// It panics.
    Panic,
}

/// The message of a panic that was put in.
const INJECTED: &str = "a fault put in";

/// Calls that were counted, and the one that fails.
#[derive(Default)]
struct Faults {
    calls: [Cell<usize>; 6],
    fault: Option<(Callback, usize, Way)>,
}

impl Faults {
    fn at(callback: Callback, call: usize, way: Way) -> Self {
        Self {
            fault: Some((callback, call, way)),
            ..Self::default()
        }
    }

    /// Counts a call and says whether it fails.
    fn strikes(&self, callback: Callback) -> Option<Way> {
        let count = &self.calls[callback as usize];
        count.set(count.get() + 1);
        let way = self
            .fault
            .filter(|&(c, call, _)| (c, call) == (callback, count.get()))?
            .2;
        assert!(way != Way::Panic, "{INJECTED}");
        Some(way)
    }

    fn spoil(&self, callback: Callback, values: &mut [f64]) {
        match self.strikes(callback) {
            None => {}
            Some(Way::False) => values.fill(f64::INFINITY),
            Some(_) => {
                let call = self.calls[callback as usize].get();
                values[call % values.len()] = f64::NAN;
            }
        }
    }
}

/// A program of which one call fails.
struct Faulty<'a, N> {
    program: &'a mut N,
    faults: &'a Faults,
}

impl<N: Nlp> Nlp for Faulty<'_, N> {
    fn variables(&self) -> &Bounds {
        self.program.variables()
    }

    fn constraints(&self) -> &Bounds {
        self.program.constraints()
    }

    fn jacobian_structure(&self) -> Entries {
        self.program.jacobian_structure()
    }

    fn hessian_structure(&self) -> Entries {
        self.program.hessian_structure()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        let mut value = [self.program.objective(x)];
        self.faults.spoil(Callback::Objective, &mut value);
        value[0]
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.program.gradient(x, grad);
        self.faults.spoil(Callback::Gradient, grad);
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.program.constraint(x, g);
        self.faults.spoil(Callback::Constraint, g);
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.program.jacobian(x, values);
        self.faults.spoil(Callback::Jacobian, values);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        self.program.hessian(x, sigma, costates, values);
        self.faults.spoil(Callback::Hessian, values);
    }
}

/// The pair steered from rest to rest in 20 intervals of 10 ms.
fn pair() -> (Control, Model, BoundaryConditions) {
    let control = rest_to_rest(1, 20, 200.0);
    let (model, boundary) = BoundaryConditions::resolve(&trunk(1), &control, 10.0).unwrap();
    (control, model, boundary)
}

fn solve(
    linear_solver: LinearSolver,
    program: &mut Transcription<'_>,
    start: &StartingPoint,
    faults: &Faults,
) -> SolverResult {
    let mut faulty = Faulty { program, faults };
    let options = Options {
        tolerance: 1e-10,
        linear_solver,
        ..Options::default()
    };
    let mut observer = |_: &Iteration, _: &Reached<'_>| match faults.strikes(Callback::Observer) {
        Some(_) => ControlFlow::Break(()),
        None => ControlFlow::Continue(()),
    };
    ipopt::solve(&mut faulty, start, &options, &mut observer).expect("Ipopt can be called")
}

/// Panics that were put in are not worth a line; others are told as always.
fn silence_injected_panics() {
    let told = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let text = panic.payload().downcast_ref::<String>();
        if !text.is_some_and(|text| text.contains(INJECTED)) {
            told(panic);
        }
    }));
}

fn is_finite(solution: &SolverResult) -> bool {
    let costates = &solution.costates;
    let lists = [
        &solution.x,
        &solution.constraints,
        &costates.constraints,
        &costates.lower,
        &costates.upper,
    ];
    let mut values = lists.into_iter().flatten();
    solution.objective.is_finite() && values.all(|value| value.is_finite())
}

/// All that the bits of a solve show in.
fn bits(solution: &SolverResult) -> Vec<u64> {
    let values = solution.x.iter().chain(&solution.costates.constraints);
    values.map(|value| value.to_bits()).collect()
}

/// Solves with a fault in every call: which one, and how they ended.
fn ends(linear_solver: LinearSolver) -> Vec<(String, SolverResult)> {
    let (control, model, boundary) = pair();
    let initial: InitialGuess = guess(&model, &boundary, &control, 10.0, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let start = program.start(&initial);
    let mut solve = |faults: &Faults| solve(linear_solver, &mut program, &start, faults);
    let counted = Faults::default();
    let undisturbed = solve(&counted);
    assert_eq!(undisturbed.status, Status::Solved);
    let calls = CALLBACKS.map(|callback| counted.calls[callback as usize].get());
    assert!(calls.iter().all(|&count| count > 10), "{calls:?}");

    let mut ends = Vec::new();
    for (callback, count) in CALLBACKS.into_iter().zip(calls) {
        for (call, way) in (1..=count).flat_map(|k| [(k, Way::False), (k, Way::Nan)]) {
            let told = format!("{callback:?}, call {call} of {count}, {way:?}");
            let solution = solve(&Faults::at(callback, call, way));
            assert!(is_finite(&solution), "{told}: {solution:?}");
            match solution.status {
                Status::Solved => {
                    assert_ne!(callback, Callback::Observer, "{told}");
                    let error = (solution.objective / undisturbed.objective - 1.0).abs();
                    // The barrier leaves its parameter times the number of bounds.
                    assert!(error < 1e-7, "{told}: {error}");
                    // A voltage at zero, where its cost has no slope, is known to the root of the tolerance.
                    for (value, expected) in solution.x.iter().zip(&undisturbed.x) {
                        let error = (value - expected).abs();
                        assert!(error < 1e-4, "{told}: {error}");
                    }
                }
                Status::Interrupted => assert_eq!(callback, Callback::Observer, "{told}"),
                Status::InvalidNumber => assert_ne!(callback, Callback::Observer, "{told}"),
                status => panic!("{told}: {status}"),
            }
            ends.push((told, solution));
        }
        for call in 1..=count {
            let told = format!("{callback:?}, call {call} of {count}");
            let faults = Faults::at(callback, call, Way::Panic);
            let panic = catch_unwind(AssertUnwindSafe(|| solve(&faults)));
            let message = panic.expect_err(&told);
            let message = message.downcast_ref::<String>().map(String::as_str);
            assert_eq!(message, Some(INJECTED), "{told}");
            let again = solve(&Faults::default());
            assert_eq!(bits(&again), bits(&undisturbed), "{told}");
        }
    }
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for (_, solution) in &ends {
        *words.entry(solution.status.word()).or_default() += 1;
    }
    println!("{calls:?} calls, {words:?}");
    // Failed trial points were got over, missing derivatives told.
    assert!(words["solved"] > 20, "{words:?}");
    assert!(words["invalid_number"] > 20, "{words:?}");
    assert_eq!(words["interrupted"], 2 * calls[5], "{words:?}");
    ends
}

#[test]
fn every_call_of_a_solve_may_fail_under_both_linear_solvers() {
    silence_injected_panics();
    let [stages, mumps] = [LinearSolver::Stages, LinearSolver::Mumps].map(ends);
    assert_eq!(stages.len(), mumps.len());
    for ((told, one), (same, other)) in stages.iter().zip(&mumps) {
        assert_eq!(told, same);
        assert_eq!(one.status, other.status, "{told}");
        let iterations = one.iterations.len().abs_diff(other.iterations.len());
        assert!(iterations <= 1, "{told}: {iterations}");
        if one.status.is_solved() {
            let error = (one.objective / other.objective - 1.0).abs();
            assert!(error < 1e-9, "{told}: {error}");
        }
    }
}

/// An effect whose derivatives do not exist in some of its evaluations.
#[derive(Debug)]
struct Failing {
    effect: Arc<dyn Term>,
    calls: Arc<AtomicUsize>,
    /// First call that fails, and the first one after it that does not.
    from: usize,
    until: usize,
}

impl Term for Failing {
    fn name(&self) -> &str {
        self.effect.name()
    }

    fn elements(&self) -> usize {
        self.effect.elements()
    }

    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        self.effect.couple(to);
    }

    fn reading(&self, _: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Term>> {
        unreachable!("no reaction is limited")
    }

    fn kind(&self) -> TermKind {
        self.effect.kind()
    }

    fn energy(&self, frame: &Sample<'_>) -> f64 {
        self.effect.energy(frame)
    }

    fn momentum_along(&self, at: [&[Vector]; 2], by: [&[Vector]; 2], out: &mut [Vector]) {
        self.effect.momentum_along(at, by, out);
    }

    fn momentum(&self, x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        self.effect.momentum(x, v, out);
    }

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        self.effect.evaluate(level, frame, slots, out);
        let call = 1 + self.calls.fetch_add(1, Ordering::SeqCst);
        if (self.from..self.until).contains(&call) {
            for forces in &mut out.plain.forces {
                forces.fill(Vector::repeat(f64::NAN));
            }
        }
    }
}

const STEPS: usize = 12;

/// A swing of the pair under a voltage switched on at once, and how often an effect was evaluated.
fn swing(
    coordinates: Coordinates,
    from: usize,
    until: usize,
) -> (DiscreteTrajectory, Option<StepError>, usize) {
    let mut model = Model::new(trunk(1), Some(coordinates), 10.0, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let calls = Arc::new(AtomicUsize::new(0));
    let effects = &mut model.action.intervals.terms;
    let effect = effects.remove(0);
    let failing = Failing {
        effect,
        calls: calls.clone(),
        from,
        until,
    };
    effects.insert(0, Arc::new(failing));
    let scalars = model.scalars(&[0.0, 1700.0]);
    let voltages = |_: f64, _: f64| scalars.clone();
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 10.0, STEPS, voltages, go_on);
    (discrete, failure, calls.load(Ordering::SeqCst))
}

fn all_finite(discrete: &DiscreteTrajectory) -> bool {
    let mut rows = discrete.z.iter().chain(&discrete.momenta);
    rows.all(|row| row.iter().all(|value| value.is_finite()))
}

#[test]
fn every_evaluation_of_a_simulation_may_fail() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let (whole, failure, calls) = swing(coordinates, usize::MAX, usize::MAX);
        assert_eq!(failure, None);
        assert_eq!(whole.intervals(), STEPS);
        assert!(calls > 3 * STEPS, "{calls}");
        let turn = (whole.z[STEPS][0] - whole.z[0][0]).abs();
        assert!(turn > 1e-2, "it moves: {turn}");
        let mut reached = Vec::new();
        for call in 1..=calls {
            let told = format!("{coordinates:?}, evaluation {call} of {calls}");
            // For good: the motion ends where it was, with the time.
            let (discrete, failure, _) = swing(coordinates, call, usize::MAX);
            let Some(StepError::NoConvergence { time, .. }) = failure else {
                panic!("{told}: {failure:?}");
            };
            let steps = discrete.intervals();
            reached.push(steps);
            assert!((time - 10.0 * steps as f64).abs() < 1e-9, "{told}: {time}");
            assert!(all_finite(&discrete), "{told}");
            assert_eq!(discrete.momenta, whole.momenta[..=steps], "{told}");
            // Once: the step is halved and the motion goes on.
            let (discrete, failure, _) = swing(coordinates, call, call + 1);
            assert_eq!((failure, discrete.intervals()), (None, STEPS), "{told}");
            assert!(all_finite(&discrete), "{told}");
            assert_eq!(discrete.report.halved, 1, "{told}");
            let error = (discrete.z[STEPS][0] - whole.z[STEPS][0]).abs();
            assert!(error < 0.05 * turn, "{told}: {error}");
        }
        assert_eq!(reached.first(), Some(&0));
        assert_eq!(reached.last(), Some(&(STEPS - 1)));
    }
}
