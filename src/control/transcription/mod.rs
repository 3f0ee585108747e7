//! The transcription: the discrete equations of motion over a horizon as a nonlinear program (DMOCC).
//!
//! Rows of instant k are `P(q_k)ᵀ [D₂L_d(q_{k−1}, q_k) + D₁L_d(q_k, q_{k+1}) + f⁺ + f⁻] (− h₀ Gᵀλ_k) = 0` with the
//! momentum of the start in row 0 and rest at the goal in row N, constraints where coordinates leave any, then limits.
//! The Jacobian is ∇²Ŝ, the Hessian of the Lagrangian ∇³Ŝ along the costates plus objective and limits, both exact.
//!
//! Rows and multipliers are scaled by magnitudes taken from the Jacobian at the guess, voltages are in V, kV or MV as their
//! bounds suggest, lengths in the length of the system, the interval length in its guess, the objective by a power of a
//! thousand, so that one tolerance means the same everywhere.

mod cost_rows;
mod costs;
pub(super) mod count;
mod energies;
mod energy_rows;
pub(super) mod layout;
mod limit_rows;
mod moved;
mod placed;
mod point;
mod program;
mod scaling;
mod segment;
mod squares;
mod structure;
mod sweep;
mod units;

use crate::control::BoundaryError;
use crate::control::conditions::{BoundaryConditions, Rests};
use crate::control::guess::InitialGuess;
use crate::control::limits::BoundedQuantity;
use crate::control::numbering::{Column, Numbering};
use crate::control::objective::{Cost, objective_scale};
use crate::control::problem::{Control, Duration};
use crate::coordinates::Configuration;
use crate::functional::{Horizon, Part};
use crate::model::{Model, Role, Size, Time};
use crate::nlp::{Bounds, Entries, Nlp};
use cost_rows::{CostRow, cost_rows, costs_size};
use count::overdetermined;
use energy_rows::{EnergyRow, Jump, energies_size, energy_rows};
use layout::Layout;
use limit_rows::LimitRow;
pub(super) use limit_rows::Site;
use placed::Placed;
use segment::Workspace;
use units::{KILOVOLT, MILLISECOND};

/// Number of intervals from which on a horizon is evaluated in two stretches.
const TWO_STRETCHES: usize = 16;

/// An entry of a matrix of the program: where its value is found, and its scale.
#[derive(Clone, Copy, Debug)]
struct Gather {
    place: usize,
    scale: f64,
}

/// A control problem as a nonlinear program.
#[derive(Debug)]
pub struct Transcription<'m> {
    model: &'m Model,
    intervals: usize,
    horizon: Horizon,
    unknowns: Numbering,
    limits: Vec<LimitRow>,
    /// Goals and limits, those that nothing can change included.
    bounded: usize,
    /// First row, instant or interval, of each stretch of limit rows.
    limit_rows: Vec<(usize, usize)>,
    cost: Cost,
    /// Costs of quantities.
    costs: Vec<CostRow>,
    /// Costs of energies.
    energies: Vec<EnergyRow>,
    objective_scale: f64,
    /// Unit of voltages in kV.
    kilovolt: f64,
    momentum: Vec<f64>,
    /// Part of the system that comes to rest at the end.
    rests: Rests,
    /// Bounds of the variables, and of the scaled rows.
    bounds: Bounds,
    row_bounds: Bounds,
    // The point.
    point: Vec<f64>,
    instants: Vec<Configuration>,
    placed: Placed,
    /// Scalars of all intervals.
    scalars: Vec<f64>,
    /// Costates of their equations.
    scalars_along: Vec<f64>,
    /// Voltages of all intervals in kV.
    kilovolts: Vec<f64>,
    h: f64,
    // Scales: value = scale · variable, scaled row = scale · row.
    variable_scales: Vec<f64>,
    row_scales: Vec<f64>,
    // Values and what is kept of them.
    benches: [Workspace; 2],
    /// Instant at which a long horizon is cut in two, and a copy of it.
    middle: Option<usize>,
    halo: Configuration,
    measured: Part,
    /// Factor of the objective in the Hessian.
    sigma: f64,
    /// Step by step the rows of an instant and those of the scalars of an interval, then costates of the limits.
    rows: Vec<f64>,
    values: Vec<f64>,
    jacobian: Vec<Gather>,
    jacobian_entries: Entries,
    hessian: Vec<Gather>,
    hessian_entries: Entries,
    /// The last entries of the Hessian: voltages of neighbouring intervals.
    jumps: Vec<Jump>,
    /// Each voltage of an interval: its place among the scalars, and the slot of its second derivative with itself.
    voltages: Vec<(usize, usize)>,
    gradient: Vec<f64>,
}
impl<'m> Transcription<'m> {
    /// Transcribes a control problem; the guess sets the scales, and the interval length where the duration is free.
    ///
    /// # Errors
    /// There are more equations than unknowns, or it is time to stop.
    pub fn new(
        model: &'m Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
    ) -> Result<Self, BoundaryError> {
        let layout = Layout::new(model, boundary, control, control.intervals);
        match overdetermined(&layout, model, control.intervals) {
            Some(error) => Err(error),
            None => Self::laid_out(model, boundary, control, initial, layout),
        }
    }

    /// Transcribes like [`new`](Self::new), also where there are more equations than unknowns: derivatives exist all the same.
    ///
    /// # Errors
    /// It is time to stop.
    pub fn of_any(
        model: &'m Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
    ) -> Result<Self, BoundaryError> {
        let layout = Layout::new(model, boundary, control, control.intervals);
        Self::laid_out(model, boundary, control, initial, layout)
    }

    fn laid_out(
        model: &'m Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
        layout: Layout,
    ) -> Result<Self, BoundaryError> {
        let motion = &model.action.motion;
        let unknown_count = motion.unknowns();
        let variables = &model.variables;
        let scalar_count = variables.of(Time::Interval).len();
        let intervals = control.intervals;
        let horizon = match control.duration {
            Duration::Given(_) => Horizon::Given,
            Duration::Free { .. } => Horizon::Free,
        };
        let goal = &boundary.goal.coordinates;
        let Layout {
            unknowns,
            limits,
            limit_rows: limit_at,
        } = layout;
        let given = |k: usize| {
            let time = control.middle(k);
            let scalars = variables.of(Time::Interval).iter();
            scalars.map(move |variable| control.given(variable, time).unwrap_or(0.0))
        };
        let scalars: Vec<f64> = (0..intervals).flat_map(given).collect();
        let voltages = variables.range(Role::Voltage);
        let kilovolts = (0..intervals).flat_map(|k| {
            let row = &scalars[k * scalar_count..(k + 1) * scalar_count];
            row[voltages.clone()].iter().map(|v| v / KILOVOLT)
        });
        let kilovolts: Vec<f64> = kilovolts.collect();
        let mut instants = vec![motion.instant(); intervals + 1];
        for (instant, z) in instants.iter_mut().zip(&initial.history.z) {
            instant.z[unknown_count..].copy_from_slice(&z[unknown_count..]);
        }
        instants[0].z.copy_from_slice(&boundary.start.z);
        let charts = instants[intervals].z[unknown_count..].iter_mut();
        charts
            .zip(boundary.goal.charts(unknown_count))
            .for_each(|(value, chart)| *value = *chart);
        for (value, goal) in instants[intervals].z.iter_mut().zip(goal) {
            *value = goal.unwrap_or(*value);
        }
        let kilo = |v: &Vec<f64>| {
            model
                .scalars(v)
                .iter()
                .map(|v| v / KILOVOLT)
                .collect::<Vec<_>>()
        };
        let ends = [
            boundary.rest[0].as_ref().map(kilo),
            boundary.rest[1].as_ref().map(kilo),
        ];
        let cost = Cost::new(&control.objective, voltages.len(), intervals, ends);
        let (paid, energies) = (&control.objective.quantities, &control.objective.energies);
        let duration = intervals as f64 * initial.h * MILLISECOND;
        let layout = model.action.layout();
        let length = model.length();
        let volts = control.voltage_unit(&model.system);
        let scale = |column: &Column| {
            let variable = column.of(variables);
            match variable.role {
                Role::Coordinate if variable.size == Size::Length => length,
                Role::Coordinate | Role::Multiplier => 1.0,
                Role::Voltage | Role::Potential => volts / variable.unit,
                Role::Parameter => model.parameter(variable).size(),
                Role::Duration => initial.h,
            }
        };
        let variable_scales = unknowns.columns.iter().map(scale).collect();
        let limit_count = limit_at.len();
        let extra: usize = limit_at.iter().map(|&(l, _)| limits[l].entries.len()).sum();
        let mut out = Self {
            model,
            intervals,
            horizon,
            limits,
            bounded: boundary.limits.list.len(),
            limit_rows: limit_at,
            objective_scale: objective_scale(
                &control.objective,
                volts / KILOVOLT,
                duration,
                costs_size(model, paid, duration) + energies_size(model, energies, volts),
            ),
            costs: cost_rows(model, paid, boundary.limits.list.len(), intervals),
            energies: energy_rows(model, energies, &boundary.rest, intervals),
            kilovolt: volts / KILOVOLT,
            cost,
            momentum: boundary.start.momentum.clone(),
            rests: boundary.goal.rests,
            bounds: Bounds::default(),
            row_bounds: Bounds::default(),
            point: vec![f64::NAN; unknowns.columns.len()],
            instants,
            placed: Placed::Nothing,
            scalars,
            scalars_along: vec![0.0; intervals * scalar_count],
            h: initial.h,
            variable_scales,
            row_scales: vec![1.0; unknowns.rows.len()],
            benches: [Workspace::new(&model.action), Workspace::new(&model.action)],
            middle: (horizon == Horizon::Given && intervals >= TWO_STRETCHES)
                .then_some(intervals / 2),
            halo: motion.instant(),
            measured: Part::new(motion.vectors.len(), scalar_count, None),
            sigma: 0.0,
            rows: vec![0.0; (intervals + 1) * (unknown_count + scalar_count) + limit_count],
            values: vec![0.0; layout.values(intervals) + extra],
            jacobian: Vec::new(),
            jacobian_entries: Entries::default(),
            hessian: Vec::new(),
            hessian_entries: Entries::default(),
            jumps: Vec::new(),
            gradient: vec![0.0; kilovolts.len()],
            voltages: voltages
                .map(|s| {
                    let slot = layout.scalars.find(s, s);
                    (s, slot.expect("a voltage has a curvature of its own"))
                })
                .collect(),
            kilovolts,
            unknowns,
        };
        out.lay_jacobian()?;
        out.lay_hessian()?;
        out.set_scales(&initial.history, initial.h);
        out.set_bounds(control);
        out.set_row_bounds();
        Ok(out)
    }

    /// Number of intervals N.
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// The model whose motion is looked for.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// Columns and rows.
    pub fn unknowns(&self) -> &Numbering {
        &self.unknowns
    }

    /// The limit or goal of a row.
    pub fn limit(&self, index: usize) -> &BoundedQuantity {
        &self.limits[index].bounded
    }

    /// Returns a value of a limit or goal as shown to users, and its unit.
    pub fn plain(&self, index: usize, value: f64) -> (f64, &'static str) {
        let quantity = &self.limits[index].bounded.quantity;
        quantity.plain(value, &self.model.system)
    }

    /// Scale of a row: scaled row = scale · row.
    pub fn row_scale(&self, row: usize) -> f64 {
        self.row_scales[row]
    }

    /// Largest violation of the scaled rows; infinite where one has no value.
    pub fn violation(&mut self, x: &[f64]) -> f64 {
        let mut g = vec![0.0; self.unknowns.rows.len()];
        self.constraint(x, &mut g);
        self.constraints().violation(&g)
    }
}
