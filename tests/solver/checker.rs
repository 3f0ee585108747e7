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

fn check(system: &System, control: &Control, factor: f64) {
    let (model, boundary) = BoundaryConditions::resolve(system, control, 10.0).unwrap();
    let initial = guess(&model, &boundary, control, 10.0, None);
    let of = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let start = of.start(&initial);
    let text = |text: &str| OptionValue::Text(text.to_owned());
    let extra = BTreeMap::from([
        ("derivative_test".to_owned(), text("second-order")),
        // Variables are scaled to about one: a small move away from the special points of the guess.
        (
            "point_perturbation_radius".to_owned(),
            OptionValue::Number(0.05),
        ),
        ("derivative_test_tol".to_owned(), OptionValue::Number(1e-4)),
        ("print_level".to_owned(), OptionValue::Integer(5)),
    ]);
    let options = Options {
        max_iterations: 0,
        start: Start::Cold,
        extra,
        ..Options::default()
    };
    let mut program = Program { of, factor };
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

/// What the checker says.
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
