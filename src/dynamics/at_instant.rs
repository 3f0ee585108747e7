//! Momenta and rates at single instants of a motion: at both ends, and at every instant of methods that mean them there.

use crate::coordinates::{Configuration, Interval, Scratch};
use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading};
use crate::dynamics::kinetic::Kinetic;
use crate::dynamics::momenta::{last_momentum, rates};
use crate::functional::Order;
use crate::math::Vector;
use crate::model::Model;

/// The storage to read them.
#[derive(Debug)]
pub(super) struct AtInstant<'m> {
    model: &'m Model,
    /// Made where rates follow from momenta under constraints.
    kinetic: Option<Kinetic<'m>>,
}

impl<'m> AtInstant<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            kinetic: None,
        }
    }

    /// Momentum of each coordinate at instant k, which is placed `here`: as recorded, at the start as the first interval asks for
    /// it, and otherwise that of the last instant.
    pub(super) fn momentum(
        &self,
        discrete: &DiscreteTrajectory,
        k: usize,
        here: &Configuration,
        scratch: &mut Scratch,
    ) -> Vec<f64> {
        let model = self.model;
        if let Some(momentum) = discrete.momenta.get(k) {
            return momentum.clone();
        }
        let n = model.coordinate_count();
        if k > 0 {
            return last_momentum(model, discrete).unwrap_or_else(|| vec![f64::NAN; n]);
        }
        let Some(scalars) = discrete.scalars.first() else {
            return vec![0.0; n];
        };
        let (mut a, mut b) = (here.clone(), here.clone());
        b.z.copy_from_slice(&discrete.z[1]);
        model.action.map.place(&mut b);
        a.forces.fill(Vector::zeros());
        model.action.evaluate_interval(
            Order::Gradient,
            [&mut a, &mut b],
            &Interval::given(scalars, discrete.times[1] - discrete.times[0]),
            scratch,
        );
        model
            .action
            .evaluate_instant(Order::Gradient, &mut a, &[], scratch);
        let mut rows = vec![0.0; model.action.map.unknowns()];
        model.action.rows(&mut a, scratch, &mut rows);
        rows[..n].iter().map(|row| -row).collect()
    }

    /// Rates of the coordinates at instant k, which is placed `here`: as recorded at the start, or those of the momentum that
    /// meet the constraints.
    pub(super) fn rates(
        &mut self,
        discrete: &DiscreteTrajectory,
        k: usize,
        here: &mut Configuration,
        momentum: &[f64],
    ) -> Vec<f64> {
        let model = self.model;
        if let (0, Some(known)) = (k, &discrete.rates) {
            return known.clone();
        }
        if model.prescribed.is_empty() && momentum.iter().all(|p| *p == 0.0) {
            return vec![0.0; momentum.len()];
        }
        let time = discrete.begun + discrete.times[k];
        let is_constrained = model.action.map.multipliers > 0;
        if discrete.reading != Reading::Intervals || is_constrained {
            let kinetic = self.kinetic.get_or_insert_with(|| Kinetic::new(model));
            if let Some(rates) = kinetic.rates(here, time, momentum) {
                return rates;
            }
        }
        rates(model, here, time, momentum)
    }
}
