//! The checker of derivatives passes right ones and names wrong ones.

use crate::common::programs::{Program, bounds, hs071, one_variable, rosenbrock};
use proboscis::nlp::differences::{EntryStatus, Matrix, TOLERANCE, check};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const POINT: [f64; 4] = [1.3, 4.2, 3.1, 1.7];

/// The same program with the derivative values altered by `alter`.
fn with_hessian(mut alter: impl FnMut(f64, &[f64], &mut [f64]) + Send + 'static) -> Program {
    let mut program = hs071();
    let mut right = hs071().hess;
    program.hess = Box::new(move |x, sigma, y, values| {
        right(x, sigma, y, values);
        alter(sigma, y, values);
    });
    program
}

#[test]
fn right_derivatives_pass() {
    for seed in 0..20 {
        let report = check(&mut hs071(), &POINT, seed);
        assert!(report.is_consistent(), "{report}");
        // Rounding stays a decade below the tolerance, as the module promises.
        assert!(
            report.gradient.max(report.jacobian).max(report.hessian) < 0.1 * TOLERANCE,
            "{report}"
        );
        let report = check(&mut rosenbrock(), &[-1.2, 1.0], seed);
        assert!(report.is_consistent(), "{report}");
    }
}

#[test]
fn a_wrong_gradient_is_named() {
    let mut program = hs071();
    let mut right = hs071().grad;
    program.grad = Box::new(move |x, grad| {
        right(x, grad);
        grad[2] += 1e-4;
    });
    let report = check(&mut program, &POINT, 1);
    let gradient: Vec<_> = report
        .wrong
        .iter()
        .filter(|entry| entry.matrix == Matrix::Gradient)
        .collect();
    assert_eq!(gradient.len(), 1, "{report}");
    assert_eq!(
        (gradient[0].row.as_str(), gradient[0].column.as_str()),
        ("objective", "x[2]")
    );
    // A constant offset does not change second derivatives.
    assert!(
        report.hessian < TOLERANCE && report.jacobian < TOLERANCE,
        "{report}"
    );
}

#[test]
fn a_wrong_jacobian_entry_is_named() {
    let mut program = hs071();
    let mut right = hs071().jac;
    program.jac = Box::new(move |x, values| {
        right(x, values);
        values[6] = -values[6];
    });
    let report = check(&mut program, &POINT, 1);
    let worst = report
        .wrong
        .iter()
        .find(|entry| entry.matrix == Matrix::Jacobian)
        .expect("an error is found");
    assert_eq!(
        (worst.row.as_str(), worst.column.as_str()),
        ("g[1]", "x[2]")
    );
    assert!(
        (worst.difference - 2.0 * POINT[2]).abs() < 1e-6
            && (worst.analytic + 2.0 * POINT[2]).abs() < 1e-12
    );
    assert!(
        report.to_string().contains("Jacobian (g[1], x[2])"),
        "{report}"
    );
}

#[test]
fn a_hessian_that_takes_sigma_for_one_is_found() {
    let mut right = hs071().hess;
    let mut program = hs071();
    program.hess = Box::new(move |x, _, y, values| right(x, 1.0, y, values));
    let report = check(&mut program, &POINT, 5);
    assert!(
        report.hessian > 1e-3 && report.gradient < TOLERANCE && report.jacobian < TOLERANCE,
        "{report}"
    );
}

#[test]
fn a_hessian_that_ignores_the_size_of_costates_is_found() {
    let mut right = hs071().hess;
    let mut program = hs071();
    program.hess = Box::new(move |x, sigma, y, values| {
        let signs: Vec<f64> = y.iter().map(|y| y.signum()).collect();
        right(x, sigma, &signs, values);
    });
    assert!(check(&mut program, &POINT, 5).hessian > 1e-3);
}

#[test]
fn a_missing_entry_is_found() {
    let mut program = hs071();
    let mut right = hs071().hess;
    program.hessian_places.pop();
    program.hess = Box::new(move |x, sigma, y, values| {
        let mut all = [0.0; 10];
        right(x, sigma, y, &mut all);
        values.copy_from_slice(&all[..9]);
    });
    let report = check(&mut program, &POINT, 3);
    assert_eq!(report.wrong.len(), 1, "{report}");
    let entry = &report.wrong[0];
    assert_eq!(
        (entry.row.as_str(), entry.column.as_str(), entry.place),
        ("x[3]", "x[3]", EntryStatus::Missing)
    );
    assert!(report.to_string().contains("no entry"));
}

#[test]
fn a_small_wrong_entry_in_a_large_row_is_found() {
    // x₁ + 1e-6 x₂ with the second slope forgotten: a millionth of the row, still a thousand times the tolerance.
    let mut program = Program {
        variables: bounds(&[(-1.0, 1.0); 2]),
        constraints: bounds(&[(0.0, 0.0)]),
        jacobian_places: vec![(0, 0), (0, 1)],
        hessian_places: vec![],
        f: Box::new(|_| 0.0),
        grad: Box::new(|_, grad| grad.fill(0.0)),
        g: Box::new(|x, g| g[0] = x[0] + 1e-6 * x[1]),
        jac: Box::new(|_, values| values.copy_from_slice(&[1.0, 0.0])),
        hess: Box::new(|_, _, _, _| ()),
    };
    let report = check(&mut program, &[0.5, 0.5], 0);
    assert_eq!(report.wrong.len(), 1, "{report}");
    assert_eq!(report.wrong[0].column, "x[1]");
}

#[test]
fn a_linear_term_of_large_value_raises_no_alarm() {
    // The gradient is 1e6 everywhere, so that its differences are rounding noise beside an empty Hessian.
    let mut program = one_variable((0.0, 1.0), |x| 1e6 * (x + 0.1), |_| 1e6, |_| 0.0);
    let report = check(&mut program, &[0.123], 0);
    assert!(report.is_consistent(), "{report}");
}

#[test]
fn an_edge_of_the_domain_is_reported() {
    let mut program = one_variable(
        (0.0, 1.0),
        f64::sqrt,
        |x| 0.5 / x.sqrt(),
        |x| -0.25 / x.powf(1.5),
    );
    let report = check(&mut program, &[1e-9], 0);
    assert_eq!(report.unchecked, ["x[0]"]);
    assert!(!report.is_consistent());
    assert!(check(&mut program, &[0.5], 0).is_consistent());
}

#[test]
fn a_value_that_is_not_a_number_is_wrong() {
    let mut program = with_hessian(|_, _, values| values[4] = f64::NAN);
    let report = check(&mut program, &POINT, 0);
    assert_eq!(report.hessian, f64::INFINITY);
    assert_eq!(
        (
            report.wrong[0].row.as_str(),
            report.wrong[0].column.as_str()
        ),
        ("x[2]", "x[1]")
    );
}

#[test]
fn equal_seeds_give_equal_reports() {
    assert_eq!(
        check(&mut hs071(), &POINT, 9),
        check(&mut hs071(), &POINT, 9)
    );
    assert_ne!(
        check(&mut hs071(), &POINT, 9).hessian,
        check(&mut hs071(), &POINT, 10).hessian
    );
}

/// Σ (xᵢ₊₁ − xᵢ²)² subject to xᵢ xᵢ₊₁ = 1 for all neighbours.
fn chain(n: usize) -> Program {
    let count = u32::try_from(n).expect("a small number");
    let neighbours = move || (0..count - 1).map(|i| (i, i + 1));
    Program {
        variables: bounds(&vec![(-10.0, 10.0); n]),
        constraints: bounds(&vec![(1.0, 1.0); n - 1]),
        jacobian_places: neighbours()
            .flat_map(|(i, next)| [(i, i), (i, next)])
            .collect(),
        hessian_places: neighbours()
            .flat_map(|(i, next)| [(i, i), (next, next), (next, i)])
            .collect(),
        f: Box::new(|x| x.windows(2).map(|x| (x[1] - x[0] * x[0]).powi(2)).sum()),
        grad: Box::new(|x, grad| {
            grad.fill(0.0);
            for i in 0..x.len() - 1 {
                let r = x[i + 1] - x[i] * x[i];
                grad[i] -= 4.0 * x[i] * r;
                grad[i + 1] += 2.0 * r;
            }
        }),
        g: Box::new(|x, g| {
            for (g, x) in g.iter_mut().zip(x.windows(2)) {
                *g = x[0] * x[1];
            }
        }),
        jac: Box::new(|x, values| {
            for (values, x) in values.chunks_exact_mut(2).zip(x.windows(2)) {
                values.copy_from_slice(&[x[1], x[0]]);
            }
        }),
        hess: Box::new(|x, sigma, y, values| {
            for ((values, x), y) in values.chunks_exact_mut(3).zip(x.windows(2)).zip(y) {
                values[0] = sigma * (12.0 * x[0] * x[0] - 4.0 * x[1]);
                values[1] = sigma * 2.0;
                values[2] = sigma * -4.0 * x[0] + y;
            }
        }),
    }
}

#[test]
fn a_thousand_variables_are_checked() {
    let n = 1000;
    let x: Vec<f64> = (0..n).map(|i| 1.5 + f64::from(i).sin()).collect();
    let mut program = chain(x.len());
    let evaluations = Arc::new(AtomicUsize::new(0));
    let (mut right, counted) = (chain(x.len()).jac, evaluations.clone());
    program.jac = Box::new(move |x, values| {
        counted.fetch_add(1, Ordering::Relaxed);
        right(x, values);
    });
    let report = check(&mut program, &x, 7);
    assert!(report.is_consistent(), "{report}");
    assert_eq!(report.checked, x.len());
    // Of three neighbours no row reads two: one evaluation here, and two for each third of the variables.
    assert_eq!(evaluations.load(Ordering::Relaxed), 7);
    program.hessian_places[3 * 500 + 2] = (501, 499);
    let report = check(&mut program, &x, 7);
    let mut places: Vec<_> = report
        .wrong
        .iter()
        .map(|w| (w.row.as_str(), w.column.as_str(), w.place))
        .collect();
    places.sort_by_key(|place| place.1);
    assert_eq!(
        places,
        [
            ("x[501]", "x[499]", EntryStatus::Stored),
            ("x[501]", "x[500]", EntryStatus::Missing)
        ]
    );
}

/// All variables enter one row of the Jacobian, and one of them all rows of the Hessian.
#[test]
fn rows_that_read_many_variables_are_checked() {
    let n = 40;
    let count = u32::try_from(n).expect("a small number");
    let dense = move || Program {
        variables: bounds(&vec![(0.0, 2.0); n]),
        constraints: bounds(&[(0.0, 9.0), (0.0, 9.0)]),
        jacobian_places: (0..count).map(|i| (0, i)).chain([(1, 0)]).collect(),
        hessian_places: (0..count).map(|i| (count - 1, i)).collect(),
        f: Box::new(move |x| x[n - 1] * x.iter().sum::<f64>()),
        grad: Box::new(move |x, grad| {
            grad.fill(x[n - 1]);
            grad[n - 1] += x.iter().sum::<f64>();
        }),
        g: Box::new(|x, g| g.copy_from_slice(&[x.iter().sum(), x[0]])),
        jac: Box::new(|_, values| values.fill(1.0)),
        hess: Box::new(move |_, sigma, _, values| {
            values.fill(sigma);
            values[n - 1] = 2.0 * sigma;
        }),
    };
    let x: Vec<f64> = (0..count).map(|i| 1.0 + f64::from(i).sin()).collect();
    let report = check(&mut dense(), &x, 3);
    assert!(report.is_consistent() && report.checked == n, "{report}");
    // Of the Hessian alone: all but one variable may be moved at once, and a wrong, a missing entry show.
    let free = move || Program {
        constraints: bounds(&[(0.0, 9.0)]),
        jacobian_places: vec![(0, 0)],
        g: Box::new(|x, g| g[0] = x[0]),
        ..dense()
    };
    let report = check(&mut free(), &x, 3);
    assert!(report.is_consistent() && report.checked == n, "{report}");
    let mut wrong = free();
    wrong.hess = Box::new(move |_, sigma, _, values| {
        values.fill(sigma);
        values[n - 1] = 2.0 * sigma;
        values[7] = 1.1 * sigma;
    });
    let mut missing = free();
    missing.hessian_places[7] = (count - 1, 8);
    let mut right = free().hess;
    missing.hess = Box::new(move |x, sigma, y, values| {
        right(x, sigma, y, values);
        values[7] = 0.0;
    });
    for mut program in [wrong, missing] {
        let report = check(&mut program, &x, 3);
        let places = report
            .wrong
            .iter()
            .map(|w| (w.row.as_str(), w.column.as_str()));
        assert_eq!(places.collect::<Vec<_>>(), [("x[39]", "x[7]")], "{report}");
    }
}
