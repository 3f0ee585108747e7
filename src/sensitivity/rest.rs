//! Derivatives of a state of rest by constants of the system and by inputs under which it rests.
//!
//! The balances of a motion of one interval that does not move are those of rest, `r(q; p) = 0`: `dq/dp = −(∂r/∂q)⁻¹ ∂r/∂p`.

use crate::control::problem::{BoundaryState, Control, Duration, Objective, SoughtHold};
use crate::control::{BoundaryConditions, Column, InitialGuess, Row, Transcription};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start};
use crate::math::Signal;
use crate::model::{Model, Role};
use crate::nlp::Nlp;
use crate::sensitivity::error::NoSensitivity;
use crate::sparse::Direct;
use nalgebra::DMatrix;

/// Derivatives of the coordinates of a state of rest: a column for each parameter of the model, then one for each of the sources.
pub(super) fn rest_derivatives(
    model: &Model,
    control: &Control,
    (state, voltages): (&Equilibrium, &[f64]),
    sources: &[usize],
) -> Result<DMatrix<f64>, NoSensitivity> {
    let control = still(control, voltages, sources);
    let n = model.coordinate_count();
    let start = Start::at_rest(model, state.z.clone());
    let boundary = BoundaryConditions::without_goal(start, n);
    let initial = InitialGuess {
        discrete: DiscreteTrajectory {
            times: vec![0.0, 1.0],
            z: vec![state.z.clone(); 2],
            scalars: vec![state.scalars.clone()],
            ..DiscreteTrajectory::default()
        },
        h: 1.0,
        costates: None,
        carried: Default::default(),
    };
    let program = Transcription::of_any(model, &boundary, &control, &initial);
    let program = program.map_err(|error| NoSensitivity::Refused(error.to_string()))?;
    solved(program, &initial, sources)
}

/// The problem of a motion of one interval of 1 ms under given inputs, but those of some sources.
fn still(control: &Control, voltages: &[f64], sources: &[usize]) -> Control {
    let given = voltages.iter().enumerate();
    let given = given.filter(|(source, _)| !sources.contains(source));
    Control {
        duration: Duration::Given(1.0),
        intervals: 1,
        start: BoundaryState::Free,
        goal: BoundaryState::Free,
        given: given.map(|(s, &v)| (s, Signal::Constant(v))).collect(),
        course: None,
        load_bounds: Default::default(),
        sought_hold: SoughtHold::Never,
        objective: Objective::default(),
        limits: Vec::new(),
        waypoints: Vec::new(),
        ..control.clone()
    }
}

/// Meaning of a column of the program of rest.
#[derive(Clone, Copy, Debug)]
enum Meaning {
    /// Unknown of this number.
    Unknown(usize),
    /// Parameter or source of this number.
    Given(usize),
}

/// The square system of a state of rest: number of each row, meaning of each column.
struct Equations {
    rows: Vec<Option<usize>>,
    columns: Vec<Meaning>,
    /// Unknown of each coordinate.
    of_coordinates: Vec<Option<usize>>,
    size: usize,
}

impl Equations {
    /// The system of a program; none where it is not square.
    fn new(program: &Transcription<'_>, sources: &[usize]) -> Option<Self> {
        let variables = &program.model().variables;
        let n = program.model().coordinate_count();
        let parameters = variables.range(Role::Parameter);
        let inputs = variables.sources_range();
        let mut size = 0;
        let mut of_coordinates = vec![None; n];
        let mut next = || {
            size += 1;
            size - 1
        };
        let mut meaning = |column: &Column| match *column {
            // All instants are the same.
            Column::Instant { i, .. } if i < n => {
                Meaning::Unknown(*of_coordinates[i].get_or_insert_with(&mut next))
            }
            Column::Parameter { s } => {
                let place = parameters.clone().position(|one| one == s);
                Meaning::Given(place.expect("a parameter of the model"))
            }
            Column::Interval { s, .. } if inputs.contains(&s) => {
                let source = column.of(variables).source;
                let place = sources.iter().position(|one| Some(*one) == source);
                Meaning::Given(parameters.len() + place.expect("a source that is open"))
            }
            _ => Meaning::Unknown(next()),
        };
        let all = program.unknowns();
        let columns = all.columns.iter().map(&mut meaning).collect();
        let mut count = 0;
        let row = |row: &Row| {
            // The state meets its constraints at both instants.
            let is_again = matches!(*row, Row::Instant { k: 0, i } if i >= n);
            (!is_again).then(|| {
                count += 1;
                count - 1
            })
        };
        let rows = all.rows.iter().map(row).collect();
        (count == size).then_some(Self {
            rows,
            columns,
            of_coordinates,
            size,
        })
    }
}

fn solved(
    mut program: Transcription<'_>,
    initial: &InitialGuess,
    sources: &[usize],
) -> Result<DMatrix<f64>, NoSensitivity> {
    let singular = || NoSensitivity::Refused("a state of rest has no derivative".to_owned());
    let equations = Equations::new(&program, sources).ok_or_else(singular)?;
    let parameters = program.model().variables.count(Role::Parameter);
    let mut x = program.encode(&initial.discrete, initial.h);
    let given = parameters + sources.len();
    if program.model().action.map.multipliers > 0 {
        let (solver, _) = factored(&mut program, &equations, &x, given).ok_or_else(singular)?;
        balance(&mut program, &equations, &mut x, solver);
    }
    let (mut solver, mut right) =
        factored(&mut program, &equations, &x, given).ok_or_else(singular)?;
    for mut column in right.column_iter_mut() {
        solver.solve(column.as_mut_slice());
    }
    let mut out = DMatrix::zeros(equations.of_coordinates.len(), given);
    for (i, unknown) in equations.of_coordinates.iter().enumerate() {
        if let Some(unknown) = *unknown {
            out.set_row(i, &right.row(unknown));
        }
    }
    Ok(out)
}

/// The factorised matrix of the equations at a point, and minus their derivatives by what is given.
fn factored(
    program: &mut Transcription<'_>,
    equations: &Equations,
    x: &[f64],
    given: usize,
) -> Option<(Direct, DMatrix<f64>)> {
    let entries = program.jacobian_structure();
    let mut values = vec![0.0; entries.rows.len()];
    program.jacobian(x, &mut values);
    let mut right = DMatrix::zeros(equations.size, given);
    let (mut places, mut left) = (Vec::new(), Vec::new());
    for ((&row, &col), &value) in entries.rows.iter().zip(&entries.cols).zip(&values) {
        let Some(row) = equations.rows[row as usize] else {
            continue;
        };
        let value = value / program.column_scale(col as usize);
        match equations.columns[col as usize] {
            Meaning::Unknown(unknown) => {
                places.push((row, unknown));
                left.push(value);
            }
            Meaning::Given(p) => right[(row, p)] -= value,
        }
    }
    let mut solver = Direct::new(equations.size, &places);
    solver.factor(&left).ok()?;
    Some((solver, right))
}

/// Finds the multipliers of the constraints, in which the equations are linear: at a state of rest a step of Newton's method changes them alone.
fn balance(
    program: &mut Transcription<'_>,
    equations: &Equations,
    x: &mut [f64],
    mut solver: Direct,
) {
    let n = program.model().coordinate_count();
    let mut g = vec![0.0; program.constraints().lower.len()];
    program.constraint(x, &mut g);
    let bounds = &program.constraints().lower;
    let mut step = vec![0.0; equations.size];
    for (row, (value, bound)) in equations.rows.iter().zip(g.iter().zip(bounds)) {
        row.iter().for_each(|&row| step[row] = bound - value);
    }
    solver.solve(&mut step);
    let columns = program.unknowns().columns.iter().zip(&equations.columns);
    for (number, (column, meaning)) in columns.enumerate() {
        if let (Column::Instant { i, .. }, Meaning::Unknown(unknown)) = (*column, *meaning)
            && i >= n
        {
            x[number] += step[unknown] / program.column_scale(number);
        }
    }
}
