//! Errors of all points: values against the limit of a reference, and measures that are errors by themselves.

use crate::study::limit::{SequenceLimit, distance, limit, observed_order};
use crate::study::measure::StudyMeasure;
use crate::study::outcome::Observed;
use crate::study::read::Reference;
use crate::study::schedule::{Done, Results};

/// Two instants are the same where they differ by less, as parts of the duration.
const SAME: f64 = 1e-9;

/// One measure of all points.
#[derive(Debug)]
pub struct Judged {
    /// Quantity that is measured.
    pub measure: StudyMeasure,
    /// The limits of the methods, or that of the reference alone; none where nothing was solved, or nothing is compared.
    pub limits: Vec<Option<SequenceLimit>>,
    /// True if all methods have the one limit.
    pub is_shared: bool,
    /// Size to which an error is relative: the path length of the markers in mm, the size of the objective; 1 where errors are relative.
    pub scale: f64,
    /// Errors by method and point, in mm or relative; none of a point without an answer.
    pub errors: Vec<Vec<Option<f64>>>,
    /// Errors of each method that are no larger are not known, as its limit is no better known.
    pub floors: Vec<f64>,
    /// Values by method and point, where there is something to compare.
    pub values: Vec<Vec<Option<Vec<f64>>>>,
    /// Order that the errors of each method show.
    pub orders: Vec<Option<f64>>,
}

impl Judged {
    /// The error of a point, where it is known.
    pub fn known(&self, method: usize, point: usize) -> Option<f64> {
        self.errors[method][point].filter(|error| *error > self.floors[method])
    }

    /// The limit that the points of a method are compared with.
    pub fn limit_of(&self, method: usize) -> Option<&SequenceLimit> {
        let index = if self.is_shared { 0 } else { method };
        self.limits.get(index)?.as_ref()
    }
}

/// Judges all points of a study by all its measures.
pub fn judge(results: &Results<'_>) -> Vec<Judged> {
    let instants = common(results);
    let measures = results.study.measures.iter();
    measures
        .map(|&measure| match measure.has_reference() {
            true => against(results, measure, &instants),
            false => alone(results, measure),
        })
        .collect()
}

/// The instants that all points have, as parts of the duration.
pub fn common(results: &Results<'_>) -> Vec<f64> {
    let points = results.methods.iter().flatten().chain(&results.reference);
    let seen: Vec<&Observed> = points.filter_map(|done| done.seen.as_ref()).collect();
    let Some(fewest) = seen.iter().min_by_key(|seen| seen.instants.len()) else {
        return Vec::new();
    };
    let everywhere = |t: &&f64| seen.iter().all(|seen| index(&seen.instants, **t).is_some());
    fewest.instants.iter().filter(everywhere).copied().collect()
}

/// Index of an instant in an ascending list.
fn index(instants: &[f64], wanted: f64) -> Option<usize> {
    let after = instants.partition_point(|&t| t < wanted - SAME);
    (*instants.get(after)? <= wanted + SAME).then_some(after)
}

/// The value of a measure that is compared.
fn value(seen: &Observed, measure: StudyMeasure, instants: &[f64]) -> Option<Vec<f64>> {
    let flat = |row: &Vec<nalgebra::Vector3<f64>>| -> Vec<f64> {
        row.iter()
            .flat_map(|place| [place.x, place.y, place.z])
            .collect()
    };
    match measure {
        StudyMeasure::End | StudyMeasure::Place => seen.places.last().map(flat),
        StudyMeasure::Path => {
            let row = |&t: &f64| index(&seen.instants, t).map(|k| flat(&seen.places[k]));
            let rows: Option<Vec<_>> = instants.iter().map(row).collect();
            rows.map(|rows| rows.concat())
        }
        measure => seen.numbers.get(&measure).map(|&number| vec![number]),
    }
}

fn against(results: &Results<'_>, measure: StudyMeasure, instants: &[f64]) -> Judged {
    let width = measure.width();
    let of = |done: &Done<'_>| value(done.seen.as_ref()?, measure, instants);
    let values: Vec<Vec<_>> = (results.methods.iter())
        .map(|points| points.iter().map(of).collect())
        .collect();
    let limit_of = |points: &[Done<'_>]| {
        let there = points
            .iter()
            .filter(|done| done.halved() == 0)
            .filter_map(|done| Some((done.point.size, of(done)?)));
        let (sizes, values): (Vec<_>, Vec<_>) = there.unzip();
        limit(&sizes, &values, width)
    };
    let (limits, is_shared) = match &results.study.reference {
        Reference::Own => (
            results
                .methods
                .iter()
                .map(|points| limit_of(points))
                .collect(),
            false,
        ),
        Reference::Of { method, points } => {
            let from = match points.is_empty() {
                true => &results.methods[*method],
                false => &results.reference,
            };
            (vec![limit_of(from)], true)
        }
    };
    let mut judged = Judged {
        measure,
        limits,
        is_shared,
        scale: scale(results, measure),
        errors: Vec::new(),
        floors: Vec::new(),
        values,
        orders: Vec::new(),
    };
    for (index, points) in results.methods.iter().enumerate() {
        let limit = judged.limit_of(index);
        let relative = match (measure, limit) {
            (StudyMeasure::Objective, Some(limit)) => limit.value[0].abs(),
            _ => 1.0,
        };
        // A single value tells nothing of its own error.
        let known = limit.filter(|limit| limit.floor().is_finite());
        let error = |value: &Option<Vec<f64>>| {
            Some(distance(value.as_ref()?, &known?.value, width) / relative)
        };
        let errors: Vec<_> = judged.values[index].iter().map(error).collect();
        let floor = known.map_or(0.0, |limit| limit.floor() / relative);
        let order = order(points, &errors, floor);
        judged.orders.push(order);
        judged.floors.push(floor);
        judged.errors.push(errors);
    }
    judged
}

/// A measure that is an error by itself.
fn alone(results: &Results<'_>, measure: StudyMeasure) -> Judged {
    let error = |done: &Done<'_>| done.seen.as_ref()?.numbers.get(&measure).copied();
    let errors: Vec<Vec<_>> = (results.methods.iter())
        .map(|points| points.iter().map(error).collect())
        .collect();
    let orders = (results.methods.iter().zip(&errors))
        .map(|(points, errors)| order(points, errors, 0.0).filter(|_| measure.has_order()))
        .collect();
    let none = |errors: &Vec<Option<f64>>| vec![None; errors.len()];
    Judged {
        measure,
        limits: Vec::new(),
        is_shared: false,
        scale: scale(results, measure),
        values: errors.iter().map(none).collect(),
        floors: vec![0.0; errors.len()],
        errors,
        orders,
    }
}

/// The order that points show which are of their size: steps that were halved are not.
fn order(points: &[Done<'_>], errors: &[Option<f64>], floor: f64) -> Option<f64> {
    let pairs = points.iter().zip(errors);
    let shown: Vec<_> = pairs
        .filter(|(done, _)| done.halved() == 0)
        .filter_map(|(done, error)| Some([done.point.size, (*error)?]))
        .collect();
    observed_order(&shown, floor)
}

/// The path length of the markers, as far as any of them gets from its start, or at rest from the reference configuration, in mm; 1
/// for relative measures.
fn scale(results: &Results<'_>, measure: StudyMeasure) -> f64 {
    let seen = || {
        results
            .methods
            .iter()
            .flatten()
            .filter_map(|done| done.seen.as_ref())
    };
    let path_length = |seen: &Observed| {
        let from = match measure {
            StudyMeasure::Place => &seen.reference,
            _ => &seen.places[0],
        };
        let apart = |row: &Vec<nalgebra::Vector3<f64>>| {
            let pairs = row.iter().zip(from);
            pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
        };
        seen.places.iter().map(apart).fold(0.0, f64::max)
    };
    match measure {
        StudyMeasure::End
        | StudyMeasure::Path
        | StudyMeasure::Place
        | StudyMeasure::ResimulatedEnd
        | StudyMeasure::ResimulatedPath => match seen().map(path_length).fold(0.0, f64::max) {
            length if length > 0.0 => length,
            _ => 1.0,
        },
        _ => 1.0,
    }
}

/// A marker that is elsewhere in one of the scenes, as the nearest node of a mesh is: its name and the distance in mm.
pub fn moved_marker(results: &Results<'_>) -> Option<(String, f64)> {
    let mut seen = (results.methods.iter().flatten().chain(&results.reference))
        .filter_map(|done| done.seen.as_ref());
    let first = seen.next()?;
    let size = first
        .reference
        .iter()
        .map(|place| place.norm())
        .fold(1.0, f64::max);
    seen.find_map(|seen| {
        let pairs = seen
            .reference
            .iter()
            .zip(&first.reference)
            .zip(&results.study.markers);
        pairs
            .map(|((a, b), name)| (name.clone(), (a - b).norm()))
            .find(|(_, apart)| *apart > 1e-6 * size)
    })
}
