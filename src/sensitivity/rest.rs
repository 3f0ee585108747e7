//! Derivatives of a state of rest by constants of the system and by inputs under which it rests.
//!
//! The balances of a motion of one interval that does not move are those of rest, `r(q; p) = 0`: `dq/dp = −(∂r/∂q)⁻¹ ∂r/∂p`.

use crate::control::problem::{BoundaryState, Control, Duration, Objective, Regime, SoughtHold};
use crate::control::{
    Argument, BoundaryConditions, Column, ImplicitFunction, InitialGuess, Transcription,
};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start};
use crate::math::Signal;
use crate::model::{Model, Role};
use crate::sensitivity::error::NoSensitivity;
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
    let singular = || NoSensitivity::Refused("a state of rest has no derivative".to_owned());
    solved(program, &initial, sources).ok_or_else(singular)
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

fn solved(
    mut program: Transcription<'_>,
    initial: &InitialGuess,
    sources: &[usize],
) -> Option<DMatrix<f64>> {
    let n = program.model().coordinate_count();
    let variables = &program.model().variables;
    let parameters = variables.range(Role::Parameter);
    let inputs = variables.sources_range();
    let known = |column: &Column| match *column {
        Column::Parameter { s } => Some(vec![(s - parameters.start, 1.0)]),
        Column::Interval { s, .. } if inputs.contains(&s) => {
            let source = column.of(variables).source;
            let place = sources.iter().position(|one| Some(*one) == source);
            let place = place.expect("a source that is open");
            Some(vec![(parameters.len() + place, 1.0)])
        }
        _ => None,
    };
    let function = ImplicitFunction::new(&program, Regime::Rest, known)?;
    let count = parameters.len() + sources.len();
    let mut x = program.encode(&initial.discrete, initial.h);
    let solved = function.derivatives(&mut program, &mut x, (count, None))?;
    let mut out = DMatrix::zeros(n, count);
    let columns = program.unknowns().columns.iter().zip(&function.columns);
    for (column, argument) in columns {
        if let (Column::Instant { k: 0, i }, &Argument::Unknown(unknown)) = (*column, argument)
            && i < n
        {
            out.set_row(i, &solved.row(unknown));
        }
    }
    Some(out)
}
