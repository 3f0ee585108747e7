//! One sweep over the horizon: forces, and second derivatives into the values.

use crate::control::transcription::limit_rows::{LimitRow, Site, fill_weights};
use crate::control::transcription::{KILOVOLT, MILLISECOND, Transcription};
use crate::functional::{Frame, Horizon, Level, Measure, Sides};
use crate::math::Vector;

impl<'m> Transcription<'m> {
    pub(super) fn clear_forces(&mut self) {
        for instant in &mut self.instants {
            instant.forces.fill(Vector::zeros());
            instant.contracted.fill(Vector::zeros());
        }
    }

    /// Interval by interval, then instant by instant: forces, and second derivatives into the values.
    pub(super) fn sweep(&mut self, level: Level) {
        let action = &self.model.action;
        let scalar_count = self.model.voltages.len();
        if level >= Level::Hessian {
            self.values.fill(0.0);
        }
        let equations = self.rows.len() - self.limit_rows.len();
        let mut square = 0.0;
        self.scratch.start();
        for k in 0..self.intervals {
            let (left, right) = self.instants.split_at_mut(k + 1);
            let (a, b) = (&mut left[k], &mut right[0]);
            let scalars = &self.scalars[k * scalar_count..(k + 1) * scalar_count];
            fill_weights(
                &mut self.weights[1],
                &self.limits,
                Site::Intervals,
                k,
                &self.rows[equations..],
            );
            let weights = &self.weights[1];
            let scratch = &mut self.scratch;
            action.evaluate_interval(
                level,
                a,
                b,
                scalars,
                self.h,
                self.horizon,
                Sides::ALL,
                weights,
                scratch,
            );
            scratch.carry(level);
            action.pull_back_interval(
                level,
                a,
                b,
                self.horizon,
                Sides::CARRIED,
                k,
                scratch,
                &mut self.values,
            );
            square += scratch.interval.contracted.horizon;
        }
        let last = &self.instants[self.intervals];
        action.pull_back_last(
            level,
            last,
            self.intervals,
            &mut self.scratch,
            &mut self.values,
        );
        for (k, instant) in self.instants.iter_mut().enumerate() {
            fill_weights(
                &mut self.weights[0],
                &self.limits,
                Site::Instants,
                k,
                &self.rows[equations..],
            );
            let weights = &self.weights[0];
            action.evaluate_instant(level, instant, weights, &mut self.scratch);
            action.pull_back_instant(level, instant, k, &mut self.scratch, &mut self.values);
            if level != Level::Third {
                let count = action.motion.unknowns();
                let rows = &mut self.rows[k * count..(k + 1) * count];
                rows.fill(0.0);
                action.rows(instant, &self.scratch, rows);
            }
        }
        if level == Level::Third && self.horizon == Horizon::Free {
            self.values[action.layout().horizon_square_at(self.intervals)] += square;
        }
    }

    /// The frame in which a measure is read at instant or interval k.
    fn frame(&self, site: Site, k: usize) -> Frame<'_> {
        let scalar_count = self.model.voltages.len();
        let next = k + site.sides() - 1;
        Frame {
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
            sides: Sides::ALL,
            weights: &[],
        }
    }

    fn measure(&self, limit: &LimitRow) -> &'m dyn Measure {
        let action = &self.model.action;
        let site = if limit.site == Site::Intervals {
            &action.intervals
        } else {
            &action.instants
        };
        site.measures[limit.measure].as_ref()
    }

    pub(super) fn limit_value(&self, limit: &LimitRow, k: usize) -> f64 {
        self.measure(limit).value(&self.frame(limit.site, k))
    }
}

impl Transcription<'_> {
    /// Gradients of the limits, behind the periodic values.
    pub(super) fn limit_gradients(&mut self) {
        let motion = &self.model.action.motion;
        let mut place = self.model.action.layout().values(self.intervals);
        for index in 0..self.limit_rows.len() {
            let (limit, k) = self.limit_rows[index];
            let measure = self.measure(&self.limits[limit]);
            let site = self.limits[limit].site;
            let mut part = std::mem::take(&mut self.measured);
            measure.gradient(&self.frame(site, k), &mut part.forces, &mut part.rows);
            let sides = site.sides();
            // Rows of the coordinates of one side at a time, in the storage of one instant's rows.
            let count = motion.unknowns();
            let mut at = 0;
            for side in 0..sides {
                let rows = &mut self.rows[..count];
                rows.fill(0.0);
                for &vector in &self.limits[limit].vectors {
                    motion.pull_back_one(
                        vector,
                        &self.instants[k + side].columns,
                        &part.forces[side][vector],
                        rows,
                    );
                }
                while let Some(&(_, i)) = self.limits[limit]
                    .entries
                    .get(at)
                    .filter(|(s, _)| *s == side)
                {
                    self.values[place] = rows[i];
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
        let scalar_count = self.model.voltages.len();
        let tau = self.h * MILLISECOND;
        for k in 0..self.intervals {
            let curvature = sigma * self.cost.curvature(k, tau) / (KILOVOLT * KILOVOLT);
            for s in 0..scalar_count {
                self.values[layout.scalars_at(k) + self.voltage_slots[s]] += curvature;
            }
        }
        if self.horizon == Horizon::Free {
            let square = self.cost.horizon(&self.kilovolts, tau, &mut self.gradient);
            for k in 0..self.intervals {
                let at = layout.horizon_scalars_at(k);
                for s in 0..scalar_count {
                    self.values[at + s] +=
                        sigma * self.gradient[k * scalar_count + s] * MILLISECOND / KILOVOLT;
                }
            }
            self.values[layout.horizon_square_at(self.intervals)] +=
                sigma * square * MILLISECOND * MILLISECOND;
        }
    }
}
