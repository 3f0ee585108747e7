//! The parametric example of sIPOPT (Pirnay, López-Negrete and Biegler 2012, section 3) and small programs with closed forms.

use proboscis::ipopt::{Options, StartingPoint, solve};
use proboscis::nlp::{Bounds, Entries, Multipliers, Nlp};
use proboscis::sensitivity::{Direction, Held, Kernel, NoSensitivity, Outcome, Side};
use std::ops::ControlFlow;

/// Minimise x₁² + x₂² + x₃² subject to 6x₁ + 3x₂ + 2x₃ = p₁, p₂x₁ + x₂ − x₃ = 1, x ≥ 0, where p are variables with equal bounds.
#[derive(Debug)]
struct Parametric {
    variables: Bounds,
    constraints: Bounds,
}

impl Parametric {
    fn new(p: [f64; 2]) -> Self {
        Self {
            variables: Bounds {
                lower: vec![0.0, 0.0, 0.0, p[0], p[1]],
                upper: vec![f64::INFINITY, f64::INFINITY, f64::INFINITY, p[0], p[1]],
            },
            constraints: Bounds {
                lower: vec![0.0, 1.0],
                upper: vec![0.0, 1.0],
            },
        }
    }
}

impl Nlp for Parametric {
    fn variables(&self) -> &Bounds {
        &self.variables
    }
    fn constraints(&self) -> &Bounds {
        &self.constraints
    }
    fn jacobian_structure(&self) -> Entries {
        Entries {
            rows: vec![0, 0, 0, 0, 1, 1, 1, 1],
            cols: vec![0, 1, 2, 3, 0, 1, 2, 4],
        }
    }
    fn hessian_structure(&self) -> Entries {
        Entries {
            rows: vec![0, 1, 2, 4],
            cols: vec![0, 1, 2, 0],
        }
    }
    fn objective(&mut self, x: &[f64]) -> f64 {
        x[..3].iter().map(|x| x * x).sum()
    }
    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        grad.fill(0.0);
        (0..3).for_each(|i| grad[i] = 2.0 * x[i]);
    }
    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        g[0] = 6.0 * x[0] + 3.0 * x[1] + 2.0 * x[2] - x[3];
        g[1] = x[4] * x[0] + x[1] - x[2];
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        values.copy_from_slice(&[6.0, 3.0, 2.0, -1.0, x[4], 1.0, -1.0, x[0]]);
    }
    fn hessian(&mut self, _: &[f64], sigma: f64, y: &[f64], values: &mut [f64]) {
        values.copy_from_slice(&[2.0 * sigma, 2.0 * sigma, 2.0 * sigma, y[1]]);
    }
}

/// An optimum with its multipliers.
type Solved = (Vec<f64>, Multipliers);

fn solved(p: [f64; 2]) -> Solved {
    let start = StartingPoint {
        x: vec![0.5, 0.5, 0.5, p[0], p[1]],
        costates: None,
    };
    let options = Options {
        tolerance: 1e-11,
        ..Options::default()
    };
    let found = solve(&mut Parametric::new(p), &start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    });
    let found = found.unwrap();
    assert!(found.status.is_solved());
    (found.x, found.costates)
}

fn held() -> Held {
    Held {
        variables: vec![false, false, false, true, true],
        constraints: vec![false, false],
        squares: None,
    }
}

#[test]
fn the_example_of_sipopt_is_met() {
    let (x, y) = solved([5.0, 1.0]);
    let mut kernel = Kernel::new(Parametric::new([5.0, 1.0]), &x, &y, &held()).unwrap();
    let at = kernel.point();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-6;
    // Table of the paper: the optimum at p = (5, 1).
    assert!(
        close(at[0], 0.6326531) && close(at[1], 0.3877551) && close(at[2], 0.0204082),
        "{at:?}"
    );
    let down = Direction {
        held: vec![(3, 1.0)],
        ..Direction::default()
    };
    let found = kernel.along(&down).unwrap();
    let moved: Vec<f64> = (0..3).map(|i| at[i] - 0.5 * found.variables[i]).collect();
    let expected = [0.576531, 0.377551, -0.045918];
    assert!(
        moved.iter().zip(expected).all(|(a, b)| close(*a, b)),
        "{moved:?}"
    );
    // x₃ reaches zero on the way.
    assert!(found.range.down.change > -0.5, "{:?}", found.range);
    assert_eq!(
        found.range.down.bound.as_deref(),
        Some("x[2] reaches its lower bound")
    );
    assert!(found.range.up.change.is_infinite() || found.range.up.change > 1.0);
    assert!(found.weak.is_empty());
}

#[test]
fn derivatives_are_those_of_optima_found_anew() {
    let (x, y) = solved([5.0, 1.0]);
    let mut kernel = Kernel::new(Parametric::new([5.0, 1.0]), &x, &y, &held()).unwrap();
    let step = 1e-4;
    for p in 0..2 {
        let found = kernel
            .along(&Direction {
                held: vec![(3 + p, 1.0)],
                ..Direction::default()
            })
            .unwrap();
        let beside = [-step, step].map(|change| {
            let mut at = [5.0, 1.0];
            at[p] += change;
            solved(at)
        });
        let slope =
            |value: &dyn Fn(&Solved) -> f64| (value(&beside[1]) - value(&beside[0])) / (2.0 * step);
        for i in 0..3 {
            let expected = slope(&|one| one.0[i]);
            assert!(expected.abs() > 1e-3);
            assert!((found.variables[i] - expected).abs() < 1e-6, "x{i} by p{p}");
        }
        for i in 0..2 {
            let expected = slope(&|one| one.1.constraints[i]);
            assert!(
                (found.multipliers[i] - expected).abs() < 1e-5,
                "y{i} by p{p}"
            );
        }
        let expected = slope(&|one| one.0[..3].iter().map(|x| x * x).sum());
        assert!((found.objective - expected).abs() < 1e-6);
    }
}

/// With p₁ = 4 the third variable rests at its bound.
#[test]
fn a_bound_that_is_reached_holds_and_moves() {
    let (x, y) = solved([4.0, 1.0]);
    let mut kernel = Kernel::new(Parametric::new([4.0, 1.0]), &x, &y, &held()).unwrap();
    assert_eq!(kernel.point()[2], 0.0);
    let by_goal = Direction {
        held: vec![(3, 1.0)],
        ..Direction::default()
    };
    let found = kernel.along(&by_goal).unwrap();
    // x₁ + x₂ = 1 and 6x₁ + 3x₂ = p₁.
    assert!((found.variables[0] - 1.0 / 3.0).abs() < 1e-9);
    assert!((found.variables[1] + 1.0 / 3.0).abs() < 1e-9);
    assert_eq!(found.variables[2], 0.0);
    let end = found.range.up.bound.unwrap();
    assert_eq!(end, "x[2] leaves its bound");
    // The price of the bound: its multiplier.
    let bound = Direction {
        bounds: vec![(2, Side::Lower, 1.0)],
        ..Direction::default()
    };
    let found = kernel.along(&bound).unwrap();
    assert!((found.objective - y.lower[2]).abs() < 1e-6 && y.lower[2] > 1e-2);
    assert_eq!(found.variables[2], 1.0);
}

#[test]
fn what_is_no_strict_optimum_has_no_sensitivities() {
    let (x, y) = solved([5.0, 1.0]);
    // A point beside the optimum moves there.
    let mut beside = x.clone();
    beside[0] += 1e-3;
    let kernel = Kernel::new(Parametric::new([5.0, 1.0]), &beside, &y, &held()).unwrap();
    assert!((kernel.point()[0] - x[0]).abs() < 1e-8);
    // Of which both equations are left out the objective alone is left: the origin, from which the multipliers are far.
    let open = Held {
        constraints: vec![true, true],
        ..held()
    };
    let mut kernel = Kernel::new(Parametric::new([5.0, 1.0]), &x, &y, &open).unwrap();
    assert!(kernel.point()[..3].iter().all(|x| x.abs() < 1e-9));
    // All three rest at their bounds without multipliers; a push at one moves it to one side alone.
    let slope = Direction {
        gradient: vec![(0, 1.0)],
        ..Direction::default()
    };
    let found = kernel.along(&slope).unwrap();
    assert_eq!(found.variables[0], -0.5);
    // Which of them moves the change of the optimum tells alone.
    assert_eq!(kernel.one_sided(&[slope]), None);
    assert_eq!(found.weak, ["x[0] reaches its lower bound"]);
    assert_eq!(
        (found.range.up.change, found.range.down.change),
        (0.0, f64::NEG_INFINITY)
    );
    // More equations than variables that no bound holds.
    let all = Held {
        variables: vec![true, true, false, true, true],
        ..held()
    };
    let error = Kernel::new(Parametric::new([5.0, 1.0]), &x, &y, &all).unwrap_err();
    assert_eq!(
        error,
        NoSensitivity::Overdetermined {
            rows: 2,
            columns: 1
        }
    );
}

/// What one solution for an outcome finds by a number is what one for the number finds of it, also where a bound is reached.
#[test]
fn outcomes_backward_are_those_forward() {
    let directions = [
        Direction {
            held: vec![(3, 1.0)],
            ..Direction::default()
        },
        Direction {
            held: vec![(4, 1.0)],
            gradient: vec![(0, 0.3)],
            ..Direction::default()
        },
        Direction {
            bounds: vec![(2, Side::Lower, 1.0)],
            constraint_bounds: vec![(1, Side::Lower, 0.7), (1, Side::Upper, 0.7)],
            objective: 2.0,
            ..Direction::default()
        },
    ];
    for p in [[5.0, 1.0], [4.0, 1.0]] {
        let (x, y) = solved(p);
        let mut kernel = Kernel::new(Parametric::new(p), &x, &y, &held()).unwrap();
        let outcome = Outcome {
            variables: vec![(0, 1.0), (2, 0.5), (3, 0.25)],
            multipliers: vec![(1, 2.0)],
        };
        let adjoint = kernel.adjoint(&outcome).unwrap();
        let objectives = kernel.objectives(&directions).unwrap();
        for (direction, objective) in directions.iter().zip(objectives) {
            let forward = kernel.along(direction).unwrap();
            let expected = outcome.of(&forward);
            let found = kernel.by(&adjoint, direction);
            assert!(expected.abs() > 0.1 && (found - expected).abs() < 1e-12 * expected.abs());
            assert!((objective - forward.objective).abs() < 1e-12 * objective.abs());
        }
    }
}
