//! Limits at start and goal: values known before the solve keep them, or are refused by name.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::error::BoundaryError;
use crate::control::goal::{Place, instant_at};
use crate::control::limits::{BoundedQuantity, When};
use crate::control::problem::{BoundaryState, Control, Limit};
use crate::control::transcription::Site;
use crate::coordinates::Configuration;
use crate::dynamics::muscle_beyond_law;
use crate::energy::{Energy, OutsideBox, SquaredDistance};
use crate::functional::Sample;
use crate::math::{Local, significant};
use crate::model::{Model, Of, Quantity, Region, Role, Time, What};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Refuses limits that contradict each other, and a start or goal of which it is known that it breaks a limit. `scalars` are voltages and potentials of states of
/// rest at start and goal.
pub(super) fn check(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    scalars: [Option<Vec<f64>>; 2],
) -> Result<(), BoundaryError> {
    let mut limits = control.limits.iter();
    let beyond = || limits.find_map(|limit| beyond_law(model, limit));
    let unknown = || unknown_reaction(model, boundary);
    let reason = contradiction(model, boundary, control).or_else(beyond);
    if let Some(reason) = reason.or_else(unknown) {
        return Err(BoundaryError::refused("limits", reason));
    }
    given_amounts(model, boundary, control)?;
    let known = [
        control.knows_start(),
        control.goal != BoundaryState::Periodic,
    ];
    let [is_start, is_goal] = [0, 1].map(|end| known[end] && !boundary.sought_rest[end]);
    let start = boundary.start.z.iter();
    let start: Vec<_> = start.map(|value| is_start.then_some(*value)).collect();
    let goal = &boundary.goal.coordinates;
    let [at_start, at_goal] = scalars;
    let (at_start, at_goal) = (at_start.filter(|_| is_start), at_goal.filter(|_| is_goal));
    let first = model.action.map.unknowns();
    let charts = [&boundary.start.z[first..], boundary.goal.charts(first)];
    let ends = [
        ("start", &start, charts[0], at_start, &control.start),
        ("goal", goal, charts[1], at_goal, &control.goal),
    ];
    for (place, coordinates, charts, scalars, state) in ends {
        let time = match place {
            "start" => control.middle(0),
            _ => control.middle(control.intervals - 1),
        };
        let mut end = End::new(model, control, time, coordinates, charts, scalars);
        end.is_at_rest = matches!(state, BoundaryState::RestAtVoltages(..));
        match state {
            _ if !known[usize::from(place == "goal")] => {}
            BoundaryState::JointAngles { angles, .. } => end.angles = angles.clone(),
            BoundaryState::Markers { places, .. } => end.places = places.clone(),
            BoundaryState::RestAtVoltages(..)
            | BoundaryState::EndOf(_)
            | BoundaryState::Free
            | BoundaryState::Periodic => {}
        }
        let is_goal = place == "goal";
        let is_there =
            |part: f64| is_goal && instant_at(part, control.intervals) == control.intervals;
        let mut limits = control.limits.iter();
        let of_joints = limits.find_map(|limit| match limit.part.is_none_or(is_there) {
            true => end.joint(limit),
            false => None,
        });
        let bounded = || {
            let list = boundary.limits.list.iter().zip(&model.measured);
            let is_of_path = |bounded: &BoundedQuantity| {
                let is_of_rate = is_of_rate(bounded);
                let is_then = match bounded.when {
                    When::Everywhere => true,
                    When::Goal => is_goal,
                    When::At(part) => is_there(part),
                    When::Never => false,
                };
                let is_here =
                    bounded.when == When::Everywhere || !bounded.quantity.is_of_intervals();
                is_then && is_here && !is_of_rate
            };
            let paths = list.filter(|(bounded, _)| is_of_path(bounded));
            let mut values = paths.map(|(b, m)| (b, end.value(b, *m)));
            values.find_map(|(b, value)| b.broken(value?, &model.system))
        };
        if let Some(reason) = of_joints.or_else(bounded) {
            return Err(BoundaryError::refused(place, reason));
        }
    }
    Ok(())
}

/// True for rates and for differences between neighbouring intervals.
fn is_of_rate(bounded: &BoundedQuantity) -> bool {
    let quantity = &bounded.quantity;
    let is_place = matches!(quantity.what, What::Place { .. });
    let is_mean = matches!(quantity.what, What::Speed(_)) || (quantity.is_step() && !is_place);
    is_mean || bounded.rate.is_some() || quantity.before().is_some()
}

/// Known values of a start or goal.
struct End<'a> {
    model: &'a Model,
    instant: Configuration,
    /// For each coordinate, true if it is known.
    known: Vec<bool>,
    /// Voltages and potentials, where they are known.
    scalars: Vec<Option<f64>>,
    /// True if nothing moves there.
    is_at_rest: bool,
    /// Joint coordinates that it names.
    angles: BTreeMap<usize, f64>,
    /// Places of markers that it names.
    places: BTreeMap<usize, Place>,
}

impl<'a> End<'a> {
    fn new(
        model: &'a Model,
        control: &Control,
        time: f64,
        coordinates: &[Option<f64>],
        charts: &[f64],
        scalars: Option<Vec<f64>>,
    ) -> Self {
        let count = model.coordinate_count();
        let mut instant = model.action.map.instant();
        let reference = model.reference_coordinates();
        let values = coordinates.iter().zip(reference);
        for (z, (value, reference)) in instant.z[..count].iter_mut().zip(values) {
            *z = value.unwrap_or(reference);
        }
        let first = model.action.map.unknowns();
        instant.z[first..]
            .iter_mut()
            .zip(charts)
            .for_each(|(value, chart)| *value = *chart);
        model.action.map.vectors(&mut instant);
        Self {
            model,
            instant,
            known: coordinates[..count].iter().map(Option::is_some).collect(),
            scalars: {
                let variables = model.variables.of(Time::Interval).iter().enumerate();
                let known = variables.map(|(s, variable)| match (&scalars, variable.role) {
                    (_, Role::Parameter) => None,
                    (Some(scalars), _) => Some(scalars[s]),
                    (None, _) => control.given(variable, time),
                });
                known.collect()
            },
            is_at_rest: false,
            angles: BTreeMap::new(),
            places: BTreeMap::new(),
        }
    }

    /// Returns the message of a joint limit that it breaks.
    fn joint(&self, limit: &Limit) -> Option<String> {
        let joint = limit.joint()?;
        let value = self.joint_coordinate(joint)?;
        of_joint(joint, limit.bounds(), self.model).broken(value, &self.model.system)
    }

    /// The coordinate of a joint, where it is known.
    fn joint_coordinate(&self, joint: usize) -> Option<f64> {
        let joints = &self.model.system.joints;
        let of_gauge = || {
            if !self.known.iter().all(|known| *known) {
                let coordinate = self.model.joint_readings[joint].coordinate?;
                return self.known[coordinate].then(|| self.instant.z[coordinate]);
            }
            let mut instant = self.instant.clone();
            self.model.action.map.place(&mut instant);
            let near = (0..joints.len()).map(|j| self.angles.get(&j).copied().unwrap_or(0.0));
            Some(self.model.joints(&instant, &near.collect::<Vec<_>>())[joint])
        };
        self.angles.get(&joint).copied().or_else(of_gauge)
    }

    /// The value of a limited quantity.
    fn value(&self, bounded: &BoundedQuantity, measure: Option<usize>) -> Option<f64> {
        match bounded.quantity.what {
            _ if bounded.quantity.of != Of::Value => {}
            // Limits of the path are checked by themselves, whatever the coordinates.
            What::Joint { .. } if bounded.when == When::Everywhere => return None,
            What::Joint { joint, .. } => return self.joint_coordinate(joint),
            What::Place { marker, axis } => {
                let given = self.places.get(&marker).and_then(|place| place.0[axis]);
                if given.is_some() {
                    return given;
                }
            }
            What::Region { marker, region } => {
                if let Some(place) = self.places.get(&marker).and_then(Place::whole) {
                    return Some(region_value(&region, &place));
                }
            }
            _ => {}
        }
        let measure = Site::from_quantity(&bounded.quantity).measure(self.model, measure?);
        let map = &self.model.action.map;
        let mut reads = measure.vectors().into_iter().flat_map(|v| map.support(v));
        let is_known = reads.all(|i| self.known[i])
            && (self.is_at_rest || !measure.reads_rates())
            && measure.scalars().iter().all(|&s| self.scalars[s].is_some());
        let scalars: Vec<f64> = self.scalars.iter().map(|s| s.unwrap_or(0.0)).collect();
        let x = &self.instant.x[..];
        let sample = Sample::of_instant(x, &scalars);
        is_known.then(|| measure.value(&sample))
    }
}

/// A joint limit as a bounded quantity, whatever the coordinates.
fn of_joint(joint: usize, bounds: [f64; 2], model: &Model) -> BoundedQuantity {
    let name = format!("joint {}", model.system.joints[joint].name);
    BoundedQuantity::new(Quantity::joint(joint, 0.0), bounds, When::Everywhere, name)
}

/// The message of a limit of a reaction that the balance of bodies does not tell.
fn unknown_reaction(model: &Model, boundary: &BoundaryConditions) -> Option<String> {
    let mut limits = boundary.limits.list.iter().zip(&model.measured);
    let is_unknown = |(bounded, measure): &(&BoundedQuantity, &Option<usize>)| {
        matches!(bounded.quantity.what, What::Reaction { .. }) && measure.is_none()
    };
    let (bounded, _) = limits.find(is_unknown)?;
    Some(format!(
        "{} is not known: the joint does not move or is in a loop, or constraints glue blocks to bodies",
        bounded.name
    ))
}

/// The message of a limit of a stretch at which the law of the muscle has no energy.
fn beyond_law(model: &Model, limit: &Limit) -> Option<String> {
    let What::Stretch(muscle) = limit.what else {
        return None;
    };
    let muscle = &model.system.muscles[muscle];
    let mut bounds = limit.bounds().into_iter();
    let beyond = bounds.find_map(|bound| match bound > 0.0 && bound.is_finite() {
        true => muscle_beyond_law(muscle, bound),
        false => None,
    });
    beyond.map(|beyond| format!("at a bound {beyond}"))
}

/// Two limits of one quantity that leave it no value.
fn contradiction(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
) -> Option<String> {
    let along = control.limits.iter().filter(|limit| limit.part.is_none());
    let joints = along.filter_map(|limit| Some(of_joint(limit.joint()?, limit.bounds(), model)));
    let is_joint = |quantity: &Quantity| {
        matches!(quantity.what, What::Joint { .. }) && quantity.of == Of::Value
    };
    let is_path = |b: &&BoundedQuantity| b.when == When::Everywhere && !is_joint(&b.quantity);
    let others = boundary.limits.list.iter().filter(is_path).cloned();
    let all: Vec<BoundedQuantity> = joints.chain(others).collect();
    let below = all.iter().filter(|bounded| bounded.lower.is_finite());
    let crossed = |low: &&BoundedQuantity, high: &&BoundedQuantity| {
        low.quantity == high.quantity && low.bounds()[0] > high.bounds()[1]
    };
    let mut pairs = below.flat_map(|low| all.iter().map(move |high| (low, high)));
    let (low, high) = pairs.find(|(low, high)| crossed(low, high))?;
    let told = |bounded: &BoundedQuantity, bound: f64| {
        let (value, unit) = bounded.quantity.plain(bound, &model.system);
        format!("{} {unit}", significant(value, 5))
            .trim_end()
            .to_owned()
    };
    let (least, most) = (told(low, low.bounds()[0]), told(high, high.bounds()[1]));
    let name = &low.name;
    Some(format!(
        "{name}: at least {least} in one limit contradicts at most {most} in another"
    ))
}

fn region_value(region: &Region, place: &Vector3<f64>) -> f64 {
    let still = Vector3::zeros();
    match *region {
        Region::Sphere { centre, radius } => {
            let scale = radius;
            let energy = SquaredDistance { centre, scale };
            energy.at::<1>(place, &still).value()
        }
        Region::Box { min, max } => {
            let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
            let energy = OutsideBox { centre, half };
            energy.at::<1>(place, &still).value()
        }
    }
}

/// Refuses limits of given amounts that these break, and costs of given amounts.
pub(super) fn given_amounts(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
) -> Result<(), BoundaryError> {
    let is_given = |measure: &Option<usize>| measure.is_none();
    let limits = boundary.limits.list.iter().zip(&model.measured);
    for (bounded, _) in limits.filter(|(_, measure)| is_given(measure)) {
        let What::Amount { muscles, amount } = &bounded.quantity.what else {
            continue;
        };
        let value = amount.of(muscles, &model.system) / bounded.quantity.unit;
        if let Some(broken) = bounded.broken(value, &model.system) {
            let reason = format!("{broken}; no free parameter changes it");
            return Err(BoundaryError::refused("limits", reason));
        }
    }
    let costs = &control.objective.quantities;
    let measures = &model.measured[boundary.limits.quantities().len()..];
    for (cost, _) in costs.iter().zip(measures).filter(|(_, m)| is_given(m)) {
        if let What::Amount { muscles, amount } = &cost.quantity.what {
            let words = amount.words(muscles, &model.system);
            let reason = format!("no free parameter changes the {words}");
            return Err(BoundaryError::refused("objective", reason));
        }
    }
    Ok(())
}
