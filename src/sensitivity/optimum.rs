//! Sensitivities of the optimum of a control problem.
//!
//! Derivatives of few outcomes of an optimum by many numbers of its problem.
//!
//! Each outcome takes one solution of the linear system (`Kernel::adjoint`) where there are fewer of them than numbers, and otherwise each number takes one. The
//! objective needs none; one for all numbers checks it, and counts as an outcome. Where a bound is reached without a multiplier, the change of the optimum
//! by each number tells whether its derivatives hold to one side alone: then each number takes one too.

use crate::control::problem::{BoundaryState, Control, OutcomeOf, Varied, VariedOf};
use crate::control::{Column, Solution, Transcription};
use crate::model::{Role, System, Time};
use crate::sensitivity::conditions::{Conditions, Direction, NoSensitivity, Places};
use crate::sensitivity::directions::Directions;
use crate::sensitivity::kernel::{Derivative, Kernel, Outcome};
use crate::sensitivity::margins::{PartSlopes, Range};
use crate::sensitivity::with_parameters::{Mapped, Opened};
use nalgebra::Vector3;
use std::mem;

/// Derivatives of an optimum by one number of its problem, by the unit inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The number.
    pub varied: Varied,
    /// Of the objective.
    pub objective: f64,
    /// Of the duration in ms.
    pub duration: f64,
    /// Of the constants that were sought, in the order of the problem.
    pub parameters: Vec<f64>,
    /// Of the voltages and loads, by interval and source.
    pub voltages: Vec<Vec<f64>>,
    /// Of the coordinates of the model, by instant.
    pub coordinates: Vec<Vec<f64>>,
    /// Of the joint coordinates, by instant and joint with a coordinate; none in redundant coordinates.
    pub joints: Vec<Vec<f64>>,
    /// Of the places of markers, by instant and marker; none where the number is a place on which they depend.
    pub markers: Vec<Vec<Vector3<f64>>>,
    /// Of the multipliers of equations and limits, in the order of the program.
    pub multipliers: Vec<f64>,
    /// Changes for which the same bounds are reached, to first order.
    pub range: Range,
    /// Bounds that are reached or left at once: the derivatives hold to one side alone.
    pub weak: Vec<String>,
}

/// A number by which the optimum has no derivative, and why.
pub type Refusal = (String, NoSensitivity);

/// Derivatives of the optimum of a problem by the numbers that it names, and those of them by which there is none.
///
/// # Errors
/// There are no derivatives at all.
pub fn sensitivities(
    system: &System,
    control: &Control,
    motion: &Solution,
) -> Result<(Vec<Sensitivity>, Vec<Refusal>), NoSensitivity> {
    let opened = Opened::new(system, control, motion)?;
    let mut of = Differentiated::new(&opened, &control.start)?;
    let instants = opened.initial.discrete.z.iter();
    let slopes = instants.map(|z| PartSlopes::new(&opened.model, z));
    let slopes: Vec<PartSlopes> = slopes.collect();
    let (mut list, mut refused) = (Vec::new(), Vec::new());
    let directions = mem::take(&mut of.directions);
    for (varied, direction) in opened.control.varied.iter().zip(directions) {
        match direction.and_then(|direction| of.kernel.along(&direction)) {
            Ok(derivative) => list.push(of.sensitivity(varied, derivative, &slopes)),
            Err(reason) => refused.push((varied.name.clone(), reason)),
        }
    }
    Ok((list, refused))
}

/// An optimum of an opened problem that is differentiated.
struct Differentiated<'a> {
    opened: &'a Opened,
    kernel: Kernel<Transcription<'a>>,
    /// Directions of the numbers that the problem names.
    directions: Vec<Result<Direction, NoSensitivity>>,
    /// Rows of the solved program.
    rows: Vec<usize>,
}

impl<'a> Differentiated<'a> {
    /// That of a problem with a start.
    fn new(opened: &'a Opened, start: &BoundaryState) -> Result<Self, NoSensitivity> {
        let program = opened.program()?;
        let Mapped {
            x,
            multipliers,
            places,
            is_new,
            squares,
            rows,
        } = opened.map(&program)?;
        let (of_squares, places) = (Some(&squares[..]), Places::Known(places));
        let conditions = Conditions::new(program, &x, &multipliers, of_squares, places);
        let kernel = Kernel::of(conditions)?;
        let directions = Directions::new(opened, &kernel, &is_new, &squares, start)?;
        let all = opened.control.varied.iter();
        Ok(Self {
            directions: all.map(|varied| directions.of(varied)).collect(),
            opened,
            kernel,
            rows,
        })
    }

    fn sensitivity(
        &self,
        varied: &Varied,
        derivative: Derivative,
        slopes: &[PartSlopes],
    ) -> Sensitivity {
        let (model, program) = (&self.opened.model, self.kernel.program());
        let intervals = program.intervals();
        let mut coordinates = vec![vec![0.0; model.coordinate_count()]; intervals + 1];
        let mut voltages = vec![vec![0.0; model.sources.len()]; intervals];
        let (mut parameters, mut duration) = (vec![0.0; self.opened.sought], 0.0);
        let first = model.variables.range(Role::Parameter).start;
        let columns = program.unknowns().columns.iter().zip(&derivative.variables);
        for (number, (column, change)) in columns.enumerate() {
            let value = change * program.column_scale(number);
            match *column {
                Column::Instant { k, i } if k <= intervals && i < model.coordinate_count() => {
                    coordinates[k][i] = value;
                }
                Column::Interval { k, s } if k < intervals => {
                    if let Some(source) = model.variables.of(Time::Interval)[s].source {
                        voltages[k][source] = value;
                    }
                }
                Column::Parameter { s } => {
                    let sought = parameters.get_mut(s - first);
                    sought.into_iter().for_each(|sought| *sought = value);
                }
                Column::Horizon => duration = value * intervals as f64,
                _ => {}
            }
        }
        let of_instants = || slopes.iter().zip(&coordinates);
        let of_joints = of_instants().map(|(slopes, row)| slopes.joints_along(row));
        let of_markers = of_instants().map(|(slopes, row)| slopes.markers_along(row));
        let multiplier = |&row: &usize| derivative.multipliers[row] * program.row_scale(row);
        let has_meaning = |value: f64| has_meaning(varied, value);
        Sensitivity {
            objective: derivative.objective,
            joints: of_joints.collect(),
            markers: of_markers.filter(|_| !is_place(varied)).collect(),
            multipliers: self.rows.iter().map(multiplier).collect(),
            varied: varied.clone(),
            range: derivative.range.while_true(varied.value, has_meaning),
            weak: derivative.weak,
            duration,
            parameters,
            voltages,
            coordinates,
        }
    }

    /// An outcome as factors of columns and rows.
    fn outcome(&self, of: &OutcomeOf) -> Result<Outcome, NoSensitivity> {
        let (opened, program) = (self.opened, self.kernel.program());
        let model = &opened.model;
        let refused = |what: &str| Err(NoSensitivity::refused(what));
        let (count, h) = (program.intervals(), opened.initial.h);
        let instant = |time: f64| ((time / h).round() as usize).min(count);
        let mut out = Outcome::default();
        let (k, coordinates) = match *of {
            OutcomeOf::Multiplier(row) => {
                let Some(&row) = self.rows.get(row) else {
                    return refused("the program has no such equation or limit");
                };
                out.multipliers.push((row, program.row_scale(row)));
                return Ok(out);
            }
            OutcomeOf::Joint { joint, time } => {
                let k = instant(time);
                let slopes = PartSlopes::new(model, &opened.initial.discrete.z[k]);
                match slopes.joint(joint) {
                    Some(slopes) => (k, slopes.to_vec()),
                    None => return refused("the system has no such joint of one coordinate"),
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
                let slopes = PartSlopes::new(model, z);
                (k, slopes.marker(marker, axis).to_vec())
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
}

/// Returns true if a number is a place on which places of markers depend by themselves.
pub(super) fn is_place(varied: &Varied) -> bool {
    varied.parameter().is_some_and(|parameter| {
        let mut constants = parameter.constants.iter();
        constants.any(|one| one.constant.is_place())
    })
}

/// Returns true if constants that have to be positive are so at a value of the number, and the duration is.
fn has_meaning(varied: &Varied, value: f64) -> bool {
    match varied.parameter() {
        Some(parameter) => {
            let mut constants = parameter.constants.iter();
            constants.all(|one| !one.constant.is_positive() || one.at(value) > 0.0)
        }
        None => varied.of != VariedOf::Duration || value > 0.0,
    }
}

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
    let opened = Opened::new(system, control, motion)?;
    let mut of = Differentiated::new(&opened, &control.start)?;
    let list = outcomes.iter().map(|one| of.outcome(one));
    let list = list.collect::<Result<Vec<_>, _>>()?;
    let directions = mem::take(&mut of.directions).into_iter();
    let directions = &directions.collect::<Result<Vec<_>, _>>()?[..];
    let kernel = &mut of.kernel;
    let is_backward = list.len() + 1 < directions.len();
    match is_backward.then(|| kernel.one_sided(directions)).flatten() {
        Some(one_sided) => by_outcomes(kernel, directions, &list, one_sided),
        None => by_numbers(kernel, directions, &list),
    }
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
