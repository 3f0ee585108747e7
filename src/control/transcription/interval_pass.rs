//! One sweep over the horizon: forces, and second derivatives into the values.

use crate::control::transcription::Transcription;
use crate::control::transcription::cost_rows::MILLISECOND;
use crate::control::transcription::limit_rows::Site;
use crate::control::transcription::segment::{
    Placed, Segment, SegmentWorkspace, Shared, instant_of, needed,
};
use crate::coordinates::{Configuration, Reduced};
use crate::functional::{BlockMask, Horizon, Order, Sample};
use crate::math::{Vector, join_if};
use crate::stop;

/// Second derivatives of a horizon from which on its stretches are evaluated at once: with fewer, a second core saves less than it
/// costs to wake it and to read what it wrote.
const MUCH: usize = 8_000;

/// One pass over the horizon.
struct Pass<'a> {
    shared: Shared<'a>,
    instants: &'a mut [Configuration],
    boundary_instant: &'a mut Configuration,
    stretches: &'a mut [SegmentWorkspace; 2],
    values: &'a mut [f64],
    rows: &'a mut [f64],
}

impl Pass<'_> {
    /// All intervals at once. Returns ∂²/∂h² along the costates.
    fn run(&mut self) -> f64 {
        let (end, instants) = self
            .instants
            .split_last_mut()
            .expect("a horizon has instants");
        Segment {
            shared: self.shared,
            first: 0,
            instants,
            end,
            workspace: &mut self.stretches[0],
            values: self.values,
            rows: self.rows,
        }
        .run()
    }

    /// The intervals before and after the middle, each by a thread, and the instant where they meet.
    fn run_in_two(&mut self, middle: usize) {
        let Shared { action, stride, .. } = self.shared;
        let last = self.instants.len() - 1;
        self.boundary_instant
            .z
            .copy_from_slice(&self.instants[middle].z);
        self.boundary_instant
            .l
            .copy_from_slice(&self.instants[middle].l);
        let [first, second] = &mut *self.stretches;
        let (left, right) = self.instants.split_at_mut(middle);
        let (end, right) = right.split_last_mut().expect("a stretch has an end");
        let (values_left, values_right) = self.values.split_at_mut(action.layout().same_at(middle));
        let (rows_left, rows_right) = self.rows.split_at_mut(middle * stride);
        let left = Segment {
            shared: self.shared,
            first: 0,
            instants: left,
            end: self.boundary_instant,
            workspace: first,
            values: values_left,
            rows: rows_left,
        };
        let right = Segment {
            shared: self.shared,
            first: middle,
            instants: right,
            end,
            workspace: second,
            values: values_right,
            rows: rows_right,
        };
        let are_much = action.layout().values(last) >= MUCH;
        join_if(are_much, || left.run(), || right.run());
        let instant = &mut self.instants[middle];
        let add = |sum: &mut [Vector], list: &[Vector]| {
            sum.iter_mut().zip(list).for_each(|(s, v)| *s += v);
        };
        add(&mut instant.forces, &self.boundary_instant.forces);
        add(&mut instant.contracted, &self.boundary_instant.contracted);
        self.complete(middle, 0);
    }

    /// Adds the blocks that a stretch carries to its last instant, and evaluates that instant.
    fn complete(&mut self, k: usize, stretch: usize) {
        let Shared { action, order, .. } = self.shared;
        let workspace = &mut self.stretches[stretch];
        let instant = &mut self.instants[k];
        action.pull_back_last(order, instant, k, &mut workspace.scratch, self.values);
        instant_of(
            self.shared,
            instant,
            [k, k],
            workspace,
            self.values,
            self.rows,
        );
    }
}

/// Number of rows of a step: of an instant, then of the scalars of an interval.
fn stride(action: &Reduced) -> usize {
    action.map.unknowns() + action.intervals.scalars
}

impl<'m> Transcription<'m> {
    /// Number of rows of a step: of an instant, then of the scalars of an interval.
    pub(super) fn stride(&self) -> usize {
        stride(&self.model.action)
    }

    /// Instant by instant and interval by interval, each while it is in the cache: forces, and second derivatives into
    /// the values. Contracted derivatives are taken along the costates in the instants.
    pub(super) fn sweep(&mut self, order: Order) {
        let Self {
            model,
            layout,
            objective,
            sides,
            workspace,
            ..
        } = self;
        let (action, last) = (&model.action, layout.span.all);
        let stride = stride(action);
        let (rows, costates) = workspace.rows.split_at_mut((last + 1) * stride);
        let limit = stop::limit();
        let mut pass = Pass {
            shared: Shared {
                action,
                limits: &layout.limits,
                costs: &objective.quantities,
                energies: &objective.energies,
                sigma: workspace.sigma,
                costates,
                scalars: &workspace.scalars,
                along: &workspace.scalars_along,
                stride,
                h: workspace.h,
                horizon: layout.horizon,
                sides: *sides,
                placed: workspace.placed,
                order,
                limit: limit.as_ref(),
            },
            instants: &mut workspace.instants,
            boundary_instant: &mut workspace.boundary_instant,
            stretches: &mut workspace.stretches,
            values: &mut workspace.values,
            rows,
        };
        let square = match layout.middle() {
            Some(middle) => {
                pass.run_in_two(middle);
                pass.complete(last, 1);
                0.0
            }
            None => {
                let square = pass.run();
                pass.complete(last, 0);
                square
            }
        };
        if order == Order::Third && layout.horizon == Horizon::Free {
            workspace.values[action.layout().horizon_square_at(last)] = square;
        }
        // A sweep that was stopped has placed some instants only.
        workspace.placed = match stop::reason() {
            Some(_) => Placed::Nothing,
            None => workspace.placed.max(needed(order)),
        };
    }

    /// The frame in which a measure is read at instant or interval k.
    pub(super) fn sample(&self, site: Site, k: usize) -> Sample<'_> {
        let scalar_count = self.model.action.layout().interval_scalars;
        let next = k + site.sides() - 1;
        let instants = [k, next].map(|k| &self.workspace.instants[k]);
        Sample {
            vectors: instants.map(|instant| &instant.x[..]),
            along: instants.map(|instant| &instant.w[..]),
            scalars: if site == Site::Intervals {
                &self.workspace.scalars[k * scalar_count..(k + 1) * scalar_count]
            } else {
                &[]
            },
            scalars_along: &[],
            h: self.workspace.h,
            horizon: Horizon::Given,
            sides: BlockMask::ALL,
            outer: &[],
        }
    }
}

impl Transcription<'_> {
    /// Adds σ∇²f to the values.
    pub(super) fn objective_curvature(&mut self, sigma: f64) {
        let pattern = self.model.action.layout();
        let tau = self.workspace.h * MILLISECOND;
        for k in 0..self.layout.span.all {
            let curvature = sigma * self.objective.cost.curvature(k, tau);
            for input in &self.objective.inputs {
                self.workspace.values[pattern.scalars_at(k) + input.slot] +=
                    curvature / (input.unit * input.unit);
            }
        }
        if self.layout.horizon == Horizon::Free {
            let square = self.objective.cost.horizon(
                &self.workspace.inputs,
                tau,
                &mut self.workspace.gradient,
            );
            let mut gradient = self.workspace.gradient.iter();
            for k in 0..self.layout.span.all {
                let at = pattern.horizon_scalars_at(k);
                for (input, slope) in self.objective.inputs.iter().zip(&mut gradient) {
                    self.workspace.values[at + input.scalar] +=
                        sigma * slope * MILLISECOND / input.unit;
                }
            }
            self.workspace.values[pattern.horizon_square_at(self.layout.span.all)] +=
                sigma * square * MILLISECOND * MILLISECOND;
            self.cost_border(sigma);
        }
    }
}
