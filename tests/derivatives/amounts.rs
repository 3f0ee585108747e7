//! Volume and mass of muscles as functions of free parameters: limits and costs against the system made anew with the values, and derivatives
//! against differences.

use crate::common::random::Random;
use crate::common::sought::{problem, robot};
use proboscis::control::problem::{Control, CostFunction, During, Limit, QuantityCost};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::model::{Amount, Coordinates, Model, Quantity, Role, System, What, with_parameters};
use proboscis::nlp::{Nlp, differences};
use std::sync::Arc;

const H: f64 = 10.0;
const LIMITED: [(Amount, &[usize]); 3] = [
    (Amount::Volume, &[0, 1, 2, 3]),
    (Amount::Mass, &[0, 1]),
    (Amount::Volume, &[3]),
];

/// Sides times distance of the ends, times density, muscle by muscle.
fn naive(system: &System, amount: Amount, muscles: &[usize]) -> f64 {
    let mut sum = 0.0;
    for &m in muscles {
        let muscle = &system.muscles[m];
        let [a, b] = muscle.cross_section;
        let (from, to) = (muscle.from.at, muscle.to.at);
        let squares: f64 = (0..3).map(|i| (to[i] - from[i]) * (to[i] - from[i])).sum();
        let volume = a * b * squares.sqrt() / muscle.prestretch.unwrap_or(1.0);
        sum += match amount {
            Amount::Volume => volume,
            Amount::Mass => volume * muscle.material.density.unwrap_or(0.0),
        };
    }
    sum
}

/// The robot with limits of amounts, or none of them.
fn limited(coordinates: Coordinates, is_free: bool, weight: f64) -> (System, Control) {
    let system = robot();
    let mut plain = problem(&system, is_free, None);
    // Those that shape the muscles, and one that does not.
    let kept = ["width", "arm", "end", "density", "viscosity"];
    plain.parameters.retain(|one| kept.contains(&&*one.name));
    let of = |(amount, muscles): (Amount, &[usize])| {
        Limit::new(
            What::Amount {
                muscles: Arc::from(muscles),
                amount,
            },
            [
                0.5 * naive(&system, amount, muscles),
                0.9 * naive(&system, amount, muscles),
            ],
        )
    };
    let mut control = Control {
        coordinates: Some(coordinates),
        limits: LIMITED.into_iter().map(of).collect(),
        ..plain
    };
    if weight > 0.0 {
        control.objective.quantities.push(QuantityCost {
            quantity: Quantity::of(What::Amount {
                muscles: Arc::from([0, 2]),
                amount: Amount::Volume,
            })
            .in_unit(1e3),
            weight,
            function: CostFunction::Itself,
            during: During::End,
        });
    }
    (system, control)
}

/// Values of the parameters at a point.
fn values(program: &Transcription<'_>, model: &Model, x: &[f64]) -> Vec<f64> {
    let range = model.variables.range(Role::Parameter);
    program.decode(x).scalars[0][range].to_vec()
}

#[test]
fn amounts_are_those_of_the_system_made_with_the_values_and_derivatives_are_differences() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        for is_free in [false, true] {
            let (system, control) = limited(coordinates, is_free, 0.7);
            let (model, boundary) = BoundaryConditions::resolve(&system, &control, H).unwrap();
            let initial = guess(&model, &boundary, &control, H, None);
            let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
            let mut random = Random(17);
            let start = program.start(&initial).x;
            let x: Vec<f64> = start.iter().map(|x| x + 0.05 * random.unit()).collect();
            let anew = with_parameters(&system, &control.parameters, &values(&program, &model, &x));
            let rows = program.constraints().lower.len();
            let mut g = vec![0.0; rows];
            program.constraint(&x, &mut g);
            let entries = program.jacobian_structure();
            for (amount, muscles) in LIMITED {
                let name = amount.words(muscles, &system);
                let found: Vec<usize> = (0..rows)
                    .filter(|&r| program.constraint_name(r) == name)
                    .collect();
                let &[row] = &found[..] else {
                    panic!("{name}: {} rows", found.len());
                };
                let unit = 0.9 * naive(&system, amount, muscles);
                let value = naive(&anew, amount, muscles) / unit;
                let before = 1.0 / 0.9;
                assert!((value - before).abs() > 1e-3, "{name} is moved");
                assert!((g[row] - value).abs() < 1e-13, "{name}: {} {value}", g[row]);
                let columns = entries.rows.iter().zip(&entries.cols);
                let columns = columns.filter(|(r, _)| **r as usize == row);
                let reads = columns.map(|(_, &c)| program.variable_name(c as usize));
                let reads: Vec<String> = reads.collect();
                let expected: &[&str] = match (amount, muscles) {
                    (Amount::Volume, [3]) => &["width"],
                    (Amount::Volume, _) => &["width", "arm", "end"],
                    (Amount::Mass, _) => &["width", "arm", "end", "density"],
                };
                assert!(reads.len() == expected.len(), "{name}: {reads:?}");
                let is_read = |one: &&str| reads.iter().any(|name| name.contains(one));
                assert!(expected.iter().all(is_read), "{name}: {reads:?}");
            }
            let objective = program.objective(&x);
            let (_, without) = limited(coordinates, is_free, 0.0);
            let (other, boundary) = BoundaryConditions::resolve(&system, &without, H).unwrap();
            let mut plain = Transcription::new(&other, &boundary, &without, &initial).unwrap();
            let cost = 0.7 * naive(&anew, Amount::Volume, &[0, 2]) / 1e3;
            let difference = objective - plain.objective(&x);
            assert!(
                cost > 0.1 && (difference - cost).abs() < 1e-12,
                "{difference} {cost}"
            );
            let report = differences::check(&mut program, &x, 5);
            assert!(
                report.is_consistent(),
                "{coordinates:?} {is_free}: {report}"
            );
        }
    }
}
