//! Distances from bounds that are not reached, and multipliers of those that are, with their derivatives.
//!
//! Changes of what is held up to which the same bounds are reached, to first order.
//!
//! A bound that is not reached is at the distance s, a multiplier of one that is has the size s. Either becomes zero at the change −s/ṡ, where ṡ is
//! its derivative.

use crate::model::Model;
use crate::nlp::Nlp;
use crate::sensitivity::conditions::{Conditions, Direction, Place, Side};
use nalgebra::Vector3;

/// A bound, or its multiplier, that ends a range.
#[derive(Clone, Copy, Debug)]
pub(super) enum Of {
    Variable(usize, Side),
    Constraint(usize, Side),
    MultiplierOfVariable(usize),
    MultiplierOfConstraint(usize),
}

/// Derivatives along a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Changes<'a> {
    /// Of the unknowns and of the multipliers of constraints.
    pub(super) x: &'a [f64],
    pub(super) y: &'a [f64],
    /// Of the slopes and of the constraints, while both stay.
    pub(super) slopes: &'a [f64],
    pub(super) constraints: &'a [f64],
    pub(super) direction: &'a Direction,
}

/// An optimum: its conditions, the places of variables and constraints, and `∇f + Jᵀy`.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<'a, N> {
    pub(super) conditions: &'a Conditions<N>,
    pub(super) columns: &'a [Place],
    pub(super) rows: &'a [Place],
    pub(super) slopes: &'a [f64],
}

const SIDES: [(Side, f64); 2] = [(Side::Lower, 1.0), (Side::Upper, -1.0)];

impl<N: Nlp> At<'_, N> {
    /// All margins of an optimum with their derivatives.
    pub(super) fn margins(&self, changes: Changes<'_>) -> Vec<Margin<Of>> {
        let mut margins = self.of_variables(changes);
        self.add_constraints(changes, &mut margins);
        margins
    }

    fn of_variables(&self, changes: Changes<'_>) -> Vec<Margin<Of>> {
        let conditions = self.conditions;
        let mut slopes = changes.slopes.to_vec();
        conditions.add_curved(changes.x, &mut slopes);
        conditions.add_transposed(changes.y, &mut slopes);
        let mut moved = [vec![0.0; self.columns.len()], vec![0.0; self.columns.len()]];
        for &(i, side, value) in &changes.direction.bounds {
            let given = side.of(conditions.given_bounds())[i];
            moved[side as usize][i] += conditions.squares.rate(i, given) * value;
        }
        let mut margins = Vec::new();
        for (i, place) in self.columns.iter().enumerate() {
            match place {
                Place::Free => {
                    for (side, sign) in SIDES {
                        let bound = side.of(&conditions.bounds)[i];
                        if !bound.is_finite() {
                            continue;
                        }
                        let of_bound = moved[side as usize][i];
                        margins.push(Margin {
                            distance: sign * (conditions.x[i] - bound),
                            rate: sign * (changes.x[i] - of_bound),
                            of: Of::Variable(i, side),
                        });
                    }
                }
                Place::Lower | Place::Upper => margins.push(Margin {
                    distance: -place.sign() * self.slopes[i],
                    rate: -place.sign() * slopes[i],
                    of: Of::MultiplierOfVariable(i),
                }),
                Place::Equation | Place::Held => {}
            }
        }
        margins
    }

    fn add_constraints(&self, changes: Changes<'_>, margins: &mut Vec<Margin<Of>>) {
        let conditions = self.conditions;
        let mut constraints = changes.constraints.to_vec();
        conditions.add_times(changes.x, &mut constraints);
        for (i, place) in self.rows.iter().enumerate() {
            match place {
                Place::Free => {
                    for (side, sign) in SIDES {
                        let bound = side.of(&conditions.row_bounds)[i];
                        let of_bound = moved(&changes.direction.constraint_bounds, i, side);
                        if bound.is_finite() {
                            margins.push(Margin {
                                distance: sign * (conditions.g[i] - bound),
                                rate: sign * (constraints[i] - of_bound),
                                of: Of::Constraint(i, side),
                            });
                        }
                    }
                }
                Place::Lower | Place::Upper => margins.push(Margin {
                    distance: place.sign() * conditions.y[i],
                    rate: place.sign() * changes.y[i],
                    of: Of::MultiplierOfConstraint(i),
                }),
                Place::Equation | Place::Held => {}
            }
        }
    }

    /// The bound of a margin in words.
    pub(super) fn words(&self, of: Of) -> String {
        let side = |side: Side| match side {
            Side::Lower => "lower",
            Side::Upper => "upper",
        };
        let of_variable = |i: usize| self.conditions.variable_name(i);
        let of_constraint = |i: usize| self.conditions.constraint_name(i);
        match of {
            Of::Variable(i, at) => format!("{} reaches its {} bound", of_variable(i), side(at)),
            Of::Constraint(i, at) => format!("{} reaches its {} bound", of_constraint(i), side(at)),
            Of::MultiplierOfVariable(i) => format!("{} leaves its bound", of_variable(i)),
            Of::MultiplierOfConstraint(i) => format!("{} leaves its bound", of_constraint(i)),
        }
    }
}

/// Change of a bound.
fn moved(list: &[(usize, Side, f64)], i: usize, side: Side) -> f64 {
    let of = list.iter().filter(|one| (one.0, one.1) == (i, side));
    of.map(|one| one.2).sum()
}

/// Coordinates with derivatives that are not zero.
type Slopes = Vec<(usize, f64)>;

/// Derivatives by marker and axis.
pub(super) struct MarkerSlopes(Vec<[Slopes; 3]>);

impl MarkerSlopes {
    /// Derivatives at an instant with unknowns z.
    pub(super) fn new(model: &Model, z: &[f64]) -> Self {
        let map = &model.action.map;
        let mut instant = map.placed(z);
        map.tangent(&mut instant);
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
        Self(model.markers.iter().map(&mut of).collect())
    }

    /// Those of the place of a marker along an axis.
    pub(super) fn of(&self, marker: usize, axis: usize) -> &[(usize, f64)] {
        &self.0[marker][axis]
    }

    /// Changes of the places with those of the coordinates.
    pub(super) fn along(&self, changes: &[f64]) -> Vec<Vector3<f64>> {
        let change = |slopes: &Slopes| slopes.iter().map(|&(c, slope)| slope * changes[c]).sum();
        let place = |axes: &[Slopes; 3]| Vector3::from(axes.each_ref().map(change));
        self.0.iter().map(place).collect()
    }
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

/// A distance with its derivative, and a number by which its words are found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin<M> {
    pub(super) distance: f64,
    pub(super) rate: f64,
    pub(super) of: M,
}

impl Range {
    /// The range of these margins.
    pub(super) fn new<M: Copy>(margins: &[Margin<M>], words: impl Fn(M) -> String) -> Self {
        let least = least_rate(margins);
        let end = |sign: f64| {
            let falling = margins.iter().filter(|one| sign * one.rate < -least);
            let change = |one: &Margin<M>| one.distance.max(0.0) / one.rate.abs();
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
    pub(super) fn ends_at_once<M: Copy>(
        margins: &[Margin<M>],
        distance: f64,
    ) -> impl Iterator<Item = M> {
        let least = least_rate(margins);
        let is_at_once = move |one: &&Margin<M>| one.distance < distance && one.rate.abs() > least;
        margins.iter().filter(is_at_once).map(|one| one.of)
    }
}

/// The derivative up to which all are rounding.
fn least_rate<M>(margins: &[Margin<M>]) -> f64 {
    let rates = margins.iter().map(|one| one.rate.abs());
    ROUNDING * rates.fold(0.0, f64::max)
}
