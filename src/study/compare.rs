//! Errors of all points: values against the limit of a reference, and measures that are errors by themselves.

use crate::study::limit::{SequenceLimit, distance, limit, observed_order};
use crate::study::measure::{StudyMeasure, Unit};
use crate::study::outcome::Observed;
use crate::study::read::Study;
use crate::study::schedule::{Done, Results};

/// Two instants are the same where they differ by less, as parts of the duration.
const SAME: f64 = 1e-9;

/// One measure of all points.
#[derive(Debug)]
pub struct Judged {
    /// Quantity that is measured.
    pub measure: StudyMeasure,
    /// Size to which an error is relative: the path length of the markers in mm, the size of the objective; 1 where errors are relative.
    pub scale: f64,
    /// The methods, in the order of the study.
    pub methods: Vec<MethodErrors>,
}

/// One measure of the points of a method.
#[derive(Debug)]
pub struct MethodErrors {
    /// The limit that the points are compared with; none where nothing was solved, or nothing is compared.
    pub limit: Option<SequenceLimit>,
    /// Errors in mm or relative; none of a point without an answer.
    pub errors: Vec<Option<f64>>,
    /// Errors that are no larger are not known, as the limit is no better known.
    pub floor: f64,
    /// Values; those of a measure that is an error by itself are its errors.
    pub values: Vec<Option<Vec<f64>>>,
    /// Order that the errors show.
    pub order: Option<f64>,
}

impl MethodErrors {
    /// The error of a point, where it is known.
    pub fn known(&self, point: usize) -> Option<f64> {
        self.errors[point].filter(|error| *error > self.floor)
    }

    /// The error that a point does not exceed: its distance from the reference, and the uncertainty of that.
    pub(super) fn surely(&self, point: usize) -> Option<f64> {
        Some(self.errors[point]? + self.floor)
    }
}

impl Judged {
    /// Limits that points are compared with, with the names of the methods that they are of.
    pub(super) fn limits<'s>(&'s self, study: &'s Study) -> Vec<(&'s str, &'s SequenceLimit)> {
        let of = |method: usize, errors: usize| {
            let limit = self.methods[errors].limit.as_ref()?;
            Some((study.methods[method].name.as_str(), limit))
        };
        match study.reference {
            None => (0..study.methods.len()).filter_map(|m| of(m, m)).collect(),
            Some(method) => of(method, 0).into_iter().collect(),
        }
    }
}

/// Judges all points of a study by all its measures.
pub fn judge(results: &Results<'_>) -> Vec<Judged> {
    let measures = results.study.measures.iter();
    let judged = measures.map(|&measure| Judged {
        measure,
        scale: scale(results, measure),
        methods: methods(results, measure),
    });
    judged.collect()
}

/// The instants that all points have, as parts of the duration.
pub fn common(results: &Results<'_>) -> Vec<f64> {
    let seen: Vec<&Observed> = results.seen().collect();
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

/// A measure of each method: values against their limit, or that of the reference; or errors by themselves.
fn methods(results: &Results<'_>, measure: StudyMeasure) -> Vec<MethodErrors> {
    let instants = common(results);
    let width = measure.width();
    let is_against = measure.has_reference();
    let of = |done: &Done<'_>| value(done.seen.as_ref()?, measure, &instants);
    let limit_of = |points: &[Done<'_>]| {
        let whole = points.iter().filter(|done| done.halved() == 0);
        let there = whole.filter_map(|done| Some((done.point.size, of(done)?)));
        let (sizes, values): (Vec<_>, Vec<_>) = there.unzip();
        limit(&sizes, &values, width).filter(|_| is_against)
    };
    let shared = results.study.reference.map(|method| {
        limit_of(match results.reference.is_empty() {
            true => &results.methods[method],
            false => &results.reference,
        })
    });
    let of_method = |points: &Vec<Done<'_>>| {
        let limit = shared.clone().unwrap_or_else(|| limit_of(points));
        let relative = match (measure, &limit) {
            (StudyMeasure::Objective, Some(limit)) => limit.value[0].abs(),
            _ => 1.0,
        };
        // A single value tells nothing of its own error.
        let known = limit.as_ref().filter(|limit| limit.floor().is_finite());
        let error = |value: &Option<Vec<f64>>| match is_against {
            true => Some(distance(value.as_ref()?, &known?.value, width) / relative),
            false => Some(value.as_ref()?[0]),
        };
        let values: Vec<_> = points.iter().map(of).collect();
        let errors: Vec<_> = values.iter().map(error).collect();
        let floor = known.map_or(0.0, |limit| limit.floor() / relative);
        MethodErrors {
            order: order(points, &errors, floor).filter(|_| measure.has_order()),
            errors,
            floor,
            values,
            limit,
        }
    };
    results.methods.iter().map(of_method).collect()
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
    let points = results.methods.iter().flatten();
    let seen = points.filter_map(|done| done.seen.as_ref());
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
    match (measure.unit(), seen.map(path_length).fold(0.0, f64::max)) {
        (Unit::Length, length) if length > 0.0 => length,
        _ => 1.0,
    }
}

/// A marker that is elsewhere in one of the scenes, as the nearest node of a mesh is: its name and the distance in mm.
pub fn moved_marker(results: &Results<'_>) -> Option<(String, f64)> {
    let mut seen = results.seen();
    let first = &seen.next()?.reference;
    let size = first.iter().map(|place| place.norm()).fold(1.0, f64::max);
    seen.find_map(|seen| {
        let pairs = seen.reference.iter().zip(first);
        pairs
            .zip(&results.study.markers)
            .map(|((a, b), name)| (name.clone(), (a - b).norm()))
            .find(|(_, apart)| *apart > 1e-6 * size)
    })
}
