//! `study.json`: every point with its input, its seconds and its errors, and the references of these; SI units.

use crate::app::ProgressDisplay;
use crate::files::lay_out;
use crate::ipopt;
use crate::report::atomic::WriteError;
use crate::report::origin::Origin;
use crate::report::{atomic, quoting};
use crate::study::compare::{Judged, common};
use crate::study::limit::{How, SequenceLimit};
use crate::study::measure::{StudyMeasure, StudyTask};
use crate::study::outcome::FINER;
use crate::study::read::{Method, Study, StudyPoint};
use crate::study::schedule::{Done, Results};
use crate::workflow::parallel_map::cores;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The file.
#[derive(Debug, Serialize)]
struct Record<'a> {
    command: &'a str,
    study: String,
    title: &'a str,
    asked: StudyTask,
    /// `complete` or `interrupted`.
    status: &'static str,
    /// Conclusion, in words.
    conclusion: &'a str,
    /// Timed runs that were asked for.
    runs: usize,
    markers: &'a [String],
    /// Instants that all points have, as parts of the duration.
    instants: Vec<f64>,
    /// Refinement factor of the grid of a re-simulation.
    resimulated_finer: usize,
    measures: Vec<MeasureRecord>,
    methods: Vec<MethodRecord<'a>>,
    /// Points that were run for the reference alone.
    reference_points: Vec<PointRecord<'a>>,
    machine: Machine,
    versions: Versions,
}

/// Measure with its references.
#[derive(Debug, Serialize)]
struct MeasureRecord {
    measure: StudyMeasure,
    unit: &'static str,
    /// Size to which an error is relative.
    scale: f64,
    /// Limits; empty for what is an error by itself.
    references: Vec<LimitRecord>,
}

/// A limit.
#[derive(Debug, Serialize)]
struct LimitRecord {
    /// The method whose limit it is.
    method: String,
    how: &'static str,
    is_extrapolated: bool,
    /// Observed in each three successive points; nothing where it is not sensible.
    orders: Vec<Option<f64>>,
    uncertainty: Option<f64>,
    value: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct MethodRecord<'a> {
    name: &'a str,
    refined: &'a str,
    /// Order that the errors of each measure show.
    orders: BTreeMap<StudyMeasure, f64>,
    points: Vec<PointRecord<'a>>,
}

#[derive(Debug, Serialize)]
struct PointRecord<'a> {
    value: &'a str,
    size: f64,
    problem: String,
    set: &'a [String],
    /// Command line that runs the point.
    command: String,
    status: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<Seconds<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    iterations: Option<usize>,
    /// Steps that had to be halved: the point is then none of its step, and enters neither limit nor order.
    #[serde(skip_serializing_if = "Option::is_none")]
    halved_steps: Option<usize>,
    values: BTreeMap<StudyMeasure, Vec<f64>>,
    errors: BTreeMap<StudyMeasure, f64>,
}

/// Wall time of a solution with its set-up, without reading the files and measuring.
#[derive(Debug, Serialize)]
struct Seconds<'a> {
    median: f64,
    lower_quartile: f64,
    upper_quartile: f64,
    /// All runs, ascending.
    runs: &'a [f64],
}

/// Machine of the runs.
#[derive(Debug, Serialize)]
pub(super) struct Machine {
    /// Name of the processor, where the system gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) processor: Option<String>,
    pub(super) cores: usize,
    pub(super) system: String,
}

#[derive(Debug, Serialize)]
struct Versions {
    proboscis: String,
    ipopt: &'static str,
}

/// Writes the file.
pub(super) fn write(
    path: &Path,
    request: &StudyRequest,
    results: &Results<'_>,
    judged: &[Judged],
    conclusion: &str,
) -> Result<(), WriteError> {
    let study = results.study;
    let record = Record {
        command: &request.command,
        study: request.input.display().to_string(),
        title: &study.title,
        asked: study.asked,
        status: match results.is_interrupted {
            true => "interrupted",
            false => "complete",
        },
        conclusion,
        runs: request.runs.unwrap_or(study.runs),
        markers: &study.markers,
        instants: common(results),
        resimulated_finer: FINER,
        measures: judged
            .iter()
            .map(|judged| of_measure(study, judged))
            .collect(),
        methods: (study.methods.iter().enumerate())
            .map(|(m, method)| of_method(study, m, method, &results.methods[m], judged))
            .collect(),
        reference_points: (results.reference.iter())
            .map(|done| of_point(study, done))
            .collect(),
        machine: machine(),
        versions: Versions {
            proboscis: Origin::program(),
            ipopt: ipopt::VERSION,
        },
    };
    let compact = serde_json::to_string(&record).expect("a record is JSON");
    atomic::write(path, lay_out(&compact).as_bytes())
}

fn of_measure(study: &Study, judged: &Judged) -> MeasureRecord {
    let measure = judged.measure;
    let limits = judged.limits.iter().enumerate();
    let of = |(index, limit): (usize, &Option<SequenceLimit>)| {
        let limit = limit.as_ref()?;
        let si = |value: f64| measure.unit().to_si(value);
        Some(LimitRecord {
            method: of_reference(study, judged, index).to_owned(),
            how: limit.how.words(),
            is_extrapolated: limit.how == How::Extrapolated,
            orders: limit.orders.clone(),
            uncertainty: limit.uncertainty.map(si),
            value: limit.value.iter().map(|&x| si(x)).collect(),
        })
    };
    MeasureRecord {
        measure,
        unit: match measure.unit().suffix() {
            "" => "1",
            _ => "m",
        },
        scale: measure.unit().to_si(judged.scale),
        references: limits.filter_map(of).collect(),
    }
}

/// Name of the method that limit `index` is of.
pub(super) fn of_reference<'s>(study: &'s Study, judged: &Judged, index: usize) -> &'s str {
    let method = match (&study.reference, judged.is_shared) {
        (crate::study::read::Reference::Of { method, .. }, true) => *method,
        _ => index,
    };
    &study.methods[method].name
}

fn of_method<'a>(
    study: &'a Study,
    m: usize,
    method: &'a Method,
    points: &'a [Done<'a>],
    judged: &[Judged],
) -> MethodRecord<'a> {
    let points = points.iter().enumerate().map(|(k, done)| {
        let each = || judged.iter();
        let si = |judged: &Judged, x: f64| judged.measure.unit().to_si(x);
        let errors = each().filter_map(|j| Some((j.measure, si(j, j.errors[m][k]?))));
        let values = each().filter_map(|j| {
            let value = j.values[m][k].as_ref()?;
            Some((j.measure, value.iter().map(|&x| si(j, x)).collect()))
        });
        PointRecord {
            errors: errors.collect(),
            values: values.collect(),
            ..of_point(study, done)
        }
    });
    let orders = judged.iter();
    MethodRecord {
        name: &method.name,
        refined: &method.refined,
        orders: orders
            .filter_map(|j| Some((j.measure, j.orders[m]?)))
            .collect(),
        points: points.collect(),
    }
}

/// A point without errors.
fn of_point<'a>(study: &Study, done: &'a Done<'a>) -> PointRecord<'a> {
    let seconds = |median| {
        Some(Seconds {
            median,
            lower_quartile: done.quantile(0.25)?,
            upper_quartile: done.quantile(0.75)?,
            runs: &done.seconds,
        })
    };
    PointRecord {
        value: &done.point.label,
        size: done.point.size,
        problem: done.point.problem.display().to_string(),
        set: &done.point.set,
        command: command(study.asked, done.point),
        status: done.first.status,
        message: done.first.message.as_deref(),
        seconds: done.median().and_then(seconds),
        iterations: done.seen.as_ref().map(|seen| seen.iterations),
        halved_steps: Some(done.halved()).filter(|&count| count > 0),
        values: BTreeMap::new(),
        errors: BTreeMap::new(),
    }
}

/// Returns the command line that runs a point alone.
pub(super) fn command(asked: StudyTask, point: &StudyPoint) -> String {
    let word = match asked {
        StudyTask::Control => "solve",
        StudyTask::Motion => "simulate",
        StudyTask::Rest => "equilibrium",
    };
    let problem = point.problem.display().to_string();
    let mut words = vec!["proboscis", word, &problem];
    for change in &point.set {
        words.extend(["--set", change]);
    }
    quoting::command(words)
}

/// The machine that this runs on.
pub(super) fn machine() -> Machine {
    let table = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = table
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    Machine {
        processor: name.map(|(_, name)| name.trim().to_owned()),
        cores: cores(),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
    }
}

/// A command on a study file.
#[derive(Clone, Debug)]
pub struct StudyRequest {
    /// The command as typed.
    pub command: String,
    /// The study file as typed.
    pub input: PathBuf,
    /// Folder for the results; `results/studies/<name of the study>` where not given.
    pub output: Option<PathBuf>,
    /// Timed runs of each point, in place of those of the file.
    pub runs: Option<usize>,
    /// Display of progress.
    pub progress: ProgressDisplay,
}

impl StudyRequest {
    /// Folder for the results.
    pub fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = self.input.file_stem().unwrap_or_default();
            PathBuf::from("results/studies").join(stem)
        })
    }
}
