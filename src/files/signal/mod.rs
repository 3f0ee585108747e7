//! Functions of time in a file: `spec` as they are written, and their conversion to signals.

pub(crate) mod spec;

use crate::files::columns::Columns;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::signal::spec::{
    FollowedInTime, RampSpec, SignalCsvSpec, SignalSpec, SignalTableSpec, SineSpec,
};
use crate::files::units::quantity::{Kind, Quantity, Time};
use crate::math::Signal;

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
        "ramp" ramp |scope, spec| of_ramp(spec, kind, scope);
        "sine" sine |scope, spec| of_sine(spec, kind, scope);
        "table" table |scope, spec| of_table(spec, kind, scope);
        "csv" csv |scope, spec| of_csv::<M>(spec, kind, scope);
    )
}

/// A value of a kind; 0 where not written.
fn or_zero<M: FollowedInTime>(
    value: &Option<Quantity<M>>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<f64> {
    let value = value.as_ref();
    value.map_or(Ok(0.0), |value| scope.value_as(value, kind))
}

fn of_ramp<M: FollowedInTime>(
    spec: &RampSpec<M>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    Ok(Signal::Ramp {
        from: or_zero(&spec.from, kind, &scope.key("from"))?,
        to: scope.key("to").value_as(&spec.to, kind)?,
        start: spec.start.as_ref().map_or(0.0, |t| t.value()),
        duration: scope.key("duration").positive(&spec.duration)?,
    })
}

fn of_sine<M: FollowedInTime>(
    spec: &SineSpec<M>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    Ok(Signal::Sine {
        mean: or_zero(&spec.mean, kind, &scope.key("mean"))?,
        amplitude: scope.key("amplitude").value_as(&spec.amplitude, kind)?,
        frequency: scope.key("period").positive(&spec.period)?.recip(),
        phase: spec.phase.as_ref().map_or(0.0, |v| v.value()),
    })
}

fn of_table<M: FollowedInTime>(
    spec: &SignalTableSpec<M>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    let [time, values] = ["time", "values"].map(|key| scope.key(key));
    linear(
        (&spec.time, &|k| time.index(k)),
        (&spec.values, &|k| values.index(k)),
        kind,
        [&time, &values],
    )
}

fn of_csv<M: FollowedInTime>(
    spec: &SignalCsvSpec,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<Signal> {
    let columns = Columns::read(&spec.file, &scope.key("file"))?;
    let [time, values] = ["time", "values"].map(|key| scope.key(key));
    let times = columns.column::<Time>((&spec.time, &Time::kind()), &time)?;
    let column = columns.column::<M>((&spec.values, kind), &values)?;
    let mut signal = linear(
        (&times, &|_| time.clone()),
        (&column, &|_| values.clone()),
        kind,
        [&time, &values],
    )?;
    if let (Signal::Table { times, .. }, Some(offset)) = (&mut signal, &spec.time_offset) {
        times.iter_mut().for_each(|time| *time -= offset.value());
    }
    Ok(signal)
}

/// Quantities, and the place of each.
type Placed<'a, 's, M> = (&'a [Quantity<M>], &'a dyn Fn(usize) -> Scope<'s>);

/// Linear between values at times.
fn linear<'s, M: FollowedInTime>(
    (times, time): Placed<'_, 's, Time>,
    (values, value): Placed<'_, 's, M>,
    kind: &Kind,
    [whole_times, whole_values]: [&Scope<'s>; 2],
) -> Result<Signal> {
    let instants: Vec<f64> = times.iter().map(Quantity::value).collect();
    refuse!(if instants.is_empty(), whole_times; found "no times", expected "one or more");
    if let Some(k) = instants.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(time(k + 1).wrong(times[k + 1].to_string(), "increasing times"));
    }
    refuse!(if values.len() != instants.len(), whole_values;
        found format!("{} values", values.len()),
        expected format!("{}, one for each time", instants.len()));
    let read = values.iter().enumerate();
    let read = read.map(|(k, written)| value(k).value_as(written, kind));
    Ok(Signal::Table {
        times: instants,
        values: read.collect::<Result<_, _>>()?,
    })
}
