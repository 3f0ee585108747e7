//! The problem that a controller plans anew in each of its intervals.

use crate::control::problem::{Ahead, Duration, Regulator, Simulation, Task};
use crate::feedback::{Law, LawInput};
use crate::files::json::document::Document;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::build::ProblemSpec;
use crate::files::problem::feedback::{CONTROL_FILE, ROUNDING};
use crate::files::problem::simulation::refuse_given;
use crate::math::shortest;
use crate::model::system::{Source, System};
use std::path::Path;
use std::sync::Arc;

/// Reads the problem that the controller of a simulation plans anew, where there is one, by a reader of problem files.
pub(crate) fn add_plan(
    task: &mut Task,
    spec: &ProblemSpec,
    scope: &Scope<'_>,
    read: impl Fn(&Path) -> Result<(System, Task, Option<Regulator>)>,
) -> Result<()> {
    let simulate = spec.simulate.as_ref();
    let written = simulate.and_then(|one| one.controller.as_ref());
    let written_delay = written.and_then(|one| one.delay.as_ref());
    let written = written.and_then(|one| one.horizon.as_ref());
    let (Some(horizon), Task::Simulate(simulation)) = (written, task) else {
        return Ok(());
    };
    let place = scope.key("simulate").key("controller").key("horizon");
    let most = Ahead::MOST_INTERVALS;
    let intervals = place.key("intervals");
    intervals.count(horizon.intervals, "interval", most)?;
    let Simulation {
        duration,
        step,
        controller: Some(controller),
        ..
    } = simulation
    else {
        return Ok(());
    };
    let step = *duration / (*duration / *step - 1e-9).ceil().max(1.0);
    let place = place.key("problem");
    let of = &horizon.problem;
    // A simulation could name itself.
    let without = || place.wrong(format!("{of:?}, which has none"), CONTROL_FILE);
    if Document::read(&controller.path)?.entry("control").is_none() {
        return Err(without());
    }
    let (system, Task::Control(control), regulator) = read(&controller.path)? else {
        return Err(without());
    };
    let Duration::Given(duration) = control.duration else {
        let found = format!("{of:?}, whose duration is free");
        return Err(place.wrong(found, "a given duration"));
    };
    let sample = duration / control.intervals as f64;
    let steps = (sample / step).round();
    let is_multiple = steps >= 1.0 && (sample / step - steps).abs() <= ROUNDING * steps;
    refuse!(if control.is_refined || !is_multiple, place;
        found format!("{of:?} with intervals of {} ms", shortest(sample, 9)),
        expected format!("given intervals that are multiples of the step {} ms", shortest(step, 9)));
    let given = system.sources().into_iter().enumerate();
    let inputs = given.filter(|(source, named)| named.acts() && !control.is_given(*source));
    let input = |(_, named): (usize, Source)| LawInput {
        name: named.name,
        is_squared: false,
        bounds: [f64::NEG_INFINITY, f64::INFINITY],
    };
    controller.law = Arc::new(Law {
        inputs: inputs.map(input).collect(),
        h: sample,
        ..(*controller.law).clone()
    });
    if let Some(simulate) = simulate {
        refuse_given(simulate, &controller.law, &scope.key("simulate"))?;
    }
    let regulator = regulator.unwrap_or_default();
    controller.sample = sample;
    if written_delay.is_none() {
        controller.delay = regulator.delayed(sample) as f64 * sample;
    }
    controller.ahead = Some(Box::new(Ahead {
        system,
        control: *control,
        regulator,
        intervals: horizon.intervals,
    }));
    Ok(())
}
