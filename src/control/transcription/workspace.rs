//! The point of a transcription and what is evaluated there: all that changes from one evaluation to the next.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::guess::InitialGuess;
use crate::control::problem::Control;
use crate::control::transcription::cost_rows::unit_of;
use crate::control::transcription::layout::Layout;
use crate::control::transcription::segment::{Placed, SegmentWorkspace};
use crate::coordinates::Configuration;
use crate::functional::SumDerivatives;
use crate::model::{Model, Time};

/// Storage of the evaluations.
#[derive(Debug)]
pub(super) struct Workspace {
    /// Values of the variables; NaN before the first point.
    pub(super) point: Vec<f64>,
    pub(super) instants: Vec<Configuration>,
    pub(super) placed: Placed,
    /// Scalars of all intervals.
    pub(super) scalars: Vec<f64>,
    /// Costates of their equations.
    pub(super) scalars_along: Vec<f64>,
    /// Voltages of all intervals in kV.
    pub(super) inputs: Vec<f64>,
    /// Length of an interval in ms.
    pub(super) h: f64,
    /// Storage of each stretch of a horizon.
    pub(super) stretches: [SegmentWorkspace; 2],
    /// Copy of the instant at which a long horizon is cut in two.
    pub(super) boundary_instant: Configuration,
    pub(super) measured: SumDerivatives,
    /// Factor of the objective in the Hessian.
    pub(super) sigma: f64,
    /// Step by step the rows of an instant and those of the scalars of an interval, then costates of the limits.
    pub(super) rows: Vec<f64>,
    /// Second derivatives step by step, then gradients of the limits.
    pub(super) values: Vec<f64>,
    /// Gradient by the voltages of all intervals.
    pub(super) gradient: Vec<f64>,
}

impl Workspace {
    /// Storage for a layout, with all values that are given.
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
        layout: &Layout,
    ) -> Self {
        let (action, intervals) = (&model.action, layout.span.all);
        let map = &action.map;
        let scalars = given_scalars(model, control, layout);
        let scalar_count = model.variables.of(Time::Interval).len();
        let inputs = input_values(model, control, &scalars, scalar_count, intervals);
        let stride = map.unknowns() + scalar_count;
        let limits = layout.limit_rows.iter();
        let limit_entries: usize = limits.map(|&(l, _)| layout.limits[l].entries.len()).sum();
        Self {
            point: vec![f64::NAN; layout.unknowns.columns.len()],
            instants: given_instants(model, boundary, initial, layout),
            placed: Placed::Nothing,
            scalars_along: vec![0.0; scalars.len()],
            scalars,
            gradient: vec![0.0; inputs.len()],
            inputs,
            h: initial.h,
            stretches: [SegmentWorkspace::new(action), SegmentWorkspace::new(action)],
            boundary_instant: map.instant(),
            measured: SumDerivatives::new(map.vectors.len(), scalar_count, None),
            sigma: 0.0,
            rows: vec![0.0; (intervals + 1) * stride + layout.limit_rows.len()],
            values: vec![
                0.0;
                action.layout().values(intervals) + limit_entries + 2 * layout.times.len()
            ],
        }
    }
}

/// Instants with the charts of the guess, the start, and the coordinates that the goal gives.
fn given_instants(
    model: &Model,
    boundary: &BoundaryConditions,
    initial: &InitialGuess,
    layout: &Layout,
) -> Vec<Configuration> {
    let map = &model.action.map;
    let unknowns = map.unknowns();
    let mut instants = vec![map.instant(); layout.span.all + 1];
    for (instant, z) in instants.iter_mut().zip(&initial.discrete.z) {
        instant.z[unknowns..].copy_from_slice(&z[unknowns..]);
    }
    for (k, instant) in instants.iter_mut().enumerate() {
        model.prescribe(k as f64 * initial.h, &mut instant.z);
    }
    if !layout.span.is_closed {
        instants[0].z.copy_from_slice(&boundary.start.z);
    }
    boundary
        .goal
        .give(&mut instants[layout.span.end].z, unknowns);
    layout.share(&mut instants, map);
    instants
}

/// Scalars of all intervals; zero where they are unknowns.
fn given_scalars(model: &Model, control: &Control, layout: &Layout) -> Vec<f64> {
    let given = |k: usize| {
        let time = match k == layout.span.end {
            true => control.duration.first(),
            false => control.middle(k),
        };
        let scalars = model.variables.of(Time::Interval).iter();
        scalars.map(move |variable| control.given(variable, time).unwrap_or(0.0))
    };
    (0..layout.span.all).flat_map(given).collect()
}

/// Inputs of all intervals in kV, N and N m, from `count` scalars of each.
fn input_values(
    model: &Model,
    control: &Control,
    scalars: &[f64],
    count: usize,
    intervals: usize,
) -> Vec<f64> {
    let units = model.variables.sources();
    let units: Vec<f64> = units.map(|s| unit_of(model, control, s)).collect();
    let values = (0..intervals).flat_map(|k| {
        let row = &scalars[k * count..(k + 1) * count];
        row.iter().zip(&units).map(|(value, unit)| value / unit)
    });
    values.collect()
}
