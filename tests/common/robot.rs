//! A robot under voltages, in short steps.

use proboscis::dynamics::{Stepper, rates_of_momentum};
use proboscis::model::Model;

/// The robot.
pub struct Robot<'m> {
    model: &'m Model,
    pub z: Vec<f64>,
    pub momentum: Vec<f64>,
    parts: usize,
}

impl<'m> Robot<'m> {
    /// At rest in the reference configuration; each interval is so many steps.
    pub fn new(model: &'m Model, parts: usize) -> Self {
        Self {
            model,
            z: model.reference_coordinates(),
            momentum: vec![0.0; model.coordinate_count()],
            parts,
        }
    }

    /// Coordinates, then their rates.
    pub fn measure(&self) -> Vec<f64> {
        let rates = rates_of_momentum(self.model, &self.z, 0.0, &self.momentum);
        let n = self.model.coordinate_count();
        self.z[..n].iter().chain(&rates).copied().collect()
    }

    /// An interval of h ms.
    pub fn go(&mut self, h: f64, voltages: &[f64]) {
        let mut stepper = Stepper::new(self.model, &self.z, &self.momentum, Default::default());
        let scalars = self.model.scalars(voltages);
        for _ in 0..self.parts {
            let step = stepper.step(h / self.parts as f64, &scalars);
            step.expect("a step");
        }
        self.z = stepper.coordinates().to_vec();
        self.momentum = stepper.momentum().to_vec();
    }
}
