//! One sweep over the horizon: forces, and second derivatives into the values.

use crate::control::transcription::limit_rows::{LimitRow, Site};
use crate::control::transcription::placed::Placed;
use crate::control::transcription::segment::{Segment, Shared, instant_of, needed};
use crate::control::transcription::{KILOVOLT, MILLISECOND, Transcription};
use crate::functional::{BlockMask, Horizon, Measure, Order, Sample};
use crate::ipopt::interrupt;
use crate::math::{Vector, both};

/// Second derivatives of a horizon from which on its stretches are evaluated at once: with fewer, a second core saves less than it
/// costs to wake it and to read what it wrote.
const MUCH: usize = 8_000;

impl<'m> Transcription<'m> {
    /// Number of rows of a step: of an instant, then of the scalars of an interval.
    pub(super) fn stride(&self) -> usize {
        self.model.action.motion.unknowns() + self.model.action.intervals.scalars
    }

    /// Instant by instant and interval by interval, each while it is in the cache: forces, and second derivatives into
    /// the values. Contracted derivatives are taken along the costates in the instants.
    pub(super) fn sweep(&mut self, order: Order) {
        let (action, last) = (&self.model.action, self.intervals);
        let (layout, stride) = (action.layout(), self.stride());
        let (rows, costates) = self.rows.split_at_mut((last + 1) * stride);
        let limit = interrupt::limit();
        let shared = Shared {
            action,
            limits: &self.limits,
            costs: &self.costs,
            energies: &self.energies,
            sigma: self.sigma,
            costates,
            scalars: &self.scalars,
            along: &self.scalars_along,
            stride,
            h: self.h,
            horizon: self.horizon,
            placed: self.placed,
            order,
            limit: limit.as_ref(),
        };
        let [bench, second] = &mut self.benches;
        let values = &mut self.values;
        let mut square = 0.0;
        if let Some(middle) = self.middle {
            let halo = &mut self.halo;
            halo.z.copy_from_slice(&self.instants[middle].z);
            halo.l.copy_from_slice(&self.instants[middle].l);
            let (left, right) = self.instants.split_at_mut(middle);
            let (end, right) = right.split_last_mut().expect("a stretch has an end");
            let (values_left, values_right) = values.split_at_mut(layout.same_at(middle));
            let (rows_left, rows_right) = rows.split_at_mut(middle * stride);
            let left = Segment {
                shared,
                first: 0,
                instants: left,
                end: halo,
                bench,
                values: values_left,
                rows: rows_left,
            };
            let right = Segment {
                shared,
                first: middle,
                instants: right,
                end,
                bench: second,
                values: values_right,
                rows: rows_right,
            };
            let are_much = layout.values(last) >= MUCH;
            both(are_much, || left.run(), || right.run());
            let instant = &mut self.instants[middle];
            let add = |sum: &mut [Vector], list: &[Vector]| {
                sum.iter_mut().zip(list).for_each(|(s, v)| *s += v);
            };
            add(&mut instant.forces, &self.halo.forces);
            add(&mut instant.contracted, &self.halo.contracted);
            action.pull_back_last(order, instant, middle, &mut self.benches[0].scratch, values);
            instant_of(
                shared,
                instant,
                [middle; 2],
                &mut self.benches[0],
                values,
                rows,
            );
        } else {
            let (end, instants) = self
                .instants
                .split_last_mut()
                .expect("a horizon has instants");
            square = Segment {
                shared,
                first: 0,
                instants,
                end,
                bench,
                values,
                rows,
            }
            .run();
        }
        let bench = &mut self.benches[usize::from(self.middle.is_some())];
        action.pull_back_last(
            order,
            &self.instants[last],
            last,
            &mut bench.scratch,
            values,
        );
        instant_of(
            shared,
            &mut self.instants[last],
            [last; 2],
            bench,
            values,
            rows,
        );
        if order == Order::Third && self.horizon == Horizon::Free {
            values[layout.horizon_square_at(last)] = square;
        }
        // A sweep that was stopped has placed some instants only.
        self.placed = match interrupt::stop() {
            Some(_) => Placed::Nothing,
            None => self.placed.max(needed(order)),
        };
    }

    /// The frame in which a measure is read at instant or interval k.
    pub(super) fn sample(&self, site: Site, k: usize) -> Sample<'_> {
        let scalar_count = self.model.action.layout().interval_scalars;
        let next = k + site.sides() - 1;
        Sample {
            vectors: [&self.instants[k].x, &self.instants[next].x],
            along: [&self.instants[k].w, &self.instants[next].w],
            scalars: if site == Site::Intervals {
                &self.scalars[k * scalar_count..(k + 1) * scalar_count]
            } else {
                &[]
            },
            scalars_along: &[],
            h: self.h,
            horizon: Horizon::Given,
            sides: BlockMask::ALL,
            outer: &[],
        }
    }

    fn measure(&self, limit: &LimitRow) -> &'m dyn Measure {
        limit.site.measure(self.model, limit.measure)
    }

    pub(super) fn limit_value(&self, limit: &LimitRow, k: usize) -> f64 {
        self.measure(limit).value(&self.sample(limit.site, k))
    }
}

impl Transcription<'_> {
    /// Gradients of the limits, behind the periodic values.
    pub(super) fn limit_gradients(&mut self) {
        let motion = &self.model.action.motion;
        let mut place = self.model.action.layout().values(self.intervals);
        self.rows[..motion.unknowns()].fill(0.0);
        for index in 0..self.limit_rows.len() {
            let (limit, k) = self.limit_rows[index];
            let measure = self.measure(&self.limits[limit]);
            let site = self.limits[limit].site;
            let mut part = std::mem::take(&mut self.measured);
            measure.gradient(&self.sample(site, k), &mut part.forces, &mut part.rows);
            // Rows of the coordinates of one side at a time, in the storage of one instant's rows.
            let mut at = 0;
            for side in (0..site.sides()).filter(|&side| measure.reads(side)) {
                for &vector in &self.limits[limit].vectors {
                    motion.pull_back_one(
                        vector,
                        &self.instants[k + side].columns,
                        &part.forces[side][vector],
                        &mut self.rows,
                    );
                }
                while let Some(&(_, i)) = self.limits[limit]
                    .entries
                    .get(at)
                    .filter(|(s, _)| *s == side)
                {
                    self.values[place] = std::mem::take(&mut self.rows[i]);
                    (at, place) = (at + 1, place + 1);
                }
            }
            for &(_, s) in &self.limits[limit].entries[at..] {
                self.values[place] = part.rows[s];
                place += 1;
            }
            for &vector in &self.limits[limit].vectors {
                for side in &mut part.forces {
                    side[vector] = Vector::zeros();
                }
            }
            part.rows.fill(0.0);
            self.measured = part;
        }
    }

    /// Adds σ∇²f to the values.
    pub(super) fn objective_curvature(&mut self, sigma: f64) {
        let layout = self.model.action.layout();
        let tau = self.h * MILLISECOND;
        for k in 0..self.intervals {
            let curvature = sigma * self.cost.curvature(k, tau) / (KILOVOLT * KILOVOLT);
            for &(_, slot) in &self.voltages {
                self.values[layout.scalars_at(k) + slot] += curvature;
            }
        }
        if self.horizon == Horizon::Free {
            let square = self.cost.horizon(&self.kilovolts, tau, &mut self.gradient);
            let mut gradient = self.gradient.iter();
            for k in 0..self.intervals {
                let at = layout.horizon_scalars_at(k);
                for (&(s, _), slope) in self.voltages.iter().zip(&mut gradient) {
                    self.values[at + s] += sigma * slope * MILLISECOND / KILOVOLT;
                }
            }
            self.values[layout.horizon_square_at(self.intervals)] +=
                sigma * square * MILLISECOND * MILLISECOND;
            self.cost_border(sigma);
        }
    }
}
