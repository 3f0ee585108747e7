//! Distances from bounds that are not reached, and multipliers of those that are, with their derivatives.

use crate::model::Model;
use crate::nlp::Nlp;
use crate::sensitivity::active_set::{Direction, Place, Side};
use crate::sensitivity::conditions::Conditions;
use crate::sensitivity::range::Margin;
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
