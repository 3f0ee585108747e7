//! The program of one motion or several, its point and the kind of start of its solver, from models and boundaries.

use crate::control::problem::{Combined, Control, ControlTask, Guess, MotionTask, QuantityCost};
use crate::control::{
    BoundaryConditions, Carried, PEAK_VOLTAGE, RestProgram, Solution, Transcription, guess,
    rest_programs,
};
use crate::ipopt::{Start, StartingPoint};
use crate::model::{Model, Parameter, Role, System, What, with_parameters};
use crate::nlp::joined::{Joined, Places, SharedVariable};
use crate::nlp::{Multipliers, Nlp};
use crate::workflow::error::WorkflowError;
use crate::workflow::{hold_check, junction, memory};
use std::sync::Arc;

/// The program of a motion, or of several, with the point to start from and what that point is worth.
pub(crate) struct Prepared<P, C> {
    pub(crate) program: P,
    pub(crate) point: StartingPoint,
    pub(crate) start: Start,
    /// Changes of the earlier solution, or of that of each motion.
    pub(crate) carried: C,
}

/// Model and boundary of each motion.
///
/// # Errors
/// Start or goal of one of them is wrong.
pub(crate) fn resolve_each(
    task: &ControlTask<'_>,
) -> Result<Vec<(Arc<Model>, BoundaryConditions)>, WorkflowError> {
    let each = task.motions.iter().map(|one| {
        let resolved = resolve(one.system, one.control);
        let (model, boundary) =
            resolved.map_err(|error| error.of_motion(one.control.list(), one.name))?;
        Ok((Arc::new(model), boundary))
    });
    each.collect()
}

/// The motions with their models and boundaries.
pub(crate) fn program_motions<'m>(
    task: &ControlTask<'m>,
    resolved: &'m [(Arc<Model>, BoundaryConditions)],
) -> Vec<ProgramMotion<'m>> {
    let each = task.motions.iter().zip(resolved);
    let each = each.map(|(one, (model, boundary))| ProgramMotion {
        task: *one,
        model,
        boundary,
    });
    each.collect()
}

/// Guesses and programs of motions, joined.
///
/// # Errors
/// As of [`prepare`], or something cannot be shared.
pub(crate) fn prepare_together<'m>(
    motions: &[ProgramMotion<'m>],
    task: &ControlTask<'_>,
) -> Result<Prepared<Joined<Transcription<'m>>, Vec<Carried>>, WorkflowError> {
    let (mut parts, mut starts, mut carried) = (Vec::new(), Vec::new(), Vec::new());
    for motion in motions {
        let MotionTask {
            name,
            control,
            earlier,
            ..
        } = motion.task;
        let one = prepare(
            motion.model,
            motion.boundary,
            control,
            earlier,
            Counted::Yes,
        );
        let one = one.map_err(|error| error.of_motion(control.list(), name))?;
        parts.push((one.program, one.point));
        starts.push(one.start);
        carried.push(one.carried);
    }
    let (program, point) = joined(motions, parts, task)?;
    Ok(Prepared {
        program,
        point,
        start: common(&starts),
        carried,
    })
}

/// Hands the program of a task to `read`, with the point to start from.
///
/// # Errors
/// As of [`resolve_each`] and [`prepare_together`].
pub(crate) fn with_joined<R>(
    task: &ControlTask<'_>,
    read: impl FnOnce(&mut dyn Nlp, &[f64]) -> R,
) -> Result<R, WorkflowError> {
    let resolved = resolve_each(task)?;
    let motions = program_motions(task, &resolved);
    let mut prepared = prepare_together(&motions, task)?;
    Ok(read(&mut prepared.program, &prepared.point.x))
}

/// The start that suits all of these: where they differ, what is known of all of them counts.
fn common(starts: &[Start]) -> Start {
    let barrier = |start: &Start| match start {
        Start::Primal { mu_init } | Start::Resumed { mu_init } => Some(*mu_init),
        _ => None,
    };
    let largest = starts.iter().filter_map(barrier).fold(0.0, f64::max);
    let all = |is: fn(&Start) -> bool| starts.iter().all(is);
    let first = starts[0];
    if starts.iter().all(|start| *start == first) {
        return first;
    }
    let mu_init = largest;
    match first {
        _ if all(|start| matches!(start, Start::Resumed { .. })) => Start::Resumed { mu_init },
        _ if all(|start| matches!(start, Start::Primal { .. })) => Start::Primal { mu_init },
        _ if all(|start| matches!(start, Start::PrimalDual | Start::Centred)) => Start::Centred,
        _ if all(|start| !matches!(start, Start::Cold | Start::Simulated)) => RESAMPLED,
        _ => Start::Cold,
    }
}

/// Start from an earlier solution that was resampled and has no costates.
pub(super) const RESAMPLED: Start = Start::Primal { mu_init: 1e-2 };

/// An earlier solution that violates the equations of another grid or duration by less lies on the right bounds: smooth voltages
/// violate them by 1e-6 to 1e-4, those that jump at other instants by 4e-4 to 4e-2.
const FITS: f64 = 2e-4;

/// Treatment of a program with more equations than unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// It has no solution.
    Yes,
    /// Its derivatives exist all the same.
    No,
}

/// Guess and program; an `earlier` solution in memory comes before the guess of the problem.
pub(crate) fn prepare<'m>(
    model: &'m Model,
    boundary: &BoundaryConditions,
    control: &Control,
    earlier: Option<&Solution>,
    counted: Counted,
) -> Result<Prepared<Transcription<'m>, Carried>, WorkflowError> {
    memory::of_program(model, control.intervals)?;
    let named = match (&control.guess, earlier) {
        (Guess::Solution(earlier), None) => {
            Some(earlier.solution(model).map_err(WorkflowError::Earlier)?)
        }
        _ => None,
    };
    let earlier = earlier.or(named.as_deref());
    let initial = guess(model, boundary, control, interval(control), earlier);
    let program = match counted {
        Counted::Yes => Transcription::new(model, boundary, control, &initial),
        Counted::No => Transcription::of_any(model, boundary, control, &initial),
    };
    let mut program = program.map_err(|error| WorkflowError::boundary("control", &error))?;
    let point = program.start(&initial);
    let carried = initial.carried;
    let is_same_grid = |earlier: &Solution| {
        earlier.intervals() == control.intervals && carried.stretched.is_none()
    };
    let start = match (earlier, &point.costates) {
        (None, _) if matches!(control.guess, Guess::Simulate(_)) => Start::Simulated,
        (None, _) => Start::Cold,
        (
            Some(Solution {
                barrier: Some(mu), ..
            }),
            costates,
        ) if earlier.is_some_and(is_same_grid) => match costates {
            Some(_) => Start::Resumed { mu_init: *mu },
            None => Start::Primal { mu_init: *mu },
        },
        (Some(_), _) if carried.simulated => Start::Simulated,
        (Some(earlier), Some(_)) if is_same_grid(earlier) => Start::PrimalDual,
        (Some(_), Some(_)) if program.violation(&point.x) < FITS => Start::PrimalDual,
        (Some(_), Some(_)) => Start::Centred,
        (Some(earlier), None) if is_same_grid(earlier) => Start::PRIMAL,
        (Some(_), None) => RESAMPLED,
    };
    Ok(Prepared {
        program,
        point,
        start,
        carried,
    })
}

/// A motion of a program.
#[derive(Clone, Copy)]
pub(crate) struct ProgramMotion<'m> {
    pub(crate) task: MotionTask<'m>,
    pub(crate) model: &'m Model,
    pub(crate) boundary: &'m BoundaryConditions,
}

/// The multipliers of the program of a motion.
pub(super) fn multipliers_of(places: &Places, number: usize, whole: &Multipliers) -> Multipliers {
    Multipliers {
        constraints: places.row_multipliers_of(number, &whole.constraints),
        lower: places.multipliers_of(number, &whole.lower),
        upper: places.multipliers_of(number, &whole.upper),
    }
}

/// The programs of motions with their points, and of their states of rest, as one.
///
/// # Errors
/// It is time to stop, or something cannot be shared.
pub(super) fn joined<'m>(
    motions: &[ProgramMotion<'m>],
    parts: Vec<(Transcription<'m>, StartingPoint)>,
    task: &ControlTask<'_>,
) -> Result<(Joined<Transcription<'m>>, StartingPoint), WorkflowError> {
    let mut rest = Vec::new();
    for (number, (motion, (program, _))) in motions.iter().zip(&parts).enumerate() {
        let own = rest_programs(program, motion.model, motion.boundary, motion.task.control);
        let own = own.map_err(|error| WorkflowError::boundary("control", &error))?;
        rest.extend(own.into_iter().map(|one| (number, one)));
    }
    let mut shared = shared_variables(&parts, &rest, task.shared_inputs)?;
    let mut rows = Vec::new();
    if let Combined::InSequence(_) = task.combined {
        let phases: Vec<_> = parts.iter().map(|(program, _)| program).collect();
        let names: Vec<_> = motions.iter().map(|motion| motion.task.name).collect();
        let (variables, balances) = junction::shared(&names, &phases, parts.len() + rest.len())?;
        shared.extend(variables);
        rows = balances;
    }
    let (mut programs, mut points) = (Vec::new(), Vec::new());
    for (motion, (program, point)) in motions.iter().zip(parts) {
        programs.push((motion.task.name.to_owned(), program));
        points.push(point);
    }
    for (number, one) in rest {
        let name = motions[number].task.name;
        let of = if name.is_empty() { "" } else { ": " };
        let name = format!("{name}{of}state of rest at the {}", one.end);
        programs.push((name, one.program));
        points.push(one.point);
    }
    let program = Joined::with_rows(programs, &shared, &rows).with_objectives_of(motions.len());
    let mut program = match task.combined {
        Combined::Sum | Combined::InSequence(None) => program,
        Combined::Worst => program.with_worst(),
        Combined::InSequence(Some(whole)) => junction::lasting(program, task, whole),
    };
    let mut point = joined_point(program.places(), &points);
    let StartingPoint { x, costates } = &mut point;
    program.complete(x, costates.as_mut().map(|all| &mut all.constraints));
    Ok((program, point))
}

/// The point of several programs as one; with multipliers where all of them have some.
fn joined_point(places: &Places, points: &[StartingPoint]) -> StartingPoint {
    let x: Vec<&[f64]> = points.iter().map(|point| &*point.x).collect();
    let all = points.iter().map(|point| point.costates.as_ref());
    let all: Option<Vec<&Multipliers>> = all.collect();
    let of = |list: fn(&Multipliers) -> &Vec<f64>, all: &[&Multipliers]| {
        let lists: Vec<&[f64]> = all.iter().map(|one| &**list(one)).collect();
        places.multipliers(&lists)
    };
    StartingPoint {
        x: places.values(&x),
        costates: all.map(|all| Multipliers {
            constraints: {
                let lists: Vec<&[f64]> = all.iter().map(|one| &*one.constraints).collect();
                places.row_multipliers(&lists)
            },
            lower: of(|one| &one.lower, &all),
            upper: of(|one| &one.upper, &all),
        }),
    }
}

/// The shared variables of programs, none of a single one: intervals of the named inputs, then constants, then coordinates of states of
/// rest, whose programs come last.
///
/// # Errors
/// A constant is not sought alike in all motions, or an input not at the same instants.
fn shared_variables(
    parts: &[(Transcription<'_>, StartingPoint)],
    rest: &[(usize, RestProgram<'_>)],
    inputs: &[String],
) -> Result<Vec<SharedVariable>, WorkflowError> {
    let of_motions = parts.iter().map(|(program, _)| program);
    let of_rest = rest.iter().map(|(_, one)| &one.program);
    let programs: Vec<&Transcription<'_>> = of_motions.chain(of_rest).collect();
    let [first, _, ..] = programs[..] else {
        return Ok(Vec::new());
    };
    let motions = parts.len();
    let mut shared = Vec::new();
    for name in inputs {
        for k in 0..first.intervals() {
            let places = programs[..motions].iter();
            let places = places.map(|program| input(program, name, k));
            let places = places.collect::<Option<Vec<usize>>>();
            shared.push(places.ok_or_else(|| {
                let reason = format!(
                    "the input of \"{name}\" is not sought in all intervals of all motions"
                );
                WorkflowError::problem("control.shared_inputs", reason)
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
        shared.push(places.ok_or_else(|| {
            let reason = "is one constant of all motions, which cannot begin at another value or be absent in one of them";
            WorkflowError::problem("control.free", format!("\"{}\" {reason}", constant.name))
        })?);
    }
    let of_first = |places: &[usize]| first.column_scale(places[0]);
    let variable = |places: Vec<usize>| {
        let scale = of_first(&places);
        let each = places.iter().zip(&programs);
        let of = each.map(|(&place, of)| Some((place, scale / of.column_scale(place))));
        let mut all: Vec<_> = of.collect();
        all.resize(programs.len(), None);
        SharedVariable(all)
    };
    let mut all: Vec<SharedVariable> = shared.into_iter().map(variable).collect();
    for (number, (motion, one)) in (motions..).zip(rest) {
        let scale = |program: usize, place: usize| programs[program].column_scale(place);
        let coordinate = |&[of_motion, own]: &[usize; 2]| {
            let mut places = vec![None; programs.len()];
            let factor = scale(*motion, of_motion) / scale(number, own);
            places[*motion] = Some((of_motion, 1.0));
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
    let source = model.sources.iter().position(|it| it.name == name)?;
    let scalar = model.variables.input(source)?;
    (k < program.intervals()).then(|| program.unknowns().scalar(k, scalar))?
}

/// Free parameters of the scene with their columns.
fn constants<'p>(program: &'p Transcription<'_>) -> Vec<(&'p Parameter, usize)> {
    let model = program.model();
    let parameters = model.analysis.parameters.iter();
    let all = parameters.zip(model.variables.range(Role::Parameter));
    let all = all.filter(|(constant, _)| constant.name != PEAK_VOLTAGE);
    all.filter_map(|(constant, s)| Some((constant, program.unknowns().scalar(0, s)?)))
        .collect()
}

/// Model and boundary of a control problem.
pub(crate) fn resolve(
    system: &System,
    control: &Control,
) -> Result<(Model, BoundaryConditions), WorkflowError> {
    let (model, boundary) = BoundaryConditions::resolve(system, control, interval(control))
        .map_err(|error| WorkflowError::boundary("control", &error))?;
    hold_check::check(control, &model, &boundary)?;
    Ok((model, boundary))
}

/// Interval length in ms, or its guess.
pub(crate) fn interval(control: &Control) -> f64 {
    control.duration.first() / control.intervals as f64
}

/// Model and boundary of the system with the parameters put in that a motion was found with.
pub(crate) fn with_found(
    system: &System,
    control: &Control,
    sought: &Model,
    motion: &Solution,
) -> Result<(Model, BoundaryConditions), WorkflowError> {
    let values: Vec<f64> = motion.parameters.iter().map(|found| found.value).collect();
    let mut objective = control.objective.clone();
    // What nothing changes any more is no cost and no limit: a point that breaks one is an iterate, and the program says so.
    let amounts = |cost: &QuantityCost| matches!(cost.quantity.what, What::Amount { .. });
    objective.quantities.retain(|cost| !amounts(cost));
    let mut limits = control.limits.clone();
    limits.retain(|limit| !matches!(limit.what, What::Amount { .. }));
    let given = Control {
        parameters: Vec::new(),
        objective,
        limits,
        coordinates: Some(sought.coordinates),
        ..control.clone()
    };
    let system = with_parameters(system, &control.parameters, &values);
    let (model, boundary) = resolve(&system, &given)?;
    if model.action.map.unknowns() != sought.action.map.unknowns() {
        let reason = "the identified values change which bodies can move; start from other guesses";
        return Err(WorkflowError::problem("control.free", reason));
    }
    Ok((model, boundary))
}
