//! Voltages, loads, lengths and joint coordinates as functions of time: as they are written, and their conversion to signals.

use crate::files::columns::Columns;
use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::units::quantity::{
    Angle, JointCoordinate, Kind, Length, LoadSize, PhysicalQuantity, Quantity, Time, Voltage,
};
use crate::math::Signal;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use std::borrow::Cow;

/// A function of time whose values are of a kind.
pub(crate) fn signal<M: FollowedInTime>(
    spec: &SignalSpec<M>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    let function = match spec {
        SignalSpec::Constant(value) => return scope.value_as(value, kind).map(Signal::Constant),
        SignalSpec::Function(function) => function.as_ref(),
    };
    the_one!(scope, function;
        "ramp" ramp |at, ramp| {
            let from = at.optional("from", &ramp.from, |at, from| at.value_as(from, kind))?;
            Ok(Signal::Ramp {
                from: from.unwrap_or(0.0),
                to: at.key("to").value_as(&ramp.to, kind)?,
                start: ramp.start.as_ref().map_or(0.0, Quantity::value),
                duration: at.key("duration").positive(&ramp.duration)?,
            })
        };
        "sine" sine |at, sine| {
            let mean = at.optional("mean", &sine.mean, |at, mean| at.value_as(mean, kind))?;
            Ok(Signal::Sine {
                mean: mean.unwrap_or(0.0),
                amplitude: at.key("amplitude").value_as(&sine.amplitude, kind)?,
                frequency: at.key("period").positive(&sine.period)?.recip(),
                phase: sine.phase.as_ref().map_or(0.0, Quantity::value),
            })
        };
        "table" table |at, table| {
            linear(&table.time, &table.values, kind, at, |key, k| at.key(key).index(k))
        };
        "csv" csv |at, csv| of_csv::<M>(csv, kind, at);
    )
}

fn of_csv<M: FollowedInTime>(
    spec: &SignalCsvSpec,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    let columns = Columns::read(&spec.file, &scope.key("file"))?;
    let times = columns.column::<Time>(&spec.time, &Time::kind(), &scope.key("time"))?;
    let values = columns.column::<M>(&spec.values, kind, &scope.key("values"))?;
    let mut signal = linear(&times, &values, kind, scope, |key, _| scope.key(key))?;
    if let (Signal::Table { times, .. }, Some(offset)) = (&mut signal, &spec.time_offset) {
        times.iter_mut().for_each(|time| *time -= offset.value());
    }
    Ok(signal)
}

/// Linear between values at times; `place` is that of one of them by its key and number.
fn linear<'s, M: FollowedInTime>(
    times: &[Quantity<Time>],
    values: &[Quantity<M>],
    kind: &Kind,
    scope: &Scope<'s>,
    place: impl Fn(&str, usize) -> Scope<'s>,
) -> Result<Signal> {
    let instants: Vec<f64> = times.iter().map(Quantity::value).collect();
    refuse!(if instants.is_empty(), scope.key("time"); found "no times", expected "one or more");
    let falls = instants.windows(2).position(|pair| pair[0] >= pair[1]);
    refuse!(if let Some(k) = falls, place("time", k + 1);
        found times[k + 1], expected "increasing times");
    refuse!(if values.len() != instants.len(), scope.key("values");
        found format!("{} values", values.len()),
        expected format!("{}, one for each time", instants.len()));
    let read = values.iter().enumerate();
    let read = read.map(|(k, written)| place("values", k).value_as(written, kind));
    Ok(Signal::Table {
        times: instants,
        values: read.collect::<Result<_, _>>()?,
    })
}

objects! {
    /// A constant in its SI unit, or exactly one of `ramp`, `sine`, `table` and `csv`.
    #[serde(bound(serialize = "M: FollowedInTime"))]
    pub either SignalSpec<M: FollowedInTime>(M::EXPECTED) {
        /// Constant.
        Constant: Quantity<M>,
        /// A function of time.
        Function: Box<FunctionSpec<M>>,
    }

    /// A function of time: exactly one of the four.
    #[serde(bound = "")]
    pub struct FunctionSpec<M: FollowedInTime> {
        /// Linear between two values, constant before and after.
        pub ramp: Option<RampSpec<M>>,
        /// A sine.
        pub sine: Option<SineSpec<M>>,
        /// Linear between values at times, constant before and after.
        pub table: Option<SignalTableSpec<M>>,
        /// The same, with times and values from columns of a CSV file.
        pub csv: Option<SignalCsvSpec>,
    }

    /// Linear between two values, constant before and after.
    #[serde(bound = "")]
    pub struct RampSpec<M: FollowedInTime> {
        /// Value up to the start; 0 where not written.
        pub from: Option<Quantity<M>>,
        /// Value from the end on.
        pub to: Quantity<M>,
        /// Time at which it begins, SI unit s; 0 where not written.
        pub start: Option<Quantity<Time>>,
        /// Time that it takes, SI unit s.
        pub duration: Quantity<Time>,
    }

    /// `mean + amplitude sin(2π t/period + phase)`.
    #[serde(bound = "")]
    pub struct SineSpec<M: FollowedInTime> {
        /// Mean; 0 where not written.
        pub mean: Option<Quantity<M>>,
        /// Amplitude.
        pub amplitude: Quantity<M>,
        /// Period, SI unit s.
        pub period: Quantity<Time>,
        /// Phase, SI unit rad; 0 where not written.
        pub phase: Option<Quantity<Angle>>,
    }

    /// Values at times.
    #[serde(bound = "")]
    pub struct SignalTableSpec<M: FollowedInTime> {
        /// Times, growing, SI unit s.
        pub time: Vec<Quantity<Time>>,
        /// A value at each.
        pub values: Vec<Quantity<M>>,
    }

    /// Values at times, from a CSV file: one line of headers such as `muscle1 [kV]`, SI units where a header has none, which a note
    /// says; lines that begin with `#` are comments.
    pub struct SignalCsvSpec {
        /// Path of the file, relative to the problem or to the current folder.
        pub file: String,
        /// Header of the times, with or without its unit.
        #[serde(default = "time")]
        pub time: String,
        /// Time in that column which is 0 of the motion, SI unit s; 0 where not written, or that of a recording of the same file.
        pub time_offset: Option<Quantity<Time>>,
        /// Header of the values, with or without its unit.
        pub values: String,
    }
}

/// The usual header of times.
pub(crate) fn time() -> String {
    "time".to_owned()
}

impl<M: FollowedInTime> SignalSpec<M> {
    /// The columns of a file that it is read from, where it is.
    pub(crate) fn csv_mut(&mut self) -> Option<&mut SignalCsvSpec> {
        match self {
            Self::Constant(_) => None,
            Self::Function(function) => function.csv.as_mut(),
        }
    }
}

/// A measure that may be a function of time.
pub trait FollowedInTime: PhysicalQuantity + JsonSchema {
    /// Expected value, for messages.
    const EXPECTED: &'static str;
}

/// Declares measures that may be functions of time; the schema of a measure is that of a quantity of it.
macro_rules! followed_in_time {
    ($($measure:ident: $expected:literal;)*) => {
        $(
            impl FollowedInTime for $measure {
                const EXPECTED: &'static str = $expected;
            }

            impl JsonSchema for $measure {
                fn schema_name() -> Cow<'static, str> {
                    Self::NAME.into()
                }

                fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                    Quantity::<Self>::json_schema(generator)
                }
            }
        )*
    };
}

followed_in_time! {
    Voltage: "a voltage such as \"1.7 kV\", or an object with \"ramp\", \"sine\", \"table\" or \"csv\"";
    Length: "a length such as \"50 mm\", or an object with \"ramp\", \"sine\", \"table\" or \"csv\"";
    LoadSize: "a force such as \"2 N\" or a torque such as \"0.2 N m\", or an object with \"ramp\", \"sine\", \"table\" or \"csv\"";
    JointCoordinate: "an angle or a length, or an object with \"ramp\", \"sine\", \"table\" or \"csv\"";
}
