//! The program of an optimum in which constants of the system, start and goal are columns too, held at their values.
//!
//! Refusals of numbers by which no optimum is differentiated, before one is looked for.

use crate::control::problem::{BoundaryState, Control, Duration, Rest, Varied, VariedOf};
use crate::control::{
    BoundaryConditions, BoundaryError, BoundedQuantity, Column, InitialGuess, Numbering, Outline,
    Rests, Row, Solution, Transcription, guess, rest_at,
};
use crate::dynamics::Equilibrium;
use crate::model::{Model, Parameter, Role, System};
use crate::nlp::{Multipliers, Nlp};
use crate::sensitivity::conditions::{Conditions, Held, NoSensitivity, Place, Places};
use crate::sensitivity::kernel::Kernel;

/// A state of rest with its voltages.
pub(super) struct AtRest {
    pub(super) state: Equilibrium,
    pub(super) voltages: Vec<f64>,
}

/// An optimum with all that its program with more columns is made of.
pub(super) struct Opened {
    /// The problem, with the constants as parameters and an open start.
    pub(super) control: Control,
    pub(super) model: Model,
    pub(super) boundary: BoundaryConditions,
    pub(super) initial: InitialGuess,
    /// Columns and rows of the program that was solved.
    pub(super) solved: Outline,
    /// That program, at its optimum.
    at: Approached,
    /// States of rest at the start and at the goal, with their voltages.
    pub(super) rests: [Option<AtRest>; 2],
    /// Number of parameters that are sought.
    pub(super) sought: usize,
}

/// The optimum of the program that was solved, to which Newton's method has moved.
struct Approached {
    /// Values of the columns, and multipliers of the rows.
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// Multipliers of the bounds of the columns, those of the solution.
    bounds: [Vec<f64>; 2],
    /// Places of both.
    places: [Vec<Place>; 2],
    /// Numbers of the columns that enter by their squares alone.
    squares: Vec<usize>,
}

/// Columns and rows of the program that was solved among those of the opened one.
pub(super) struct Mapped {
    /// True for each column that the solved program lacks.
    pub(super) is_new: Vec<bool>,
    /// Columns that enter by their squares alone.
    pub(super) squares: Vec<usize>,
    /// Row of each row of the solved program.
    pub(super) rows: Vec<usize>,
}

impl Opened {
    /// Opens the problem of an optimum.
    pub(super) fn new(
        system: &System,
        control: &Control,
        motion: &Solution,
    ) -> Result<Self, NoSensitivity> {
        let control = &Control {
            intervals: motion.intervals(),
            is_refined: false,
            parameters: found(&control.parameters, motion),
            ..control.clone()
        };
        let h0 = control.duration.first() / control.intervals as f64;
        let (model, boundary) =
            BoundaryConditions::resolve(system, control, h0).map_err(NoSensitivity::refused)?;
        if boundary.sought_rest != [false; 2] {
            let reason = "a state of rest depends on a free parameter, which is not offered";
            return Err(NoSensitivity::refused(reason));
        }
        let solved = Outline::new(&model, &boundary, control);
        let at = approached(&model, &boundary, control, motion)?;
        let counts = (model.coordinate_count(), model.action.map.unknowns());
        let mut control = eased(control, &boundary);
        let constants = control.varied.iter().filter_map(Varied::parameter).cloned();
        let sought = control.parameters.len();
        control.parameters.extend(constants.collect::<Vec<_>>());
        let resolved = BoundaryConditions::resolve_held(system, &control, h0);
        let (model, mut boundary) = resolved.map_err(NoSensitivity::refused)?;
        if counts != (model.coordinate_count(), model.action.map.unknowns()) {
            let reason = "with these constants as variables other parts of the system move";
            return Err(NoSensitivity::refused(reason));
        }
        let rests = rests(&model, &boundary, &control)?;
        let initial = guess(&model, &boundary, &control, h0, Some(motion));
        if control.goal != BoundaryState::Periodic {
            control.start = BoundaryState::Free;
            boundary.goal.coordinates.fill(None);
        }
        let mut varied = control.varied.iter();
        if varied.any(|one| one.of == VariedOf::Duration)
            && let Duration::Given(given) = control.duration
        {
            control.duration = Duration::Free {
                min: given,
                max: given,
                guess: given,
            };
        }
        Ok(Self {
            control,
            model,
            boundary,
            initial,
            solved,
            at,
            rests,
            sought,
        })
    }

    /// The program with all columns at its optimum, in which the solved one is found.
    pub(super) fn kernel(&self) -> Result<(Kernel<Transcription<'_>>, Mapped), NoSensitivity> {
        let (model, boundary) = (&self.model, &self.boundary);
        let mut program = Transcription::of_any(model, boundary, &self.control, &self.initial)
            .map_err(NoSensitivity::refused)?;
        if self.sought == 0 {
            program.hold_parameters();
        }
        let all = program.unknowns();
        let Numbering { columns, rows, .. } = &self.solved.unknowns;
        let Approached {
            columns: values,
            rows: of_rows,
            bounds: [lower, upper],
            places,
            squares,
        } = &self.at;
        let counts = [all.columns.len(), all.rows.len()];
        let mut of = Mapped {
            is_new: vec![true; counts[0]],
            squares: Vec::new(),
            rows: Vec::new(),
        };
        let mut x = program.encode(&self.initial.discrete, self.initial.h);
        let mut multipliers = Multipliers::default();
        multipliers.reset(counts[0], counts[1]);
        let mut found = counts.map(|count| vec![Place::Held; count]);
        for (number, column) in columns.iter().enumerate() {
            let column = match *column {
                Column::Interval { k, s } => {
                    let s = self.shifted(s);
                    Column::Interval { k, s }
                }
                other => other,
            };
            let place = all.number(column).ok_or_else(missing)?;
            let scale = program.column_scale(place);
            x[place] = values[number] / scale;
            of.is_new[place] = false;
            found[0][place] = places[0][number];
            if squares.contains(&number) {
                of.squares.push(place);
            }
            multipliers.lower[place] = lower[number] * scale;
            multipliers.upper[place] = upper[number] * scale;
        }
        let mut all_rows = all.rows.iter().enumerate();
        for (number, row) in rows.iter().enumerate() {
            let is_row = |one: &Row| self.is_same_row(row, one, &program);
            let place = all_rows.find(|(_, one)| is_row(one));
            let (place, _) = place.ok_or_else(|| self.unknown_row(row))?;
            found[1][place] = places[1][number];
            multipliers.constraints[place] = of_rows[number] / program.row_scale(place);
            of.rows.push(place);
        }
        let (squares, places) = (Some(&of.squares[..]), Places::Known(found));
        let conditions = Conditions::new(program, &x, &multipliers, squares, places);
        Ok((Kernel::of(conditions)?, of))
    }

    /// The number here of a scalar of the solved program: parameters stand before potentials.
    fn shifted(&self, s: usize) -> usize {
        let parameters = self.model.variables.range(Role::Parameter);
        let first = parameters.start + self.sought;
        if s >= first {
            s + parameters.end - first
        } else {
            s
        }
    }

    fn is_same_row(&self, solved: &Row, opened: &Row, program: &Transcription<'_>) -> bool {
        match (*solved, *opened) {
            (Row::Interval { k, s }, Row::Interval { .. }) => {
                let s = self.shifted(s);
                *opened == Row::Interval { k, s }
            }
            (Row::Limit { limit, k }, Row::Limit { limit: own, k: at }) => {
                let known: &BoundedQuantity = &self.solved.limits[limit];
                k == at && known == program.limit(own)
            }
            (solved, opened) => solved == opened,
        }
    }

    fn unknown_row(&self, row: &Row) -> NoSensitivity {
        let of = match *row {
            Row::Limit { limit, .. } => format!("{:?}", self.solved.limits[limit].name),
            _ => "an equation".to_owned(),
        };
        NoSensitivity::refused(format!(
            "{of} reads one of the constants, which is not offered"
        ))
    }
}

fn missing() -> NoSensitivity {
    NoSensitivity::refused("the optimum has no multipliers of this problem")
}

/// The optimum of the solved program: where its conditions hold with the bounds that the solution has reached.
fn approached(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    motion: &Solution,
) -> Result<Approached, NoSensitivity> {
    let h0 = control.duration.first() / control.intervals as f64;
    let initial = guess(model, boundary, control, h0, Some(motion));
    let program = Transcription::of_any(model, boundary, control, &initial)
        .map_err(NoSensitivity::refused)?;
    let costates = motion.costates.as_ref().ok_or_else(missing)?;
    let (columns, rows) = (program.variables().count(), program.constraints().count());
    let counts = [&costates.rows, &costates.lower, &costates.upper].map(Vec::len);
    if counts != [rows, columns, columns] {
        return Err(missing());
    }
    let of_columns = |list: &[f64]| -> Vec<f64> {
        let scaled = list.iter().enumerate();
        scaled.map(|(i, v)| v * program.column_scale(i)).collect()
    };
    let of_rows = costates.rows.iter().enumerate();
    let multipliers = Multipliers {
        constraints: of_rows.map(|(r, v)| v / program.row_scale(r)).collect(),
        lower: of_columns(&costates.lower),
        upper: of_columns(&costates.upper),
    };
    let mut squares = program.squares();
    if control.objective.rate != 0.0 || !control.objective.energies.is_empty() {
        squares.clear();
    }
    let held = Held {
        variables: vec![false; columns],
        constraints: vec![false; rows],
        squares: Some(squares.clone()),
    };
    let x = program.encode(&initial.discrete, initial.h);
    let kernel = Kernel::new(program, &x, &multipliers, &held)?;
    let (program, point) = (kernel.program(), kernel.point());
    let multipliers = kernel.multipliers().into_iter().enumerate();
    Ok(Approached {
        rows: multipliers.map(|(r, v)| v * program.row_scale(r)).collect(),
        columns: point
            .iter()
            .enumerate()
            .map(|(i, v)| v * program.column_scale(i))
            .collect(),
        bounds: [costates.lower.clone(), costates.upper.clone()],
        places: [&kernel.conditions.columns, &kernel.conditions.rows].map(Vec::clone),
        squares,
    })
}

/// Free parameters at the values that were found.
fn found(parameters: &[Parameter], motion: &Solution) -> Vec<Parameter> {
    let at = |parameter: &Parameter| {
        let mut found = motion.parameters.iter();
        let value = found.find(|one| one.name == parameter.name);
        Parameter {
            guess: value.map_or(parameter.guess, |one| {
                one.value.clamp(parameter.lower, parameter.upper)
            }),
            ..parameter.clone()
        }
    };
    parameters.iter().map(at).collect()
}

/// The problem with a goal at which rests what rests at that of the boundary.
fn eased(control: &Control, boundary: &BoundaryConditions) -> Control {
    let goal = match boundary.goal.rests {
        Rests::Bodies => control.goal.resting(Rest::Bodies),
        _ => None,
    };
    Control {
        goal: goal.unwrap_or_else(|| control.goal.clone()),
        ..control.clone()
    }
}

/// States of rest at start and goal.
fn rests(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
) -> Result<[Option<AtRest>; 2], NoSensitivity> {
    let at_rest = |state: Equilibrium, voltages: &[f64]| AtRest {
        state,
        voltages: voltages.to_vec(),
    };
    let start = match &control.start {
        BoundaryState::RestAtVoltages(voltages, _) if control.goal != BoundaryState::Periodic => {
            let state = rest_at(model, voltages, "start", 0.0).map_err(NoSensitivity::refused)?;
            Some(at_rest(state, voltages))
        }
        _ => None,
    };
    let goal = match (&control.goal, &boundary.goal.rest) {
        (BoundaryState::RestAtVoltages(voltages, _), Some(state)) => {
            Some(at_rest(state.clone(), voltages))
        }
        _ => None,
    };
    Ok([start, goal])
}

/// Checks that the optimum of a problem may be differentiated by the numbers that it names.
///
/// # Errors
/// Name of the number and the reason why not.
pub fn check(system: &System, control: &Control) -> Result<(), (String, String)> {
    if control.varied.is_empty() {
        return Ok(());
    }
    if control.goal.has_rates() {
        let name = control.varied[0].name.clone();
        let reason = "the motion ends with given rates, for which derivatives are not offered";
        return Err((name, reason.to_owned()));
    }
    let constants = control.varied.iter().filter_map(Varied::parameter);
    let mut held = control.clone();
    held.parameters.extend(constants.cloned());
    let h0 = control.duration.first() / control.intervals as f64;
    let (model, boundary) = match BoundaryConditions::resolve_held(system, &held, h0) {
        Ok(found) => found,
        Err(BoundaryError::Parameter { name, reason }) => return Err((name, reason)),
        // The solve itself tells of other mistakes.
        Err(_) => return Ok(()),
    };
    for varied in &control.varied {
        let reason = match &varied.of {
            VariedOf::Duration => of_duration(system, control, &boundary).map(str::to_owned),
            VariedOf::StartJoint(_) if remembers(system) => Some(
                "the memory of Maxwell branches at the start follows it, which is not offered"
                    .to_owned(),
            ),
            VariedOf::StartJoint(_) if !model.has_independent_joints() => {
                Some("it is offered in joint coordinates, without constraints, alone".to_owned())
            }
            _ => None,
        };
        if let Some(reason) = reason {
            return Err((varied.name.clone(), reason));
        }
    }
    Ok(())
}

/// The reason why the derivative by a given duration is not known, if there is one.
fn of_duration(
    system: &System,
    control: &Control,
    boundary: &BoundaryConditions,
) -> Option<&'static str> {
    let given = control.given.values().all(|signal| signal.is_constant());
    let moves = system.joints.iter().any(|joint| joint.motion.is_some());
    let is_function = control.course.is_some() || !given || moves;
    let mut limits = boundary.limits.list.iter();
    let is_rate = limits.any(|one| {
        let quantity = &one.quantity;
        one.rate.is_some() || quantity.is_step() || quantity.before().is_some()
    });
    match (is_function, is_rate) {
        (true, _) => Some("given functions of time do not stretch with it, which is not offered"),
        (_, true) => {
            Some("limits of rates, currents or reactions count time by it, which is not offered")
        }
        _ => None,
    }
}

/// Returns true if a material has Maxwell branches.
fn remembers(system: &System) -> bool {
    let of_muscles = system.muscles.iter().map(|muscle| &muscle.material);
    let of_blocks = system.solids.iter().flat_map(|solid| &solid.materials);
    let mut all = of_muscles.chain(of_blocks);
    all.any(|material| !material.maxwell.list().is_empty())
}
