//! Sensitivities of the optimum of a control problem.
//!
//! Derivatives of few outcomes of an optimum by many numbers of its problem.
//!
//! Each outcome takes one solution of the linear system (`Kernel::adjoint`) where there are fewer of them than numbers, and otherwise each number takes one. The
//! objective needs none; one for all numbers checks it, and counts as an outcome. Where a bound is reached without a multiplier, the change of the optimum
//! by each number tells whether its derivatives hold to one side alone: then each number takes one too.

use crate::control::problem::{BoundaryState, Control, OutcomeOf, Varied, VariedOf};
use crate::control::{Solution, Transcription};
use crate::model::{Role, System};
use crate::sensitivity::conditions::{Direction, NoSensitivity};
use crate::sensitivity::directions::Directions;
use crate::sensitivity::kernel::{Derivative, Kernel, Outcome};
use crate::sensitivity::margins::{PartSlopes, Range};
use crate::sensitivity::with_parameters::Opened;
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
        let (kernel, solved) = opened.kernel()?;
        let directions = Directions::new(opened, &kernel, &solved, start)?;
        let all = opened.control.varied.iter();
        Ok(Self {
            directions: all.map(|varied| directions.of(varied)).collect(),
            opened,
            kernel,
            rows: solved.rows,
        })
    }

    fn sensitivity(
        &self,
        varied: &Varied,
        derivative: Derivative,
        slopes: &[PartSlopes],
    ) -> Sensitivity {
        let (model, program) = (&self.opened.model, self.kernel.program());
        let (unknowns, intervals) = (program.unknowns(), program.intervals());
        let change = |column: Option<usize>| {
            let change = column.map(|at| derivative.variables[at] * program.column_scale(at));
            change.unwrap_or(0.0)
        };
        let of_instant = |k: usize| -> Vec<f64> {
            let all = 0..model.coordinate_count();
            all.map(|i| change(unknowns.unknown(k, i))).collect()
        };
        let coordinates: Vec<Vec<f64>> = (0..=intervals).map(of_instant).collect();
        let of_interval = |k: usize| -> Vec<f64> {
            let inputs = (0..model.sources.len()).map(|source| model.variables.input(source));
            let columns = inputs.map(|input| unknowns.scalar(k, input?));
            columns.map(change).collect()
        };
        let parameters = model.variables.range(Role::Parameter);
        let parameters = parameters.take(self.opened.sought);
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
            duration: change(unknowns.horizon()) * intervals as f64,
            parameters: parameters.map(|s| change(unknowns.scalar(0, s))).collect(),
            voltages: (0..intervals).map(of_interval).collect(),
            coordinates,
        }
    }

    /// An outcome as factors of columns and rows.
    fn outcome(&self, of: &OutcomeOf) -> Result<Outcome, NoSensitivity> {
        let (opened, program) = (self.opened, self.kernel.program());
        let model = &opened.model;
        let refused = |what: &str| Err(NoSensitivity::refused(what));
        let unknowns = program.unknowns();
        let (count, h) = (program.intervals(), opened.initial.h);
        let instant = |time: f64| ((time / h).round() as usize).min(count);
        let slopes = |time: f64| PartSlopes::new(model, &opened.initial.discrete.z[instant(time)]);
        let along = |time: f64, slopes: &[(usize, f64)]| -> Vec<_> {
            let slopes = slopes.iter();
            let of = slopes.map(|&(i, slope)| (unknowns.unknown(instant(time), i), slope));
            of.collect()
        };
        let factors = match *of {
            OutcomeOf::Multiplier(row) => {
                let Some(&row) = self.rows.get(row) else {
                    return refused("the program has no such equation or limit");
                };
                return Ok(Outcome {
                    multipliers: vec![(row, program.row_scale(row))],
                    ..Outcome::default()
                });
            }
            OutcomeOf::Joint { joint, time } => match slopes(time).joint(joint) {
                Some(slopes) => along(time, slopes),
                None => return refused("the system has no such joint of one coordinate"),
            },
            OutcomeOf::Marker { marker, axis, time } => {
                if let Some(place) = opened.control.varied.iter().find(|one| is_place(one)) {
                    let Varied { name, .. } = place;
                    return refused(&format!("places of markers depend on {name} by themselves"));
                }
                if marker >= model.markers.len() || axis > 2 {
                    return refused("the system has no such marker");
                }
                along(time, slopes(time).marker(marker, axis))
            }
            OutcomeOf::Duration => vec![(unknowns.horizon(), count as f64)],
            OutcomeOf::Parameter(place) => {
                let own = model.variables.range(Role::Parameter).nth(place);
                vec![(own.and_then(|s| unknowns.scalar(0, s)), 1.0)]
            }
            OutcomeOf::Input { source, time } => {
                let interval = ((time / h + SNAP) as usize).min(count - 1);
                let input = model.variables.input(source);
                vec![(input.and_then(|s| unknowns.scalar(interval, s)), 1.0)]
            }
        };
        let scaled = |(column, factor): (Option<usize>, f64)| {
            column.map(|column| (column, factor * program.column_scale(column)))
        };
        Ok(Outcome {
            variables: factors.into_iter().filter_map(scaled).collect(),
            ..Outcome::default()
        })
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
