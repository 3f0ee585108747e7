//! Distances from bounds that are not reached, and multipliers of those that are, with their derivatives.
//!
//! Changes of what is held up to which the same bounds are reached, to first order.
//!
//! A bound that is not reached is at the distance s, a multiplier of one that is has the size s. Either becomes zero at the change −s/ṡ, where ṡ is
//! its derivative.

use crate::coordinates::Configuration;
use crate::model::Model;
use crate::nlp::Nlp;
use crate::sensitivity::conditions::{Conditions, Direction, Place, Side};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A bound of this side that ends a range, or, without one, the multiplier of that which is reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum Of {
    Variable(usize, Option<Side>),
    Constraint(usize, Option<Side>),
}

const SIDES: [(Side, f64); 2] = [(Side::Lower, 1.0), (Side::Upper, -1.0)];

/// A variable or a constraint with its multiplier, and their derivatives along a direction.
struct Placed {
    place: Place,
    value: f64,
    rate: f64,
    multiplier: f64,
    of_multiplier: f64,
}

impl Placed {
    /// Adds its distances from bounds, which move, or the size of its multiplier.
    fn add(
        &self,
        bounds: impl Fn(Side) -> [f64; 2],
        of: impl Fn(Option<Side>) -> Of,
        margins: &mut Vec<Margin>,
    ) {
        match self.place {
            Place::Free => {
                let of_side = |(side, sign)| {
                    let [bound, moved] = bounds(side);
                    bound.is_finite().then(|| Margin {
                        distance: sign * (self.value - bound),
                        rate: sign * (self.rate - moved),
                        of: of(Some(side)),
                    })
                };
                margins.extend(SIDES.into_iter().filter_map(of_side));
            }
            Place::Lower | Place::Upper => margins.push(Margin {
                distance: self.place.sign() * self.multiplier,
                rate: self.place.sign() * self.of_multiplier,
                of: of(None),
            }),
            Place::Equation | Place::Held => {}
        }
    }
}

impl<N: Nlp> Conditions<N> {
    /// All margins of an optimum with their derivatives along a direction, by those of the unknowns and of the multipliers of constraints, and by those
    /// of the slopes and of the constraints while both stay.
    pub(super) fn margins(
        &self,
        [x, y]: [&[f64]; 2],
        [slopes, constraints]: [&[f64]; 2],
        direction: &Direction,
    ) -> Vec<Margin> {
        let mut margins = Vec::new();
        let mut slopes = slopes.to_vec();
        self.add_curved(x, &mut slopes);
        self.add_transposed(y, &mut slopes);
        let mut moved = [vec![0.0; self.columns.len()], vec![0.0; self.columns.len()]];
        for &(i, side, value) in &direction.bounds {
            let given = side.of(self.program().variables())[i];
            moved[side as usize][i] += self.squares.rate(i, given) * value;
        }
        for (i, &place) in self.columns.iter().enumerate() {
            let variable = Placed {
                place,
                value: self.x[i],
                rate: x[i],
                multiplier: -self.slopes[i],
                of_multiplier: -slopes[i],
            };
            let bounds = |side: Side| [side.of(&self.bounds)[i], moved[side as usize][i]];
            variable.add(bounds, |side| Of::Variable(i, side), &mut margins);
        }
        let mut constraints = constraints.to_vec();
        self.add_times(x, &mut constraints);
        let given = &direction.constraint_bounds;
        for (i, &place) in self.rows.iter().enumerate() {
            let constraint = Placed {
                place,
                value: self.g[i],
                rate: constraints[i],
                multiplier: self.y[i],
                of_multiplier: y[i],
            };
            let bounds = |side: Side| [side.of(&self.row_bounds)[i], moved_by(given, i, side)];
            constraint.add(bounds, |side| Of::Constraint(i, side), &mut margins);
        }
        margins
    }

    /// The bound of a margin in words.
    pub(super) fn words(&self, of: Of) -> String {
        let (name, side) = match of {
            Of::Variable(i, side) => (self.program().variable_name(i), side),
            Of::Constraint(i, side) => (self.program().constraint_name(i), side),
        };
        match side {
            Some(Side::Lower) => format!("{name} reaches its lower bound"),
            Some(Side::Upper) => format!("{name} reaches its upper bound"),
            None => format!("{name} leaves its bound"),
        }
    }
}

/// Change of a bound.
fn moved_by(list: &[(usize, Side, f64)], i: usize, side: Side) -> f64 {
    let of = list.iter().filter(|one| (one.0, one.1) == (i, side));
    of.map(|one| one.2).sum()
}

/// Coordinates with derivatives that are not zero.
type Slopes = Vec<(usize, f64)>;

/// Derivatives of the places of markers, by marker and axis, and of joint coordinates, by joint of one coordinate.
pub(super) struct PartSlopes {
    markers: Vec<[Slopes; 3]>,
    joints: BTreeMap<usize, Slopes>,
}

impl PartSlopes {
    /// Derivatives at an instant with unknowns z.
    pub(super) fn new(model: &Model, z: &[f64]) -> Self {
        let map = &model.action.map;
        let mut instant = map.placed(z);
        let joints = model.system.joints.iter().enumerate();
        let joints = joints.filter(|(_, joint)| joint.has_coordinate());
        let joints = joints.map(|(j, _)| (j, of_joint(model, j, &mut instant)));
        let joints = joints.collect();
        let mut row = vec![0.0; map.unknowns()];
        let mut slopes = |vector: usize, axis: usize| {
            let mut along = Vector3::zeros();
            along[axis] = 1.0;
            row.fill(0.0);
            map.pull_back_one(vector, &instant.columns, &along, &mut row);
            let coordinates = row[..model.coordinate_count()].iter().copied();
            let slopes = coordinates.enumerate();
            slopes.filter(|(_, slope)| *slope != 0.0).collect()
        };
        let mut of = |&vector: &usize| [0, 1, 2].map(|axis| slopes(vector, axis));
        Self {
            markers: model.markers.iter().map(&mut of).collect(),
            joints,
        }
    }

    /// Those of the place of a marker along an axis.
    pub(super) fn marker(&self, marker: usize, axis: usize) -> &[(usize, f64)] {
        &self.markers[marker][axis]
    }

    /// Those of the coordinate of a joint, which is its only one.
    pub(super) fn joint(&self, joint: usize) -> Option<&[(usize, f64)]> {
        self.joints.get(&joint).map(Vec::as_slice)
    }

    /// Changes of the places with those of the coordinates.
    pub(super) fn markers_along(&self, changes: &[f64]) -> Vec<Vector3<f64>> {
        let change = |slopes: &Slopes| along(slopes, changes);
        let place = |axes: &[Slopes; 3]| Vector3::from(axes.each_ref().map(change));
        self.markers.iter().map(place).collect()
    }

    /// Changes of the joint coordinates.
    pub(super) fn joints_along(&self, changes: &[f64]) -> Vec<f64> {
        let change = |slopes: &Slopes| match slopes.is_empty() {
            true => 0.0,
            false => along(slopes, changes),
        };
        self.joints.values().map(change).collect()
    }
}

fn along(slopes: &Slopes, changes: &[f64]) -> f64 {
    slopes.iter().map(|&(c, slope)| slope * changes[c]).sum()
}

/// Derivatives of the coordinate of a joint at a placed instant; none of one that does not move.
fn of_joint(model: &Model, joint: usize, instant: &mut Configuration) -> Slopes {
    if let Some(own) = model.joint_readings[joint].coordinate {
        return vec![(own, 1.0)];
    }
    if model.presolved.joint(joint).is_none() {
        return Vec::new();
    }
    let mut slope = |i: usize| {
        instant.l.fill(0.0);
        instant.l[i] = 1.0;
        model.joint_rate(joint, instant)
    };
    let slopes = (0..model.coordinate_count()).map(|i| (i, slope(i)));
    slopes.filter(|(_, slope)| *slope != 0.0).collect()
}

/// The change at which other bounds are reached, in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// The change; infinite where there is none.
    pub change: f64,
    /// The bound that is reached or left there.
    pub bound: Option<String>,
}

/// Changes between which the same bounds are reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Downwards: a change that is not positive.
    pub down: End,
    /// Upwards.
    pub up: End,
}

/// A derivative this small relative to the greatest is rounding.
const ROUNDING: f64 = 1e-9;

/// Multiple of a value beyond which none is asked whether it has a meaning.
const FAR: f64 = 100.0;

/// A distance from a bound, or the size of a multiplier, with its derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    pub(super) distance: f64,
    pub(super) rate: f64,
    pub(super) of: Of,
}

impl Range {
    /// The range of these margins.
    pub(super) fn new(margins: &[Margin], words: impl Fn(Of) -> String) -> Self {
        let least = least_rate(margins);
        let end = |sign: f64| {
            let falling = margins.iter().filter(|one| sign * one.rate < -least);
            let change = |one: &Margin| one.distance.max(0.0) / one.rate.abs();
            let first = falling.min_by(|a, b| change(a).total_cmp(&change(b)));
            End {
                change: sign * first.map_or(f64::INFINITY, change),
                bound: first.map(|one| words(one.of)),
            }
        };
        Self {
            down: end(-1.0),
            up: end(1.0),
        }
    }

    /// The part of the range around `value` within which values have a meaning.
    #[must_use]
    pub(super) fn while_true(mut self, value: f64, has_meaning: impl Fn(f64) -> bool) -> Self {
        for end in [&mut self.down, &mut self.up] {
            let far = FAR * value.abs().max(f64::MIN_POSITIVE);
            let (mut good, mut bad) = (0.0, end.change.clamp(-far, far));
            if has_meaning(value + bad) {
                continue;
            }
            while (bad - good).abs() > f64::EPSILON * value.abs() {
                let middle = 0.5 * (good + bad);
                match has_meaning(value + middle) {
                    true => good = middle,
                    false => bad = middle,
                }
            }
            *end = End {
                change: bad,
                bound: Some("it loses its meaning".to_owned()),
            };
        }
        self
    }

    /// Margins that a change ends at once, to either side.
    pub(super) fn ends_at_once(margins: &[Margin], distance: f64) -> impl Iterator<Item = Of> {
        let least = least_rate(margins);
        let is_at_once = move |one: &&Margin| one.distance < distance && one.rate.abs() > least;
        margins.iter().filter(is_at_once).map(|one| one.of)
    }
}

/// The derivative up to which all are rounding.
fn least_rate(margins: &[Margin]) -> f64 {
    let rates = margins.iter().map(|one| one.rate.abs());
    ROUNDING * rates.fold(0.0, f64::max)
}
