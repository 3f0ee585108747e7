//! Ipopt's own second-order derivative checker is silent.
//!
//! It writes to standard output from C, so the solve runs in a child process: this very test, told so by its environment.

use crate::common::cases::{control, rest_to_rest};
use crate::common::systems::branched;
use crate::common::trunk;
use proboscis::control::problem::{Control, Objective};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::ipopt::{self, OptionValue, Options, Start};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::nlp::{Bounds, Entries, Nlp};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::process::Command;

const CHILD: &str = "PROBOSCIS_DERIVATIVE_CHECKER";

/// Passes everything on, but the costates of the Hessian times a factor.
struct Program<'m> {
    of: Transcription<'m>,
    factor: f64,
}

impl Nlp for Program<'_> {
    fn variables(&self) -> &Bounds {
        self.of.variables()
    }

    fn constraints(&self) -> &Bounds {
        self.of.constraints()
    }

    fn jacobian_structure(&self) -> Entries {
        self.of.jacobian_structure()
    }

    fn hessian_structure(&self) -> Entries {
        self.of.hessian_structure()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.of.objective(x)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.of.gradient(x, grad);
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.of.constraint(x, g);
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.of.jacobian(x, values);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        let costates: Vec<f64> = costates.iter().map(|y| y * self.factor).collect();
        self.of.hessian(x, sigma, &costates, values);
    }
}

/// By how much variables move away from the start.
const RADIUS: f64 = 0.05;
/// Round-off of a first derivative over that of its largest entry: sums of about so many numbers of its size.
const SUMMED: f64 = 8.0;

/// Step and tolerance of the checker, which compares second derivatives with one-sided differences of first ones.
///
/// Such a difference over δ is wrong by `2 ε J/δ + δ T/2`, with first derivatives up to J that are known up to ε, and third ones up to T. That is
/// least at `δ² = 4 ε J/T`. Where the second derivative is small the checker compares the error with the square of its tolerance.
fn method(program: &mut Program<'_>, x: &[f64]) -> (f64, f64) {
    let (jacobian, hessian) = (program.jacobian_structure(), program.hessian_structure());
    let costates = vec![1.5; program.constraints().lower.len()];
    let mut first = vec![0.0; jacobian.rows.len()];
    let mut ends = [(); 2].map(|()| vec![0.0; hessian.rows.len()]);
    program.jacobian(x, &mut first);
    let mut gradient = vec![0.0; x.len()];
    program.gradient(x, &mut gradient);
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let first = 1.5 * largest(&first).max(largest(&gradient));
    // Third derivatives along one direction after the other.
    let mut third = 0.0_f64;
    for i in 0..x.len() {
        for (sign, values) in [-1.0, 1.0].into_iter().zip(&mut ends) {
            let mut x = x.to_vec();
            x[i] += sign * 0.1 * RADIUS;
            program.hessian(&x, 1.5, &costates, values);
        }
        let [low, high] = &ends;
        let differences: Vec<f64> = high.iter().zip(low).map(|(a, b)| a - b).collect();
        third = third.max(largest(&differences) / (0.2 * RADIUS));
    }
    assert!(first > 0.1 && third > 0.1, "{first} {third}");
    let rounded = SUMMED * f64::EPSILON * first;
    let step = 2.0 * (rounded / third).sqrt();
    let error = 2.0 * rounded / step + 0.5 * step * third;
    (step, error.sqrt())
}

fn check(system: &System, control: &Control, factor: f64) {
    let (model, boundary) = BoundaryConditions::resolve(system, control, 10.0).unwrap();
    let initial = guess(&model, &boundary, control, 10.0, None);
    let of = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let start = of.start(&initial);
    let mut program = Program { of, factor };
    let (step, tolerance) = method(&mut program, &start.x);
    let text = |text: &str| OptionValue::Text(text.to_owned());
    let number = OptionValue::Number;
    let extra = BTreeMap::from([
        ("derivative_test".to_owned(), text("second-order")),
        // Variables are scaled to about one: a small move away from the special points of the guess.
        ("point_perturbation_radius".to_owned(), number(RADIUS)),
        ("derivative_test_perturbation".to_owned(), number(step)),
        ("derivative_test_tol".to_owned(), number(tolerance)),
        ("print_level".to_owned(), OptionValue::Integer(5)),
    ]);
    let options = Options {
        max_iterations: 0,
        start: Start::Cold,
        extra,
        ..Options::default()
    };
    ipopt::solve(&mut program, &start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
}

/// The problem of a name, in a child process.
fn child(name: &str) {
    let (case, coordinates) = name.split_once(' ').unwrap();
    let coordinates = match coordinates {
        "reduced" => Coordinates::Reduced,
        _ => Coordinates::Redundant,
    };
    let (system, mut control, factor) = match case {
        "pair" => (trunk(1), rest_to_rest(1, 4, 80.0), 1.0),
        "branched" => (branched(), control(&branched(), 2), 1.0),
        _ => (trunk(1), rest_to_rest(1, 4, 80.0), 1.05),
    };
    if case == "branched" {
        control.limits = crate::common::cases::all_limits();
        control.objective = Objective {
            rate: 0.1,
            ..control.objective
        };
    }
    control.coordinates = Some(coordinates);
    check(&system, &control, factor);
}

/// Output of the checker.
fn output(name: &str) -> String {
    let this = std::env::current_exe().unwrap();
    let result = Command::new(this)
        .args(["--exact", "checker::the_checker_is_silent", "--nocapture"])
        .env(CHILD, name)
        .output()
        .unwrap();
    assert!(
        result.status.success(),
        "{}",
        String::from_utf8_lossy(&result.stderr)
    );
    String::from_utf8(result.stdout).unwrap()
}

#[test]
fn the_checker_is_silent() {
    if let Ok(name) = std::env::var(CHILD) {
        child(&name);
        return;
    }
    for name in ["pair reduced", "pair redundant", "branched reduced"] {
        let output = output(name);
        assert!(
            output.contains("Starting derivative checker"),
            "{name}: {output}"
        );
        assert!(
            output.contains("No errors detected by derivative checker"),
            "{name}: {output}"
        );
    }
    // It is able to speak.
    let output = output("mistaken redundant");
    assert!(output.contains("Derivative checker detected"), "{output}");
}
