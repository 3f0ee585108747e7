//! Ipopt solves small programs with known solutions, and survives what evaluations and callers do to it.

use std::ops::ControlFlow;
use std::thread;
use std::time::Duration;

use crate::common::programs::{
    HS071_OPTIMUM, HS071_START, bounds, hs071, one_variable, rosenbrock,
};
use proboscis::ipopt::{
    IpoptError, Iteration, OptionValue, Options, Reached, SolverResult, Start, StartingPoint, solve,
};
use proboscis::nlp::{Bounds, Multipliers, Nlp, Status};

pub(crate) fn from(x: &[f64]) -> StartingPoint {
    StartingPoint {
        x: x.to_vec(),
        costates: None,
    }
}

pub(crate) fn with(extra: &[(&str, OptionValue)]) -> Options {
    let extra = extra
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()))
        .collect();
    Options {
        extra,
        ..Options::default()
    }
}

fn go_on(_: &Iteration, _: &Reached<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(crate) fn run(nlp: &mut dyn Nlp, x: &[f64], options: &Options) -> SolverResult {
    solve(nlp, &from(x), options, &mut go_on).expect("Ipopt can be called")
}

/// ∇f + ∇gᵀ y − z_L + z_U, from the program itself.
fn stationarity(nlp: &mut dyn Nlp, x: &[f64], costates: &Multipliers) -> Vec<f64> {
    let places = nlp.jacobian_structure();
    let mut sum = vec![0.0; x.len()];
    nlp.gradient(x, &mut sum);
    let mut values = vec![0.0; places.rows.len()];
    nlp.jacobian(x, &mut values);
    for (place, value) in values.iter().enumerate() {
        sum[places.cols[place] as usize] +=
            value * costates.constraints[places.rows[place] as usize];
    }
    let bounds = costates.lower.iter().zip(&costates.upper);
    sum.iter()
        .zip(bounds)
        .map(|(sum, (lower, upper))| sum - lower + upper)
        .collect()
}

#[test]
fn hs071_has_its_published_optimum() {
    let solution = run(&mut hs071(), &HS071_START, &Options::default());
    assert_eq!(solution.status, Status::Solved);
    // The optimum is published with seven decimals.
    assert!(
        (solution.objective - HS071_OPTIMUM).abs() < 1e-7,
        "{}",
        solution.objective
    );
    assert!(
        (solution.constraints[0] - 25.0).abs() < 1e-6
            && (solution.constraints[1] - 40.0).abs() < 1e-6
    );
    // The tolerance asked for is 1e-8, in Ipopt's scaled measure.
    for value in stationarity(&mut hs071(), &solution.x, &solution.costates) {
        assert!(value.abs() < 1e-6, "{value}");
    }
    assert!(
        solution.costates.lower[0] > 1.0,
        "the lower bound of the first variable is active"
    );
}

#[test]
fn duplicate_hessian_entries_are_summed() {
    // The line also passes a second minimum near (−2, 4).
    let solution = run(&mut rosenbrock(), &[0.0, 0.0], &Options::default());
    assert_eq!(solution.status, Status::Solved);
    assert!(
        (solution.x[0] - 1.0).abs() < 1e-7 && (solution.x[1] - 1.0).abs() < 1e-7,
        "{:?}",
        solution.x
    );
    // Newton's method converges in a few steps only if the Hessian is right.
    assert!(
        solution.iterations.len() < 30,
        "{}",
        solution.iterations.len()
    );
}

#[test]
fn the_account_of_a_solve_adds_up() {
    let mut told = Vec::new();
    let mut observer = |iteration: &Iteration, _: &Reached<'_>| {
        told.push(*iteration);
        thread::sleep(Duration::from_millis(2));
        ControlFlow::Continue(())
    };
    let solution = solve(
        &mut hs071(),
        &from(&HS071_START),
        &Options::default(),
        &mut observer,
    )
    .expect("can be called");
    assert_eq!(told, solution.iterations);
    assert!(
        told.iter()
            .enumerate()
            .all(|(number, iteration)| iteration.iteration == number)
    );
    let seconds = solution.seconds;
    let parts = seconds.solver
        + seconds.objective
        + seconds.gradient
        + seconds.constraints
        + seconds.jacobian
        + seconds.hessian
        + seconds.observer;
    assert!((parts - seconds.total).abs() <= 1e-9 * seconds.total);
    assert!(seconds.observer >= 2e-3 * told.len() as f64);
    // One gradient and one Jacobian per iterate, one Hessian per step.
    assert_eq!(solution.evaluations.gradient, told.len());
    assert_eq!(solution.evaluations.jacobian, told.len());
    assert_eq!(solution.evaluations.hessian, told.len() - 1);
    assert_eq!(solution.failed_evaluations, 0);
}

#[test]
fn no_constraints_and_one_variable() {
    let mut program = one_variable(
        (-10.0, 10.0),
        |x| (x - 3.0).powi(4) + x,
        |x| 4.0 * (x - 3.0).powi(3) + 1.0,
        |x| 12.0 * (x - 3.0).powi(2),
    );
    let solution = run(&mut program, &[0.0], &Options::default());
    assert_eq!(solution.status, Status::Solved);
    // 4 (x − 3)³ = −1.
    assert!(
        (solution.x[0] - (3.0 - 0.25_f64.cbrt())).abs() < 1e-7,
        "{:?}",
        solution.x
    );
    assert!(solution.constraints.is_empty() && solution.costates.constraints.is_empty());
}

#[test]
fn fixed_variables_keep_their_value() {
    let mut program = hs071();
    program.variables = bounds(&[(1.0, 1.0), (1.0, 5.0), (1.0, 5.0), (1.0, 5.0)]);
    let solution = run(&mut program, &HS071_START, &Options::default());
    // The first variable is one at the optimum anyway.
    assert_eq!((solution.status, solution.x[0]), (Status::Solved, 1.0));
    assert!((solution.objective - HS071_OPTIMUM).abs() < 1e-6);
}

#[test]
fn a_contradiction_is_infeasible() {
    let mut program = rosenbrock();
    // x² + y² ≤ −1.
    program.constraints = bounds(&[(f64::NEG_INFINITY, -1.0)]);
    program.hessian_places = vec![(0, 0), (1, 0), (1, 1)];
    program.g = Box::new(|x, g| g[0] = x[0] * x[0] + x[1] * x[1]);
    program.jac = Box::new(|x, values| values.copy_from_slice(&[2.0 * x[0], 2.0 * x[1]]));
    program.hess = Box::new(|x, sigma, y, values| {
        values[0] = sigma * (2.0 + 1200.0 * x[0] * x[0] - 400.0 * x[1]) + 2.0 * y[0];
        values[1] = -400.0 * sigma * x[0];
        values[2] = 200.0 * sigma + 2.0 * y[0];
    });
    let solution = run(&mut program, &[0.7, -0.4], &Options::default());
    assert_eq!(solution.status, Status::Infeasible);
    assert!(!solution.status.is_solved());
    assert!(
        solution
            .iterations
            .iter()
            .any(|iteration| iteration.restoration)
    );
    // The point of least violation is the origin.
    assert!(
        solution.x.iter().all(|x| x.abs() < 1e-3),
        "{:?}",
        solution.x
    );
}

#[test]
fn an_unbounded_objective_diverges_or_ends_at_the_limit() {
    let mut program = one_variable(
        (f64::NEG_INFINITY, f64::INFINITY),
        |x| -x,
        |_| -1.0,
        |_| 0.0,
    );
    let solution = run(&mut program, &[0.0], &Options::default());
    assert_eq!(solution.status, Status::Diverging);
    let options = Options {
        max_iterations: 3,
        ..Options::default()
    };
    let solution = run(&mut rosenbrock(), &[-1.2, 1.0], &options);
    assert_eq!(
        (solution.status, solution.iterations.len()),
        (Status::IterationLimit, 4)
    );
}

#[test]
fn too_many_equalities_are_a_status() {
    let mut program = rosenbrock();
    program.constraints = bounds(&[(2.0, 2.0); 3]);
    program.jacobian_places = (0..3).flat_map(|i| [(i, 0), (i, 1)]).collect();
    program.g = Box::new(|x, g| g.fill(x[0] + x[1]));
    let solution = run(&mut program, &[-1.2, 1.0], &Options::default());
    assert_eq!(solution.status, Status::TooFewDegreesOfFreedom);
    assert_eq!(solution.x, [-1.2, 1.0]);
}

#[test]
fn steps_out_of_the_domain_are_shortened() {
    // −log x + x has its minimum at one; the first full step from 3 leads to −3, where there is no logarithm.
    let mut program = one_variable(
        (f64::NEG_INFINITY, f64::INFINITY),
        |x| x - x.ln(),
        |x| 1.0 - 1.0 / x,
        |x| 1.0 / (x * x),
    );
    let solution = run(&mut program, &[3.0], &Options::default());
    assert_eq!(solution.status, Status::Solved);
    assert!((solution.x[0] - 1.0).abs() < 1e-7);
    assert!(solution.failed_evaluations > 0);
}

#[test]
fn a_start_outside_the_domain_is_a_status() {
    let mut program = one_variable(
        (f64::NEG_INFINITY, f64::INFINITY),
        f64::ln,
        |x| 1.0 / x,
        |x| -1.0 / (x * x),
    );
    let solution = run(&mut program, &[-1.0], &Options::default());
    assert_eq!(solution.status, Status::InvalidNumber);
    assert_eq!(solution.x, [-1.0]);
    assert!(solution.failed_evaluations > 0);
}

#[test]
fn unknown_options_are_errors_with_a_suggestion() {
    let options = with(&[("max_itre", OptionValue::Integer(5))]);
    let error =
        solve(&mut hs071(), &from(&HS071_START), &options, &mut go_on).expect_err("no such option");
    assert_eq!(
        error.to_string(),
        "Ipopt rejects the option max_itre = 5; did you mean max_iter?"
    );
    let options = with(&[("mu_strategy", OptionValue::Text("quick".to_owned()))]);
    let error =
        solve(&mut hs071(), &from(&HS071_START), &options, &mut go_on).expect_err("no such value");
    let value = OptionValue::Text("quick".to_owned());
    assert_eq!(
        error,
        IpoptError::OptionRejected {
            name: "mu_strategy".to_owned(),
            value,
            nearest: None
        }
    );
    let options = with(&[("tol", OptionValue::Text("small\0".to_owned()))]);
    assert!(solve(&mut hs071(), &from(&HS071_START), &options, &mut go_on).is_err());
}

#[test]
fn extra_options_override_and_whole_numbers_are_numbers() {
    let options = with(&[
        ("max_iter", OptionValue::Integer(2)),
        ("mu_init", OptionValue::Integer(1)),
        ("mumps_pivot_order", OptionValue::Integer(0)),
    ]);
    let solution = run(&mut hs071(), &HS071_START, &options);
    assert_eq!(
        (solution.status, solution.iterations[0].mu),
        (Status::IterationLimit, 1.0)
    );
}

#[test]
fn programs_without_variables_are_errors() {
    let mut program = one_variable((0.0, 1.0), |x| x, |_| 1.0, |_| 0.0);
    program.variables = Bounds::default();
    program.hessian_places.clear();
    let error = solve(&mut program, &from(&[]), &Options::default(), &mut go_on)
        .expect_err("nothing to vary");
    assert_eq!(
        error,
        IpoptError::ProblemNotCreated {
            variables: 0,
            constraints: 0,
            entries: 0
        }
    );
}

#[test]
fn warm_starts_take_fewer_iterations() {
    let steps = |solution: &SolverResult| solution.iterations.len() - 1;
    let cold = run(&mut hs071(), &HS071_START, &Options::default());
    let primal = Options {
        start: Start::PRIMAL,
        ..Options::default()
    };
    let primal = solve(&mut hs071(), &cold.to_point(), &primal, &mut go_on).expect("can be called");
    let dual = Options {
        start: Start::PrimalDual,
        ..Options::default()
    };
    let dual = solve(&mut hs071(), &cold.to_point(), &dual, &mut go_on).expect("can be called");
    assert_eq!(
        (primal.status, dual.status),
        (Status::Solved, Status::Solved)
    );
    assert!(steps(&dual) <= 2, "{}", steps(&dual));
    assert!(
        steps(&dual) <= steps(&primal) && steps(&primal) < steps(&cold),
        "{} {}",
        steps(&primal),
        steps(&cold)
    );
    assert!((dual.objective - HS071_OPTIMUM).abs() < 1e-6);
}

#[test]
fn a_centred_start_lies_on_the_path_of_the_barrier() {
    // Where the bound pushes, where it does not, and from above; the slope is linear, so that one variable is found at once.
    type Of = fn(f64) -> f64;
    let pushed: [Of; 2] = [|x| 1.5 * x * x - 2.0 * x, |x| 3.0 * x - 2.0];
    let flat: [Of; 2] = [|x| 1.5 * (x - 1.0).powi(2), |x| 3.0 * (x - 1.0)];
    let above: [Of; 2] = [|x| 1.5 * x * x - 5.0 * x, |x| 3.0 * x - 5.0];
    let (lower, upper) = ((1.0, f64::INFINITY), (f64::NEG_INFINITY, 1.0));
    for (name, bound, [f, slope], x, mu) in [
        ("on the bound", lower, pushed, 1.0, 1e-4),
        ("away from it", lower, pushed, 1.5, 3e-4),
        ("without a slope", lower, flat, 1.0, 1e-4),
        ("from above", upper, above, 1.0, 1e-4),
        ("from afar below", upper, above, 0.5, 3e-4),
    ] {
        let point = StartingPoint {
            x: vec![x],
            costates: Some(Multipliers {
                constraints: vec![],
                lower: vec![7.0],
                upper: vec![7.0],
            }),
        };
        let options = Options {
            start: Start::Centred,
            ..Options::default()
        };
        let mut first = None;
        let mut program = one_variable(bound, f, slope, |_| 3.0);
        let solution = solve(&mut program, &point, &options, &mut |iteration, reached| {
            first.get_or_insert((reached.x[0], iteration.dual_infeasibility));
            ControlFlow::Continue(())
        });
        assert_eq!(solution.expect("can be called").status, Status::Solved);
        let (x, infeasibility) = first.expect("a starting point");
        let apart = ((x - 1.0) * slope(x) - mu).abs();
        // Ipopt moves bounds by 1e-8.
        assert!(apart < 1e-7, "{name}: {x}, {apart:e}");
        assert!(infeasibility < 1e-7, "{name}: {infeasibility:e}");
    }
}

#[test]
#[should_panic(expected = "one value per variable in the starting point")]
fn a_short_starting_point_is_the_callers_mistake() {
    run(&mut hs071(), &[1.0], &Options::default());
}
