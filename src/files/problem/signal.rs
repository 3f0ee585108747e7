//! From voltages as functions of time as written to signals.

use crate::control::Signal;
use crate::control::problem::Voltages;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_signal::{
    FunctionSpec, RampSpec, SignalSpec, SignalTableSpec, SineSpec,
};
use crate::files::problem::state::driven;
use crate::model::system::System;
use std::collections::BTreeMap;

/// Voltages by the names of sources; constant ones where all of them are.
pub(crate) fn signals(
    map: &BTreeMap<String, SignalSpec>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages, SceneError> {
    let sources = system.sources();
    let mut signals = vec![Signal::Constant(0.0); sources.len()];
    for (name, spec) in map {
        let scope = scope.key(name);
        signals[driven(name, &sources, &scope)?] = signal(spec, &scope)?;
    }
    let constant = |signal: &Signal| match signal {
        Signal::Constant(value) => Some(*value),
        _ => None,
    };
    let constants: Option<Vec<f64>> = signals.iter().map(constant).collect();
    Ok(match constants {
        Some(row) => Voltages::Constant(row),
        None => Voltages::Signals(signals),
    })
}

fn signal(spec: &SignalSpec, scope: &Scope<'_>) -> Result<Signal, SceneError> {
    let FunctionSpec { ramp, sine, table } = match spec {
        SignalSpec::Constant(voltage) => return Ok(Signal::Constant(voltage.value())),
        SignalSpec::Function(function) => function.as_ref(),
    };
    type Build<'a> = Box<dyn FnOnce() -> Result<Signal, SceneError> + 'a>;
    let build = scope.exactly_one([
        (
            "ramp",
            ramp.as_ref()
                .map(|spec| -> Build<'_> { Box::new(|| of_ramp(spec, &scope.key("ramp"))) }),
        ),
        (
            "sine",
            sine.as_ref()
                .map(|spec| -> Build<'_> { Box::new(|| of_sine(spec, &scope.key("sine"))) }),
        ),
        (
            "table",
            table
                .as_ref()
                .map(|spec| -> Build<'_> { Box::new(|| of_table(spec, &scope.key("table"))) }),
        ),
    ])?;
    build()
}

fn of_ramp(spec: &RampSpec, scope: &Scope<'_>) -> Result<Signal, SceneError> {
    Ok(Signal::Ramp {
        from: spec.from.as_ref().map_or(0.0, |v| v.value()),
        to: spec.to.value(),
        start: spec.start.as_ref().map_or(0.0, |t| t.value()),
        duration: scope.key("duration").positive(&spec.duration)?,
    })
}

fn of_sine(spec: &SineSpec, scope: &Scope<'_>) -> Result<Signal, SceneError> {
    Ok(Signal::Sine {
        mean: spec.mean.as_ref().map_or(0.0, |v| v.value()),
        amplitude: spec.amplitude.value(),
        frequency: scope.key("period").positive(&spec.period)?.recip(),
        phase: spec.phase.as_ref().map_or(0.0, |v| v.value()),
    })
}

fn of_table(spec: &SignalTableSpec, scope: &Scope<'_>) -> Result<Signal, SceneError> {
    let times: Vec<f64> = spec.time.iter().map(|t| t.value()).collect();
    if times.is_empty() {
        return Err(scope.key("time").wrong("no times", "one or more"));
    }
    if let Some(k) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        let found = spec.time[k + 1].to_string();
        let place = scope.key("time").index(k + 1);
        return Err(place.wrong(found, "increasing times"));
    }
    if spec.values.len() != times.len() {
        let found = format!("{} voltages", spec.values.len());
        let expected = format!("{}, one for each time", times.len());
        return Err(scope.key("values").wrong(found, expected));
    }
    Ok(Signal::Table {
        times,
        values: spec.values.iter().map(|v| v.value()).collect(),
    })
}
