//! An identification in a problem file, and its conversion to a task.

use crate::control::problem::{
    Channel, Identification, Prior, Reading, Recording, Regime, SoughtStart, begin_late,
};
use crate::files::columns::Columns;
use crate::files::json::objects::read_objects;
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::{At, CoordinatesSpec};
use crate::files::problem::inputs::{LoadMap, VoltagesSpec, driven};
use crate::files::problem::numbers::{FreeMap, parameters};
use crate::files::problem::quantities::entry::Recorded;
use crate::files::problem::quantities::keys::MeasuredSpec;
use crate::files::problem::state::StartSpec;
use crate::files::scene::constants::WrittenScene;
use crate::files::signal::{SignalCsvSpec, SignalSpec, time};
use crate::files::study::ChangesSpec;
use crate::files::units::quantity::{
    MeasuredSize, PhysicalQuantity, Quantity, Ratio, SoughtConstant, Time,
};
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
    let found = match spec.recordings.is_empty() {
        true => "no recordings",
        false => "recordings that are all held out",
    };
    refuse!(if spec.recordings.iter().all(|one| one.held_out), of_recordings;
        found found, expected "one or more to which constants are fitted");
    let recordings = spec.recordings.iter().enumerate();
    let recordings = recordings.filter(|(_, one)| one.set == *scene.changes);
    let recordings = recordings.map(|(index, one)| recording(one, &of_recordings.index(index)));
    let candidates = spec.candidates.iter().enumerate();
    let candidates = candidates.filter(|(_, one)| one.set == *scene.changes);
    let candidates = candidates.map(|(index, one)| candidate(one, &of_candidates.index(index)));
    let mut priors = priors(spec, &parameters, scene, &at.key("priors"))?;
    priors.extend(of_their_priors);
    Ok(Identification {
        priors,
        parameters,
        recordings: recordings.collect::<Result<_, _>>()?,
        candidates: candidates.collect::<Result<_, _>>()?,
        step: at.optional("step", &spec.step, |at, step| at.positive(step))?,
        coordinates: spec.coordinates.map(Into::into),
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
    let keys = [
        ("start", spec.start.is_some()),
        ("sought_start", sought_start != SoughtStart::Nothing),
    ];
    let written = keys.into_iter().find(|(_, is_written)| *is_written);
    refuse!(if let (true, Some((key, _))) = (spec.at_rest, written), at.key(key);
        found "a start",
        expected "none beside \"at_rest\": states of rest follow from voltages and loads");
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
    let times = times(from, &columns, spec, at)?;
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
fn times(from: &str, columns: &Columns, spec: &RecordingSpec, at: &Scope<'_>) -> Result<Vec<f64>> {
    let place = at.key("time");
    let written = columns.column::<Time>(&spec.time, &Time::kind(), &place)?;
    let times: Vec<f64> = written.iter().map(Quantity::value).collect();
    refuse!(if times.is_empty(), at.key(from);
        found "no readings", expected "one line or more below the headers");
    let falls = times.windows(2).position(|pair| pair[0] >= pair[1]);
    refuse!(if let Some(k) = falls, place;
        found format!("{} after {}", written[k + 1], written[k]), expected "increasing times");
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
    of: &IdentifySpec,
    parameters: &[Parameter],
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<Vec<Prior>> {
    at.each_named(&of.priors, |path, spec, place| {
        let found = parameters.iter().position(|one| one.name == *path);
        let (Some(constant), Some(bounds)) = (found, of.free.get(path)) else {
            return Err(place.wrong(format!("{path:?}"), "a constant of \"free\""));
        };
        let [of_value, of_size] = ["value", "standard_deviation"].map(|key| place.key(key));
        let text = serde_json::to_value(&spec.value).unwrap_or_default();
        let with = scene.with(&JsonPath::parse(path).unwrap_or_default(), &text);
        with.map_err(|fault| of_value.error_of(fault))?;
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
    })
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
        out.push(parameter(gain(name), constant, range, 1.0, &place)?);
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
        let constants = sources.into_iter().map(Constant::Delay);
        let constants = constants.map(Follower::from).collect();
        out.push(parameter(name, constants, range, least, &place)?);
    }
    Ok((out, priors))
}

/// The prior of a constant, if it has one.
fn prior<M: PhysicalQuantity>(
    range: &RangeSpec<M>,
    constant: usize,
    at: &Scope<'_>,
) -> Result<Option<Prior>> {
    at.optional("prior", &range.prior, |at, spec| {
        let deviation = at.key("standard_deviation");
        Ok(Prior {
            constant,
            value: spec.value.value(),
            deviation: deviation.positive(&spec.standard_deviation)?,
        })
    })
}

/// A constant between bounds, from its guess on or from a `usual` value.
fn parameter<M: PhysicalQuantity>(
    name: String,
    constants: Vec<Follower>,
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

/// Columns, and the times of their rows.
struct Source<'a> {
    columns: &'a Columns,
    times: &'a [f64],
}

impl Recorded {
    /// The standard deviation that is written for all readings.
    fn deviation(&self, spec: &MeasuredSpec, at: &Scope<'_>) -> Result<Option<f64>> {
        let key = "standard_deviation";
        at.optional(key, &spec.standard_deviation, |at, written| {
            let value = at.value_as(written, &self.kind)?;
            refuse!(if value <= 0.0, at; found written, expected "a positive one");
            Ok(value)
        })
    }

    /// The channel with readings.
    fn with(&self, readings: Vec<Reading>, is_deviation_known: bool) -> Channel {
        Channel {
            name: self.name.clone(),
            parts: self.parts.clone(),
            unit: self.kind.unit(),
            is_deviation_known,
            readings,
        }
    }

    /// The channel with the readings of its columns.
    fn channel(&self, spec: &MeasuredSpec, source: &Source<'_>, at: &Scope<'_>) -> Result<Channel> {
        let given = [
            ("standard_deviation", spec.standard_deviation.is_some()),
            ("deviations", spec.deviations.is_some()),
            ("weights", spec.weights.is_some()),
        ];
        let mut given = given.into_iter().filter(|(_, is_given)| *is_given);
        let both = (given.next(), given.next());
        refuse!(if let (Some((first, _)), Some((second, _))) = both, at.key(second);
            found "a second one", expected format!("one of both, not \"{first}\" too"));
        let values = self.values(&self.of, source, &at.key("column"))?;
        let of_all = self.deviation(spec, at)?;
        let deviations = match (&spec.deviations, &spec.weights) {
            (Some(header), _) => self.values(header, source, &at.key("deviations"))?,
            (_, Some(header)) => weights(header, source, &at.key("weights"))?,
            _ => vec![Some(of_all.unwrap_or(1.0)); values.len()],
        };
        let mut readings = Vec::new();
        for (k, value) in values.iter().enumerate() {
            let (Some(value), Some(deviation)) = (*value, deviations[k]) else {
                continue;
            };
            let key = match spec.deviations {
                Some(_) => "deviations",
                None => "weights",
            };
            refuse!(if deviation <= 0.0 || deviation.is_nan(), at.key(key);
                found format!("a value that is not positive, in row {}", k + 1),
                expected "positive values");
            readings.push(Reading {
                time: source.times[k],
                value,
                deviation,
            });
        }
        refuse!(if readings.is_empty(), at.key("column");
            found format!("{:?}, a column of gaps alone", self.of), expected "one reading or more");
        let is_known = of_all.is_some() || spec.deviations.is_some();
        Ok(self.with(readings, is_known))
    }

    /// Values of a column in the units inside; none of a gap.
    fn values(
        &self,
        header: &str,
        source: &Source<'_>,
        at: &Scope<'_>,
    ) -> Result<Vec<Option<f64>>> {
        let column = source
            .columns
            .with_gaps::<MeasuredSize>(header, &self.kind, at)?;
        let value = |written: Option<Quantity<MeasuredSize>>| {
            let read = written.map(|written| at.value_as(&written, &self.kind));
            read.transpose()
        };
        column.into_iter().map(value).collect()
    }
}

/// Relative deviations of weights.
fn weights(header: &str, source: &Source<'_>, at: &Scope<'_>) -> Result<Vec<Option<f64>>> {
    let column = source
        .columns
        .with_gaps::<Ratio>(header, &Ratio::kind(), at)?;
    let deviation = |weight: Option<Quantity<Ratio>>| Some(weight?.value().sqrt().recip());
    Ok(column.into_iter().map(deviation).collect())
}

read_objects! {
    /// Constants that are fitted to recordings, with what the data say of them.
    pub struct IdentifySpec {
        /// Free parameters by their paths in the scene, such as `"materials.silicone.shear_modulus"`, each between bounds.
        pub free?: FreeMap,
        /// Constants of the inputs that are sought: gains of sources, and their delays.
        pub inputs?: InputConstantsSpec,
        /// Constants of `free` that are known beside the recordings, by their paths: each counts as one reading more.
        pub priors: BTreeMap<String, PriorSpec>,
        /// Recordings: those that constants are fitted to, and those that are held out to check their prediction.
        pub recordings: Vec<RecordingSpec>,
        /// Experiments that could be done next; the result ranks them by the variance that they leave.
        pub candidates?: Vec<CandidateSpec>,
        /// Step of the first grid, SI unit s, which is halved until its bias is below a tenth of the standard errors; by the number of readings
        /// where not written.
        pub step: Option<Quantity<Time>>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
    }

    /// Constants of the inputs of all recordings.
    #[derive(Default)]
    pub struct InputConstantsSpec {
        /// Factors between the voltages and loads that recordings say and those that act, by the names of muscles, electrodes and loads.
        pub gains: BTreeMap<String, RangeSpec<Ratio>>,
        /// Time by which all voltages and loads act later than recordings say, SI unit s; before they act, those of the state of rest at the
        /// start, or the first ones.
        pub delay: Option<RangeSpec<Time>>,
        /// The same of single sources, by the names of muscles, electrodes and loads, beside that of all others.
        pub delays: BTreeMap<String, RangeSpec<Time>>,
    }

    /// Bounds of a constant.
    #[serde(bound = "")]
    #[schemars(bound = "M: PhysicalQuantity")]
    pub struct RangeSpec<M: PhysicalQuantity> {
        /// Lower bound.
        pub min: Quantity<M>,
        /// Upper bound.
        pub max: Quantity<M>,
        /// Value at which the fit starts; 1 of a gain, the lower bound of a delay where not written.
        pub guess: Option<Quantity<M>>,
        /// A normal distribution, as of a data sheet, which counts as one reading more.
        pub prior: Option<InputPriorSpec<M>>,
    }

    /// A normal distribution of a constant of the inputs.
    #[serde(bound = "")]
    #[schemars(bound = "M: PhysicalQuantity")]
    pub struct InputPriorSpec<M: PhysicalQuantity> {
        /// Mean.
        pub value: Quantity<M>,
        /// Standard deviation.
        pub standard_deviation: Quantity<M>,
    }

    /// A normal distribution of a constant, such as that of a data sheet.
    pub struct PriorSpec {
        /// Mean, in the unit of the constant.
        pub value: Quantity<SoughtConstant>,
        /// Standard deviation.
        pub standard_deviation: Quantity<SoughtConstant>,
    }

    /// Readings of a motion or of states of rest under given voltages and loads.
    pub struct RecordingSpec {
        /// Unique name.
        pub name: String,
        /// Path of the CSV file, relative to the problem or to the current folder: one line of headers such as `tip [mm]`, `tip (mm)` or `tip_mm`,
        /// SI units where a header has none, which a note says; lines that begin with `#` are comments, empty cells are gaps.
        pub file: Option<String>,
        /// Columns of numbers by such headers in place of a file; `null` is a gap.
        pub columns: Option<BTreeMap<String, Vec<Option<f64>>>>,
        /// Header of the times, which begin with the motion at 0; `time` where not written.
        #[serde(default = "time")]
        pub time: String,
        /// Time in that column at which the motion begins, SI unit s, which all times lose, also those of inputs from the same file that have no
        /// `time_offset` of their own; 0 where not written. A motion whose readings begin late needs it.
        pub time_offset: Option<Quantity<Time>>,
        /// Quantities that the columns measure.
        pub measured: Vec<MeasuredSpec>,
        /// Voltages, loads and start.
        pub experiment?: ExperimentSpec,
        /// Values that are other ones in the scene of this recording, by their places, such as `"scene.bodies.payload.mass": "1 kg"`.
        pub set?: ChangesSpec,
        /// True if no constant is fitted to it: the result says whether the fitted constants explain it.
        pub held_out: bool,
    }

    /// An experiment that could be done.
    pub struct CandidateSpec {
        /// Unique name.
        pub name: String,
        /// Length, SI unit s.
        pub duration: Quantity<Time>,
        /// Number of readings of each quantity, at equal distances.
        pub readings: usize,
        /// Measured quantities; their columns are not read.
        pub measured: Vec<MeasuredSpec>,
        /// Voltages, loads and start.
        pub experiment?: ExperimentSpec,
        /// Values that are other ones in the scene of this experiment, by their places.
        pub set?: ChangesSpec,
    }

    /// Voltages, loads and start of a recording.
    #[derive(Default)]
    pub struct ExperimentSpec {
        /// Constant voltages, those of a solution, a table, or functions of time such as columns of a CSV file; 0 where not written.
        pub voltages?: VoltagesSpec,
        /// Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        pub loads?: LoadMap,
        /// Start of the motion; the reference configuration at rest where not written.
        pub start: Option<StartSpec>,
        /// Part of the start that is unknown, and fitted with the constants; nothing where not written.
        pub sought_start?: SoughtStartSpec,
        /// True if each reading is one of a state of rest under the voltages and loads of its time.
        pub at_rest: bool,
    }

    /// Unknown part of a start.
    #[derive(Default)]
    pub enum SoughtStartSpec: SoughtStart {
        /// All is given.
        #[default]
        Nothing,
        /// The coordinates.
        Coordinates,
        /// The coordinates and the momenta.
        State,
    }
}
