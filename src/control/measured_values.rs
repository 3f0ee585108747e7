//! Values of the quantities of costs in a motion.

use crate::control::BoundaryConditions;
use crate::control::transcription::Site;
use crate::dynamics::DiscreteTrajectory;
use crate::functional::Sample;
use crate::model::{Model, Quantity};

/// Value and plain unit of the quantity of cost number `index` at instant `k` of a motion, or in the interval before it; none where the model
/// does not measure it.
pub fn measured_value(
    (model, boundary): (&Model, &BoundaryConditions),
    (index, quantity): (usize, &Quantity),
    motion: &DiscreteTrajectory,
    k: usize,
) -> Option<(f64, &'static str)> {
    let place = boundary.limits.quantities().len() + index;
    let (value, h) = value(model, (place, quantity), motion, k)?;
    let quantity = quantity.clone().with_interval(h);
    Some(quantity.plain(value, &model.system))
}

/// The value of measured quantity number `place`, and the length in ms of the interval; 1 of what is measured at instants.
pub(super) fn value(
    model: &Model,
    (place, quantity): (usize, &Quantity),
    motion: &DiscreteTrajectory,
    k: usize,
) -> Option<(f64, f64)> {
    let site = Site::from_quantity(quantity);
    let measure = site.measure(model, (*model.measured.get(place)?)?);
    let first = k.checked_sub(site.sides() - 1)?;
    let [before, here] = [first, k].map(|k| model.action.map.placed(&motion.z[k]));
    let h = match site {
        Site::Instants => 1.0,
        Site::Intervals => motion.times[k] - motion.times[first],
    };
    let scalars = motion.scalars.get(first).map_or(&[][..], Vec::as_slice);
    let sample = Sample {
        vectors: [&before.x, &here.x],
        h,
        ..Sample::of_instant(&before.x, scalars)
    };
    Some((measure.value(&sample), h))
}
