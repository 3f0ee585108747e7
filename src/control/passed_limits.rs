//! Path limits of a problem along a motion of a robot, the one of the problem or another with joints, muscles and markers of the same names.

use crate::control::BoundaryConditions;
use crate::control::limits::{BoundedQuantity, Length, Limits, largest};
use crate::control::problem::Limit;
use crate::control::transcription::Site;
use crate::dynamics::DiscreteTrajectory;
use crate::functional::Sample;
use crate::model::{Analysis, Model, ModelError, Quantity, System, What};

/// A limit beyond which a motion goes, there where it does so most.
#[derive(Clone, Debug, PartialEq)]
pub struct PassedLimit {
    /// Name of the limit.
    pub name: String,
    /// Its value there, and the bound, in their plain unit.
    pub value: f64,
    /// The bound.
    pub bound: f64,
    /// The unit; none of a pure number.
    pub unit: &'static str,
    /// Instant in ms; of what is measured in an interval its end.
    pub time: f64,
    /// Distance to the bound as a part of the larger bound; of a squared quantity that of its square.
    pub part: f64,
}

/// Comparison of a motion with limits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitsAlong {
    /// Names of the limits that were compared.
    pub compared: Vec<String>,
    /// Names of those that cannot be.
    pub left_out: Vec<String>,
    /// Those that are passed, in the order of the problem.
    pub passed: Vec<PassedLimit>,
}

/// Compares a motion of a system in steps of about h ms with limits of another system, at the instants of its steps and in the steps.
///
/// # Errors
/// There is no model of the system that measures them.
pub fn limits_along(
    of: &System,
    limits: &[Limit],
    system: &System,
    analysis: Analysis,
    motion: &DiscreteTrajectory,
) -> Result<LimitsAlong, ModelError> {
    let mut out = LimitsAlong::default();
    let length = Length {
        h: analysis.interval,
        is_free: false,
    };
    let mut own = Vec::new();
    for limit in limits {
        match limit.of_other(of, system) {
            Some(limit) => own.push(limit),
            None => {
                let named = Limits::new(std::slice::from_ref(limit), of, true, length);
                let mut names: Vec<String> = named.list.into_iter().map(|one| one.name).collect();
                names.dedup();
                out.left_out.append(&mut names);
            }
        }
    }
    let list = Limits::new(&own, system, true, length);
    let analysis = Analysis {
        quantities: list.quantities(),
        ..analysis
    };
    let model = Model::for_analysis(system.clone(), analysis)?;
    let mut others = list.list.len()..;
    for (place, bounded) in list.list.iter().enumerate() {
        let before = bounded.other_before().and_then(|_| others.next());
        // Steps of voltages, and what flows with them, are those of the program.
        let is_reaction = matches!(bounded.quantity.what, What::Reaction { .. });
        if bounded.quantity.before().is_some() && !is_reaction {
            if out.left_out.last() != Some(&bounded.name) {
                out.left_out.push(bounded.name.clone());
            }
            continue;
        }
        let along = (0..=motion.intervals()).filter_map(|k| {
            let value = match before {
                None => along(&model, place, bounded, motion, k)?,
                Some(before) => step(&model, [before, place], &bounded.quantity, motion, k)?,
            };
            let beyond = bounded.beyond(value);
            Some((
                k,
                value,
                beyond.map_or((0.0, 0.0), |(bound, excess, _)| (excess, bound)),
            ))
        });
        let worst = along.reduce(|a, b| if b.2.0 > a.2.0 { b } else { a });
        let Some((k, value, (excess, bound))) = worst else {
            continue;
        };
        if out.compared.last() != Some(&bounded.name) {
            out.compared.push(bounded.name.clone());
        }
        if excess > 0.0 {
            let plain = |value: f64| bounded.quantity.plain(value, system);
            let (value, unit) = plain(value);
            out.take(PassedLimit {
                name: bounded.name.clone(),
                value,
                bound: plain(bound).0,
                unit,
                time: motion.times[k],
                part: excess / largest([bounded.lower, bounded.upper]).unwrap_or(0.0),
            });
        }
    }
    Ok(out)
}

/// A value of a bounded quantity at instant k of a motion, or in the interval before it.
fn along(
    model: &Model,
    place: usize,
    bounded: &BoundedQuantity,
    motion: &DiscreteTrajectory,
    k: usize,
) -> Option<f64> {
    // An angle as it has turned, whatever the branch that a measure would take.
    if let (What::Joint { joint, .. }, false) = (&bounded.quantity.what, bounded.quantity.is_step())
        && let Some(own) = model.joint_readings[*joint].coordinate
    {
        return Some(motion.z[k][own]);
    }
    value(model, place, &bounded.quantity, motion, k).map(|(value, _)| value)
}

/// The step from the interval before instant k of a motion to the one after it, by what is measured in both, in its unit.
fn step(
    model: &Model,
    [before, here]: [usize; 2],
    quantity: &Quantity,
    motion: &DiscreteTrajectory,
    k: usize,
) -> Option<f64> {
    if k == 0 || k == motion.intervals() {
        return None;
    }
    let at = |place: usize, k: usize| Some(value(model, place, quantity, motion, k)?.0);
    Some((at(here, k + 1)? - at(before, k)?) / quantity.step_unit())
}

impl LimitsAlong {
    /// Takes a limit that is passed, unless one of its name is passed farther.
    fn take(&mut self, passed: PassedLimit) {
        let mut same = self.passed.iter_mut();
        match same.find(|known| known.name == passed.name) {
            None => self.passed.push(passed),
            Some(known) if passed.part > known.part => *known = passed,
            Some(_) => {}
        }
    }
}

/// Value and plain unit of the quantity of cost number `index` at instant `k` of a motion, or in the interval before it; none where the model
/// does not measure it.
pub fn measured_value(
    model: &Model,
    boundary: &BoundaryConditions,
    index: usize,
    quantity: &Quantity,
    motion: &DiscreteTrajectory,
    k: usize,
) -> Option<(f64, &'static str)> {
    let place = boundary.limits.quantities().len() + index;
    let (value, h) = value(model, place, quantity, motion, k)?;
    let quantity = quantity.clone().with_interval(h);
    Some(quantity.plain(value, &model.system))
}

/// The value of measured quantity number `place`, and the length in ms of the interval; 1 of what is measured at instants.
pub(super) fn value(
    model: &Model,
    place: usize,
    quantity: &Quantity,
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
