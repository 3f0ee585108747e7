//! Sensitivities of the optimum of a control problem.

use crate::control::problem::{Control, Varied, VariedOf};
use crate::control::{Column, Solution, Transcription};
use crate::model::{Coordinates, Model, Role, System, Time};
use crate::sensitivity::active_set::Direction;
use crate::sensitivity::check::NoSensitivity;
use crate::sensitivity::directions::Directions;
use crate::sensitivity::kernel::{Derivative, Kernel};
use crate::sensitivity::margins::MarkerSlopes;
use crate::sensitivity::range::Range;
use crate::sensitivity::with_parameters::Opened;
use nalgebra::Vector3;

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
    with_kernel(
        system,
        control,
        motion,
        |opened, kernel, directions, rows| {
            let instants = opened.initial.discrete.z.iter();
            let markers = instants.map(|z| MarkerSlopes::new(&opened.model, z));
            let markers: Vec<MarkerSlopes> = markers.collect();
            let (mut list, mut refused) = (Vec::new(), Vec::new());
            for (varied, direction) in opened.control.varied.iter().zip(directions) {
                let found = direction.as_ref().map_err(NoSensitivity::clone);
                match found.and_then(|direction| kernel.along(direction)) {
                    Ok(derivative) => {
                        let at = (opened, kernel.program(), rows);
                        list.push(sensitivity(varied, (&derivative, &markers), at));
                    }
                    Err(reason) => refused.push((varied.name.clone(), reason)),
                }
            }
            Ok((list, refused))
        },
    )
}

/// Hands on the opened problem of an optimum, its kernel, the directions of the numbers that it names, and the rows of the solved program.
pub(super) fn with_kernel<T>(
    system: &System,
    control: &Control,
    motion: &Solution,
    go_on: impl FnOnce(
        &Opened,
        &mut Kernel<Transcription<'_>>,
        &[Result<Direction, NoSensitivity>],
        &[usize],
    ) -> Result<T, NoSensitivity>,
) -> Result<T, NoSensitivity> {
    let opened = Opened::new(system, control, motion)?;
    let program = opened.program()?;
    let mapped = opened.map(&program)?;
    let point = (&*mapped.x, &mapped.multipliers);
    let places = Some(mapped.places);
    let mut kernel = Kernel::with_places(program, point, &mapped.held, places)?;
    let directions = {
        let point = kernel.point();
        let at = (kernel.program(), &mapped.held, &point[..]);
        let directions = Directions::new(&opened, at, &control.start)?;
        let all = opened.control.varied.iter();
        all.map(|varied| directions.of(varied)).collect::<Vec<_>>()
    };
    go_on(&opened, &mut kernel, &directions, &mapped.rows)
}

fn sensitivity(
    varied: &Varied,
    (derivative, markers): (&Derivative, &[MarkerSlopes]),
    (opened, program, rows): (&Opened, &Transcription<'_>, &[usize]),
) -> Sensitivity {
    let model = &opened.model;
    let intervals = program.intervals();
    let mut coordinates = vec![vec![0.0; model.coordinate_count()]; intervals + 1];
    let mut voltages = vec![vec![0.0; model.sources.len()]; intervals];
    let (mut parameters, mut duration) = (vec![0.0; opened.sought], 0.0);
    let sought = model.variables.range(Role::Parameter).take(opened.sought);
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
                let place = sought.clone().position(|one| one == s);
                place
                    .into_iter()
                    .for_each(|place| parameters[place] = value);
            }
            Column::Horizon => duration = value * intervals as f64,
            _ => {}
        }
    }
    Sensitivity {
        objective: derivative.objective,
        joints: joints(model, &coordinates),
        markers: match is_place(varied) {
            true => Vec::new(),
            false => {
                let instants = markers.iter().zip(&coordinates);
                instants.map(|(slopes, row)| slopes.along(row)).collect()
            }
        },
        multipliers: rows
            .iter()
            .map(|&row| derivative.multipliers[row] * program.row_scale(row))
            .collect(),
        varied: varied.clone(),
        range: derivative
            .range
            .clone()
            .while_true(varied.value, |value| has_meaning(varied, value)),
        weak: derivative.weak.clone(),
        duration,
        parameters,
        voltages,
        coordinates,
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

/// Derivatives of the joint coordinates.
fn joints(model: &Model, coordinates: &[Vec<f64>]) -> Vec<Vec<f64>> {
    if model.coordinates != Coordinates::Reduced {
        return Vec::new();
    }
    let of = |row: &Vec<f64>| {
        let joints = model.joint_readings.iter().zip(&model.system.joints);
        let joints = joints.filter(|(_, joint)| joint.has_coordinate());
        joints
            .map(|(reading, _)| reading.coordinate.map_or(0.0, |c| row[c]))
            .collect()
    };
    coordinates.iter().map(of).collect()
}
