//! Free parameters: derivatives against differences; and at any values of them the program is that of the system made anew
//! with these values, which knows nothing of free parameters.

use crate::action::not_trivial;
use crate::common::cases::joints;
use crate::common::random::Random;
use crate::common::sought::{crowded, elements, lengthened, problem, relaxing, robot, wired};
use crate::sought_laws::by_laws;
use proboscis::control::problem::{BoundaryState, Control, Voltages};
use proboscis::control::{BoundaryConditions, Column, InitialGuess, Transcription, guess};
use proboscis::model::{Coordinates, Model, Role, System, with_parameters};
use proboscis::nlp::{Nlp, differences};
use std::collections::HashMap;

pub(crate) const H: f64 = 10.0;

/// Systems with free parameters: of bodies in both coordinates, with and without a free duration, of finite elements with one of the two.
fn variants() -> Vec<(System, Control)> {
    let both = [Coordinates::Reduced, Coordinates::Redundant];
    let cases = both.into_iter().flat_map(|c| [(c, false), (c, true)]);
    let of = |(coordinates, is_free): (Coordinates, bool)| {
        let system = robot();
        let control = Control {
            coordinates: Some(coordinates),
            ..problem(&system, is_free, None)
        };
        (system, control)
    };
    let of_elements =
        [(elements(), true), (relaxing(), false), (by_laws(), true)].map(|(of, is_free)| {
            let (system, parameters) = of;
            let control = Control {
                parameters,
                start: joints(&[(0, 0.05)]),
                goal: BoundaryState::Free,
                ..problem(&system, is_free, None)
            };
            (system, control)
        });
    let (system, parameters) = wired();
    let of_circuits = [false, true].map(|is_free| Control {
        parameters: parameters.clone(),
        goal: BoundaryState::Free,
        ..problem(&system, is_free, None)
    });
    let of_circuits = of_circuits.map(|control| (system.clone(), control));
    let (system, parameters) = crowded();
    let crowded = Control {
        parameters,
        goal: BoundaryState::Free,
        ..problem(&system, false, None)
    };
    let crowded = [(system, crowded)];
    let (system, parameters) = lengthened();
    let of_lengths = [false, true].map(|is_free| Control {
        parameters: parameters.clone(),
        goal: BoundaryState::Free,
        coordinates: Some(Coordinates::Reduced),
        ..problem(&system, is_free, None)
    });
    let of_lengths = of_lengths.map(|control| (system.clone(), control));
    let others = of_elements.into_iter().chain(of_circuits);
    let others = others.chain(crowded).chain(of_lengths);
    cases.map(of).chain(others).collect()
}

/// Does `check` with the program of each variant, at a point beside its start.
fn for_each_program(
    check: impl Fn((&System, &Control), &Model, &InitialGuess, &mut Transcription<'_>, &[f64]),
) {
    for (system, control) in variants() {
        let (model, boundary) = BoundaryConditions::resolve(&system, &control, H).unwrap();
        let initial = guess(&model, &boundary, &control, H, None);
        let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
        // Nodes are moved less, so that no element is inverted.
        let noise = if system.solids.is_empty() { 0.07 } else { 0.01 };
        let x = noisy(&program, program.start(&initial).x, noise);
        check((&system, &control), &model, &initial, &mut program, &x);
    }
}

pub(crate) fn noisy(program: &Transcription<'_>, start: Vec<f64>, size: f64) -> Vec<f64> {
    let mut random = Random(17);
    let noise = |x: f64| x + size * random.unit();
    assert!(start.len() == program.unknowns().columns.len());
    start.into_iter().map(noise).collect()
}

#[test]
fn derivatives_are_differences() {
    for_each_program(|(_, control), _, _, program, x| {
        let report = differences::check(program, x, 5);
        let what = format!("{:?} {:?}", control.coordinates, control.duration);
        println!("{what}: {report}");
        assert!(report.is_consistent(), "{what}: {report}");
        not_trivial(&what, program, x);
    });
}

/// The peak is a parameter that limits and a cost read, beside one that muscles read.
#[test]
fn derivatives_of_a_least_peak_are_differences() {
    for (system, mut control) in variants() {
        if !system.solids.is_empty() {
            continue;
        }
        control.parameters.truncate(1);
        control.objective.rate = 0.01;
        assert!(control.minimise_peak_voltage(0.7, &system));
        let (model, boundary) = BoundaryConditions::resolve(&system, &control, H).unwrap();
        let initial = guess(&model, &boundary, &control, H, None);
        let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
        let mut x = noisy(&program, program.start(&initial).x, 0.07);
        let mut columns = program.unknowns().columns.iter();
        let peak = columns.rposition(|column| matches!(column, Column::Parameter { .. }));
        let peak = peak.expect("the peak is a parameter");
        let objective = program.objective(&x);
        x[peak] *= 0.9;
        assert!(
            (program.objective(&x) - objective).abs() > 0.1,
            "it is paid"
        );
        let report = differences::check(&mut program, &x, 5);
        assert!(
            report.is_consistent(),
            "{:?}: {report}",
            control.coordinates
        );
        not_trivial("peak", &mut program, &x);
    }
}

/// Rows, and entries of Jacobian and Hessian without parameters, unscaled, by names.
type Numbers = (HashMap<String, f64>, [HashMap<(String, String), f64>; 2]);

fn numbers(program: &mut Transcription<'_>, model: &Model, x: &[f64]) -> Numbers {
    let rows = program.constraints().lower.len();
    let names: Vec<String> = (0..rows).map(|r| program.constraint_name(r)).collect();
    let columns: Vec<Column> = program.unknowns().columns.clone();
    let scales: Vec<f64> = (0..rows).map(|r| program.row_scale(r)).collect();
    // Sizes of inputs follow from constants: variables are compared in the units inside.
    let units: Vec<f64> = (0..x.len()).map(|c| program.column_scale(c)).collect();
    let is_parameter = |c: usize| columns[c].of(&model.variables).role == Role::Parameter;
    let variables: Vec<String> = (0..x.len()).map(|c| program.variable_name(c)).collect();
    let mut g = vec![0.0; rows];
    program.constraint(x, &mut g);
    let values = names.iter().cloned();
    let g = values
        .zip(g.iter().zip(&scales).map(|(g, s)| g / s))
        .collect();
    let places = program.jacobian_structure();
    let mut list = vec![0.0; places.rows.len()];
    program.jacobian(x, &mut list);
    let mut jacobian = HashMap::new();
    for ((&r, &c), value) in places.rows.iter().zip(&places.cols).zip(&list) {
        if !is_parameter(c as usize) {
            let key = (names[r as usize].clone(), variables[c as usize].clone());
            *jacobian.entry(key).or_insert(0.0) += value / (scales[r as usize] * units[c as usize]);
        }
    }
    // Costates of the unscaled rows are the same in both programs.
    let mut random = Random(5);
    let costates: Vec<f64> = scales.iter().map(|s| random.unit() / s).collect();
    let places = program.hessian_structure();
    let mut list = vec![0.0; places.rows.len()];
    program.hessian(x, 0.3, &costates, &mut list);
    let mut hessian = HashMap::new();
    for ((&r, &c), value) in places.rows.iter().zip(&places.cols).zip(&list) {
        if !is_parameter(r as usize) && !is_parameter(c as usize) {
            let mut key = [variables[r as usize].clone(), variables[c as usize].clone()];
            key.sort();
            let [a, b] = key;
            *hessian.entry((a, b)).or_insert(0.0) +=
                value / (units[r as usize] * units[c as usize]);
        }
    }
    (g, [jacobian, hessian])
}

#[test]
fn a_program_with_parameters_is_that_of_the_system_made_with_their_values() {
    for_each_program(|(system, control), model, initial, program, x| {
        let discrete = program.decode(x);
        let parameters = control.parameters.clone();
        let values: Vec<f64> = {
            let range = model.variables.range(Role::Parameter);
            assert_eq!(range.len(), parameters.len());
            discrete.scalars[0][range].to_vec()
        };
        for (parameter, value) in parameters.iter().zip(&values) {
            assert!((value - parameter.guess).abs() > 1e-6 * parameter.size());
        }
        let anew = with_parameters(system, &parameters, &values);
        let given = Control {
            parameters: Vec::new(),
            ..control.clone()
        };
        let (other, boundary) = BoundaryConditions::resolve(&anew, &given, H).unwrap();
        assert_eq!(other.variables.count(Role::Parameter), 0);
        let mut plain = Transcription::new(&other, &boundary, &given, initial).unwrap();
        // The same point: columns of parameters left out, multipliers in the scales of the other program.
        let mut discrete = discrete;
        let range = model.variables.range(Role::Parameter);
        for row in &mut discrete.scalars {
            row.drain(range.clone());
        }
        let y = plain.encode(&discrete, discrete.times[1]);
        let (g, matrices) = numbers(program, model, x);
        let (expected, expected_matrices) = numbers(&mut plain, &other, &y);
        let size = expected.values().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(size > 1e-6);
        for (name, value) in &expected {
            assert!(
                (g[name] - value).abs() < 1e-12 * size,
                "{name}: {} {value}",
                g[name]
            );
        }
        // Multipliers have other scales in both programs; all other columns agree.
        for (found, expected) in matrices.iter().zip(&expected_matrices) {
            let is_scaled_alike = |name: &str| !name.contains("multiplier");
            let mut seen = 0;
            let alike = expected
                .iter()
                .filter(|((a, b), _)| is_scaled_alike(a) && is_scaled_alike(b));
            let largest = alike.clone().fold(0.0_f64, |a, (_, b)| a.max(b.abs()));
            for (key, value) in alike {
                let other = found.get(key).copied().unwrap_or(0.0);
                assert!(
                    (other - value).abs() < 1e-11 * largest,
                    "{key:?}: {other} {value}"
                );
                seen += 1;
            }
            assert!(seen > 50 && largest > 0.0);
        }
    });
}

#[test]
fn a_parameter_is_one_column_and_given_ones_leave_none() {
    let system = robot();
    let voltages = Voltages::constant(&[900.0, 700.0, 800.0, 0.0]);
    let sought = problem(&system, false, Some(voltages));
    let given = Control {
        parameters: Vec::new(),
        ..sought.clone()
    };
    let columns = |control: &Control| {
        let (model, boundary) = BoundaryConditions::resolve(&system, control, H).unwrap();
        let initial = guess(&model, &boundary, control, H, None);
        let program = Transcription::of_any(&model, &boundary, control, &initial).unwrap();
        let columns = program.unknowns().columns.clone();
        let role = |c: &Column| c.of(&model.variables).role;
        let count = |which: Role| columns.iter().filter(|c| role(c) == which).count();
        [count(Role::Parameter), count(Role::Voltage), columns.len()]
    };
    let [parameters, voltages, all] = columns(&sought);
    assert_eq!([parameters, voltages], [sought.parameters.len(), 0]);
    let [none, voltages, others] = columns(&given);
    assert_eq!([none, voltages, others + parameters], [0, 0, all]);
}
