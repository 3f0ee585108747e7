//! Derivatives of the places of markers by the coordinates of an instant.

use crate::model::Model;
use nalgebra::Vector3;

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
