//! Limits, goals and costs of quantities that read free parameters: derivatives, and values of the system made anew.

use crate::common::sought::{lengthened, problem, wired};
use crate::sought::{H, noisy};
use nalgebra::Vector3;
use proboscis::control::problem::{
    BoundaryState, Control, CostFunction, During, Limit, Place, QuantityCost, Rest,
};
use proboscis::control::{BoundaryConditions, Row, Transcription, guess};
use proboscis::math::Signal;
use proboscis::model::{
    Constant, Coordinates, FieldPlace, Model, Pulling, Quantity, Region, Role, System, What,
    with_parameters,
};
use proboscis::nlp::{Nlp, differences};

/// Limits and costs of quantities that read constants: stretches, fields, tensions, charges and what sources give.
fn bounded() -> (System, Control) {
    let (mut system, mut parameters) = wired();
    system.muscles[3].circuit = None;
    parameters.extend(crate::common::sought::parameters(&system));
    let far = [f64::NEG_INFINITY, 1e3];
    let [min, max] = far;
    let flows = (0..2).flat_map(|muscle| {
        [
            Limit::new(What::Current(muscle), [min, max]),
            Limit::new(What::Power(muscle), [min, max]),
        ]
    });
    let of_muscles = (0..4).flat_map(|muscle| {
        [
            Limit::new(What::Stretch(muscle), [0.2, 5.0]),
            Limit::below(What::Field(FieldPlace::Muscle(muscle)), 2e5),
        ]
    });
    let limits = of_muscles.chain(flows).chain(tensions());
    let mut control = Control {
        parameters,
        goal: BoundaryState::Free,
        ..problem(&system, false, None)
    };
    control.limits = limits.collect();
    control.objective.quantities = [
        (Quantity::tension(Pulling::Muscle(0)), square(0.1)),
        (Quantity::tension(Pulling::Muscle(1)), square(0.0)),
        (Quantity::squared_field(2, false), CostFunction::Itself),
        (Quantity::current(1), square(0.02)),
    ]
    .map(|(quantity, function)| QuantityCost {
        quantity,
        weight: 0.3,
        function,
        during: During::Motion,
    })
    .to_vec();
    (system, control)
}

/// Limits of the tensions of muscles, springs and a tendon.
fn tensions() -> impl Iterator<Item = Limit> {
    let springs = [Pulling::Spring(0), Pulling::Spring(1), Pulling::Tendon(0)];
    let parts = (0..4).map(Pulling::Muscle).chain(springs);
    parts.map(|part| Limit::new(What::Tension(part), [f64::NEG_INFINITY, 1e3]))
}

fn square(reference: f64) -> CostFunction {
    CostFunction::Square {
        reference: Signal::Constant(reference),
    }
}

/// Values of the limits of a program, unscaled, in order of size, and the objective.
fn limits(program: &mut Transcription<'_>, x: &[f64]) -> (Vec<f64>, f64) {
    let mut values = vec![0.0; program.constraints().lower.len()];
    program.constraint(x, &mut values);
    let rows = program.unknowns().rows.iter().enumerate();
    let of_limits = rows.filter(|(_, row)| matches!(row, Row::Limit { .. }));
    let mut limits: Vec<f64> = of_limits
        .map(|(r, _)| values[r] / program.row_scale(r))
        .collect();
    limits.sort_by(f64::total_cmp);
    (limits, program.objective(x))
}

/// Number of entries of limits by parameters that are not zero.
fn read_constants(program: &mut Transcription<'_>, model: &Model, x: &[f64]) -> usize {
    let places = program.jacobian_structure();
    let mut values = vec![0.0; places.rows.len()];
    program.jacobian(x, &mut values);
    let unknowns = program.unknowns();
    let is_meant = |row: u32, col: u32| {
        let column = unknowns.columns[col as usize].of(&model.variables);
        matches!(unknowns.rows[row as usize], Row::Limit { .. }) && column.role == Role::Parameter
    };
    let entries = places.rows.iter().zip(&places.cols).zip(&values);
    let entries = entries.filter(|((row, col), value)| **value != 0.0 && is_meant(**row, **col));
    entries.count()
}

#[test]
fn limits_and_costs_read_constants() {
    let (system, control) = bounded();
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, H).unwrap();
    let initial = guess(&model, &boundary, &control, H, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let x = noisy(&program, program.start(&initial).x, 0.05);
    let report = differences::check(&mut program, &x, 5);
    assert!(report.is_consistent(), "{report}");
    assert!(read_constants(&mut program, &model, &x) > 100);
}

#[test]
fn limits_and_costs_are_those_of_the_system_made_with_their_values() {
    let (system, mut control) = bounded();
    // The unit of the charge behind the resistor is that of the guess: no parameter changes it.
    for parameter in &mut control.parameters {
        let is_other = |c: Constant| c.muscle() != Some(1);
        parameter.constants.retain(|one| is_other(one.constant));
    }
    control.parameters.retain(|p| !p.constants.is_empty());
    assert_are_those_of_the_system_made_anew(&system, &control, 100);
}

/// Places, regions and speeds of a marker, a goal of its place, and tensions of parts whose ends move.
#[test]
fn markers_are_where_parameters_move_them() {
    let (system, parameters) = lengthened();
    let (min, max) = (Vector3::repeat(-500.0), Vector3::repeat(500.0));
    let centre = Vector3::new(400.0, 0.0, 0.0);
    let regions = [
        (Region::Box { min, max }, [f64::NEG_INFINITY, 1.0]),
        (
            Region::Sphere {
                centre,
                radius: 20.0,
            },
            [1.0, f64::INFINITY],
        ),
    ];
    let limits = regions.map(|(region, side)| Limit::new(What::Region { marker: 0, region }, side));
    let speed = Limit::new(What::Speed(0), [0.0, 1e3]);
    let place = Place([Some(5.0), None, Some(3.0)]);
    let control = Control {
        parameters,
        limits: limits
            .into_iter()
            .chain([speed])
            .chain(tensions())
            .collect(),
        goal: BoundaryState::Markers {
            places: [(0, place)].into(),
            orientations: Default::default(),
            rest: Rest::Bodies,
            hold: None,
        },
        coordinates: Some(Coordinates::Reduced),
        ..problem(&system, false, None)
    };
    assert_are_those_of_the_system_made_anew(&system, &control, 20);
}

/// Derivatives are differences, and values those of the program of the system made anew with the values of the parameters; at least `count`
/// entries of limits by parameters are there.
fn assert_are_those_of_the_system_made_anew(system: &System, control: &Control, count: usize) {
    let (model, boundary) = BoundaryConditions::resolve(system, control, H).unwrap();
    let initial = guess(&model, &boundary, control, H, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let x = noisy(&program, program.start(&initial).x, 0.05);
    let report = differences::check(&mut program, &x, 5);
    assert!(report.is_consistent(), "{report}");
    assert!(read_constants(&mut program, &model, &x) >= count);
    let mut discrete = program.decode(&x);
    let range = model.variables.range(Role::Parameter);
    let values = discrete.scalars[0][range.clone()].to_vec();
    let anew = with_parameters(system, &control.parameters, &values);
    let given = Control {
        parameters: Vec::new(),
        ..control.clone()
    };
    let (other, boundary) = BoundaryConditions::resolve(&anew, &given, H).unwrap();
    let mut plain = Transcription::new(&other, &boundary, &given, &initial).unwrap();
    for row in &mut discrete.scalars {
        row.drain(range.clone());
    }
    let y = plain.encode(&discrete, discrete.times[1]);
    let (found, objective) = limits(&mut program, &x);
    let (expected, expected_objective) = limits(&mut plain, &y);
    assert!(objective.abs() > 1e-3);
    assert!((objective - expected_objective).abs() < 1e-12 * objective.abs());
    // At the start coordinates are given, so that constants alone open rows there.
    assert!(expected.len() > 12 && found.len() >= expected.len());
    for value in expected {
        let is_same = |other: &f64| (other - value).abs() < 1e-11 * value.abs().max(1e-3);
        assert!(found.iter().any(is_same), "{value} is not in {found:?}");
    }
}
