//! Variables that the programs of several motions and of their states of rest share: free parameters of the scene, inputs that are the same in
//! all motions, and coordinates of states of rest.

use crate::control::{Column, PEAK_VOLTAGE, Transcription};
use crate::model::Parameter;
use crate::nlp::joined::SharedVariable;
use crate::workflow::error::WorkflowError;

/// A program beside those of the motions: of a state of rest of one of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside<'a> {
    /// The motion.
    pub(super) motion: usize,
    /// Variables of the motion and of this program that are one.
    pub(super) shared: &'a [[usize; 2]],
}

/// The shared variables of programs, none of a single one: intervals of the named inputs, then constants, then coordinates of states of
/// rest, whose programs come last.
///
/// # Errors
/// A constant is not sought alike in all motions, or an input not at the same instants.
pub(super) fn shared_variables(
    programs: &[&Transcription<'_>],
    beside: &[Beside<'_>],
    inputs: &[String],
) -> Result<Vec<SharedVariable>, WorkflowError> {
    let [first, _, ..] = programs else {
        return Ok(Vec::new());
    };
    let motions = programs.len() - beside.len();
    let mut shared = Vec::new();
    for name in inputs {
        for k in 0..first.intervals() {
            let places = programs[..motions].iter();
            let places = places.map(|program| input(program, name, k));
            let places = places.collect::<Option<Vec<usize>>>();
            shared.push(places.ok_or_else(|| WorkflowError::Problem {
                place: "control.shared_inputs".to_owned(),
                reason: format!(
                    "the input of \"{name}\" is not sought in all intervals of all motions"
                ),
            })?);
        }
    }
    for (constant, place) in constants(first) {
        let other = |program: &&Transcription<'_>| {
            let found = constants(program).into_iter().find(|(other, _)| {
                let numbers = |one: &Parameter| [one.lower, one.upper, one.guess];
                other.name == constant.name && numbers(other) == numbers(constant)
            });
            found.map(|(_, place)| place)
        };
        let others = programs[1..].iter().map(other);
        let places = [Some(place)].into_iter().chain(others);
        let places = places.collect::<Option<Vec<usize>>>();
        shared.push(places.ok_or_else(|| WorkflowError::Problem {
            place: "control.free".to_owned(),
            reason: format!(
                "\"{}\" is one constant of all motions, which cannot begin at another value or be absent in one of them",
                constant.name
            ),
        })?);
    }
    let of_first = |places: &[usize]| first.variable_scale(places[0]);
    let variable = |places: Vec<usize>| {
        let scale = of_first(&places);
        let each = places.iter().zip(programs);
        let of = |(&place, program): (&usize, &&Transcription<'_>)| {
            (place, scale / program.variable_scale(place))
        };
        let mut all: Vec<_> = each.map(of).map(Some).collect();
        all.resize(programs.len(), None);
        SharedVariable(all)
    };
    let mut all: Vec<SharedVariable> = shared.into_iter().map(variable).collect();
    for (number, one) in (motions..).zip(beside) {
        let scale = |program: usize, place: usize| programs[program].variable_scale(place);
        let coordinate = |&[of_motion, own]: &[usize; 2]| {
            let mut places = vec![None; programs.len()];
            let factor = scale(one.motion, of_motion) / scale(number, own);
            places[one.motion] = Some((of_motion, 1.0));
            places[number] = Some((own, factor));
            SharedVariable(places)
        };
        all.extend(one.shared.iter().map(coordinate));
    }
    Ok(all)
}

/// Column of an input in an interval of the motion.
fn input(program: &Transcription<'_>, name: &str, k: usize) -> Option<usize> {
    let model = program.model();
    let source = model
        .sources
        .iter()
        .position(|source| source.name == name)?;
    let scalar = model.variables.input(source)?;
    (k < program.intervals()).then(|| program.unknowns().scalar(k, scalar))?
}

/// Free parameters of the scene with their columns.
fn constants<'p>(program: &'p Transcription<'_>) -> Vec<(&'p Parameter, usize)> {
    let model = program.model();
    let constant = |(place, column): (usize, &Column)| match column {
        Column::Parameter { .. } => Some((model.parameter(column.of(&model.variables)), place)),
        _ => None,
    };
    let columns = program.unknowns().columns.iter().enumerate();
    let all = columns.filter_map(constant);
    all.filter(|(constant, _)| constant.name != PEAK_VOLTAGE)
        .collect()
}
