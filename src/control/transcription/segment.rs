//! A stretch of the horizon: neighbouring intervals that one thread evaluates.
//!
//! A stretch owns its instants up to the last, which begins the next stretch; of that it has a copy, whose forces and
//! carried blocks are added when both are done. Where stretches meet depends on the number of intervals only, so results
//! are the same for any number of threads.
//!
//! State of the kinematics of a horizon: the quantities known at its instants.

use crate::control::transcription::cost_rows::{CostRow, EnergyRow, fill_costs, fill_energies};
use crate::control::transcription::limit_rows::{LimitRow, Site, fill_limits};
use crate::coordinates::{Configuration, Reduced, Scratch};
use crate::functional::{BlockMask, Horizon, Order, Outer, Sample};
use crate::math::Vector;
use crate::stop::TimeLimit;

/// Data that all stretches read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared<'a> {
    pub(super) action: &'a Reduced,
    pub(super) limits: &'a [LimitRow],
    pub(super) costs: &'a [CostRow],
    pub(super) energies: &'a [EnergyRow],
    /// Factor of the costs.
    pub(super) sigma: f64,
    /// Costates of the limits.
    pub(super) costates: &'a [f64],
    /// Scalars of all intervals.
    pub(super) scalars: &'a [f64],
    /// Costates of their equations.
    pub(super) along: &'a [f64],
    /// Rows of one step: of the instant, then of the scalars.
    pub(super) stride: usize,
    pub(super) h: f64,
    pub(super) horizon: Horizon,
    pub(super) sides: BlockMask,
    pub(super) placed: Placed,
    pub(super) order: Order,
    /// Until when intervals are evaluated.
    pub(super) limit: Option<&'a TimeLimit>,
}

/// Storage of one thread.
#[derive(Clone, Debug)]
pub(super) struct SegmentWorkspace {
    pub(super) scratch: Scratch,
    /// Functions of the measures of instants and intervals.
    outer: [Vec<Outer>; 2],
}

/// The intervals from `first` on, one for each of the instants.
#[derive(Debug)]
pub(super) struct Segment<'a> {
    pub(super) shared: Shared<'a>,
    pub(super) first: usize,
    pub(super) instants: &'a mut [Configuration],
    /// The instant after the last interval.
    pub(super) end: &'a mut Configuration,
    pub(super) workspace: &'a mut SegmentWorkspace,
    /// Values of the steps from `first` on.
    pub(super) values: &'a mut [f64],
    /// Rows of the steps from `first` on.
    pub(super) rows: &'a mut [f64],
}

/// Returns the quantities of an instant that an order of derivatives needs.
pub(super) fn needed(order: Order) -> Placed {
    match order {
        Order::Gradient => Placed::Vectors,
        Order::Hessian | Order::Third => Placed::Columns,
    }
}

impl SegmentWorkspace {
    pub(super) fn new(action: &Reduced) -> Self {
        let outer = |measures: usize| vec![Outer::default(); measures];
        Self {
            scratch: action.scratch(Order::Third),
            outer: [
                outer(action.instants.measures.len()),
                outer(action.intervals.measures.len()),
            ],
        }
    }
}

impl Segment<'_> {
    /// Forces of the intervals, and second derivatives into the values; instants too, but the first where another
    /// stretch comes before. Returns ∂²/∂h² along the costates.
    pub(super) fn run(mut self) -> f64 {
        self.workspace.scratch.start();
        self.prepare(0);
        let mut square = 0.0;
        for j in 0..self.instants.len() {
            // What is not evaluated any more is not used either.
            if self.shared.limit.and_then(TimeLimit::reached).is_some() {
                break;
            }
            self.prepare(j + 1);
            square += self.interval(j);
            if self.first + j > 0 && j == 0 {
                continue;
            }
            let (instant, k) = (&mut self.instants[j], self.first + j);
            instant_of(
                self.shared,
                instant,
                [k, j],
                self.workspace,
                self.values,
                self.rows,
            );
        }
        square
    }

    /// Places an instant as far as the order needs it, and clears the sums.
    fn prepare(&mut self, j: usize) {
        let Shared {
            action,
            order,
            placed,
            ..
        } = self.shared;
        let segment = action.layout().same_at(j)..action.layout().same_at(j + 1);
        if order >= Order::Hessian && segment.end <= self.values.len() {
            self.values[segment].fill(0.0);
        }
        let map = &action.map;
        let instant = self.instants.get_mut(j).unwrap_or(self.end);
        if placed < Placed::Vectors {
            map.vectors(instant);
        }
        if placed < needed(order) && needed(order) == Placed::Columns {
            map.tangent(instant);
        }
        instant.forces.fill(Vector::zeros());
        if order == Order::Third {
            instant.contracted.fill(Vector::zeros());
            map.along(instant);
        }
    }

    fn interval(&mut self, j: usize) -> f64 {
        let Shared {
            action,
            order,
            horizon,
            sides,
            h,
            stride,
            ..
        } = self.shared;
        let (left, right) = self.instants.split_at_mut(j + 1);
        let (a, b) = (&mut left[j], right.first_mut().unwrap_or(self.end));
        let k = self.first + j;
        let count = action.intervals.scalars;
        let of_step = k * count..(k + 1) * count;
        let SegmentWorkspace {
            scratch,
            outer: [_, outer],
        } = &mut *self.workspace;
        let site = Site::Intervals;
        fill_limits(outer, self.shared.limits, site, k, self.shared.costates);
        let plain = Sample {
            scalars_along: &self.shared.along[of_step.clone()],
            horizon,
            sides,
            ..Sample::of_interval(&self.shared.scalars[of_step], h)
        };
        if order == Order::Third {
            let (costs, sigma) = (self.shared.costs, self.shared.sigma);
            let sample = plain.between([a, b]);
            fill_costs(outer, costs, site, k, sigma, action, &sample);
        }
        let interval = Sample { outer, ..plain };
        action.evaluate_interval(order, [a, b], &interval, scratch);
        if order == Order::Gradient {
            let rows = &mut self.rows[j * stride + action.map.unknowns()..(j + 1) * stride];
            rows.copy_from_slice(&scratch.interval.plain.rows);
        }
        scratch.carry(order);
        let carried = Sample {
            sides: BlockMask::CARRIED,
            ..interval
        };
        action.pull_back_interval(order, [a, b], &carried, j, scratch, self.values);
        scratch.interval.contracted.horizon
    }
}

/// Instant k, whose forces are complete; its values and rows are those of step j.
pub(super) fn instant_of(
    shared: Shared<'_>,
    instant: &mut Configuration,
    [k, j]: [usize; 2],
    workspace: &mut SegmentWorkspace,
    values: &mut [f64],
    rows: &mut [f64],
) {
    let Shared { action, order, .. } = shared;
    let SegmentWorkspace {
        scratch,
        outer: [outer, _],
    } = workspace;
    let site = Site::Instants;
    fill_limits(outer, shared.limits, site, k, shared.costates);
    if order == Order::Third {
        let sample = Sample {
            h: shared.h,
            ..Sample::of_instant(&instant.x, &[])
        };
        let (sigma, count) = (shared.sigma, action.layout().interval_scalars);
        fill_costs(outer, shared.costs, site, k, sigma, action, &sample);
        fill_energies(outer, shared.energies, k, sigma, shared.scalars, count);
    }
    action.evaluate_instant(order, instant, outer, scratch);
    action.pull_back_instant(order, instant, j, scratch, values);
    if order == Order::Gradient {
        let count = action.map.unknowns();
        let rows = &mut rows[j * shared.stride..j * shared.stride + count];
        rows.fill(0.0);
        action.rows(instant, scratch, rows);
    }
}

/// Quantities known at the instants for the present point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Placed {
    /// Coordinates only.
    Nothing,
    /// Vectors.
    Vectors,
    /// Vectors and columns of P.
    Columns,
}
