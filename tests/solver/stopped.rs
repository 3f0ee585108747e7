//! Factorisations that are told to stop, alone and within a solve.

use crate::common::programs::{Program, bounds};
use crate::horizon::{Horizon, System};
use crate::ipopt::from;
use crate::matrices::Random;
use proboscis::ipopt::{Iteration, Options, Reached, Solver};
use proboscis::kkt::{Plan, Solver as Factors, Stopped};
use proboscis::nlp::Status;
use proboscis::stop::{self, Questions};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::rc::Rc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

const SMALL: Horizon = Horizon {
    intervals: 40,
    states: 6,
    inputs: 3,
    limits: 1,
    has_border: false,
    own: 0.0,
};

/// Few inputs, so that it is condensed.
const LONG: Horizon = Horizon {
    intervals: 5,
    states: 260,
    inputs: 1,
    limits: 0,
    has_border: false,
    own: 260.0,
};

fn factors(system: &System) -> Factors {
    let unknowns = Some(system.unknowns.as_slice());
    let plan = Plan::new(system.order(), &system.rows, &system.cols, unknowns);
    Factors::new(plan)
}

fn solution(factors: &mut Factors) -> Vec<f64> {
    let order = factors.plan().order();
    let mut x: Vec<f64> = (0..order).map(|i| (i as f64).cos()).collect();
    factors.solve(&mut x);
    x
}

/// Number of times that a factorisation asks if it is to stop.
fn questions(system: &System) -> usize {
    let asked = AtomicUsize::new(0);
    let count = || {
        asked.fetch_add(1, Ordering::Relaxed);
        false
    };
    factors(system)
        .factor_unless(&system.entries, &count)
        .unwrap();
    asked.into_inner()
}

#[test]
fn a_factorisation_stops_at_any_question_and_leaves_no_trace() {
    let mut random = Random(31);
    let condensed = System::of_horizon(LONG, 1.0, &mut random);
    for (system, is_condensed) in [
        (condensed, true),
        (System::full(700, |_, _| random.number()), false),
    ] {
        let mut fresh = factors(&system);
        let inertia = fresh.factor(&system.entries);
        assert!(inertia.negative > 0 && inertia.zero == 0);
        assert_eq!(fresh.statistics().condensed, usize::from(is_condensed));
        let expected = solution(&mut fresh);
        assert!(expected.iter().any(|x| x.abs() > 1e-6));
        let questions = questions(&system);
        assert!(questions >= 3, "{questions}");
        let mut factors = factors(&system);
        for last in [0, 1, questions / 2, questions - 1] {
            let left = AtomicUsize::new(last);
            let is_over = || {
                let one_less = |left: usize| left.checked_sub(1);
                left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less)
                    .is_err()
            };
            let stopped = factors.factor_unless(&system.entries, &is_over);
            assert_eq!(stopped, Err(Stopped), "question {last} of {questions}");
            assert!(solution(&mut factors).iter().all(|x| x.is_nan()));
            assert_eq!(factors.factor(&system.entries), inertia);
            assert!(solution(&mut factors) == expected);
        }
    }
}

/// An analysis stops at any of its questions, and takes no more than so many numbers between two of them.
#[test]
fn an_analysis_stops_at_any_question() {
    const BETWEEN: usize = 1 << 22;
    let system = System::full(2200, |_, _| 1.0);
    let unknowns = Some(system.unknowns.as_slice());
    let asked = AtomicUsize::new(0);
    let last = AtomicUsize::new(usize::MAX);
    let is_over = || asked.fetch_add(1, Ordering::Relaxed) >= last.load(Ordering::Relaxed);
    let analysed = || {
        asked.store(0, Ordering::Relaxed);
        let order = system.order();
        let plan = Plan::new_unless(order, &system.rows, &system.cols, unknowns, &is_over);
        (plan.map(|plan| plan.order()), asked.load(Ordering::Relaxed))
    };
    let (whole, questions) = analysed();
    assert_eq!(whole, Ok(system.order()));
    // Each entry is looked at several times.
    let least = system.rows.len() / BETWEEN + 3;
    assert!(
        questions >= least,
        "{questions} questions, expected {least}"
    );
    for stopped_at in 0..questions {
        last.store(stopped_at, Ordering::Relaxed);
        assert_eq!(analysed(), (Err(Stopped), stopped_at + 1));
    }
}

/// A question takes as long as some hundred multiplications.
#[test]
fn a_small_system_asks_once() {
    let system = System::of_horizon(SMALL, 1.0, &mut Random(32));
    assert!(system.order() > 500);
    assert_eq!(questions(&system), 1);
}

/// After how many answers of the Hessian the time is over at the next question.
type Answer = Arc<Mutex<Option<(usize, Questions)>>>;

/// Σ over all pairs of `½ aᵢⱼ xᵢ xⱼ + ¼ xᵢ⁴ − xᵢ` on a sphere: the Hessian is dense.
fn large(order: usize, answer: Answer) -> Program {
    let places: Vec<(u32, u32)> = (0..order as u32)
        .flat_map(|i| (0..=i).map(move |j| (i, j)))
        .collect();
    let mut random = Random(33);
    let of_place = |&(i, j): &(u32, u32)| random.number() + if i == j { 30.0 } else { 0.0 };
    let values: Vec<f64> = places.iter().map(of_place).collect();
    let product = {
        let (places, values) = (places.clone(), values.clone());
        move |x: &[f64]| {
            let mut to = vec![0.0; x.len()];
            for (&(i, j), value) in places.iter().zip(&values) {
                to[i as usize] += value * x[j as usize];
                if i != j {
                    to[j as usize] += value * x[i as usize];
                }
            }
            to
        }
    };
    let of_gradient = product.clone();
    let diagonal: Vec<usize> = (0..order).map(|i| i * (i + 3) / 2).collect();
    Program {
        variables: bounds(&vec![(-3.0, f64::INFINITY); order]),
        constraints: bounds(&[(order as f64, order as f64)]),
        jacobian_places: (0..order as u32).map(|j| (0, j)).collect(),
        hessian_places: places,
        f: Box::new(move |x| {
            let of_x = |(x, p): (&f64, f64)| 0.5 * x * p + 0.25 * x.powi(4) - x;
            x.iter().zip(product(x)).map(of_x).sum()
        }),
        grad: Box::new(move |x, grad| {
            for ((grad, p), x) in grad.iter_mut().zip(of_gradient(x)).zip(x) {
                *grad = p + x.powi(3) - 1.0;
            }
        }),
        g: Box::new(|x, g| g[0] = x.iter().map(|x| x * x).sum()),
        jac: Box::new(|x, to| to.iter_mut().zip(x).for_each(|(to, x)| *to = 2.0 * x)),
        hess: Box::new(move |x, sigma, y, to| {
            to.iter_mut()
                .zip(&values)
                .for_each(|(to, v)| *to = sigma * v);
            for (&at, x) in diagonal.iter().zip(x) {
                to[at] += sigma * 3.0 * x * x + 2.0 * y[0];
            }
            let mut answer = answer.lock().unwrap();
            if let Some((calls, questions)) = answer.take() {
                match calls {
                    // One more question: whether this answer came in time.
                    1 => questions.end_after(1),
                    calls => *answer = Some((calls - 1, questions)),
                }
            }
        }),
    }
}

/// Iterates that an observer has heard of.
type Heard = Rc<RefCell<Vec<(Iteration, Vec<f64>)>>>;

/// Hears of iterates up to the last one it wants.
fn observer(heard: &Heard, last: usize) -> impl FnMut(&Iteration, &Reached<'_>) -> ControlFlow<()> {
    let heard = heard.clone();
    move |iteration, reached| {
        heard.borrow_mut().push((*iteration, reached.x.to_vec()));
        match iteration.iteration < last {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    }
}

/// The time is over when the Hessian of the third iterate has answered, so that the factorisation is stopped: what is left is the same as if
/// the observer had stopped at this iterate.
#[test]
fn a_limit_within_a_factorisation_leaves_the_last_iterate() {
    const LAST: usize = 2;
    const ORDER: usize = 400;
    let answer = Answer::default();
    let point = from(&vec![0.3; ORDER]);
    let heard = Heard::default();
    let mut solver = Solver::new(large(ORDER, answer.clone()), Options::default());
    let whole = solver.solve(&point, &mut observer(&heard, usize::MAX));
    let whole = whole.unwrap().clone();
    assert!(whole.status.is_solved() && whole.iterations.len() > LAST + 2);
    let of_whole = heard.take();

    let asked = solver.solve(&point, &mut observer(&heard, LAST)).unwrap();
    let asked = asked.clone();
    assert_eq!(asked.status, Status::Interrupted);
    assert!(asked.costates.constraints[0].abs() > 1e-6);
    let of_asked = heard.take();
    assert!(of_asked == of_whole[..=LAST]);

    let questions = Questions::allowed(u64::MAX);
    *answer.lock().unwrap() = Some((LAST + 1, questions.clone()));
    let watch = stop::watch_questions(&questions);
    let stopped = solver.solve(&point, &mut observer(&heard, usize::MAX));
    let stopped = stopped.unwrap().clone();
    drop(watch);
    let within = stopped.linear.stages.unwrap().stopped;
    assert_eq!(within, Some(Status::TimeLimit), "within the factorisation");
    assert_eq!(stopped.status, Status::TimeLimit);
    assert!(heard.take() == of_asked);
    assert_eq!(stopped.x, asked.x);
    assert_eq!(stopped.objective.to_bits(), asked.objective.to_bits());
    assert_eq!(stopped.constraints, asked.constraints);
    assert_eq!(stopped.iterations, asked.iterations);
    let (costates, expected) = (&stopped.costates, &asked.costates);
    assert_eq!(costates.constraints, expected.constraints);
    assert_eq!(costates.upper, expected.upper);
    let mu = stopped.iterations[LAST].mu;
    for ((z, expected), x) in costates.lower.iter().zip(&expected.lower).zip(&stopped.x) {
        assert!((z * (x + 3.0) / mu - 1.0).abs() < 1e-6, "{z} {x} {mu}");
        assert!(
            *expected > 0.0 && (0.1..10.0).contains(&(z / expected)),
            "{z} {expected}"
        );
    }

    *answer.lock().unwrap() = None;
    solver.set_options(Options::default());
    let again = solver.solve(&point, &mut observer(&heard, usize::MAX));
    let again = again.unwrap();
    assert_eq!(again.linear.stages.unwrap().stopped, None);
    assert_eq!((&again.x, &again.iterations), (&whole.x, &whole.iterations));
}
