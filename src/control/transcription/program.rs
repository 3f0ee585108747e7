//! What the solver asks.

use crate::control::limits::{BoundedQuantity, When};
use crate::control::numbering::{Row, Variable};
use crate::control::transcription::{KILOVOLT, MILLISECOND, Transcription};
use crate::functional::Order;
use crate::nlp::{Bounds, Entries, Nlp};

impl Nlp for Transcription<'_> {
    fn variables(&self) -> Bounds {
        self.bounds.clone()
    }

    fn constraints(&self) -> Bounds {
        let bound = |row: &Row| match *row {
            Row::Equation { .. } | Row::Gauss { .. } => (0.0, 0.0),
            Row::Limit { limit, .. } => {
                let limit = &self.limits[limit];
                let bounded = &limit.bounded;
                (bounded.lower * limit.scale, bounded.upper * limit.scale)
            }
        };
        let (lower, upper) = self.unknowns.rows.iter().map(bound).unzip();
        Bounds { lower, upper }
    }

    fn jacobian_structure(&self) -> Entries {
        self.jacobian_entries.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.hessian_entries.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.load(x);
        self.cost.value(&self.kilovolts, self.h * MILLISECOND)
    }

    fn objective_scale(&self) -> f64 {
        self.objective_scale
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.load(x);
        let by_horizon =
            self.cost
                .gradient(&self.kilovolts, self.h * MILLISECOND, &mut self.gradient);
        let driven = self.model.voltages.len();
        for ((variable, scale), g) in self
            .unknowns
            .variables
            .iter()
            .zip(&self.variable_scales)
            .zip(grad)
        {
            *g = match *variable {
                Variable::Scalar { k, s } if s < driven => {
                    self.gradient[k * driven + s] * scale / KILOVOLT
                }
                Variable::Horizon => by_horizon * MILLISECOND * scale,
                Variable::Scalar { .. } | Variable::Unknown { .. } => 0.0,
            };
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.load(x);
        self.sweep(Order::Gradient);
        let stride = self.stride();
        let (count, driven) = (
            self.model.action.motion.unknowns(),
            self.model.voltages.len(),
        );
        for (value, (row, scale)) in g
            .iter_mut()
            .zip(self.unknowns.rows.iter().zip(&self.row_scales))
        {
            *value = scale
                * match *row {
                    Row::Equation { k, i } => {
                        let start = if k == 0 && i < self.momentum.len() {
                            self.momentum[i]
                        } else {
                            0.0
                        };
                        self.rows[k * stride + i] + start
                    }
                    Row::Gauss { k, s } => self.rows[k * stride + count + s - driven],
                    Row::Limit { limit, k } => self.limit_value(&self.limits[limit], k),
                };
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.load(x);
        self.sweep(Order::Hessian);
        self.limit_gradients();
        for (value, kept) in values.iter_mut().zip(&self.jacobian) {
            *value = kept.scale * self.values[kept.place];
        }
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        self.load(x);
        for instant in &mut self.instants {
            instant.l.fill(0.0);
        }
        self.rows.fill(0.0);
        self.scalars_along.fill(0.0);
        let count = self.model.action.layout().interval_scalars;
        let total = self.rows.len() - self.limit_rows.len();
        let first = self.unknowns.rows.len() - self.limit_rows.len();
        for (r, (row, y)) in self.unknowns.rows.iter().zip(costates).enumerate() {
            let y = y * self.row_scales[r];
            match *row {
                Row::Equation { k, i } => self.instants[k].l[i] = y,
                Row::Gauss { k, s } => self.scalars_along[k * count + s] = y,
                Row::Limit { .. } => self.rows[total + r - first] = y,
            }
        }
        self.sweep(Order::Third);
        self.objective_curvature(sigma);
        let tau = self.h * MILLISECOND;
        let (own, coupling) = values.split_at_mut(self.hessian.len());
        for (value, kept) in own.iter_mut().zip(&self.hessian) {
            *value = kept.scale * self.values[kept.place];
        }
        coupling.fill(sigma * self.cost.coupling(tau) * self.kilovolt * self.kilovolt);
    }

    fn variable_name(&self, i: usize) -> String {
        match self.unknowns.variables[i] {
            Variable::Unknown { k, i } => format!("{} at instant {k}", self.model.unknown_name(i)),
            Variable::Scalar { k, s } => match s.checked_sub(self.model.voltages.len()) {
                None => {
                    let source = &self.model.sources[self.model.voltages[s]];
                    format!("voltage of {} in interval {k}", source.name)
                }
                Some(p) => format!(
                    "potential of {} in interval {k}",
                    self.model.potential_names[p]
                ),
            },
            Variable::Horizon => "interval length".to_owned(),
        }
    }

    fn constraint_name(&self, i: usize) -> String {
        let n = self.model.coordinate_count();
        match self.unknowns.rows[i] {
            Row::Equation { k, i } if i < n && k == self.intervals => {
                format!("rest at the goal, {}", self.model.unknown_name(i))
            }
            Row::Equation { k, i } if i < n => {
                format!("motion at instant {k}, {}", self.model.unknown_name(i))
            }
            Row::Equation { k, i } => format!(
                "constraint {} at instant {k}",
                self.model.multiplier_names[i - n]
            ),
            Row::Gauss { k, s } => format!(
                "Gauss's law of {} in interval {k}",
                self.model.potential_names[s - self.model.voltages.len()]
            ),
            Row::Limit { limit, k } => {
                let BoundedQuantity {
                    name,
                    quantity,
                    when: place,
                    ..
                } = self.limit(limit);
                match place {
                    When::Goal => name.clone(),
                    When::Everywhere => format!("{name} {} {k}", quantity.when()),
                }
            }
        }
    }
}
