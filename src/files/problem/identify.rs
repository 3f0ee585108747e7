//! Conversion of an identification in a problem file to its task.

use crate::control::problem::{
    Identification, Prior, Reading, Recording, Regime, SoughtStart, begin_late,
};
use crate::files::columns::Columns;
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::At;
use crate::files::problem::channels::Source;
use crate::files::problem::free::{FreeMap, parameters};
use crate::files::problem::loads::driven;
use crate::files::problem::quantities::entry::Recorded;
use crate::files::problem::quantities::keys::MeasuredSpec;
use crate::files::problem::spec_identify::{
    CandidateSpec, ExperimentSpec, IdentifySpec, InputConstantsSpec, PriorSpec, RangeSpec,
    RecordingSpec,
};
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::scene::constants::WrittenScene;
use crate::files::signal::spec::{SignalCsvSpec, SignalSpec};
use crate::files::units::quantity::{PhysicalQuantity, Quantity, Time};
use crate::model::{Constant, Follower, Parameter};
use std::collections::BTreeMap;

/// Most readings of a candidate.
const MOST_READINGS: usize = 100_000;

/// The task of an identification, with the recordings of one scene alone.
pub(crate) fn identification(
    spec: &IdentifySpec,
    scene: &WrittenScene<'_>,
    at: &At<'_>,
) -> Result<Identification> {
    let place = at.key("free");
    let first = spec.free.len();
    let (of_inputs, of_their_priors) = input_constants(&spec.inputs, first, &at.key("inputs"))?;
    refuse!(if spec.free.is_empty() && of_inputs.is_empty(), place;
        found "no constant", expected "one or more");
    let mut parameters = parameters(&spec.free, scene, &place)?;
    parameters.extend(of_inputs);
    let [of_recordings, of_candidates] = ["recordings", "candidates"].map(|key| at.key(key));
    let mut names = Vec::new();
    for (index, one) in spec.recordings.iter().enumerate() {
        unique(&one.name, &mut names, &of_recordings.index(index))?;
    }
    for (index, one) in spec.candidates.iter().enumerate() {
        unique(&one.name, &mut names, &of_candidates.index(index))?;
    }
    if spec.recordings.iter().all(|one| one.held_out) {
        let found = match spec.recordings.is_empty() {
            true => "no recordings",
            false => "recordings that are all held out",
        };
        return Err(of_recordings.wrong(found, "one or more to which constants are fitted"));
    }
    let recordings = spec.recordings.iter().enumerate();
    let recordings = recordings.filter(|(_, one)| one.set == *scene.changes);
    let recordings = recordings.map(|(index, one)| recording(one, &of_recordings.index(index)));
    let candidates = spec.candidates.iter().enumerate();
    let candidates = candidates.filter(|(_, one)| one.set == *scene.changes);
    let candidates = candidates.map(|(index, one)| candidate(one, &of_candidates.index(index)));
    let step = spec.step.as_ref();
    let step = step.map(|step| at.key("step").positive(step));
    let of_scene = (&parameters[..], &spec.free);
    let mut priors = priors(&spec.priors, of_scene, scene, &at.key("priors"))?;
    priors.extend(of_their_priors);
    Ok(Identification {
        priors,
        parameters,
        recordings: recordings.collect::<Result<_, _>>()?,
        candidates: candidates.collect::<Result<_, _>>()?,
        step: step.transpose()?,
        coordinates: at.coordinates(spec.coordinates)?,
    })
}

/// Refuses a name that stands already.
fn unique(name: &str, names: &mut Vec<String>, at: &Scope<'_>) -> Result<()> {
    refuse!(if names.iter().any(|other| other == name), at.key("name");
        found format!("{name:?}"), expected "a name that no other recording or candidate has");
    names.push(name.to_owned());
    Ok(())
}

/// A recording without its readings.
fn experiment(name: &str, spec: &ExperimentSpec, at: &At<'_>) -> Result<Recording> {
    let (start, voltages) = driven(spec.start.as_ref(), &spec.voltages, &spec.loads, at)?;
    let sought_start = SoughtStart::from(spec.sought_start);
    if spec.at_rest && (sought_start != SoughtStart::Nothing || spec.start.is_some()) {
        let key = match spec.start {
            Some(_) => "start",
            None => "sought_start",
        };
        let expected = "none beside \"at_rest\": states of rest follow from voltages and loads";
        return Err(at.key(key).wrong("a start", expected));
    }
    Ok(Recording {
        name: name.to_owned(),
        scene: None,
        regime: match spec.at_rest {
            true => Regime::Rest,
            false => Regime::Motion,
        },
        voltages,
        start,
        sought_start,
        is_held_out: false,
        channels: Vec::new(),
    })
}

/// All that is measured, with what it is called.
fn measured(list: &[MeasuredSpec], at: &At<'_>) -> Result<Vec<Recorded>> {
    let at = at.key("measured");
    refuse!(if list.is_empty(), at;
        found "nothing that is measured", expected "one or more quantities");
    at.each(list, MeasuredSpec::recorded)
}

/// Voltages, loads and start of a recording; inputs from its own file are on its clock.
fn on_its_clock(spec: &RecordingSpec) -> ExperimentSpec {
    let mut out = spec.experiment.clone();
    let own = |csv: &mut SignalCsvSpec| {
        if csv.time_offset.is_none() && spec.file.as_ref() == Some(&csv.file) {
            csv.time_offset.clone_from(&spec.time_offset);
        }
    };
    if let VoltagesSpec::Signals(voltages) = &mut out.voltages {
        let csv = voltages.values_mut().filter_map(SignalSpec::csv_mut);
        csv.for_each(own);
    }
    let csv = out.loads.values_mut().filter_map(SignalSpec::csv_mut);
    csv.for_each(own);
    out
}

fn recording(spec: &RecordingSpec, at: &At<'_>) -> Result<Recording> {
    let place = at.key("experiment");
    let mut out = experiment(&spec.name, &on_its_clock(spec), &place)?;
    out.is_held_out = spec.held_out;
    let (from, columns) = columns(spec, at)?;
    let times = times((from, &columns), spec, at)?;
    let all = measured(&spec.measured, at)?;
    for (index, (one, spec_of)) in all.iter().zip(&spec.measured).enumerate() {
        let at = at.key("measured").index(index);
        let column = &one.of;
        refuse!(if all[..index].iter().any(|other| other.of == *column), at.key("column");
            found format!("{column:?}, which is measured already"),
            expected "each column once, as twice the readings would be twice the data");
        let source = Source {
            columns: &columns,
            times: &times,
        };
        out.channels.push(one.channel(spec_of, &source, &at)?);
    }
    refuse!(if out.regime == Regime::Motion && out.duration() <= 0.0, at.key(from);
        found "a recording that is too short: no reading after time 0",
        expected "readings at later times");
    Ok(out)
}

/// The columns of a recording, with the key at which they stand.
fn columns(spec: &RecordingSpec, at: &Scope<'_>) -> Result<(&'static str, Columns)> {
    Ok(the_one!(at, spec;
        "file" file |at, path| ("file", Columns::read(path, at)?);
        "columns" columns |at, columns| ("columns", Columns::inside(columns, at)?);
    ))
}

/// Times in ms of all rows from the begin of the motion on.
fn times(
    (from, columns): (&str, &Columns),
    spec: &RecordingSpec,
    at: &Scope<'_>,
) -> Result<Vec<f64>> {
    let place = at.key("time");
    let written = columns.column::<Time>((&spec.time, &Time::kind()), &place)?;
    let times: Vec<f64> = written.iter().map(Quantity::value).collect();
    refuse!(if times.is_empty(), at.key(from);
        found "no readings", expected "one line or more below the headers");
    if let Some(k) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        let found = format!("{} after {}", written[k + 1], written[k]);
        return Err(place.wrong(found, "increasing times"));
    }
    let first = &written[0];
    let offset = spec.time_offset.as_ref();
    refuse!(if offset.is_none() && !spec.experiment.at_rest && begin_late(&times), place;
        found format!("{first} at the first reading, which leaves open when the motion begins"),
        expected format!("\"time_offset\": {first} beside \"time\" if the motion begins with the first reading, or \"time_offset\": 0 if it begins at time 0 of the column"));
    let begin = offset.map_or(0.0, Quantity::value);
    match (times[0] < begin, offset) {
        (false, _) => Ok(times.iter().map(|time| time - begin).collect()),
        (true, None) => Err(place.wrong(first.to_string(), "times from 0 on")),
        (true, Some(offset)) => {
            let expected = format!("a time no later than {first}, that of the first reading");
            Err(at.key("time_offset").wrong(offset.to_string(), expected))
        }
    }
}

fn candidate(spec: &CandidateSpec, at: &At<'_>) -> Result<Recording> {
    let mut out = experiment(&spec.name, &spec.experiment, &at.key("experiment"))?;
    let duration = at.key("duration").positive(&spec.duration)?;
    at.key("readings")
        .count(spec.readings, "reading", MOST_READINGS)?;
    let time = |k: usize| duration * (k + 1) as f64 / spec.readings as f64;
    let all = measured(&spec.measured, at)?;
    for (index, (one, spec_of)) in all.iter().zip(&spec.measured).enumerate() {
        let at = at.key("measured").index(index);
        let deviation = one.deviation(spec_of, &at)?;
        let reading = |k| Reading {
            time: time(k),
            value: 0.0,
            deviation: deviation.unwrap_or(1.0),
        };
        let readings = (0..spec.readings).map(reading).collect();
        out.channels.push(one.with(readings, deviation.is_some()));
    }
    Ok(out)
}

/// The priors of free parameters, by their paths.
pub(super) fn priors(
    map: &BTreeMap<String, PriorSpec>,
    (parameters, free): (&[Parameter], &FreeMap),
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<Vec<Prior>> {
    let one = |(path, spec): (&String, &PriorSpec)| {
        let place = at.key(path);
        let found = parameters.iter().position(|one| one.name == *path);
        let (Some(constant), Some(bounds)) = (found, free.get(path)) else {
            return Err(place.wrong(format!("{path:?}"), "a constant of \"free\""));
        };
        let [of_value, of_size] = ["value", "standard_deviation"].map(|key| place.key(key));
        let text = serde_json::to_value(&spec.value).unwrap_or_default();
        let with = scene.with(&JsonPath::parse(path).unwrap_or_default(), &text);
        with.map_err(|reason| reason.at(&of_value))?;
        let size = &spec.standard_deviation;
        let written = [&spec.value, &bounds.min, &bounds.max];
        let unit = written.into_iter().find_map(|one| one.dimension());
        refuse!(if size.dimension().is_some_and(|own| unit != Some(own)), of_size;
            found size, expected "a size in a unit of the value, or a plain number in its SI unit");
        refuse!(if size.si() <= 0.0, of_size; found size, expected "a positive size");
        let factor = parameters[constant].unit(scene.system).factor;
        Ok(Prior {
            constant,
            value: spec.value.si() / factor,
            deviation: size.si() / factor,
        })
    };
    map.iter().map(one).collect()
}

/// Name of the delay of all inputs among the constants.
const DELAY: &str = "delay";

/// Words for what a source is.
const SOURCE: &str = "the name of a muscle, an electrode or a load";

/// Name of a gain among the constants.
fn gain(source: &str) -> String {
    format!("gain of {source}")
}

/// The gains and the delay that are sought, behind `first` other constants, and what is known of them beside the recordings.
pub(super) fn input_constants(
    spec: &InputConstantsSpec,
    first: usize,
    at: &At<'_>,
) -> Result<(Vec<Parameter>, Vec<Prior>)> {
    let (mut out, mut priors) = (Vec::new(), Vec::new());
    for (name, range) in &spec.gains {
        let place = at.key("gains").key(name);
        let source = place.source(name, SOURCE)?;
        let constant = vec![Constant::Gain(source).into()];
        priors.extend(prior(range, first + out.len(), &place)?);
        out.push(parameter((gain(name), constant), range, 1.0, &place)?);
    }
    let mut delays: Vec<(String, &RangeSpec<Time>, Vec<usize>, At<'_>)> = Vec::new();
    for (name, range) in &spec.delays {
        let place = at.key("delays").key(name);
        let source = place.source(name, SOURCE)?;
        delays.push((format!("delay of {name}"), range, vec![source], place));
    }
    if let Some(range) = &spec.delay {
        let own: Vec<usize> = delays.iter().flat_map(|one| one.2.clone()).collect();
        let others = (0..at.sources.len()).filter(|source| !own.contains(source));
        delays.push((DELAY.to_owned(), range, others.collect(), at.key("delay")));
    }
    for (name, range, sources, place) in delays {
        let least = range.min.value();
        refuse!(if least < 0.0, place.key("min"); found range.min, expected "no negative time");
        priors.extend(prior(range, first + out.len(), &place)?);
        let constants = sources
            .into_iter()
            .map(|source| Constant::Delay(source).into());
        let of = (name, constants.collect());
        out.push(parameter(of, range, least, &place)?);
    }
    Ok((out, priors))
}

/// The prior of a constant, if it has one.
fn prior<M: PhysicalQuantity>(
    range: &RangeSpec<M>,
    constant: usize,
    at: &Scope<'_>,
) -> Result<Option<Prior>> {
    let Some(spec) = &range.prior else {
        return Ok(None);
    };
    let deviation = at.key("prior").key("standard_deviation");
    Ok(Some(Prior {
        constant,
        value: spec.value.value(),
        deviation: deviation.positive(&spec.standard_deviation)?,
    }))
}

/// A constant between bounds, from its guess on or from a `usual` value.
fn parameter<M: PhysicalQuantity>(
    (name, constants): (String, Vec<Follower>),
    range: &RangeSpec<M>,
    usual: f64,
    at: &Scope<'_>,
) -> Result<Parameter> {
    let [lower, upper] = [&range.min, &range.max].map(|bound| bound.value());
    refuse!(if lower >= upper, at.key("max");
        found range.max, expected format!("a value larger than \"min\" {}", range.min));
    let guess = range.guess.as_ref().map_or(usual, |guess| guess.value());
    if !(lower..=upper).contains(&guess) {
        let (place, found) = match &range.guess {
            Some(guess) => (at.key("guess"), guess.to_string()),
            None => (at.clone(), format!("bounds without {usual}")),
        };
        let expected = format!("a guess from {} to {}", range.min, range.max);
        return Err(place.wrong(found, expected));
    }
    Ok(Parameter {
        name,
        constants,
        lower,
        upper,
        guess,
    })
}
