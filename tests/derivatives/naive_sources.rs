//! Naive formulas of what sources do: currents, powers, charges, energies.

use crate::naive_formulas::{Formula, three};
use num_dual::DualNum;
use proboscis::energy::{MeanCharge, SourceCurrent, SourcePower, StoredEnergy};

impl Formula<7> for SourceCurrent {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        let charge = p[3] * self.unit_of_charge;
        let across = charge / self.capacitance.naive(&three(p, 0));
        (p[6] - across) / self.resistance / self.unit
    }
}

impl Formula<7> for MeanCharge {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        let [a, b] = [0, 3].map(|span| self.0.naive(&three(p, span)) * p[6]);
        (a + b) / 2.0
    }
}

impl Formula<4> for StoredEnergy {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        let capacitance = self.0.naive(&three(p, 0));
        (capacitance * p[3]).powi(2) / capacitance / 2.0
    }
}

impl Formula<7> for SourcePower {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        p[6] * self.0.naive(p)
    }
}
