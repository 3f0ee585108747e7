//! Derivatives of few outcomes of an optimum by many numbers of its problem.
//!
//! Each outcome takes one solution of the linear system (`adjoint`) where there are fewer of them than numbers, and otherwise each number takes one. The
//! objective needs none; one for all numbers checks it, and counts as an outcome. Where a bound is reached without a multiplier, the change of the optimum
//! by each number tells whether its derivatives hold to one side alone: then each number takes one too.

use crate::control::problem::{Control, OutcomeOf, Varied};
use crate::control::{Column, Solution, Transcription};
use crate::model::{Coordinates, Role, System, Time};
use crate::sensitivity::active_set::Direction;
use crate::sensitivity::adjoint::Outcome;
use crate::sensitivity::check::NoSensitivity;
use crate::sensitivity::kernel::Kernel;
use crate::sensitivity::margins::MarkerSlopes;
use crate::sensitivity::optimum::{is_place, with_kernel};
use crate::sensitivity::with_parameters::Opened;

/// Part of an interval before its start that counts as its own.
const SNAP: f64 = 1e-6;

/// Derivatives of outcomes by numbers, by the units inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// Of the objective, by number.
    pub objective: Vec<f64>,
    /// Of the outcomes, by outcome and number.
    pub outcomes: Vec<Vec<f64>>,
    /// Number of solutions of the linear system that this took, the check of the objective included.
    pub solutions: usize,
    /// Bounds that are reached or left with a number at once: derivatives by it hold to one side alone.
    pub one_sided: Vec<String>,
}

/// Derivatives of outcomes of an optimum, and of its objective, by the numbers that its problem names.
///
/// # Errors
/// The derivatives do not exist, are not known to be right, or are not offered of an outcome.
pub fn gradients(
    system: &System,
    control: &Control,
    motion: &Solution,
    outcomes: &[OutcomeOf],
) -> Result<Gradients, NoSensitivity> {
    with_kernel(
        system,
        control,
        motion,
        |opened, kernel, directions, rows| {
            let of = |one: &OutcomeOf| outcome(one, (opened, kernel.program(), rows));
            let list = outcomes.iter().map(of).collect::<Result<Vec<_>, _>>()?;
            let directions = directions.iter().cloned().collect::<Result<Vec<_>, _>>()?;
            let directions = &directions[..];
            let backward = list.len() + 1;
            let one_sided = match backward < directions.len() {
                true => kernel.one_sided(directions),
                false => None,
            };
            match one_sided {
                Some(one_sided) => by_outcomes(kernel, directions, &list, one_sided),
                None => by_numbers(kernel, directions, &list),
            }
        },
    )
}

/// One solution for each outcome.
fn by_outcomes(
    kernel: &mut Kernel<Transcription<'_>>,
    directions: &[Direction],
    outcomes: &[Outcome],
    one_sided: Vec<String>,
) -> Result<Gradients, NoSensitivity> {
    let objective = kernel.objectives(directions)?;
    let mut list = Vec::new();
    for outcome in outcomes {
        let adjoint = kernel.adjoint(outcome)?;
        let by = |direction: &Direction| kernel.by(&adjoint, direction);
        list.push(directions.iter().map(by).collect());
    }
    Ok(Gradients {
        objective,
        solutions: 1 + list.len(),
        outcomes: list,
        one_sided,
    })
}

/// One solution for each number.
fn by_numbers(
    kernel: &mut Kernel<Transcription<'_>>,
    directions: &[Direction],
    outcomes: &[Outcome],
) -> Result<Gradients, NoSensitivity> {
    let mut out = Gradients {
        objective: Vec::new(),
        outcomes: vec![Vec::new(); outcomes.len()],
        solutions: directions.len(),
        one_sided: Vec::new(),
    };
    for direction in directions {
        let derivative = kernel.along(direction)?;
        out.objective.push(derivative.objective);
        for (outcome, list) in outcomes.iter().zip(&mut out.outcomes) {
            list.push(outcome.of(&derivative));
        }
        let new = derivative.weak.into_iter();
        let new: Vec<String> = new.filter(|one| !out.one_sided.contains(one)).collect();
        out.one_sided.extend(new);
    }
    Ok(out)
}

/// An outcome as factors of columns and rows.
fn outcome(
    of: &OutcomeOf,
    (opened, program, rows): (&Opened, &Transcription<'_>, &[usize]),
) -> Result<Outcome, NoSensitivity> {
    let model = &opened.model;
    let refused = |what: &str| Err(NoSensitivity::Refused(what.to_owned()));
    let (count, h) = (program.intervals(), opened.initial.h);
    let instant = |time: f64| ((time / h).round() as usize).min(count);
    let mut out = Outcome::default();
    let (k, coordinates) = match *of {
        OutcomeOf::Multiplier(row) => {
            let Some(&row) = rows.get(row) else {
                return refused("the program has no such equation or limit");
            };
            out.multipliers.push((row, program.row_scale(row)));
            return Ok(out);
        }
        OutcomeOf::Joint { joint, time } => {
            let reading = model.joint_readings.get(joint);
            let coordinate = reading.and_then(|one| one.coordinate);
            let is_one = model.coordinates == Coordinates::Reduced;
            match coordinate.filter(|_| is_one) {
                Some(c) => (instant(time), vec![(c, 1.0)]),
                None => return refused("a joint is an outcome in reduced coordinates alone"),
            }
        }
        OutcomeOf::Marker { marker, axis, time } => {
            if let Some(place) = opened.control.varied.iter().find(|one| is_place(one)) {
                let Varied { name, .. } = place;
                return refused(&format!("places of markers depend on {name} by themselves"));
            }
            if marker >= model.markers.len() || axis > 2 {
                return refused("the system has no such marker");
            }
            let k = instant(time);
            let z = &opened.initial.discrete.z[k];
            let slopes = MarkerSlopes::new(model, z);
            (k, slopes.of(marker, axis).to_vec())
        }
        _ => (0, Vec::new()),
    };
    let parameters = model.variables.range(Role::Parameter);
    let columns = program.unknowns().columns.iter().enumerate();
    for (number, column) in columns {
        let factor = match (*column, of) {
            (Column::Horizon, OutcomeOf::Duration) => program.intervals() as f64,
            (Column::Parameter { s }, OutcomeOf::Parameter(place)) => {
                f64::from(u8::from(parameters.start + place == s))
            }
            (Column::Interval { k, s }, OutcomeOf::Input { source, time }) => {
                let own = model.variables.of(Time::Interval)[s].source;
                let interval = ((time / h + SNAP) as usize).min(count - 1);
                f64::from(u8::from(k == interval && own == Some(*source)))
            }
            (Column::Instant { k: at, i }, _) if at == k => {
                let own = coordinates.iter().find(|(c, _)| *c == i);
                own.map_or(0.0, |(_, factor)| *factor)
            }
            _ => 0.0,
        };
        if factor != 0.0 {
            let scale = program.column_scale(number);
            out.variables.push((number, factor * scale));
        }
    }
    Ok(out)
}
