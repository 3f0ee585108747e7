//! Weights as forces on the vectors.

use crate::coordinates::Interval;
use crate::functional::Order;
use crate::math::Vector;
use crate::model::Model;

/// Weights on the vectors over the time of the multipliers, as rows of rest read them.
pub(super) fn weights(model: &Model) -> Vec<Vector> {
    let map = &model.action.map;
    let instant = map.placed(&vec![0.0; map.unknowns()]);
    let scalars = vec![0.0; model.action.intervals.scalars];
    let interval = Interval::given(&scalars, model.multiplier_time);
    let sample = interval.sample([&instant, &instant]);
    let mut out = model.action.intervals.output(Order::Gradient);
    let terms = model.action.intervals.terms.iter();
    for weight in terms.filter(|term| term.is_weight()) {
        weight.evaluate(Order::Gradient, &sample, &[], &mut out);
    }
    let [here, there] = &out.plain.forces;
    here.iter().zip(there).map(|(a, b)| a + b).collect()
}
