//! `study.json`: every point with its input, its seconds and its errors, and the references of these; SI units.

use crate::app::CommandInput;
use crate::files::Entries;
use crate::ipopt;
use crate::report::atomic::WriteError;
use crate::report::origin::Origin;
use crate::report::{atomic, quoting};
use crate::study::compare::{Judged, common};
use crate::study::limit::How;
use crate::study::measure::StudyTask;
use crate::study::outcome::FINER;
use crate::study::read::{Study, StudyPoint};
use crate::study::schedule::{Done, Results};
use crate::workflow::parallel_map::cores;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Machine of the runs.
#[derive(Debug, Serialize)]
pub(super) struct Machine {
    /// Name of the processor, where the system gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) processor: Option<String>,
    pub(super) cores: usize,
    pub(super) system: String,
}

/// Writes the file.
pub(super) fn write(
    path: &Path,
    request: &CommandInput,
    runs: usize,
    results: &Results<'_>,
    judged: &[Judged],
    conclusion: &str,
) -> Result<(), WriteError> {
    let study = results.study;
    let status = match results.is_interrupted {
        true => "interrupted",
        false => "complete",
    };
    let measures = judged.iter().map(|judged| of_measure(study, judged));
    let methods = 0..study.methods.len();
    let reference = results
        .reference
        .iter()
        .map(|done| of_point(study, done, &[], [0; 2]));
    let versions = Entries::default()
        .with("proboscis", Origin::program())
        .with("ipopt", ipopt::VERSION);
    let record = Entries::default()
        .with("command", &request.command)
        .with("study", request.input.display().to_string())
        .with("title", &study.title)
        .with("asked", study.asked)
        .with("status", status)
        .with("conclusion", conclusion)
        // Timed runs that were asked for.
        .with("runs", runs)
        .with("markers", &study.markers)
        // Instants that all points have, as parts of the duration.
        .with("instants", common(results))
        .with("resimulated_finer", FINER)
        .with_each("measures", measures)
        .with_each("methods", methods.map(|m| of_method(results, m, judged)))
        // Points that were run for the reference alone.
        .with_each("reference_points", reference)
        .with("machine", machine())
        .with("versions", versions);
    atomic::write(path, record.laid_out().as_bytes())
}

/// A measure with the limits that its errors are relative to; none of what is an error by itself.
fn of_measure(study: &Study, judged: &Judged) -> Entries {
    let measure = judged.measure;
    let si = |value: f64| measure.unit().to_si(value);
    let limits = judged.limits(study).into_iter().map(|(method, limit)| {
        let value = limit.value.iter().map(|&x| si(x));
        Entries::default()
            .with("method", method)
            .with("how", limit.how.words())
            .with("is_extrapolated", limit.how == How::Extrapolated)
            // Observed in each three successive points; nothing where it is not sensible.
            .with("orders", &limit.orders)
            .with("uncertainty", limit.uncertainty.map(si))
            .with_each("value", value)
    });
    let unit = match measure.unit().suffix() {
        "" => "1",
        _ => "m",
    };
    Entries::default()
        .with("measure", measure)
        .with("unit", unit)
        // Size to which an error is relative.
        .with("scale", si(judged.scale))
        .with_each("references", limits)
}

/// A method with its points and the order that the errors of each measure show.
fn of_method(results: &Results<'_>, m: usize, judged: &[Judged]) -> Entries {
    let method = &results.study.methods[m];
    let points = results.methods[m].iter().enumerate();
    let points = points.map(|(k, done)| of_point(results.study, done, judged, [m, k]));
    let orders = judged
        .iter()
        .filter_map(|j| Some((j.measure, j.methods[m].order?)));
    Entries::default()
        .with("name", &method.name)
        .with("refined", &method.refined)
        .with("orders", orders.collect::<BTreeMap<_, _>>())
        .with_each("points", points)
}

/// A point, at its place by method and number in what was judged; SI units.
fn of_point(study: &Study, done: &Done<'_>, judged: &[Judged], [m, k]: [usize; 2]) -> Entries {
    let si = |judged: &Judged, x: f64| judged.measure.unit().to_si(x);
    let errors = judged
        .iter()
        .filter_map(|j| Some((j.measure, si(j, j.methods[m].errors[k]?))));
    let compared = judged.iter().filter(|j| j.measure.has_reference());
    let values = compared.filter_map(|j| {
        let value = j.methods[m].values[k].as_ref()?;
        Some((
            j.measure,
            value.iter().map(|&x| si(j, x)).collect::<Vec<_>>(),
        ))
    });
    let seconds = done.median().map(|median| {
        Entries::default()
            .with("median", median)
            .with("lower_quartile", done.quantile(0.25))
            .with("upper_quartile", done.quantile(0.75))
            .with("runs", &done.seconds)
    });
    Entries::default()
        .with("value", &done.point.label)
        .with("size", done.point.size)
        .with("problem", done.point.problem.display().to_string())
        .with("set", &done.point.set)
        .with("command", command(study.asked, done.point))
        .with("status", done.first.status)
        .with_some("message", done.first.message.as_deref())
        // Wall time of a solution with its set-up, without reading the files and measuring.
        .with_some("seconds", seconds)
        .with_some("iterations", done.seen.as_ref().map(|seen| seen.iterations))
        // The point is then none of its step, and enters neither limit nor order.
        .with_some(
            "halved_steps",
            Some(done.halved()).filter(|&count| count > 0),
        )
        .with("values", values.collect::<BTreeMap<_, _>>())
        .with("errors", errors.collect::<BTreeMap<_, _>>())
}

/// Returns the command line that runs a point alone.
pub(super) fn command(asked: StudyTask, point: &StudyPoint) -> String {
    let word = match asked {
        StudyTask::Control => "solve",
        StudyTask::Motion => "simulate",
        StudyTask::Rest => "equilibrium",
    };
    let alone = CommandInput {
        input: point.problem.clone(),
        set: point.set.clone(),
        ..CommandInput::default()
    };
    quoting::command(alone.words(word))
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
